/** The lab's notes (lost kernel or robot, held edits, conflicting texts, hung block), and announcements for screen readers. */

import type { Difference } from "../protocol";
import { besideGraph } from "../session/state";
import type { Lab } from "../session/store";
import { button } from "../ui/button";
import { copyText } from "../ui/clipboard";
import { differentLines, drawDifference, scrollToDifference, summaryOf } from "../ui/difference";
import { h, prose, setHidden, setProse, setText, unmarked } from "../ui/dom";
import { calledAfter } from "../ui/timers";

export function notes(lab: Lab, text: () => string): HTMLElement {
  const all = [hungNote(lab), robotNote(lab), unstartedNote(lab), heldNote(lab), conflictNote(lab, text)];
  const ofSession = h("div", {}, ...all);
  lab.store.watch(["link"], () => setHidden(ofSession, lab.store.state.link === "dead"));
  return h("div", {}, linkNote(lab, text), ofSession);
}

function linkNote(lab: Lab, text: () => string): HTMLElement {
  const { store } = lab;
  const words = h("p", {});
  const copy = button({
    label: "Copy text",
    title: "Copy the program's text",
    action: "copy",
    onclick: async () => {
      const failed = "The browser does not allow copying here. Select the text and press Ctrl+C.";
      lab.notify((await copyText(text())) ? "The text is copied." : failed);
    },
  });
  const again = button({
    label: "Start again",
    title: "Start the program from the beginning, with the text here",
    action: "start-again",
    class: "lrp-button lrp-primary",
    onclick: () => void lab.act({ do: "run" }),
  });
  const note = h("div", { class: "lrp-note lrp-note-warning", role: "status" }, words, copy, again);
  store.watch(["link", "status", "reason"], () => {
    const { link, status, reason, debugger: command } = store.state;
    const cell = command.startsWith("%lrp")
      ? "`%load_ext lrp_jupyter`, then the cell again,"
      : "the cell again";
    const broken = status === "broken" || status === "closed";
    setHidden(note, !(link === "lost" || link === "dead" || link === "busy" || broken));
    copy.hidden = link !== "dead";
    again.hidden = status !== "broken" || link === "dead";
    const sentence = {
      busy: "The kernel is busy. Commands are applied as soon as it is free.",
      lost: "The kernel has not answered for 3 seconds. This view is out of date; your text is kept.",
      dead: `The kernel was restarted or shut down. Run ${cell} to continue; your text is kept.`,
    }[link as string];
    setProse(words, sentence ?? (reason || "The session is closed. Run the cell again to continue."));
  });
  return note;
}

export function hungNote(lab: Lab): HTMLElement {
  const words = h("p", {});
  const interrupt = button({
    label: "Interrupt the block",
    title: "End the block now; it becomes an issue, and the program continues",
    action: "interrupt",
    onclick: () => void lab.act({ do: "interrupt" }),
  });
  const note = h("div", { class: "lrp-note lrp-note-warning" }, words, interrupt); // changes every second: see `announcer`
  lab.store.watch(["hung", "reason"], () => {
    const { hung, reason } = lab.store.state;
    setHidden(note, !hung);
    interrupt.hidden = !hung || hung.held;
    if (hung) setProse(words, reason);
  });
  return note;
}

/** Why the robot stands although the program runs: it does not answer, or its data are too old to drive on. */
export function robotNote(lab: Lab): HTMLElement {
  const heading = h("strong", { role: "status" }); // the sentence has an age that changes all the time
  const words = h("p", {});
  const note = h("div", { class: "lrp-note lrp-note-warning", "data-lrp-note": "robot" }, heading, words);
  lab.store.watch(["bridge"], () => {
    const { status, sentence } = lab.store.state.bridge;
    const headings: Record<string, string> = { lost: "Robot lost", stale: "Robot data too old" };
    setHidden(note, !(status in headings));
    setText(heading, headings[status] ?? "");
    setProse(words, note.hidden ? "" : sentence);
  });
  return note;
}

