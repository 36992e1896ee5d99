/**
 * Texts that are cut where there is no room, and never within a character: values and short names at their end,
 * long names in the middle, because they often differ at their ends.
 */

import { h } from "./dom";

const END = 7; // characters of a long name that stay longest
const LONG = 2 * END; // of a shorter one too little would stay on one of the sides

/** Set the text of an element, which the stylesheet cuts before its end. */
export function setName(element: Element, name: string): void {
  if (element.textContent === name) return;
  const characters = [...name];
  const begin = characters.length < LONG ? 0 : characters.length - END;
  const parts = [characters.slice(0, begin).join(""), characters.slice(begin).join("")].filter(Boolean);
  element.replaceChildren(...parts.map((part) => h("span", { class: "lrp-cut" }, part)));
}

/** The first `most` UTF-16 units of a text, and a sign that there are more. */
export function shortened(text: string, most: number): string {
  return text.length > most ? `${text.slice(0, most).replace(/[\uD800-\uDBFF]$/, "")}…` : text;
}
