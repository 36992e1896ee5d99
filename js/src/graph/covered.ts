/** The coverage on the drawing: how many of the kept runs reach a state or a transition; what none reaches is marked. */

import { onlyWay, timesReached } from "../parts/coverage";
import type { LabState } from "../session/state";
import { s, setAttribute, setText } from "../ui/dom";

const [INSET, ABOVE] = [8, 4]; // px from the right side of a state, and from its top, to its figure
const APART = 7; // px between two lines of a hatching
const EDGE = 3; // px around it
const NAMED = /(?: \d+)?(?=: state )/; // in the name of a state: here ends what is seen of it

/** Draw what the coverage says; after a drawing, and when it changes. */
export function drawReached(root: SVGElement, { reached: wanted, settings }: LabState): void {
  const reached = settings.graph === "live" ? wanted : null;
  if (!reached && !root.hasAttribute("data-covered")) return;
  setAttribute(root, "data-covered", reached !== null);
  for (const node of root.querySelectorAll("[data-lrp-state]")) {
    const times = timesReached(reached, "state", node.getAttribute("data-lrp-state") ?? "");
    const box = node.querySelector(":scope > .lrp-box");
    setAttribute(node, "data-reached", times);
    const name = node.getAttribute("aria-label")?.replace(NAMED, times === null ? "" : ` ${times}`);
    setAttribute(node, "aria-label", name);
    const hatching = node.querySelector(":scope > .lrp-hatching");
    if (times !== 0) hatching?.remove();
    else if (box && !hatching) box.after(s("path", { class: "lrp-hatching", d: hatchingOf(box) }));
    const figure = node.querySelector(":scope > .lrp-reached");
    if (times === null || !box) figure?.remove();
    else {
      const [x, y, width] = ["x", "y", "width"].map((name) => Number(box.getAttribute(name)));
      const place = { class: "lrp-reached", x: x! + width! - INSET, y: y! - ABOVE };
      if (figure) setText(figure, ` ${times}`);
      else node.append(s("text", place, ` ${times}`));
    }
  }
  for (const part of root.querySelectorAll(".lrp-transition, .lrp-label, .lrp-halo")) {
    const path = part.getAttribute("data-of") ?? "";
    const times = timesReached(reached, "transition", path);
    setAttribute(part, "data-reached", times);
    if (part.matches(".lrp-transition")) continue;
    const figure = part.querySelector(":scope > .lrp-reached");
    const words = `${times}${onlyWay(reached, "transition", path) ? " ◐" : ""}`;
    if (times === null) figure?.remove();
    else if (figure) setText(figure, words);
    else part.append(s("tspan", { class: "lrp-reached", dx: 3, dy: -3 }, words));
  }
}

/** Lines from the lower left to the upper right in a box. */
function hatchingOf(box: Element): string {
  const [x, y, width, height] = ["x", "y", "width", "height"].map((name) => Number(box.getAttribute(name)));
  const [left, right] = [x! + EDGE, x! + width! - EDGE];
  const [top, bottom] = [y! + EDGE, y! + height! - EDGE];
  const lines: string[] = [];
  for (let sum = left + top + APART; sum < right + bottom; sum += APART) {
    const from = Math.max(left, sum - bottom);
    const to = Math.min(right, sum - top);
    lines.push(`M${from} ${sum - from}L${to} ${sum - to}`);
  }
  return lines.join("");
}
