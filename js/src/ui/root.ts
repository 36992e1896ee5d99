/** The tree that the lab is in: the page's, or that of a shadow root, in which some notebooks draw their widgets. */

/** The element that has the keyboard's focus, as seen from another; the page itself sees a shadow's host only. */
export function focusedAround(element: Element): Element | null {
  return (element.getRootNode() as Partial<DocumentOrShadowRoot>).activeElement ?? null;
}

/** Whether an element, or one in it, has the keyboard's focus. */
export function hasFocus(element: Element): boolean {
  return element.contains(focusedAround(element));
}

/** The element around another; around the outermost one of a shadow root, the root's host. */
export function parentOf(element: Element): Element | null {
  return element.parentElement ?? (element.parentNode as Partial<ShadowRoot> | null)?.host ?? null;
}

/** Whether an event comes from an element; its target is, seen from the page, a shadow's host. */
export function comesFrom(event: Event, element: Element): boolean {
  return event.composedPath().includes(element);
}

/** Call back with the tree that an element is in, also if it comes into one later: a view may be rendered before. */
export function whenAttached(
  element: Element,
  closed: AbortSignal,
  attached: (tree: Document | ShadowRoot) => void,
): void {
  let tree: Node | null = null;
  const check = () => {
    const now = element.getRootNode();
    if (!element.isConnected || now === tree) return;
    tree = now;
    attached(now as Document | ShadowRoot);
  };
  const observer = new ResizeObserver(check);
  observer.observe(element);
  closed.addEventListener("abort", () => observer.disconnect());
  check();
}
