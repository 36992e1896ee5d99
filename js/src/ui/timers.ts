/** Delayed calls, and elements that glow for a moment. */

/** Return a function that makes a call this many ms later; calling it again meanwhile changes nothing. */
export function calledAfter(ms: number, call: () => void): () => void {
  let isDue = false;
  return () => {
    if (isDue) return;
    isDue = true;
    setTimeout(() => {
      isDue = false;
      call();
    }, ms);
  };
}

/** How long a visit, a firing or a new value stays visible (ms); at least 150, whatever the rate. */
export const AFTERGLOW = 450;
const glowing = new WeakMap<Element, ReturnType<typeof setTimeout>>();

export function glow(element: Element): void {
  clearTimeout(glowing.get(element));
  element.setAttribute("data-glow", "");
  const timer = setTimeout(() => element.removeAttribute("data-glow"), AFTERGLOW);
  glowing.set(element, timer);
}
