/**
 * Instances: a machine may run in several places at a time. An instance, and a variable in it, is known by its path
 * as spawned; everything else by its path in the text. One that is selected is meant wherever the lab asks or acts.
 */

import { differences, machineOf, nameOf } from "../language/paths";
import type { InstanceView } from "../protocol";
import type { LabState } from "./state";

export type Running = Pick<LabState, "instances" | "instance">;

/** The instances of a machine that run. */
export function instancesOf({ instances }: Pick<Running, "instances">, machine: string): InstanceView[] {
  return instances.filter((each) => each.machine === machine);
}

/** Those that are meant: the selected one, or the nearest to it; all, where none is near. */
export function meant(state: Running, machine: string): InstanceView[] {
  const all = instancesOf(state, machine);
  const near = all.map(({ path }) => nearness(path, state.instance));
  const most = Math.max(...near);
  return all.filter((_, index) => near[index] === most);
}

/** How many names two paths as spawned begin with in common: up to a state, or all of one. */
function nearness(a: string, b: string): number {
  const [one, other] = [a.split("/"), b.split("/")];
  const apart = one.findIndex((name, index) => name !== other[index]);
  const common = apart < 0 ? one.length : apart;
  return common < Math.min(one.length, other.length) ? common - (common % 2) : common;
}

const truths: Readonly<Record<string, string>> = { true: "True", false: "False" };

/** The path of an element in an instance of its machine. */
export function inInstance(path: string, instance: string): string {
  return instance + path.slice(machineOf(path).length);
}

/** The path of an element, or a variable, as spawned, in the instance that is meant; as in the text if none runs. */
export function spawned(state: Running, path: string): string {
  const machine = machineOf(path);
  return inInstance(path, meant(state, machine)[0]?.path ?? machine);
}

/** The path by which the kernel is told which element is meant: as spawned only where several instances run. */
export function addressed(state: Running, path: string): string {
  return instancesOf(state, machineOf(path)).length > 1 ? spawned(state, path) : path;
}

/** The scope of a block of a machine, by the path with which the kernel is told. */
export function scopeOf(state: Running, machine: string): string {
  const found = meant(state, machine);
  return instancesOf(state, machine).length > 1 ? found[0]!.path : machine;
}

/** Where each of some instances of one machine runs, as short as they can be told apart; empty for a single one. */
export function placesOf(instances: readonly string[]): Map<string, string> {
  const places = instances.length > 1 ? differences(instances) : [];
  return new Map(
    instances.map((path, index) => [path, places[index] || (places.length ? nameOf(path) : "")]),
  );
}

/** Where an instance runs; empty if its machine runs once. */
export function placeOf(state: Pick<Running, "instances">, instance: string): string {
  const machine = state.instances.find(({ path }) => path === instance)?.machine;
  const all = machine === undefined ? [] : instancesOf(state, machine).map(({ path }) => path);
  return placesOf(all).get(instance) ?? "";
}

/** The active state of an instance, by its path in the text; empty if it does not run. */
export function stateOf(
  { active }: Pick<LabState, "active">,
  { path, machine }: Pick<InstanceView, "path" | "machine">,
): string {
  const found = active.find((each) => each.startsWith(`${path}/`));
  return found ? `${machine}/${found.slice(path.length + 1).split("/")[0]}` : "";
}

/** The value of a variable or an event in each instance that is meant, with where that is. */
export function valuesOf(
  state: Running & Pick<LabState, "variables" | "events">,
  kind: "variable" | "event",
  path: string,
  every = false,
): { path: string; place: string; text: string }[] {
  const machine = machineOf(path);
  const found = every ? instancesOf(state, machine) : meant(state, machine);
  const paths = found.length ? found.map((each) => inInstance(path, each.path)) : [path];
  return paths.flatMap((each) => {
    const text = kind === "event" ? truths[String(state.events[each])] : state.variables[each]?.[0];
    return text === undefined ? [] : [{ path: each, place: placeOf(state, machineOf(each)), text }];
  });
}
