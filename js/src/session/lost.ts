/**
 * Texts that no kernel has: what was typed after it ended, or on its way when it did. The browser keeps
 * them, and the next view of the same program gets them, which asks what to do with them.
 */

const PREFIX = "lrp-typed:";
const others = new Map<string, string>(); // where the browser keeps nothing, or has no space left

export function keepLost(home: string, text: string): void {
  if (!home) return;
  try {
    localStorage.setItem(PREFIX + home, text);
    others.delete(home);
  } catch {
    others.set(home, text);
  }
}

export function lostText(home: string): string | null {
  try {
    return others.get(home) ?? localStorage.getItem(PREFIX + home);
  } catch {
    return others.get(home) ?? null;
  }
}

export function forgetLost(home: string): void {
  others.delete(home);
  try {
    localStorage.removeItem(PREFIX + home);
  } catch {
    // there was nothing
  }
}
