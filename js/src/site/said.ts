/** The line below the title of a page, which says what it does or what is wrong. */

import { prose } from "../ui/dom";

export const element = (id: string) => document.getElementById(id)!;

export function say(sentence: string, kind: "busy" | "error" | "done" = "busy"): void {
  const status = element("status");
  status.replaceChildren(...prose(sentence));
  status.dataset.kind = kind;
  status.hidden = !sentence;
}
