/**
 * Marks of the run on the drawing: active states, and visits too short to see; the transition that fired last, for
 * good, and those before it for a while, fainter with each firing since.
 */

import { parentOf } from "../language/paths";
import { reachWords } from "../parts/coverage";
import type { CountAndTick, Layout } from "../protocol";
import { inGraph, type LabState } from "../session/state";
import { s, setAttribute, setText } from "../ui/dom";
import { glow } from "../ui/timers";
import type { Layers } from "./draw";
import { statesOn } from "./inside";

const [INSET, ABOVE] = [10, 4]; // px from the left side of a state, and from its top, to what is written above it

type Counts = Record<string, CountAndTick>;

/** Return what updates the marks from the state; a watcher of the store. */
export function marking({ root }: Pick<Layers, "root">, state: LabState): () => void {
  let before = { entered: {} as Counts, fired: {} as Counts, machine: "", tick: 0 };
  /** Whether something happened since the last update; a renamed element keeps its count. */
  const grown = (now: CountAndTick | undefined, then: CountAndTick | undefined) =>
    then ? (now?.[0] ?? 0) > then[0] : (now?.[1] ?? 0) > before.tick;
  return () => {
    const { machine, tick, chosen, layouts } = state;
    const { active, lit, users, entered, fired } = inGraph(state);
    const fresh = machine !== before.machine; // another drawing: nothing that was before glows
    for (const node of root.querySelectorAll("[data-lrp-state]")) {
      const path = node.getAttribute("data-lrp-state") ?? "";
      const isLit = lit.includes(path);
      setAttribute(node, "data-active", isLit);
      setAttribute(node, "aria-current", isLit ? "true" : null);
      if (!fresh && !isLit && grown(entered[path], before.entered[path])) glow(node);
      setAttribute(node, "data-chosen", path === chosen);
      describe(node, users[path] ? `in ${users[path]}` : "", reachWords(state, "state", path));
      tag(node, users[path] ?? "");
    }
    nameUsers(root, active, layouts);
    const ages = agesOf(fired);
    for (const part of root.querySelectorAll("[data-of]")) {
      const id = part.getAttribute("data-of") ?? "";
      const isArrow = part.classList.contains("lrp-transition");
      setAttribute(part, "data-chosen", id === chosen);
      setAttribute(part, "data-fired", ages.get(id) === 0);
      if (!isArrow) continue;
      describe(part, ages.get(id) === 0 ? "fired last" : "", reachWords(state, "transition", id));
      if (!fresh && grown(fired[id], before.fired[id])) glow(part);
      setAttribute(part, "style", `--lrp-age: ${ages.get(id) ?? 0}`);
    }
    before = { entered, fired, machine, tick };
  };
}

function describe(element: Element, ...words: string[]): void {
  setAttribute(element, "aria-description", words.filter(Boolean).join(", ") || null);
}

/** Name the state in which the machine of an active state runs, above it, right of the mark of a start state. */
function tag(node: Element, user: string): void {
  const before = node.querySelector(":scope > .lrp-user");
  const box = node.querySelector(":scope > .lrp-box");
  if (!user || !box) {
    before?.remove();
    return;
  }
  const element = before ?? s("text", { class: "lrp-user" });
  if (!before) node.append(element);
  const at = (name: string) => Number(box.getAttribute(name));
  setAttribute(element, "x", at("x") + INSET);
  setAttribute(element, "y", at("y") - ABOVE);
  setText(element, user);
}

/** Name the state in which a machine of the top level runs, beside its name: nested ones name it all the time. */
function nameUsers(root: Element, active: readonly string[], layouts: Record<string, Layout>): void {
  const users = new Map<string, Set<string>>();
  for (const path of active) {
    const states = statesOn(path, layouts);
    states.slice(1).forEach((state, outer) => {
      const machine = parentOf(state);
      users.set(machine, (users.get(machine) ?? new Set()).add(states[outer]!));
    });
  }
  for (const name of root.querySelectorAll("[data-drawing] > .lrp-layer-frame > .lrp-machine")) {
    const machine = name.closest("[data-drawing]")!.getAttribute("data-drawing")!;
    if (parentOf(machine)) continue;
    const within = [...(users.get(machine) ?? [])].join(", ");
    const before = name.querySelector(".lrp-within");
    if (!within) before?.remove();
    else if (before) setText(before, `in ${within}`);
    else name.append(s("tspan", { class: "lrp-within", dx: 6 }, `in ${within}`));
  }
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
