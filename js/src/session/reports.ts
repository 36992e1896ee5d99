/**
 * Reports to the kernel that what runs has changed, where something there waits for that: cells of a notebook that
 * runs them again, observers. The report is a trait, because that is what such a notebook hears of.
 */

import type { Model } from "./connection";
import { newest } from "./newest";
import type { Store } from "./store";

const INTERVAL = 250; // ms between two reports at least

/** Report each change of what the program does; time alone is none. */
export function reportChanges(model: Model, { store, closed }: { store: Store; closed: AbortSignal }): void {
  let last = Number.NEGATIVE_INFINITY;
  const report = newest(
    closed,
    () => last + INTERVAL,
    async () => {
      last = performance.now();
      model.set?.("reported", Date.now());
      model.save_changes?.();
    },
  );
  store.watch(["status", "active", "variables", "revision", "issues"], () => {
    if (store.state.tick && model.get?.("reports")) report();
  });
}
