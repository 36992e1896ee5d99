/** How much of the lab is in sight: it is as high as the part of the notebook that can be seen. */

const LEAST = 480; // px
const AROUND = 12; // px between a lab and the edge of what can be seen

/** Keep `--lrp-room` at the height of what scrolls around an element. */
export function fitHeight(root: HTMLElement): () => void {
  let scroller: Element | null = null;
  const observer = new ResizeObserver(() => {
    scroller ??= scrollerOf(root);
    if (scroller?.clientHeight) {
      observer.observe(scroller);
      root.style.setProperty("--lrp-room", `${Math.max(LEAST, scroller.clientHeight - AROUND)}px`);
    }
  });
  observer.observe(root); // a view may be rendered before it is attached
  return () => observer.disconnect();
}

/** The outermost element that scrolls what is around another; null if only the window does, or it fills that. */
function scrollerOf(element: Element): Element | null {
  let found: Element | null = null;
  for (
    let around = element.parentElement;
    around && around !== document.body && !around.hasAttribute("popover");
    around = around.parentElement
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
