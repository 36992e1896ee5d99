/** The last line of the lab: notes, which grow upward over the page and push nothing; the restarts; the status. */

import type { Lab } from "../session/store";
import { h, setAttribute, setText, unmarked } from "../ui/dom";
import { notes } from "./notes";
import { restarts } from "./restarts";

/** `forms` are shown in the place of the notes. */
export function foot(lab: Lab, text: () => string, ...forms: HTMLElement[]): HTMLElement {
  const { notice, counter } = restarts(lab);
  return h(
    "footer",
    { class: "lrp-foot" },
    h("div", { class: "lrp-notes" }, ...forms, notes(lab, text), notice),
    counter,
    statusLine(lab),
  );
}

function statusLine(lab: Lab): HTMLElement {
  const { store } = lab;
  const dot = h("span", { class: "lrp-dot", "aria-hidden": "true" });
  const words = h("span", {});
  const line = h("span", { class: "lrp-status" }, dot, words);
  store.watch(["status", "tick", "time", "link", "reason"], () => {
    const { status, tick, time, link, reason } = store.state;
    const word =
      link === "busy"
        ? "kernel busy"
        : link === "lost"
          ? "no answer"
          : link === "dead"
            ? "no kernel"
            : status;
    setAttribute(dot, "data-status", link === "live" || link === "connecting" ? status : link);
    setText(words, `${word} · tick ${tick.toLocaleString("en")} · ${time.toFixed(1)} s`);
    setAttribute(line, "title", unmarked(reason));
  });
  return line;
}
