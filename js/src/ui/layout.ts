/**
 * The panels of the lab: all in one screen, and the world the largest. The arrangement, sizes and hidden panels are
 * kept by the browser. A panel moves in the document only where it keeps its focus and where it was scrolled to.
 */

import { arrange } from "./boxes";
import { h, setAttribute } from "./dom";
import { forget, forgetAll, keep, kept } from "./kept";
import { ARRANGEMENTS, type Arrangement, HEAD, planFor } from "./plans";
import { put, splitter } from "./splitter";
import { Tabs } from "./tabs";

const ARRANGEMENT = "arrangement";
const HIDDEN = "hidden-";
const SHARE = "share-";
const STACK = ["world", "goal", "editor", "machines", "lists"]; // see frame.css
const STACKED = 300; // px: the world's height where the panels are stacked, at most
/** Set by a panel while there is nothing that it could show: no challenge, no runs. */
export const ABSENT = "data-absent";
/** Set while the conditions of a study withhold a panel. */
export const WITHHELD = "data-withheld";
/** Set by the world's panel while it shows a world: its width divided by its height. */
export const ASPECT = "data-aspect";

export type Panels = Record<
  "goal" | "editor" | "tree" | "graph" | "world" | "variables" | "robot" | "issues" | "runs" | "breakpoints",
  HTMLElement
>;

export class Layout {
  readonly element: HTMLElement;
  /** What has a place of its own: a panel, the tree and the graph together, or the panels that share tabs. */
  private readonly places: Map<string, HTMLElement>;
  private readonly bars = new Map<string, ReturnType<typeof splitter>>(); // by the names of divisions
  /** Called when the user shows or hides a panel, or shows it alone. */
  told: (about: string, on: boolean) => void = () => {};
  /** Makes a change in which what one reads stays in place. */
  holding: (change: () => void) => void = (change) => change();
  private alone: HTMLElement | null = null;
  private readonly tabs: Tabs;
  private looksBack = false;
  private readonly observer = new ResizeObserver(() => {
    if (this.element.clientWidth) this.update(); // in a tab that is not shown, everything stays as it is
  });
  private readonly robots = new MutationObserver(() => this.update());

  constructor(readonly panels: Readonly<Panels>) {
    const { goal, editor, tree, graph, world, ...others } = panels;
    const machines = h("div", { class: "lrp-machines" }, tree, graph);
    this.tabs = new Tabs(others, isPanelVisible);
    this.tabs.told = (name, on) => this.told(name, on);
    const lists = this.tabs.element;
    this.places = new Map(Object.entries({ goal, editor, machines, world, lists }));
    this.element = h("div", { class: "lrp-panels" }, ...this.places.values());
    for (const [name, panel] of Object.entries(panels)) panel.hidden = kept(HIDDEN + name) !== null;
    this.observer.observe(this.element);
    this.robots.observe(panels.world, { attributes: true, attributeFilter: [ASPECT] });
    for (const panel of [panels.goal, panels.runs])
      this.robots.observe(panel, { attributes: true, attributeFilter: [ABSENT] });
    this.update();
  }

  show(name: keyof Panels, on: boolean): void {
    this.panels[name].hidden = !on;
    if (on) forget(HIDDEN + name);
    else keep(HIDDEN + name, "");
    this.told(name, on);
    this.maximise(null);
  }

  /** Withhold these panels, and no others, whatever the user has chosen. */
  withhold(names: readonly string[]): void {
    for (const [name, panel] of Object.entries(this.panels))
      panel.toggleAttribute(WITHHELD, names.includes(name));
    this.maximise(this.alone?.hasAttribute(WITHHELD) ? null : this.alone);
  }

  /** Bring one of the panels that share tabs to the front, or null: let the user's choice return to it. */
  call(name: keyof Panels | null): void {
    this.tabs.call(name);
  }

  /** Bring one of them to the front, and show it if it is hidden, as if the user had done so. */
  choose(name: keyof Panels): void {
    if (this.panels[name].hidden) this.show(name, true);
    else this.maximise(null);
    this.tabs.choose(name);
    if (this.element.hasAttribute("data-stacked")) this.panels[name].scrollIntoView({ block: "nearest" });
  }

  get arrangement(): Arrangement {
    const name = kept(ARRANGEMENT);
    return ARRANGEMENTS.find((each) => each === name) ?? "work";
  }

  set arrangement(name: Arrangement) {
    keep(ARRANGEMENT, name);
    this.maximise(null);
  }

