/** The last half minute of a live value: in a card, and in the timeline once it is pinned. */

import type { Lab } from "../session/store";
import { type Subject, spark, titleOf } from "../timeline/spark";
import { button } from "../ui/button";
import { openCard } from "../ui/card";
import { h, setAttribute, setProse } from "../ui/dom";
import type { Point } from "../ui/point";
import { lookedAt } from "./study";

export const MARK = "data-lrp-history";

/** The attribute of an element that shows a value. */
export function history(subject: Subject): Record<string, string> {
  return { [MARK]: JSON.stringify(subject) };
}

/** Add plots to the timeline; those that are all there already are removed. */
export function pin({ store }: Lab, names: readonly string[]): void {
  const { plots } = store.state;
  if (!names.length) return;
  const added = names.filter((name) => !plots.includes(name));
  store.set("plots", added.length ? [...plots, ...added] : plots.filter((name) => !names.includes(name)));
}

/** Whether there is something, and all of it is in the timeline. */
export function arePinned({ store }: Lab, names: readonly string[]): boolean {
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
  const told = lookedAt(lab, titleOf(lab, subject));
  const title = h("span", {}, titleOf(lab, subject));
  const foot = h("div", { class: "lrp-row" }, pinning);
  const opened = openCard(lab, at, "close-history", [title], [shown.element, words, foot], () => {
    told();
    end();
    shown.close();
  });
  place = opened.place;
}
