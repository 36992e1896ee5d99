/** What the browser keeps of its user's choices, for all labs: sizes, hidden panels. */

const KEY = (name: string) => `lrp-kept:${name}`;

export function keep(name: string, value: string): void {
  try {
    localStorage.setItem(KEY(name), value);
  } catch {
    // a page without storage forgets
  }
}

export function kept(name: string): string | null {
  try {
    return localStorage.getItem(KEY(name));
  } catch {
    return null;
  }
}

export function forget(name: string): void {
  try {
    localStorage.removeItem(KEY(name));
  } catch {
    // there was nothing
  }
}
