/** What the controls say: the restarts, why the program is paused, and its status. */

import type { Lab } from "../session/store";
import { h, setAttribute, setHidden, setProse, setText, unmarked } from "../ui/dom";
import { ELEMENT_OF } from "./breakpoints";
import { LINKS } from "./reach";

/** Why a breakpoint paused the program, in the words of the kernel; a click shows its element. */
export function pausedBy(lab: Lab): HTMLElement {
  const { store } = lab;
  const words = h("span", {});
  const go = h(
    "button",
    {
      type: "button",
      class: "lrp-paused-by",
      "data-lrp-action": "paused-by",
      onclick: () => {
        const { kind, path } = store.state.breakpoints[store.state.paused_by?.number ?? 0] ?? {};
        const noun = kind && ELEMENT_OF[kind];
        if (noun && path) lab.goTo(noun, path);
      },
    },
    h("span", { class: "lrp-breakpoint-dot", "data-dot": "on", "aria-hidden": "true" }),
    words,
  );
  const place = h("div", { class: "lrp-paused", role: "status" }, go);
  store.watch(["paused_by", "breakpoints"], () => {
    const { paused_by: hit, breakpoints } = store.state;
    setHidden(go, !hit);
    go.disabled = !(hit && breakpoints[hit.number]?.line);
    if (!hit) return;
    setProse(words, hit.text);
    setAttribute(go, "title", unmarked(hit.text));
  });
  return place;
}

export function statusLine(lab: Lab): HTMLElement {
  const { store } = lab;
  const dot = h("span", { class: "lrp-dot", "aria-hidden": "true" });
  const [words, ticks, seconds] = [h("span"), h("span", { class: "lrp-status-tick" }), h("span")];
  const line = h("span", { class: "lrp-status" }, dot, words, ticks, seconds);
  store.watch(["status", "tick", "time", "link", "reason"], () => {
    const { status, tick, time, link, reason } = store.state;
    const isKnown = !(link in LINKS);
    setAttribute(dot, "data-status", isKnown ? status : link);
    setAttribute(line, "data-usual", isKnown && (status === "running" || status === "paused"));
    setText(words, LINKS[link] ?? status);
    setText(ticks, `tick ${tick.toLocaleString("en")}`);
    setText(seconds, `${time.toFixed(1)} s`);
    setAttribute(line, "title", unmarked(reason));
  });
  return line;
}
