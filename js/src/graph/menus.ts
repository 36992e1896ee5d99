/** The menus of states and transitions. Paper: §6.4 (transition here, teleport here), §6.5 (inspect). */

import type { Lab } from "../session/store";
import type { MenuItem } from "../ui/menu";

export function stateMenu(lab: Lab, path: string, open: () => void): (MenuItem | null)[] {
  const nested = lab.store.state.program.machines.some((machine) => machine.parent === path);
  return [
    { label: "Transition here", action: "transition", run: () => void lab.act({ do: "transition", path }) },
    { label: "Teleport here", action: "teleport", run: () => void lab.act({ do: "teleport", path }) },
    null,
    { label: "Open nested machine", action: "open", run: open, disabled: !nested, hint: "⇧⏎" },
    { label: "Inspect", action: "inspect", run: () => lab.inspect("state", path) },
    { label: "Go to source", action: "source", run: () => lab.goTo("state", path), hint: "⏎" },
    { label: "Rename…", action: "rename", run: () => lab.rename("state", path) },
  ];
}

export function transitionMenu(lab: Lab, path: string): (MenuItem | null)[] {
  return [
    { label: "Fire now", action: "fire", run: () => void lab.act({ do: "fire", path }) },
    null,
    { label: "Inspect", action: "inspect", run: () => lab.inspect("transition", path) },
    { label: "Go to source", action: "source", run: () => lab.goTo("transition", path), hint: "⏎" },
  ];
}
