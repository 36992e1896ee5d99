/** The conditions of a study, as far as they concern several parts. */

import type { SettingsView } from "../protocol";
import { setAttribute } from "../ui/dom";

const LOCKED = "This is set for a study, and cannot be changed here.";

/** The panels that are not shown. */
export function withheld({ graph, quiet }: SettingsView): string[] {
  return [...(graph === "hidden" ? ["tree", "graph"] : []), ...(quiet ? ["variables"] : [])];
}

/** Disable what would change a condition that is locked, and say why. */
export function showLock(
  control: HTMLButtonElement | HTMLSelectElement,
  { lock }: SettingsView,
  usual: string,
): void {
  control.disabled = lock;
  setAttribute(control, "title", lock ? LOCKED : usual);
}
