/** Keyboard navigation in the drawing: one tab stop; arrows move to the nearest element in that direction. */

import { consume } from "../ui/dom";
import type { Point } from "../ui/point";

const WAYS: Record<string, Point> = {
  ArrowRight: { x: 1, y: 0 },
  ArrowLeft: { x: -1, y: 0 },
  ArrowDown: { x: 0, y: 1 },
  ArrowUp: { x: 0, y: -1 },
};

/** States and transitions; a state with machines inside is a group, because a button contains no buttons. */
const ELEMENTS = ".lrp-graph [tabindex]";

/** The index of the nearest point in a direction; points off to the side count as farther. */
export function nearest(from: Point, points: readonly Point[], key: string): number {
  const way = WAYS[key];
  let best = -1;
  let least = Number.POSITIVE_INFINITY;
  if (!way) return best;
  points.forEach((point, index) => {
    const dx = point.x - from.x;
    const dy = point.y - from.y;
    const along = dx * way.x + dy * way.y;
    const aside = Math.abs(dx * way.y) + Math.abs(dy * way.x);
    const cost = along + 2.5 * aside;
    if (along > 1 && cost < least) {
      least = cost;
      best = index;
    }
  });
  return best;
}

/** Let the arrow keys move the focus between elements; `reveal` brings the focused one into view. */
export function walkWithArrows(svg: SVGSVGElement, reveal: (element: SVGGElement) => void): void {
  const elements = () => [...svg.querySelectorAll<SVGGElement>(ELEMENTS)];
  const centre = (element: SVGGElement): Point => {
    const shaft = element.querySelector<SVGPathElement>(":scope > .lrp-shaft");
    const point = shaft ? shaft.getPointAtLength(shaft.getTotalLength() / 2) : svg.createSVGPoint();
    return point.matrixTransform(element.getCTM() ?? svg.createSVGMatrix());
  };
  const focus = (element: SVGGElement) => {
    for (const other of elements()) other.setAttribute("tabindex", other === element ? "0" : "-1");
    element.focus({ preventScroll: true });
    reveal(element);
  };
  svg.addEventListener("focusin", (event) => {
    const element = (event.target as Element).closest<SVGGElement>(ELEMENTS);
    if (element) svg.dataset.focus = element.dataset.lrpState ?? element.dataset.lrpTransition ?? "";
  });
  svg.addEventListener("keydown", (event) => {
    if (!(event.key in WAYS) || event.ctrlKey || event.metaKey || event.altKey) return;
    const current = (event.target as Element).closest<SVGGElement>(ELEMENTS);
    const others = elements().filter((element) => element !== current);
    const next = current ? others[nearest(centre(current), others.map(centre), event.key)] : others[0];
    if (!next) return;
    consume(event);
    focus(next);
  });
}

/** Keep exactly one element reachable with the tab key. */
export function keepOneTabStop(svg: SVGSVGElement): void {
  const elements = [...svg.querySelectorAll<SVGGElement>(ELEMENTS)];
  if (!elements.some((element) => element.getAttribute("tabindex") === "0"))
    elements.at(-1)?.setAttribute("tabindex", "0");
}