  /** Make the world larger while an earlier moment is shown, unless it is large. */
  lookBack(on: boolean): void {
    if (this.looksBack === on) return;
    this.looksBack = on;
    this.holding(() => this.update());
  }

  /** The panel that is shown alone. */
  get maximised(): HTMLElement | null {
    return this.alone;
  }

  maximise(panel: HTMLElement | null): void {
    for (const [name, each] of Object.entries(this.panels)) {
      if (panel !== this.alone && (each === panel || each === this.alone))
        this.told(`${name} alone`, each === panel);
    }
    if (this.alone) mark(this.alone, false);
    this.alone = panel;
    if (panel) mark(panel, true);
    this.update();
  }

  /** Return to the usual sizes, at every width. */
  reset(): void {
    forgetAll((name) => name.startsWith(SHARE));
    this.maximise(null);
  }

  close(): void {
    this.observer.disconnect();
    this.robots.disconnect();
    this.tabs.close();
  }

  private update(): void {
    this.tabs.update();
    const machines = this.places.get("machines")!;
    const only = machines.contains(this.alone) ? this.alone : null;
    const shows = (["tree", "graph"] as const).filter((name) => {
      const panel = this.panels[name];
      return isPanelVisible(panel) && (!only || only === panel);
    });
    setAttribute(machines, "data-shows", shows.join(" "));
    const alone = [...this.places.keys()].find((name) => this.places.get(name)!.contains(this.alone));
    const { clientWidth: width, clientHeight: height, parentElement: lab } = this.element;
    const room = { width, height, lab: (lab?.clientWidth ?? width) * (lab?.clientHeight ?? height) };
    const shown = {
      hasGoal: isVisible(this.panels.goal),
      aspect: Number(this.panels.world.getAttribute(ASPECT)) || null,
    };
    const { arrangement } = this;
    const plan =
      alone ?? planFor(room, shown, arrangement === "work" && this.looksBack ? "past" : arrangement);
    this.element.toggleAttribute("data-stacked", !plan);
    const stacked = shown.aspect
      ? HEAD + Math.min(STACKED, width / shown.aspect, 0.6 * Math.max(STACKED, height)) // the program is in sight
      : STACKED;
    this.panels.world.style.setProperty("--lrp-stacked", `${Math.round(stacked)}px`);
    const { boxes, bars } = arrange(
      plan,
      (name) => isVisible(this.places.get(name)!),
      ({ name, share }) => Number(kept(SHARE + name)) || share,
    );
    for (const [name, place] of this.places) {
      const box = boxes.get(name);
      if (box) put(place, box);
      place.toggleAttribute("data-away", Boolean(plan) && !box); // and it keeps its size: nothing in it is laid out again
    }
    this.order([...boxes.keys()]);
    const named = new Map(bars.map((bar) => [bar.division.name, bar]));
    for (const [name, { element }] of this.bars) element.hidden = !named.has(name);
    for (const [name, bar] of named) (this.bars.get(name) ?? this.makeBar(name)).update(bar);
  }

  /** Let the tab key go through the panels as they are read, in browsers in which elements can move and stay as they are. */
  private order(names: string[]): void {
    const element: Element & { moveBefore?(moved: Element, before: Element | null): void } = this.element;
    const wanted = (names.length ? names : STACK).map((name) => this.places.get(name)!);
    wanted.forEach((place, index) => {
      const there = element.children[index] ?? null;
      if (there !== place && element.isConnected) element.moveBefore?.(place, there);
    });
  }

  private makeBar(name: string) {
    const bar = splitter(this.element, (share) => {
      if (share === null) forget(SHARE + name);
      else keep(SHARE + name, share.toFixed(1));
      this.update();
    });
    this.bars.set(name, bar);
    this.element.append(bar.element);
    return bar;
  }
}

function mark(panel: HTMLElement, isAlone: boolean): void {
  panel.toggleAttribute("data-maximised", isAlone);
  const button = panel.querySelector('[data-lrp-action="enlarge"]');
  if (button) setAttribute(button, "aria-pressed", String(isAlone));
}

function isVisible(place: HTMLElement): boolean {
  const panels = place.matches(".lrp-panel")
    ? [place]
    : [...place.querySelectorAll<HTMLElement>(".lrp-panel")];
  return panels.some(isPanelVisible);
}

function isPanelVisible(panel: HTMLElement): boolean {
  return !panel.hidden && !panel.hasAttribute(ABSENT) && !panel.hasAttribute(WITHHELD);
}
