/**
 * Texts that no kernel has: what was typed after it ended, or on its way when it did. The browser keeps
 * them, one for each view, and the next view of the same program gets them, which asks what to do with them.
 * Where the kernel keeps no texts either, that view must be in the same tab: the browser may be someone else's next.
 */

/** What distinguishes a program from others of its name, and whether its texts end with the tab. */
interface Home {
  home: string;
  tab_only: boolean;
}

const PREFIX = "lrp-typed:";
const others = new Map<string, string>(); // where the browser keeps nothing, or has no space left

const storeOf = ({ tab_only }: Home) => (tab_only ? sessionStorage : localStorage);
const keyOf = (home: string, view: string) => `${PREFIX}${home}\n${view}`;

export function keepLost(at: Home, view: string, text: string): void {
  if (!at.home) return;
  const key = keyOf(at.home, view);
  try {
    storeOf(at).setItem(key, text);
    others.delete(key);
  } catch {
    others.set(key, text);
  }
}

/** The texts of a program, by the views that kept them. */
export function lostTexts(at: Home): Map<string, string> {
  let kept: [string, string][] = [...others];
  try {
    kept = [...Object.entries<string>(storeOf(at)), ...kept];
  } catch {
    // the browser keeps nothing
  }
  const start = keyOf(at.home, "");
  return new Map(
    kept.filter(([key]) => key.startsWith(start)).map(([key, text]) => [key.slice(start.length), text]),
  );
}

export function forgetLost(at: Home, view: string): void {
  const key = keyOf(at.home, view);
  others.delete(key);
  try {
    storeOf(at).removeItem(key);
  } catch {
    // there was nothing
  }
}
