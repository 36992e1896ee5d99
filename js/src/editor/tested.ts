/** The events that are tested now, as spawned: those for which a transition out of an active state waits. */

import { isIn, machineOf, nameOf } from "../language/paths";
import { inInstance, stateOf } from "../session/instances";
import type { LabState } from "../session/state";

export function testedEvents(state: Pick<LabState, "program" | "active" | "instances">): Set<string> {
  const { program, instances } = state;
  const events = new Set([...program.events, ...program.machines.flatMap((machine) => machine.events)]);
  const tested = new Set<string>();
  for (const instance of instances) {
    const { transitions } = program.machines.find(({ path }) => path === instance.machine) ?? {};
    const active = nameOf(stateOf(state, instance));
    for (const { trigger, source, destination } of transitions ?? []) {
      const waits = leaves(source, destination, active);
      const event = waits && inScope(events, trigger.split(" ")[0]!, instance.machine);
      if (!event) continue;
      const owner = instances.findLast(
        (each) => each.machine === machineOf(event) && isIn(instance.path, each.path),
      );
      tested.add(owner ? inInstance(event, owner.path) : event);
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
