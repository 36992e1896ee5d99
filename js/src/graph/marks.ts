/** Marks of the run on the drawing: active states, the last fired transition, and visits too short to see. */

import type { CountView } from "../protocol";
import { inGraph, type LabState } from "../session/state";
import { setAttribute } from "../ui/dom";
import type { Layers } from "./draw";

/** How long a visit or a firing stays visible (ms); at least 150, whatever the rate. */
export const AFTERGLOW = 450;

export class Marks {
  private entered: Record<string, CountView> = {};
  private fired: Record<string, CountView> = {};
  private machine = "";
  private tick = 0;
  private readonly timers = new Map<Element, ReturnType<typeof setTimeout>>();

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
      if (!fresh && !active && this.grown(entered[path], this.entered[path])) this.glow(node);
      setAttribute(node, "data-chosen", path === state.chosen);
    }
    const last = new Set(lastFired(fired).values());
    for (const arrow of layers.root.querySelectorAll(".lrp-transition")) {
      const id = arrow.getAttribute("data-of") ?? "";
      setAttribute(arrow, "data-fired", last.has(id));
      if (!fresh && this.grown(fired[id], this.fired[id])) this.glow(arrow);
      setAttribute(arrow, "data-chosen", id === state.chosen);
    }
    for (const label of layers.root.querySelectorAll(".lrp-label")) {
      setAttribute(label, "data-chosen", label.getAttribute("data-of") === state.chosen);
    }
    this.entered = entered;
    this.fired = fired;
    this.tick = state.tick;
  };

  /** Whether something happened since the last update; a renamed element keeps its count. */
  private grown(now: CountView | undefined, before: CountView | undefined): boolean {
    return before ? (now?.count ?? 0) > before.count : (now?.tick ?? 0) > this.tick;
  }

  private glow(element: Element): void {
    clearTimeout(this.timers.get(element));
    element.setAttribute("data-glow", "");
    const end = () => {
      element.removeAttribute("data-glow");
      this.timers.delete(element);
    };
    this.timers.set(element, setTimeout(end, AFTERGLOW));
  }
}

/** The transition that fired last, of each machine. */
export function lastFired(fired: Record<string, CountView>): Map<string, string> {
  const last = new Map<string, string>();
  for (const [id, { count, tick }] of Object.entries(fired)) {
    const machine = id.slice(0, id.indexOf(":"));
    if (count > 0 && tick >= (fired[last.get(machine) ?? ""]?.tick ?? 0)) last.set(machine, id);
  }
  return last;
}
