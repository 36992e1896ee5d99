/** Two fingers on a surface move and zoom what is under them; what the first one had begun is given up. */

import { giveUpDrags, hold } from "./drag";
import { isTouch, type Point, pointOf } from "./point";

/** `change` gets how much larger the distance of the fingers is, the point between them, and how far that has moved. */
export function onPinch(
  surface: Element,
  change: (factor: number, middle: Point, dx: number, dy: number) => void,
): void {
  const fingers = new Map<number, Point>();
  let release = () => {};
  const spread = () => {
    const [one, other] = [...fingers.values()] as [Point, Point];
    const middle = { x: (one.x + other.x) / 2, y: (one.y + other.y) / 2 };
    return { middle, width: Math.max(1, Math.hypot(one.x - other.x, one.y - other.y)) };
  };
  const end = () => {
    release();
    fingers.clear();
  };
  const listen = (name: string, act: (event: PointerEvent) => void) =>
    surface.addEventListener(name, (event) => isTouch(event) && act(event as PointerEvent), true);
  listen("pointerdown", (event) => {
    if (event.isPrimary) end(); // what became of earlier ones was not reported
    if (fingers.size < 2) fingers.set(event.pointerId, pointOf(event));
    if (fingers.size < 2) return;
    event.stopImmediatePropagation();
    if (!fingers.has(event.pointerId)) return;
    giveUpDrags();
    release = hold(end);
    for (const finger of fingers.keys()) surface.setPointerCapture(finger);
  });
  listen("pointermove", (event) => {
    if (!fingers.has(event.pointerId)) return;
    const before = fingers.size === 2 && spread();
    fingers.set(event.pointerId, pointOf(event));
    if (!before) return;
    const { middle, width } = spread();
    change(width / before.width, middle, middle.x - before.middle.x, middle.y - before.middle.y);
  });
  const over = ({ pointerId }: PointerEvent) => fingers.has(pointerId) && end();
  listen("pointerup", over);
  listen("pointercancel", over);
}
