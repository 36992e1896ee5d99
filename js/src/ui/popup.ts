/** What lies over the lab until it is used or left: a menu, a small form. There is one at a time in each host. */

import { focusLab, returnFocus } from "./dom";
import { comesFrom, focusedAround, hasFocus } from "./root";

const closers = new WeakMap<HTMLElement, () => void>(); // by host

/**
 * Open an element in a host, put in its place now and whenever the host has another size; a press elsewhere closes it.
 * Returns what closes it, on request with the focus as it was.
 */
export function openPopup(
  host: HTMLElement,
  element: HTMLElement,
  place: () => void,
  closed: () => void = () => {},
): (focus: boolean) => void {
  closers.get(host)?.();
  const before = focusedAround(host);
  const sizes = new ResizeObserver(place);
  let isOpen = true;
  const close = (focus: boolean) => {
    if (!isOpen) return;
    isOpen = false;
    sizes.disconnect();
    document.removeEventListener("pointerdown", outside, true);
    const isLeft = hasFocus(element);
    element.remove();
    closed();
    if (focus) returnFocus(before, host);
    else if (isLeft) focusLab(host);
  };
  const outside = (event: Event) => {
    if (!comesFrom(event, element)) close(false);
  };
  closers.set(host, () => close(false));
  document.addEventListener("pointerdown", outside, true);
  host.append(element);
  place();
  sizes.observe(host);
  return close;
}
