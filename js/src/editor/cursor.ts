/** Where the cursor stood, over a reload of the page; per lab, in this tab only. */

const KEY = (name: string) => `lrp-cursor-${name}`;

export function rememberCursor(name: string, offset: number): void {
  try {
    if (name) sessionStorage.setItem(KEY(name), String(offset));
  } catch {
    // a page without storage forgets
  }
}

export function rememberedCursor(name: string): number {
  try {
    return Number(sessionStorage.getItem(KEY(name))) || 0;
  } catch {
    return 0;
  }
}
