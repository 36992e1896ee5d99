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

/**
 * Return a function that is told a value whenever it may have changed, and makes a call when it has been the same
 * for so many ms; while the call returns false, again and again.
 */
export function whenSteady(ms: number, closed: AbortSignal, call: () => boolean): (value: string) => void {
  let last = "";
  let timer: ReturnType<typeof setTimeout> | undefined;
  const wait = () => {
    timer = setTimeout(() => call() || wait(), ms);
  };
  closed.addEventListener("abort", () => clearTimeout(timer));
  return (value) => {
    if (value === last) return;
    last = value;
    clearTimeout(timer);
    wait();
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
