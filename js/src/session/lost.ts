/**
 * Texts that no kernel has: what was typed after it ended, or on its way when it did. The browser keeps
 * them, one for each view, and the next view of the same program gets them, which asks what to do with them.
 * Where the kernel keeps no texts either, that view must be in the same tab: the browser may be someone else's next.
 */

import { Kept } from "../ui/kept";

/** What distinguishes a program from others of its name, and whether its texts end with the tab. */
interface Home {
  home: string;
  tab_only: boolean;
}

const others = new Map<string, string>(); // where the browser keeps nothing, or has no space left

const storeOf = ({ home, tab_only }: Home) =>
  new Kept(() => (tab_only ? sessionStorage : localStorage), `lrp-typed:${home}\n`);
const keyOf = (home: string, view: string) => `${home}\n${view}`;

export function keepLost(at: Home, view: string, text: string): void {
  if (!at.home) return;
  if (storeOf(at).set(view, text)) others.delete(keyOf(at.home, view));
  else others.set(keyOf(at.home, view), text);
}

/** The texts of a program, by the views that kept them. */
export function lostTexts(at: Home): Map<string, string> {
  const start = keyOf(at.home, "");
  const here = [...others].filter(([key]) => key.startsWith(start));
  return new Map([
    ...storeOf(at).all(),
    ...here.map(([key, text]) => [key.slice(start.length), text] as const),
  ]);
}

export function forgetLost(at: Home, view: string): void {
  others.delete(keyOf(at.home, view));
  storeOf(at).remove((other) => other === view);
}
