/** States and transitions where they are drawn: which one an event is about, and what its menu offers. */

import { machineOf, nameOf } from "../language/paths";
import { breakpointItems } from "../parts/breakpoints";
import { askWhy } from "../parts/why";
import { addressed, placeOf } from "../session/instances";
import type { Lab } from "../session/store";
import { item, type MenuItem } from "../ui/menu";
import type { Point } from "../ui/point";

export interface Drawn {
  kind: "state" | "transition";
  path: string;
}

/** The state or transition that an event is about; a label is part of its transition. */
export function drawnAt(target: EventTarget | null): Drawn | null {
  const from = target as Partial<Element>;
  const arrow = from.closest?.("[data-of]")?.getAttribute("data-of");
  const path = arrow ?? from.closest?.(".lrp-state")?.getAttribute("data-lrp-state");
  return path ? { kind: arrow ? "transition" : "state", path } : null;
}

/** `machines`: those that run in a state; `open` shows one. */
export function menuOf(
  lab: Lab,
  { kind, path }: Drawn,
  at: Point,
  machines: readonly string[],
  open: (machine: string) => void,
): (MenuItem | null)[] {
  const isState = kind === "state";
  const opens = machines.map((machine, index) =>
    index
      ? item(`Open ${nameOf(machine)}`, `open-${index}`, () => open(machine))
      : item(`Open ${nameOf(machine)}`, "open", () => open(machine), { hint: "⇧⏎" }),
  );
  const { state } = lab.store;
  const named = addressed(state, path);
  const place = placeOf(state, machineOf(named)); // of the instance that is meant, of several
  const placed = (label: string) => (place ? label.replace(/(?=\?$)|$/, ` in ${place}`) : label);
  const forState = (item: MenuItem) => (isState ? [item] : []);
  return [
    ...(isState
      ? [
          item(
            placed("Transition here"),
            "transition",
            () => void lab.act({ do: "transition", path: named }),
          ),
          item(placed("Teleport here"), "teleport", () => void lab.act({ do: "teleport", path: named })),
        ]
      : [item(placed("Fire now"), "fire", () => void lab.act({ do: "fire", path: named }))]),
    item(placed(isState ? "Why?" : "Why not?"), "why", () => askWhy(lab, kind, path, at), { hint: "?" }),
    ...breakpointItems(lab, kind, path),
    null,
    ...opens,
    item("Inspect", "inspect", () => lab.inspect(kind, named)),
    item("Go to source", "source", () => lab.goTo(kind, path), { hint: "⏎" }),
    ...forState(item("Rename…", "rename", () => lab.rename("state", path))),
  ];
}
