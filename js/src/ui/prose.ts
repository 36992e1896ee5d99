/** Sentences of the kernel: names in backticks become code. */

import { h } from "./dom";

export function prose(sentence: string): (HTMLElement | string)[] {
  return sentence.split(/`([^`]*)`/).map((part, index) => (index % 2 ? h("code", {}, part) : part));
}
