/**
 * A press becomes a drag once the pointer has moved. It ends when the button is released, anywhere, or with Escape.
 * A finger that drags something does not scroll: see `fingers.ts`.
 */

import { isTouch } from "./point";

const FROM = 4; // px of movement
const FROM_BY_FINGER = 10; // which trembles

export interface Drag {
  /** Which movements of a finger scroll the page instead, as in the surface's `touch-action`. */
  scrolls?: "down" | "all" | undefined;
  /** The press has become a drag. */
  begin?(): void;
  move(now: PointerEvent): void;
  /** The press is over, where it was released; null if it was given up. It was a drag if the pointer moved. */
  end(last: PointerEvent | null, moved: boolean): void;
}

/** Gives up a drag, with whether it keeps the finger from scrolling. */
const drags = new Map<() => void, boolean>();

/** Whether fingers do something other than scroll the page. */
export function isHolding(): boolean {
  return [...drags.values()].includes(true);
}

/** End all drags without effect: a second finger, or a long press, means something else. */
export function giveUpDrags(): void {
  for (const giveUp of [...drags.keys()]) giveUp();
}

/** Keep fingers from scrolling until the function that is returned is called. */
export function hold(giveUp: () => void, holds = true): () => void {
  drags.set(giveUp, holds);
  return () => drags.delete(giveUp);
}

/** Report the movements of the pressed pointer. A drag that ends on the surface is not a click there. */
export function trackDrag(surface: Element, press: PointerEvent, drag: Drag): void {
  const { pointerId, clientX, clientY } = press;
  let moved = false;
  const listening = new AbortController();
  const listen = { capture: true, signal: listening.signal };
  const finger = isTouch(press);
  const from = finger ? FROM_BY_FINGER : FROM;
  const release = hold(() => stop(null), !drag.scrolls);
  const stop = (last: PointerEvent | null) => {
    release();
    listening.abort();
    if (surface.hasPointerCapture(pointerId)) surface.releasePointerCapture(pointerId);
    drag.end(last, moved);
  };
  /** The click that follows the release, which may be some time after Escape. */
  const swallowClick = () => {
    const over = new AbortController();
    const swallow = { capture: true, signal: over.signal };
    surface.addEventListener("click", (click) => click.stopImmediatePropagation(), swallow);
    const released = ({ pointerId: id }: PointerEvent) => id === pointerId && setTimeout(() => over.abort());
    window.addEventListener("pointerup", released, swallow);
    window.addEventListener("pointercancel", released, swallow);
    window.addEventListener("pointerdown", () => over.abort(), swallow); // the release was not reported
  };
  const move = (now: PointerEvent) => {
    if (now.pointerId !== pointerId) return;
    if (!now.buttons) return stop(null); // the button was released where nothing reports it
    if (!moved) {
      const [dx, dy] = [now.clientX - clientX, now.clientY - clientY];
      if (Math.hypot(dx, dy) < from) return;
      const isDown = Math.abs(dy) > Math.abs(dx);
      if (finger && (drag.scrolls === "all" || (drag.scrolls === "down" && isDown))) return stop(null);
      moved = true;
      swallowClick();
      surface.setPointerCapture(pointerId);
      drag.begin?.();
    }
    drag.move(now);
  };
  const over = (last: PointerEvent) => {
    if (last.pointerId === pointerId) stop(last.type === "pointerup" ? last : null);
  };
  const giveUp = (event: KeyboardEvent) => {
    if (event.key !== "Escape") return;
    event.stopPropagation();
    stop(null);
  };
  window.addEventListener("pointermove", move, listen);
  window.addEventListener("pointerup", over, listen);
  window.addEventListener("pointercancel", over, listen);
  window.addEventListener("keydown", giveUp, listen);
}
