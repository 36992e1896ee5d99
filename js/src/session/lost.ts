/**
 * Texts that no kernel has: what was typed after it ended, or on its way when it did. The browser keeps
 * them, one for each view, and the next view of the same program gets them, which asks what to do with them.
 */

const PREFIX = "lrp-typed:";
const others = new Map<string, string>(); // where the browser keeps nothing, or has no space left

const keyOf = (home: string, view: string) => `${PREFIX}${home}\n${view}`;

export function keepLost(home: string, view: string, text: string): void {
  if (!home) return;
  const key = keyOf(home, view);
  try {
    localStorage.setItem(key, text);
    others.delete(key);
  } catch {
    others.set(key, text);
  }
}

/** The texts of a program, by the views that kept them. */
export function lostTexts(home: string): Map<string, string> {
  let kept: [string, string][] = [...others];
  try {
    kept = [...Object.entries<string>(localStorage), ...kept];
  } catch {
    // the browser keeps nothing
  }
  const start = keyOf(home, "");
  return new Map(
    kept.filter(([key]) => key.startsWith(start)).map(([key, text]) => [key.slice(start.length), text]),
  );
}

export function forgetLost(home: string, view: string): void {
  const key = keyOf(home, view);
  others.delete(key);
  try {
    localStorage.removeItem(key);
  } catch {
    // there was nothing
  }
}
