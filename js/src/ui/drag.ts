/** A press becomes a drag once the pointer has moved. It ends when the button is released, anywhere, or with Escape. */

const FROM = 4; // px of movement

export interface Drag {
  /** The press has become a drag. */
  begin?(): void;
  move(now: PointerEvent): void;
  /** The press is over, where it was released; null if it was given up. It was a drag if the pointer moved. */
  end(last: PointerEvent | null, moved: boolean): void;
}

/** Report the movements of the pressed pointer. A drag that ends on the surface is not a click there. */
export function trackDrag(surface: Element, press: PointerEvent, drag: Drag): void {
  const { pointerId, clientX, clientY } = press;
  let moved = false;
  const listening = new AbortController();
  const listen = { capture: true, signal: listening.signal };
  const stop = (last: PointerEvent | null) => {
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
      if (Math.hypot(now.clientX - clientX, now.clientY - clientY) < FROM) return;
      moved = true;
      swallowClick();
      surface.setPointerCapture(pointerId);
      drag.begin?.();
    }
    drag.move(now);
  };
  const release = (last: PointerEvent) => {
    if (last.pointerId === pointerId) stop(last.type === "pointerup" ? last : null);
  };
  const giveUp = (event: KeyboardEvent) => {
    if (event.key !== "Escape") return;
    event.stopPropagation();
    stop(null);
  };
  window.addEventListener("pointermove", move, listen);
  window.addEventListener("pointerup", release, listen);
  window.addEventListener("pointercancel", release, listen);
  window.addEventListener("keydown", giveUp, listen);
}
