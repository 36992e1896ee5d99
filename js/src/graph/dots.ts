/** The dots on states and arrows that have a breakpoint. */

import { type Dot, dotsOf, keyOf } from "../parts/breakpoints";
import type { LabState } from "../session/state";
import { s, setAttribute } from "../ui/dom";

const RADIUS = 4;
const INSET = 3; // px from the corner of a state

/** Draw the dots that the breakpoints say; after a drawing, and when a breakpoint changes. */
export function drawDots(root: SVGElement, state: LabState): void {
  const dots = dotsOf(state);
  for (const node of root.querySelectorAll<SVGGElement>("[data-lrp-state]")) {
    const box = node.querySelector<SVGRectElement>(":scope > .lrp-box");
    const dot = box && dots.get(keyOf("state", node.getAttribute("data-lrp-state") ?? ""));
    draw(node, dot ?? null, () => [
      Number(box!.getAttribute("x")) + INSET,
      Number(box!.getAttribute("y")) + INSET,
    ]);
  }
  for (const arrow of root.querySelectorAll<SVGGElement>(".lrp-transition")) {
    const shaft = arrow.querySelector<SVGPathElement>(".lrp-shaft");
    const dot = shaft && dots.get(keyOf("transition", arrow.getAttribute("data-of") ?? ""));
    draw(arrow, dot ?? null, () => {
      const { x, y } = shaft!.getPointAtLength(shaft!.getTotalLength() / 2);
      return [x, y];
    });
  }
}

function draw(node: Element, how: Dot | null, place: () => [number, number]): void {
  let circle = node.querySelector(":scope > .lrp-breakpoint");
  setAttribute(node, "data-breakpoint", how);
  if (!how) {
    circle?.remove();
    return;
  }
  if (!circle) {
    circle = s("circle", { class: "lrp-breakpoint", r: RADIUS });
    node.append(circle);
  }
  const [x, y] = place();
  setAttribute(circle, "cx", x);
  setAttribute(circle, "cy", y);
  setAttribute(circle, "data-dot", how);
}
