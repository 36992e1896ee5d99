/** The conditions of a study, as far as they concern several parts. */

import type { Looked, SettingsView } from "../protocol";
import type { Lab } from "../session/store";
import { h, setAttribute, setHidden, unmarked } from "../ui/dom";

const LOCKED = "This is set for a study, and cannot be changed here.";

/** The panels that are not shown. */
export function withheld({ graph, quiet }: SettingsView): string[] {
  return [...(graph === "hidden" ? ["tree", "graph"] : []), ...(quiet ? ["variables", "robot", "runs"] : [])];
}

/** Disable what would change a condition that is locked, and say why. */
export function showLock(
  control: HTMLButtonElement | HTMLSelectElement,
  { lock }: SettingsView,
  usual: string,
): void {
  control.disabled = lock;
  setAttribute(control, "title", lock ? LOCKED : usual);
}

const RESTS = 500; // ms after which something under the pointer is looked at

/** Record that the user begins or ends to look at something, if that is wanted. */
export function looked(lab: Lab, what: Looked, about: string, on: boolean): void {
  if (lab.store.state.settings.log) lab.tell({ what, about, on });
}

/** Record what the pointer rests on; the function that is returned ends that. */
export function lookedAt(lab: Lab, about: string): () => void {
  let isLong = false;
  const timer = setTimeout(() => {
    isLong = true;
    looked(lab, "hover", about, true);
  }, RESTS);
  return () => {
    clearTimeout(timer);
    if (isLong) looked(lab, "hover", about, false);
  };
}

const NAMED = ["machine", "state", "transition", "variable", "issue"];

/** Record which element of the graph and the lists the pointer rests on, and whether the page can be seen. */
export function watchPointer(lab: Lab): void {
  let before = "";
  let end = () => {};
  const move = (event: Event) => {
    const name = nameUnder(event.target as Element);
    if (name === before) return;
    end();
    before = name;
    end = name ? lookedAt(lab, name) : () => {};
  };
  lab.root.addEventListener("pointerover", move);
  lab.root.addEventListener("pointerleave", move);
  document.addEventListener(
    "visibilitychange",
    () => looked(lab, "page", "", document.visibilityState === "visible"),
    { signal: lab.closed },
  );
}

function nameUnder(element: Element): string {
  const named = element.closest?.(NAMED.map((kind) => `[data-lrp-${kind}]`).join(", "));
  const kind = NAMED.find((each) => named?.hasAttribute(`data-lrp-${each}`));
  return named && kind ? `${kind} ${named.getAttribute(`data-lrp-${kind}`)}` : "";
}

/** Says that all of this is recorded. */
export function recorded(lab: Lab): HTMLElement {
  const mark = h(
    "span",
    { class: "lrp-recorded", role: "status" },
    h("span", { class: "lrp-dot", "data-status": "recorded", "aria-hidden": "true" }),
    "Recorded",
  );
  lab.store.watch(["settings"], () => {
    const { log } = lab.store.state.settings;
    setHidden(mark, !log);
    const what =
      "What you do and look at in this lab (cards, panels, the timeline, what the pointer rests on)";
    setAttribute(
      mark,
      "title",
      unmarked(`${what} is recorded in the file \`${log}\` on the kernel's computer, and sent nowhere else.`),
    );
  });
  return mark;
}
