/** Breakpoints as the page sees them: which an element has, how they are shown, and how they are set. */

import { machineOf } from "../language/paths";
import type { BreakpointView, ElementKind } from "../protocol";
import { instancesOf, meant, placeOf } from "../session/instances";
import type { LabState } from "../session/state";
import type { Lab } from "../session/store";
import { item, type MenuItem } from "../ui/menu";

type BreakpointKind = BreakpointView["kind"];

/** How a dot is drawn: filled, or hollow where no breakpoint of the element can pause. */
export type Dot = "on" | "off";

/** The kind of element that a kind of breakpoint has. */
export const ELEMENT_OF: Record<BreakpointKind, ElementKind | null> = {
  entered: "state",
  left: "state",
  fired: "transition",
  event: "event",
  condition: null,
};

/** The kind of breakpoint that a click sets on a kind of element. */
export const USUAL: Partial<Record<ElementKind, BreakpointKind>> = {
  state: "entered",
  transition: "fired",
  event: "event",
};

const LABELS: [BreakpointKind, string][] = [
  ["entered", "Pause when entered"],
  ["left", "Pause when left"],
  ["fired", "Pause when it fires"],
  ["event", "Pause when it occurs"],
];

export function breakpointsOf(
  { breakpoints }: Pick<LabState, "breakpoints">,
  kind: ElementKind,
  path: string,
): [number, BreakpointView][] {
  return Object.entries(breakpoints)
    .filter(([, each]) => ELEMENT_OF[each.kind] === kind && each.path === path)
    .map(([number, each]) => [Number(number), each]);
}

/** The dots of the elements that have a breakpoint, by kind and path: see `keyOf`. */
export function dotsOf({ breakpoints }: Pick<LabState, "breakpoints">): Map<string, Dot> {
  const dots = new Map<string, Dot>();
  for (const { kind, path, enabled, dormant } of Object.values(breakpoints)) {
    const noun = ELEMENT_OF[kind];
    const key = noun && keyOf(noun, path);
    if (key && dots.get(key) !== "on") dots.set(key, enabled && !dormant ? "on" : "off");
  }
  return dots;
}

export function keyOf(kind: ElementKind, path: string): string {
  return `${kind} ${path}`;
}

/** Add a breakpoint of this kind to an element, in any instance or in one; or remove those that it has. */
export async function toggleBreakpoint(
  lab: Lab,
  kind: BreakpointKind,
  path: string,
  instance = "",
): Promise<void> {
  const noun = ELEMENT_OF[kind];
  const known = noun
    ? breakpointsOf(lab.store.state, noun, path).filter(([, each]) => isOf(each, kind, instance))
    : [];
  if (!known.length) await lab.act({ do: "add_breakpoint", kind, path, ...(instance && { instance }) });
  for (const [number] of known) await lab.act({ do: "remove_breakpoint", number });
}

const isOf = (each: BreakpointView, kind: BreakpointKind, instance: string) =>
  each.kind === kind && each.instance === instance;

/** The items that set breakpoints: in any instance and, where its machine runs in several places, in the one meant. */
export function breakpointItems(lab: Lab, noun: ElementKind, path: string): MenuItem[] {
  const { state } = lab.store;
  const known = breakpointsOf(state, noun, path);
  const toggle = (kind: BreakpointKind, label: string, action: string, instance: string) =>
    item(label, action, () => void toggleBreakpoint(lab, kind, path, instance), {
      checked: known.some(([, each]) => isOf(each, kind, instance)),
    });
  const one = instancesOf(state, machineOf(path)).length > 1 ? meant(state, machineOf(path))[0]!.path : "";
  return LABELS.filter(([kind]) => ELEMENT_OF[kind] === noun).flatMap(([kind, label]) => [
    toggle(kind, label, `pause-${kind}`, ""),
    ...(one ? [toggle(kind, `${label} in ${placeOf(state, one)}`, `pause-${kind}-here`, one)] : []),
  ]);
}
