/** All machines, nested as in the program; each with its active state. */

import { showMachine } from "../graph/shown";
import { nameOf } from "../language/paths";
import type { MachineItem } from "../protocol";
import { besideGraph } from "../session/state";
import type { Lab } from "../session/store";
import { panel, setSwitch, toggle } from "../ui/button";
import { setName } from "../ui/cut";
import { consume, h, reconcile, setAttribute, setHidden } from "../ui/dom";

export function treeView(lab: Lab): HTMLElement {
  const { store } = lab;
  const list = h("div", { class: "lrp-tree", role: "tree", "aria-label": "Machines" });
  const follow = toggle("Follow", "Always show the machine of the innermost active state", "follow", (on) =>
    store.set("follow", on ? "active" : "nothing"),
  );
  const { element } = panel("tree", "Machines", [follow], list);
  const make = ({ path }: MachineItem) =>
    h(
      "div",
      {
        class: "lrp-tree-item",
        role: "treeitem",
        "data-lrp-machine": path,
        onclick: () => showMachine(store, path),
        ondblclick: () => lab.goTo("machine", path),
      },
      h("span", { class: "lrp-dot", "aria-hidden": "true" }),
      h("span", { class: "lrp-tree-around" }),
      h("span", { class: "lrp-tree-name" }),
      h("span", { class: "lrp-tree-state" }),
    );
  const update = (item: Element, machine: MachineItem) => {
    const { machine: selected } = store.state;
    const { lit } = besideGraph(store.state);
    const depth = machine.path.split("/").length;
    const active = machine.states.find(({ path }) => lit.includes(path))?.path;
    const [, around, name, state] = item.children;
    setName(around!, machine.parent ? `${nameOf(machine.parent)} / ` : "");
    setName(name!, nameOf(machine.path));
    setName(state!, active ? nameOf(active) : "");
    setAttribute(item, "title", active ?? machine.path);
    setAttribute(item, "style", `--lrp-depth: ${(depth - 1) / 2}`);
    setAttribute(item, "aria-level", (depth + 1) / 2);
    setAttribute(item, "aria-selected", String(machine.path === selected));
    setAttribute(item, "tabindex", machine.path === selected ? "0" : "-1");
    setAttribute(item, "data-active", Boolean(active));
  };
  store.watch(["program", "lit", "machine", "snapshot", "settings"], () => {
    reconcile(list, store.state.program.machines, ({ path }) => path, make, update);
  });
  store.watch(["settings"], () => setHidden(follow, store.state.settings.quiet));
  store.watch(["follow"], () => setSwitch(follow, store.state.follow === "active"));
  list.addEventListener("keydown", (event) => {
    const items = [...list.querySelectorAll<HTMLElement>("[role=treeitem]")];
    const index = items.indexOf(event.target as HTMLElement);
    const moves: Record<string, number> = {
      ArrowDown: index + 1,
      ArrowUp: index - 1,
      Home: 0,
      End: items.length - 1,
    };
    const next = items[moves[event.key] ?? -1];
    const path = (event.target as HTMLElement).dataset.lrpMachine;
    if (event.key === "Enter" && path) lab.goTo("machine", path);
    else if (next) {
      showMachine(store, next.dataset.lrpMachine!);
      next.focus();
    } else return;
    consume(event);
  });
  return element;
}
