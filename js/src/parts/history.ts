/**
 * The last half minute of a live value: in a card beside it while the pointer or the focus is on it, and in the
 * timeline once it is pinned. Elements say of what they show the value with `data-lrp-history`.
 */

import type { Lab } from "../session/store";
import { type Spark, type Subject, spark, titleOf } from "../timeline/spark";
import { button } from "../ui/button";
import { openCard } from "../ui/card";
import { h, setAttribute, setProse } from "../ui/dom";
import { type Point, placeInSight } from "../ui/point";
import { partInSight } from "../ui/sight";
import { lookedAt } from "./study";

const OPENS = 250; // ms that the pointer rests on a value
const CLOSES = 120; // ms until it has come to another
const EDGE = 4; // px
const MARK = "data-lrp-history";

/** The attribute of an element that shows a value. */
export function history(subject: Subject): Record<string, string> {
  return { [MARK]: JSON.stringify(subject) };
}

/** Add plots to the timeline; those that are all there already are removed. */
export function pin({ store }: Lab, names: readonly string[]): void {
  const { plots } = store.state;
  const added = names.filter((name) => !plots.includes(name));
  store.set("plots", added.length ? [...plots, ...added] : plots.filter((name) => !names.includes(name)));
}

function arePinned({ store }: Lab, names: readonly string[]): boolean {
  return names.length > 0 && names.every((name) => store.state.plots.includes(name));
}

/** Open a card that stays, with a button that pins it: for the keyboard, and for fingers. */
export function openHistory(lab: Lab, subject: Subject, at: Point): void {
  const pinning = button({
    label: "Plot in the timeline",
    title: "Add it to the timeline, or remove it from there",
    action: "pin",
    onclick: () => pin(lab, shown.names()),
  });
  let place = () => {};
  let size = 0;
  const say = () => setAttribute(pinning, "aria-pressed", String(arePinned(lab, shown.names())));
  const words = h("p", { class: "lrp-faint", role: "status" });
  const shown = spark(lab, subject, (reason) => {
    say();
    setProse(words, reason);
    pinning.disabled = reason !== "";
    if (shown.element.offsetHeight !== size) place();
    size = shown.element.offsetHeight;
  });
  pinning.disabled = true;
  const end = lab.store.watch(["plots"], say);
  const told = lookedAt(lab, titleOf(subject));
  const title = h("span", {}, titleOf(subject));
  const foot = h("div", { class: "lrp-row" }, pinning);
  const opened = openCard(lab, at, "close-history", [title], [shown.element, words, foot], () => {
    told();
    end();
    shown.close();
  });
  place = opened.place;
}

/** A card that is open while something is under the pointer, or has the focus. */
interface Hovering {
  key: string;
  shown: Spark;
  close(): void;
}

/** Show the history of values in a lab. */
export function histories(lab: Lab): void {
  const { root } = lab;
  let timer: ReturnType<typeof setTimeout> | undefined;
  let open: Hovering | null = null;
  let pointer = "";
  const valueAt = (event: Event) => (event.target as Element).closest<HTMLElement>(`[${MARK}]`);
  const close = () => {
    clearTimeout(timer);
    open?.close();
    open = null;
  };
  const soon = (act: () => void, after: number) => {
    clearTimeout(timer);
    timer = setTimeout(act, after);
  };
  const show = (value: HTMLElement, after: number) => {
    const key = value.getAttribute(MARK)!;
    if (open?.key === key) clearTimeout(timer);
    else if (!lab.store.state.settings.quiet)
      soon(() => {
        close();
        if (value.isConnected) open = hovering(lab, value, key);
      }, after);
  };
  const listen = { signal: lab.closed };
  root.addEventListener(
    "pointerover",
    (event) => {
      const value = event.pointerType === "mouse" && !event.buttons && valueAt(event);
      if (value) show(value, open ? 0 : OPENS);
      else soon(close, CLOSES);
    },
    listen,
  );
  root.addEventListener("pointerleave", close, listen);
  root.addEventListener(
    "focusin",
    (event) => {
      const value = valueAt(event);
      if (value?.matches(":focus-visible")) show(value, OPENS);
      else if (open) close();
    },
    listen,
  );
  root.addEventListener("focusout", () => soon(close, CLOSES), listen);
  for (const kind of ["keydown", "wheel"] as const)
    root.addEventListener(kind, close, { ...listen, capture: true, passive: true });
  root.addEventListener(
    "pointerdown",
    (event) => {
      pointer = event.pointerType;
      if (!valueAt(event)) close();
    },
    { ...listen, capture: true },
  );
  root.addEventListener(
    "mousedown",
    (event) => {
      if (pins(valueAt(event))) event.preventDefault(); // the cursor of the editor stays
    },
    listen,
  );
  root.addEventListener(
    "click",
    (event) => {
      const value = valueAt(event);
      if (!value || !pins(value)) return;
      const key = value.getAttribute(MARK)!;
      if (pointer === "touch" || lab.store.state.settings.quiet) {
        const { left, bottom } = value.getBoundingClientRect();
        close();
        if (!lab.store.state.settings.quiet) openHistory(lab, JSON.parse(key), { x: left, y: bottom });
        return;
      }
      const names = open?.key === key ? open.shown.names() : [];
      if (names.length) pin(lab, names);
      else void firstNames(lab, JSON.parse(key)).then((found) => pin(lab, found));
    },
    listen,
  );
  lab.store.watch(["snapshot"], close);
}

/** Whether a click on a value pins it; that on a button does what it says. */
function pins(value: HTMLElement | null): boolean {
  return value !== null && (value.tagName !== "BUTTON" || value.dataset.lrpAction === "pin");
}

async function firstNames(lab: Lab, subject: Subject): Promise<string[]> {
  const { plots = [] } = await lab.ask({ type: "plots", ...subject, seconds: 1 });
  return plots.map(({ name }) => name);
}

function hovering(lab: Lab, value: HTMLElement, key: string): Hovering {
  const subject: Subject = JSON.parse(key);
  const hint = h("p", { class: "lrp-faint" });
  const say = () => {
    const names = shown.names();
    const words = arePinned(lab, names) ? "In the timeline. Click: remove" : "Click: plot in the timeline";
    hint.textContent = pins(value) && names.length ? words : "";
  };
  const place = () => {
    const { left, right, top, bottom } = value.getBoundingClientRect();
    const { bottom: lowest } = partInSight(lab.root);
    const height = card.offsetHeight + EDGE;
    const isAbove = bottom + height > lab.root.getBoundingClientRect().top + lowest;
    const x = Math.max(left, right - card.offsetWidth);
    placeInSight(lab.root, card, { x, y: isAbove ? top - height : bottom + EDGE }, EDGE);
  };
  const shown = spark(lab, subject, (reason) => {
    card.hidden = reason !== "";
    say();
    place();
  });
  const card = h("div", { class: "lrp-history-card", hidden: true }, shown.element, hint);
  const end = lab.store.watch(["plots"], say);
  const told = lookedAt(lab, titleOf(subject));
  lab.root.append(card);
  return {
    key,
    shown,
    close() {
      told();
      end();
      shown.close();
      card.remove();
    },
  };
}
