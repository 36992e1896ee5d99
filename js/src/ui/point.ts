/** Points of the window, in px: where menus, cards and small forms open. */

import { partInSight } from "./sight";

const FINGER = 36; // px

export interface Point {
  x: number;
  y: number;
}

export function pointOf({ clientX, clientY }: MouseEvent): Point {
  return { x: clientX, y: clientY };
}

export function isTouch(event: Event): boolean {
  return (event as PointerEvent).pointerType === "touch";
}

/** How far beside a thing a press may be and still mean it, in px: a finger hides what it points at. */
export function reachOf(press: Event, ofMouse: number): number {
  return isTouch(press) ? Math.max(FINGER / 2, ofMouse) : ofMouse;
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

/**
 * Put an element over its host at a point, or as near as it is all in sight and beside what it is about: rectangles
 * of the window. `edge` px around it stay free.
 */
export function placeInSight(
  host: HTMLElement,
  element: HTMLElement,
  at: Point,
  edge: number,
  about: readonly DOMRect[] = [],
): void {
  const frame = host.getBoundingClientRect();
  const { top, bottom } = partInSight(host);
  const [width, height] = [element.offsetWidth, element.offsetHeight];
  const across = [at.x, ...about.flatMap(({ left, right }) => [right + edge, left - edge - width])];
  const down = [at.y, ...about.flatMap((box) => [box.bottom + edge, box.top - edge - height])];
  const columns = across.map((x) => Math.max(edge, Math.min(x - frame.left, frame.width - width - edge)));
  const rows = down.map((y) => Math.max(top + edge, Math.min(y - frame.top, bottom - height - edge)));
  const places = rows.flatMap((y) =>
    columns.map((x) => new DOMRect(x + frame.left, y + frame.top, width, height)),
  );
  const spot = new DOMRect(at.x, at.y);
  const free = places.filter((place) => about.every((box) => gap(place, box) > 0));
  const place = free.sort((a, b) => gap(a, spot) - gap(b, spot))[0] ?? places[0]!;
  element.style.left = `${place.left - frame.left}px`;
  element.style.top = `${place.top - frame.top}px`;
}

/** How far apart two rectangles are. */
function gap(a: DOMRect, b: DOMRect): number {
  const across = Math.max(0, a.left - b.right, b.left - a.right);
  const down = Math.max(0, a.top - b.bottom, b.top - a.bottom);
  return Math.hypot(across, down);
}
