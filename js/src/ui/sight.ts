/**
 * How much of the lab is in sight: it is as high as the part of the notebook that can be seen, or as its user
 * has made it by dragging its corner, which is kept as a share of that.
 */

import { forget, keep, kept } from "./kept";
import { parentOf } from "./root";

const HEIGHT = "height";
const LEAST = 480; // px
const AROUND = 12; // px between a lab and the edge of what can be seen

/** Keep `--lrp-room` at the height of what scrolls around an element, and the element's share of it. */
export function fitHeight(root: HTMLElement): { reset(): void; close(): void } {
  let scroller: Element | null = null;
  let share = kept(HEIGHT);
  let given = ""; // the height that was set here
  const observer = new ResizeObserver(() => {
    scroller ??= scrollerOf(root);
    if (!scroller?.clientHeight) return;
    observer.observe(scroller);
    const room = Math.max(LEAST, scroller.clientHeight - AROUND);
    const { height } = root.style;
    if (height !== given) {
      share = String(Number.parseFloat(height) / room);
      keep(HEIGHT, share);
    } else if (share) root.style.height = `${Math.round(Number(share) * room)}px`;
    given = root.style.height;
    root.style.setProperty("--lrp-room", `${room}px`);
  });
  observer.observe(root); // a view may be rendered before it is attached
  return {
    reset() {
      forget(HEIGHT);
      share = null;
      root.style.height = given = "";
    },
    close: () => observer.disconnect(),
  };
}

/** The outermost element that scrolls what is around another; null if only the window does, or it fills that. */
function scrollerOf(element: Element): Element | null {
  let found: Element | null = null;
  for (
    let around = parentOf(element);
    around && around !== document.body && !around.hasAttribute("popover");
    around = parentOf(around)
  ) {
    if (/auto|scroll/.test(getComputedStyle(around).overflowY)) found = around;
  }
  return found;
}

/** The part of an element that is in sight, from its upper edge, in px. */
export function partInSight(element: HTMLElement): { top: number; bottom: number } {
  const frame = element.getBoundingClientRect();
  const around = scrollerOf(element)?.getBoundingClientRect() ?? { top: 0, bottom: window.innerHeight };
  const top = Math.max(0, around.top - frame.top);
  return { top, bottom: Math.max(top, Math.min(frame.height, around.bottom - frame.top)) };
}

/**
 * Scroll a lab into view that its user has just opened: its cell, or the one before that to which
 * Shift+Enter went on. A notebook that is opened or reloaded stays where it is.
 */
export function bringIntoSight(root: HTMLElement): void {
  const cell = root.closest(".jp-Cell");
  const ran = cell?.matches(".jp-mod-active") || cell?.nextElementSibling?.matches(".jp-mod-active");
  if (ran && navigator.userActivation?.hasBeenActive) root.scrollIntoView({ block: "nearest" });
}
