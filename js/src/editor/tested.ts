/** The events that are tested now: those for which a transition out of an active state waits. */

import { parentOf } from "../language/paths";
import type { LabState } from "../session/state";

export function testedEvents({ program, lit }: Pick<LabState, "program" | "lit">): Set<string> {
  const events = new Set([...program.events, ...program.machines.flatMap((machine) => machine.events)]);
  const tested = new Set<string>();
  for (const { path, transitions } of program.machines) {
    const active = lit.filter((state) => parentOf(state) === path);
    for (const { trigger, source, destination } of transitions) {
      const waits = active.some((state) => leaves(source, destination, state.slice(path.length + 1)));
      const event = waits && inScope(events, trigger.split(" ")[0]!, path);
      if (event) tested.add(event);
    }
  }
  return tested;
}

/** Whether a transition leaves a state; `source` is as the language writes it: `a`, `*`, `{a b}`, `*-{a b}`. */
function leaves(source: string, destination: string, state: string): boolean {
  const named = source
    .replace(/[*{}-]/g, " ")
    .split(" ")
    .includes(state);
  return source.startsWith("*") ? state !== destination && !named : named;
}

/** The path of the event that a name means in a machine, inner before outer. */
function inScope(events: Set<string>, name: string, machine: string): string | null {
  for (let scope = `${machine}/`; ; scope = scope.split("/").slice(0, -3).concat("").join("/")) {
    if (events.has(scope + name)) return scope + name;
    if (!scope) return null;
  }
}
