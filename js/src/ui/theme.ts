/**
 * Light or dark, by the actual background: in a dark JupyterLab the browser's own
 * preference may well be light.
 */

import { parentOf, whenAttached } from "./root";

export function watchTheme(root: HTMLElement, closed: AbortSignal): void {
  const update = () => {
    root.dataset.theme = isDark(parentOf(root) ?? document.body) ? "dark" : "light";
  };
  const observer = new MutationObserver(update);
  const attributes = {
    attributes: true,
    attributeFilter: ["class", "style", "data-jp-theme-light", "data-theme"],
  };
  observer.observe(document.body, attributes);
  observer.observe(document.documentElement, attributes);
  const preference = window.matchMedia("(prefers-color-scheme: dark)");
  preference.addEventListener("change", update, { signal: closed });
  closed.addEventListener("abort", () => observer.disconnect());
  update();
  whenAttached(root, closed, update);
}

function isDark(start: Element): boolean {
  for (let element: Element | null = start; element; element = parentOf(element)) {
    const lightness = lightnessOf(getComputedStyle(element).backgroundColor);
    if (lightness !== null) return lightness < 128;
  }
  return window.matchMedia("(prefers-color-scheme: dark)").matches && colorScheme().includes("dark");
}

function colorScheme(): string {
  return getComputedStyle(document.documentElement).colorScheme;
}

/** The brightness (0 to 255) of a computed colour; null if it is transparent. */
export function lightnessOf(color: string): number | null {
  const [red, green, blue, alpha = 1] = (color.match(/[\d.]+/g) ?? []).map(Number);
  if (red === undefined || green === undefined || blue === undefined || alpha < 0.5) return null;
  const scale = color.startsWith("color(") ? 255 : 1;
  return (0.299 * red + 0.587 * green + 0.114 * blue) * scale;
}
