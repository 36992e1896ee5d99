/** Panels in one place, one of them in front; their headings are the tabs. */

import { consume, h, setAttribute } from "./dom";
import { keep, kept } from "./kept";

const CHOSEN = "tab";
/** Set while another tab is in front. */
const BEHIND = "data-behind";
const PEEP = 20; // px of a neighbour beside the tab in front: enough to press it

export class Tabs {
  readonly element: HTMLElement;
  private readonly strip: HTMLElement;
  private readonly tabs = new Map<string, HTMLButtonElement>();
  private chosen = kept(CHOSEN) ?? "";
  private called: string | null = null;
  private readonly sizes = new ResizeObserver(() => this.reveal());
  /** Called when the user brings a panel to the front, or leaves it. */
  told: (panel: string, on: boolean) => void = () => {};

  constructor(
    private readonly panels: Readonly<Record<string, HTMLElement>>,
    /** Whether a panel may be shown. */
    private readonly isShown: (panel: HTMLElement) => boolean,
  ) {
    for (const [name, panel] of Object.entries(panels)) {
      const onclick = () => this.choose(name);
      const attributes = { type: "button", role: "tab", class: "lrp-tab", "data-lrp-tab": name, onclick };
      this.tabs.set(name, h("button", attributes, panel.querySelector(".lrp-title")));
    }
    this.strip = h("div", { class: "lrp-tab-strip", role: "tablist" }, ...this.tabs.values());
    this.strip.addEventListener("keydown", (event) => this.move(event));
    this.element = h("div", { class: "lrp-tabs" }, this.strip, ...Object.values(panels));
    this.update();
    const sized = this.element.querySelectorAll(".lrp-tab-strip, .lrp-tab, .lrp-head");
    for (const each of sized) this.sizes.observe(each);
  }

  /** Show a panel until it is let go: it is not what the user has chosen. */
  call(name: string | null): void {
    if (this.called === name) return;
    this.called = name;
    this.update();
  }

  update(): void {
    const shown = [...this.tabs.keys()].filter((name) => this.isShown(this.panels[name]!));
    const front = [this.called, this.chosen].find((name) => name && shown.includes(name)) ?? shown[0];
    for (const [name, tab] of this.tabs) {
      tab.hidden = !shown.includes(name);
      setAttribute(tab, "aria-selected", String(name === front));
      setAttribute(tab, "tabindex", name === front ? "0" : "-1");
      this.panels[name]!.toggleAttribute(BEHIND, name !== front);
    }
    this.reveal();
  }

  close(): void {
    this.sizes.disconnect();
  }

  /** Scroll the tab in front into view, beside its panel's buttons and between the ends of its neighbours. */
  private reveal(): void {
    const { front, strip } = this;
    const tab = this.tabs.get(front ?? "");
    if (!tab) return;
    const head = this.panels[front!]?.querySelector<HTMLElement>(".lrp-head");
    const tools = (head?.offsetWidth ?? 0) + 1; // and what is less than a px
    strip.style.paddingRight = `${tools}px`;
    const [left, right] = [tab.offsetLeft - PEEP, tab.offsetLeft + tab.offsetWidth + PEEP];
    strip.scrollLeft = Math.min(left, Math.max(0, right + tools - strip.clientWidth));
  }

  /** Bring a panel to the front, as the user has chosen. */
  choose(name: string): void {
    const before = this.front;
    this.chosen = name;
    this.called = null;
    keep(CHOSEN, name);
    this.update();
    if (before === name) return;
    if (before) this.told(before, false);
    this.told(name, true);
  }

  private get front(): string | undefined {
    return [...this.tabs.keys()].find((name) => !this.panels[name]!.hasAttribute(BEHIND));
  }

  private move(event: KeyboardEvent): void {
    const shown = [...this.tabs].filter(([, tab]) => !tab.hidden);
    const at = shown.findIndex(([name]) => name === this.front);
    const to = { ArrowLeft: at - 1, ArrowRight: at + 1, Home: 0, End: -1 }[event.key];
    const next = to === undefined ? null : shown.at(to % shown.length);
    if (!next) return;
    this.choose(next[0]);
    next[1].focus();
    consume(event);
  }
}
