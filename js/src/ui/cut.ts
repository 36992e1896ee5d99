/**
 * Texts that are cut where there is no room, and never within a character: values at their end, names in the
 * middle, because long names often differ at their ends.
 */

import { h } from "./dom";

const END = 7; // characters that stay

/** Set the text of an element, which the stylesheet cuts before its end. */
export function setName(element: Element, name: string): void {
  if (element.textContent === name) return;
  const characters = [...name];
  const begin = Math.max(0, characters.length - END);
  const [first, rest] = [characters.slice(0, begin).join(""), characters.slice(begin).join("")];
  element.replaceChildren();
  if (first) element.append(h("span", { class: "lrp-cut" }, first));
  if (rest) element.append(h("span", {}, rest));
}

/** The first `most` UTF-16 units of a text, and a sign that there are more. */
export function shortened(text: string, most: number): string {
  return text.length > most ? `${text.slice(0, most).replace(/[\uD800-\uDBFF]$/, "")}…` : text;
}
