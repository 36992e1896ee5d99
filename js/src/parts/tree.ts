/**
 * All machines, nested as in the program; each with its active state. While they are few, a lab has no panel for
 * them: they stand in the heading of the graph, as a path.
 */

import { follow, followAsKept, followRun, showMachine } from "../graph/shown";
import { nameOf } from "../language/paths";
import type { MachineItem } from "../protocol";
import { besideGraph, type LabState } from "../session/state";
import type { Lab } from "../session/store";
import { panel, setSwitch, toggle } from "../ui/button";
import { setName } from "../ui/cut";
import { consume, h, reconcile, setAttribute, setHidden } from "../ui/dom";

const FEW = 3;
const isFew = ({ program }: LabState) => program.machines.length <= FEW;

export function treeView(lab: Lab): HTMLElement {
  const { store } = lab;
  const isPart = lab.root.dataset.part === "tree";
  const isFolded = () => !isPart && isFew(store.state);
  // folded, it is seen only where the graph is not
  const { list, update } = machines(
    lab,
    "/",
    ({ parentElement }) => !isFolded() || !!parentElement?.clientHeight,
  );
  const switches = isPart ? [followSwitch(lab)] : [];
  const { element } = panel("tree", "Machines", switches, list);
  store.watch(["program", "snapshot"], () => {
    setAttribute(element, "data-folded", isFolded() ? String(store.state.program.machines.length) : null);
  });
  if (isPart) followRun(lab);
  new ResizeObserver(update).observe(element);
  return element;
}

/** The machines in the heading of the graph; empty while they have a panel. */
export function pathView(lab: Lab): HTMLElement {
  const { list } = machines(lab, "›", () => isFew(lab.store.state));
  list.classList.add("lrp-path");
  setAttribute(list, "aria-orientation", "horizontal");
  return list;
}

function followSwitch(lab: Lab): HTMLElement {
  const { store } = lab;
  followAsKept(store);
  const element = toggle("Follow", "Always show the machine of the innermost active state", "follow", (on) =>
    follow(store, on ? "active" : "nothing"),
  );
  store.watch(["settings"], () => setHidden(element, store.state.settings.quiet));
  store.watch(["follow"], () => setSwitch(element, store.state.follow === "active"));
  return element;
}

function machines(
  lab: Lab,
  between: string,
  areShown: (list: HTMLElement) => boolean,
): { list: HTMLElement; update: () => void } {
  const { store } = lab;
  const list = h("div", { class: "lrp-tree", role: "tree", "aria-label": "Machines" });
  const make = ({ path }: MachineItem) =>
    h(
      "div",
      {
        class: "lrp-tree-item",
        role: "treeitem",
        "data-lrp-machine": path,
        onclick: () => showMachine(store, path),
        ondblclick: (event: Event) => {
          lab.goTo("machine", path);
          consume(event); // in a heading it would enlarge the panel
        },
      },
      h("span", { class: "lrp-dot", "aria-hidden": "true" }),
      h("span", { class: "lrp-tree-around" }),
      h("span", { class: "lrp-tree-name" }),
      h("span", { class: "lrp-tree-state" }),
    );
  const updateItem = (item: Element, machine: MachineItem) => {
    const { machine: selected } = store.state;
    const { lit } = besideGraph(store.state);
    const depth = machine.path.split("/").length;
    const active = machine.states.find(({ path }) => lit.includes(path))?.path;
    const [, around, name, state] = item.children;
    setName(around!, machine.parent ? `${nameOf(machine.parent)} ${between} ` : "");
    setName(name!, nameOf(machine.path));
    setName(state!, active ? nameOf(active) : "");
    setAttribute(item, "title", active ?? machine.path);
    setAttribute(item, "style", `--lrp-depth: ${(depth - 1) / 2}`);
    setAttribute(item, "aria-level", (depth + 1) / 2);
    setAttribute(item, "aria-selected", String(machine.path === selected));
    setAttribute(item, "tabindex", machine.path === selected ? "0" : "-1");
    setAttribute(item, "data-active", Boolean(active));
  };
  const update = () => {
    const shown = areShown(list) ? store.state.program.machines : [];
    reconcile(list, shown, ({ path }) => path, make, updateItem);
  };
  list.addEventListener("keydown", (event) => {
    const items = [...list.querySelectorAll<HTMLElement>("[role=treeitem]")];
    const index = items.indexOf(event.target as HTMLElement);
    const moves: Record<string, number> = {
      ArrowDown: index + 1,
      ArrowRight: index + 1,
      ArrowUp: index - 1,
      ArrowLeft: index - 1,
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
  store.watch(["program", "lit", "machine", "snapshot", "settings"], update);
  return { list, update };
}
