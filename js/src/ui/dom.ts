/** Create and update elements without a framework. */

import { focusedAround, hasFocus } from "./root";

type Child = Node | string | null | undefined | false;
type Handlers = { [K in keyof HTMLElementEventMap as `on${K}`]?: (event: HTMLElementEventMap[K]) => void };
export type Attributes = Record<string, unknown> & Handlers;

const SVG = "http://www.w3.org/2000/svg";

/** An HTML element. `onclick` and the like listen; true sets an attribute, false and null leave it out. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  return furnish(document.createElement(tag), attributes, children);
}

export function s<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): SVGElementTagNameMap[K] {
  return furnish(document.createElementNS(SVG, tag), attributes, children);
}

function furnish<E extends Element>(element: E, attributes: Attributes, children: Child[]): E {
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on") && typeof value === "function") {
      element.addEventListener(name.slice(2), value as EventListener);
    } else setAttribute(element, name, value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined && child !== false));
  return element;
}

/** Set an attribute, only if it changes; false, null and undefined remove it. */
export function setAttribute(element: Element, name: string, value: unknown): void {
  if (value === false || value === null || value === undefined) {
    if (element.hasAttribute(name)) element.removeAttribute(name);
    return;
  }
  const text = value === true ? "" : String(value);
  if (element.getAttribute(name) !== text) element.setAttribute(name, text);
}

/** Set the text, only if it changes: a screen reader and a selection are left alone. */
export function setText(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

/** Hide an element or show it; the keyboard focus in a hidden one moves to the lab, not out of it. */
export function setHidden(element: HTMLElement, hidden: boolean): void {
  const isLeft = hidden && hasFocus(element);
  element.hidden = hidden;
  if (isLeft) focusLab(element);
}

/** Give the keyboard's focus to the lab around an element. */
export function focusLab(element: Element): void {
  const lab = element.closest<HTMLElement>(".lrp-lab");
  if (!lab) return;
  lab.tabIndex = -1; // for this moment only: a click on it goes to the notebook
  lab.addEventListener("blur", () => lab.removeAttribute("tabindex"), { once: true });
  lab.focus({ preventScroll: true });
}

/** Return the keyboard's focus to where it was, or to the lab if that is gone: keys would act on the notebook. */
export function returnFocus(before: Element | null, inLab: Element): void {
  if (before?.isConnected) (before as HTMLElement | SVGElement).focus?.({ preventScroll: true });
  const focused = focusedAround(inLab);
  if (!focused || focused === document.body) focusLab(inLab);
}

/** Mark an event as handled: neither the browser nor the notebook acts on it. */
export function consume(event: Event): void {
  event.preventDefault();
  event.stopPropagation();
}

/**
 * Offer choices, each with its value and in words, and select one. An open list is left alone while its choices stay
 * the same.
 */
export function setChoices(
  select: HTMLSelectElement,
  choices: readonly (readonly [value: string, words: string])[],
  chosen: string,
): void {
  const old = [...select.options].map(({ value, text }) => [value, text]);
  if (JSON.stringify(old) !== JSON.stringify(choices))
    select.replaceChildren(...choices.map(([value, words]) => h("option", { value }, words)));
  select.value = chosen;
}

/** An id that no other element of the page has: each lab is a module of its own. */
export function freshId(): string {
  return `lrp-${Math.random().toString(36).slice(2)}`;
}

/**
 * Update the children of an element to match a list, by key: elements that stay are reused. The one with the
 * keyboard focus is never moved; if it goes, the focus moves to the lab.
 */
export function reconcile<T>(
  parent: Element,
  items: readonly T[],
  key: (item: T) => string,
  make: (item: T) => Element,
  update: (element: Element, item: T) => void,
): void {
  const old = new Map<string, Element>();
  for (const child of [...parent.children]) old.set(child.getAttribute("data-key") ?? "", child);
  let place: Element | null = parent.firstElementChild;
  for (const item of items) {
    const name = key(item);
    let element = old.get(name);
    old.delete(name);
    if (!element) {
      element = make(item);
      element.setAttribute("data-key", name);
    }
    update(element, item);
    if (hasFocus(element))
      // moved, it would lose the focus: what is before it goes to the end until it is due
      while (place && place !== element) {
        const next: Element | null = place.nextElementSibling;
        parent.append(place);
        place = next;
      }
    if (element === place) place = place.nextElementSibling;
    else parent.insertBefore(element, place);
  }
  for (const gone of old.values()) {
    if (hasFocus(gone)) focusLab(gone);
    gone.remove();
  }
}

/** A text with its control and direction characters written out: it reads as it would run. */
export function visible(text: string): string {
  return text.replace(
    /(?![\t\r\n])[\p{Cc}\p{Cf}\p{Cs}]/gu,
    (each) => `<U+${each.codePointAt(0)!.toString(16).toUpperCase().padStart(4, "0")}>`,
  );
}

/** A sentence where code cannot be marked: in a tooltip, or read aloud. */
export function unmarked(sentence: string): string {
  return sentence.replaceAll("`", "");
}

/** A sentence with its code marked. */
export function prose(sentence: string): (HTMLElement | string)[] {
  return sentence.split(/`([^`]*)`/).map((part, index) => (index % 2 ? h("code", {}, part) : part));
}

/** Show a sentence with its code marked, unless it is shown already. */
export function setProse(element: Element, sentence: string): void {
  if (element.getAttribute("data-sentence") === sentence) return;
  element.setAttribute("data-sentence", sentence);
  element.replaceChildren(...prose(sentence));
}
