/** What the browser keeps of its user's choices, for all labs: sizes, hidden panels, switches. */

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

/** Whether a switch is on; `usual` until the user has chosen. */
export function isOn(name: string, usual: boolean): boolean {
  const value = kept(name);
  return value === null ? usual : value === "on";
}

export function keepOn(name: string, on: boolean): void {
  keep(name, on ? "on" : "off");
}

export function forget(name: string): void {
  forgetAll((other) => other === name);
}

export function forgetAll(concerns: (name: string) => boolean): void {
  try {
    for (const key of Object.keys(localStorage))
      if (key.startsWith(KEY("")) && concerns(key.slice(KEY("").length))) localStorage.removeItem(key);
  } catch {
    // there was nothing
  }
}
