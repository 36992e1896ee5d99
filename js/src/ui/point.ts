/** Points of the window, in px: where menus, cards and small forms open. */

import { partInSight } from "./sight";

export interface Point {
  x: number;
  y: number;
}

export function pointOf({ clientX, clientY }: MouseEvent): Point {
  return { x: clientX, y: clientY };
}

/** The lower left corner of an element, or the point `gap` px below it. */
export function below(element: Element, gap = 0): Point {
  const { left, bottom } = element.getBoundingClientRect();
  return { x: left, y: bottom + gap };
}

export function middleOf(element: Element): Point {
  const { left, top, width, height } = element.getBoundingClientRect();
  return { x: left + width / 2, y: top + height / 2 };
}

/** Put an element over its host at a point, or as near as it is all in sight; `edge` px around it stay free. */
export function placeInSight(host: HTMLElement, element: HTMLElement, at: Point, edge: number): void {
  const frame = host.getBoundingClientRect();
  const { top, bottom } = partInSight(host);
  const left = Math.min(at.x - frame.left, frame.width - element.offsetWidth - edge);
  const highest = Math.min(at.y - frame.top, bottom - element.offsetHeight - edge);
  element.style.left = `${Math.max(edge, left)}px`;
  element.style.top = `${Math.max(top + edge, highest)}px`;
}