export function unstartedNote(lab: Lab): HTMLElement {
  const words = h("p", {});
  const note = h("div", { class: "lrp-note lrp-note-warning", role: "status" }, words);
  lab.store.watch(["status", "reason", "tick"], () => {
    const { status, reason, tick } = lab.store.state;
    setHidden(note, !(status === "paused" && tick === 0 && reason));
    if (!note.hidden) setProse(words, reason);
  });
  return note;
}

function heldNote(lab: Lab): HTMLElement {
  const { store } = lab;
  const list = h("ul", { class: "lrp-difference" });
  const note = h(
    "div",
    { class: "lrp-note", role: "status" },
    h("strong", {}, "Held edits"),
    list,
    button({
      label: "Apply",
      title: "Apply the held edits (Ctrl+Enter)",
      action: "apply",
      class: "lrp-button lrp-primary",
      onclick: () => void lab.act({ do: "apply" }),
    }),
    button({
      label: "Revert",
      title: "Return to the text of the running program",
      action: "revert",
      onclick: () => void lab.act({ do: "revert" }),
    }),
  );
  store.watch(["pending", "settings"], () => {
    const { pending } = store.state;
    setHidden(note, !pending);
    if (pending) list.replaceChildren(...lines(pending));
  });
  return note;
}

function lines(difference: Difference): HTMLElement[] {
  const signs = { added: "+", removed: "−", changed: "~", moved: "↕" } as const;
  const items = (Object.keys(signs) as (keyof Difference)[]).flatMap((kind) =>
    difference[kind].map((element) =>
      h("li", { "data-kind": kind }, h("span", { "aria-label": kind }, signs[kind]), " ", ...prose(element)),
    ),
  );
  return items.length ? items : [h("li", {}, "no change to the program")];
}

function conflictNote(lab: Lab, present: () => string): HTMLElement {
  const words = h("p", {});
  const text = h("pre", { class: "lrp-source", tabindex: "0", "aria-label": "Both texts" });
  const heading = h("summary", {});
  const number = () => lab.store.state.conflict?.number ?? null;
  const use = button({
    label: "Use it",
    title: "Make the other text the program",
    action: "take",
    onclick: () => void lab.act({ do: "take", number: number() }),
  });
  const keep = button({
    label: "Keep",
    title: "Keep the present text; the other one is listed in the versions",
    action: "keep-text",
    onclick: () => void lab.act({ do: "keep", number: number() }),
  });
  const note = h(
    "div",
    { class: "lrp-note lrp-note-warning", role: "alertdialog", "aria-label": "Conflicting texts" },
    words,
    h("div", { class: "lrp-row" }, use, keep),
    h("details", { class: "lrp-details", ontoggle: () => scrollToDifference(text) }, heading, text),
  );
  lab.store.watch(["conflict", "findings", "snapshot"], () => {
    const { conflict } = lab.store.state;
    setHidden(note, !conflict);
    if (!conflict) return;
    setProse(words, conflict.sentence);
    use.replaceChildren(conflict.use);
    keep.replaceChildren(conflict.keep);
    const lines = differentLines(present(), conflict.text);
    heading.textContent = summaryOf(lines);
    text.replaceChildren(...drawDifference(lines));
  });
  return note;
}

const PAUSE = 1000; // ms

/** The names of the states in a path, which machines alternate with. */
const statesOf = (path: string) => path.split("/").filter((_, i) => i % 2);

export function announcer(lab: Lab): HTMLElement {
  const region = h("div", { class: "lrp-hidden", "aria-live": "polite", role: "status" });
  let announced = "";
  const speak = () => {
    const { status, reason } = lab.store.state;
    const { active } = besideGraph(lab.store.state);
    const states = active.map((path) => statesOf(path).join(", "));
    const why = status === "hung" ? `${unmarked(reason)} ` : "";
    const words = `${status === "running" ? "" : `${status}. `}${why}${states.length ? `In ${states.join(" and ")}` : ""}`;
    if (words !== announced) region.textContent = announced = words;
  };
  lab.store.watch(["active", "status"], calledAfter(PAUSE, speak));
  return region;
}
