/**
 * Marks of the run on the drawing: active states, and visits too short to see; the transition that fired last, for
 * good, and those before it for a while, fainter with each firing since.
 */

import type { CountAndTick } from "../protocol";
import { inGraph, type LabState } from "../session/state";
import { setAttribute } from "../ui/dom";
import { glow } from "../ui/timers";
import type { Layers } from "./draw";

type Counts = Record<string, CountAndTick>;

/** Return what updates the marks from the state; a watcher of the store. */
export function marking({ root }: Pick<Layers, "root">, state: LabState): () => void {
  let before = { entered: {} as Counts, fired: {} as Counts, machine: "", tick: 0 };
  /** Whether something happened since the last update; a renamed element keeps its count. */
  const grown = (now: CountAndTick | undefined, then: CountAndTick | undefined) =>
    then ? (now?.[0] ?? 0) > then[0] : (now?.[1] ?? 0) > before.tick;
  return () => {
    const { machine, tick, chosen } = state;
    const { lit, entered, fired } = inGraph(state);
    const fresh = machine !== before.machine; // another drawing: nothing that was before glows
    for (const node of root.querySelectorAll("[data-lrp-state]")) {
      const path = node.getAttribute("data-lrp-state") ?? "";
      const active = lit.includes(path);
      setAttribute(node, "data-active", active);
      setAttribute(node, "aria-current", active ? "true" : null);
      if (!fresh && !active && grown(entered[path], before.entered[path])) glow(node);
      setAttribute(node, "data-chosen", path === chosen);
    }
    const ages = agesOf(fired);
    for (const part of root.querySelectorAll("[data-of]")) {
      const id = part.getAttribute("data-of") ?? "";
      const isArrow = part.classList.contains("lrp-transition");
      setAttribute(part, "data-chosen", id === chosen);
      setAttribute(part, "data-fired", ages.get(id) === 0);
      if (!isArrow) continue;
      setAttribute(part, "aria-description", ages.get(id) === 0 ? "fired last" : null);
      if (!fresh && grown(fired[id], before.fired[id])) glow(part);
      setAttribute(part, "style", `--lrp-age: ${ages.get(id) ?? 0}`);
    }
    before = { entered, fired, machine, tick };
  };
}

/** How many other transitions of its machine have fired since each did: 0 for the last one. */
function agesOf(fired: Counts): Map<string, number> {
  const younger = new Map<string, number>(); // machine -> transitions counted
  const ages = new Map<string, number>();
  const counted = Object.entries(fired).filter(([, [count]]) => count > 0);
  for (const [id] of counted.reverse().sort(([, [, a]], [, [, b]]) => b - a)) {
    const machine = id.slice(0, id.indexOf(":"));
    const age = younger.get(machine) ?? 0;
    ages.set(id, age);
    younger.set(machine, age + 1);
  }
  return ages;
}

/** The transitions that fired last: one of each machine. */
export function lastFired(fired: Counts): string[] {
  return [...agesOf(fired)].filter(([, age]) => age === 0).map(([id]) => id);
}
