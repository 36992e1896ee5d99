/**
 * Marks of the run on the drawing: active states, and visits too short to see; the transition that fired last, for
 * good, and those before it for a while, fainter with each firing since.
 */

import type { CountAndTick } from "../protocol";
import { inGraph, type LabState } from "../session/state";
import { setAttribute } from "../ui/dom";
import { glow } from "../ui/timers";
import type { Layers } from "./draw";

export class Marks {
  private entered: Record<string, CountAndTick> = {};
  private fired: Record<string, CountAndTick> = {};
  private machine = "";
  private tick = 0;

  constructor(
    private readonly layers: Layers,
    private readonly state: LabState,
  ) {}

  /** Update the marks from the state; a watcher of the store. */
  readonly update = (): void => {
    const { layers, state } = this;
    const { lit, entered, fired } = inGraph(state);
    const fresh = state.machine !== this.machine; // another drawing: nothing that was before glows
    this.machine = state.machine;
    for (const node of layers.root.querySelectorAll("[data-lrp-state]")) {
      const path = node.getAttribute("data-lrp-state") ?? "";
      const active = lit.includes(path);
      setAttribute(node, "data-active", active);
      setAttribute(node, "aria-current", active ? "true" : null);
      if (!fresh && !active && this.grown(entered[path], this.entered[path])) glow(node);
      setAttribute(node, "data-chosen", path === state.chosen);
    }
    const ages = agesOf(fired);
    for (const part of layers.root.querySelectorAll("[data-of]")) {
      const id = part.getAttribute("data-of") ?? "";
      const isArrow = part.classList.contains("lrp-transition");
      setAttribute(part, "data-chosen", id === state.chosen);
      setAttribute(part, "data-fired", ages.get(id) === 0);
      if (!isArrow) continue;
      setAttribute(part, "aria-description", ages.get(id) === 0 ? "fired last" : null);
      if (!fresh && this.grown(fired[id], this.fired[id])) glow(part);
      setAttribute(part, "style", `--lrp-age: ${ages.get(id) ?? 0}`);
    }
    this.entered = entered;
    this.fired = fired;
    this.tick = state.tick;
  };

  /** Whether something happened since the last update; a renamed element keeps its count. */
  private grown(now: CountAndTick | undefined, before: CountAndTick | undefined): boolean {
    return before ? (now?.[0] ?? 0) > before[0] : (now?.[1] ?? 0) > this.tick;
  }
}

/** How many other transitions of its machine have fired since each did: 0 for the last one. */
export function agesOf(fired: Record<string, CountAndTick>): Map<string, number> {
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
export function lastFired(fired: Record<string, CountAndTick>): string[] {
  return [...agesOf(fired)].filter(([, age]) => age === 0).map(([id]) => id);
}
