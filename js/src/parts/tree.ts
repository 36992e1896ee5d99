/**
 * All machines, nested as in the program; each with its active state. Under one that runs in several places stand its
 * instances, of which one can be selected. While they are few, a lab has no panel for
 * them: they stand in the heading of the graph, as a path.
 */

import { follow, followAsKept, followRun, showMachine } from "../graph/shown";
import { nameOf } from "../language/paths";
import type { InstanceView, MachineItem } from "../protocol";
import { instancesOf, placesOf, stateOf } from "../session/instances";
import { besideGraph, type LabState } from "../session/state";
import type { Lab, Store } from "../session/store";
import { panel, setSwitch, toggle } from "../ui/button";
import { setName } from "../ui/cut";
import { consume, h, reconcile, setAttribute, setHidden, setText } from "../ui/dom";

const FEW = 3;
/** The views in which a machine has run in several places: from then on they have a panel, so that nothing swings. */
const SHARING = new WeakSet<Store>();

function isFew(store: Store): boolean {
  const { program, instances } = store.state;
  if (new Set(instances.map(({ machine }) => machine)).size < instances.length) SHARING.add(store);
  return program.machines.length <= FEW && !SHARING.has(store);
}

export function treeView(lab: Lab): HTMLElement {
  const { store } = lab;
  const isPart = lab.root.dataset.part === "tree";
  const isFolded = () => !isPart && isFew(store);
  // folded, it is seen only where the graph is not
  const { list, update } = machines(
    lab,
    "/",
    ({ parentElement }) => !isFolded() || !!parentElement?.clientHeight,
  );
  const switches = isPart ? [followSwitch(lab)] : [];
  const { element } = panel("tree", "Machines", switches, list);
  store.watch(["program", "instances", "snapshot"], () => {
    setAttribute(element, "data-folded", isFolded() ? String(store.state.program.machines.length) : null);
  });
  if (isPart) followRun(lab);
  new ResizeObserver(update).observe(element);
  return element;
}

/** The machines in the heading of the graph; empty while they have a panel. */
export function pathView(lab: Lab): HTMLElement {
  const { list } = machines(lab, "›", () => isFew(lab.store));
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

/** A machine, or one of its instances, with where that runs. */
interface Row {
  machine: MachineItem;
  instance: InstanceView | null;
  place: string;
}

/** The machines of a program, each before its instances if there are several. */
export function rowsOf(
  { machines }: Pick<LabState["program"], "machines">,
  run: Pick<LabState, "instances">,
): Row[] {
  return machines.flatMap((machine) => {
    const all = instancesOf(run, machine.path);
    const places = placesOf(all.map(({ path }) => path));
    const [only = null] = all.length === 1 ? all : [];
    const several = all.length > 1 ? all : [];
    const own = several.map((each) => ({ machine, instance: each, place: places.get(each.path)! }));
    return [{ machine, instance: only, place: "" }, ...own];
  });
}

function machines(
  lab: Lab,
  between: string,
  areShown: (list: HTMLElement) => boolean,
): { list: HTMLElement; update: () => void } {
  const { store } = lab;
  const list = h("div", { class: "lrp-tree", role: "tree", "aria-label": "Machines" });
  const keyOf = ({ machine, instance, place }: Row) =>
    place ? `${machine.path} ${instance!.path}` : machine.path;
  /** Show a machine, and select an instance of it; a machine that runs in several places means all of them. */
  const select = (path: string, instance: string) => {
    showMachine(store, path);
    if (instance || instancesOf(store.state, path).length > 1) store.set("instance", instance);
  };
  const make = ({ machine: { path }, instance, place }: Row) =>
    h(
      "div",
      {
        class: "lrp-tree-item",
        role: "treeitem",
        "data-lrp-machine": path,
        "data-lrp-instance": place ? instance!.path : null,
        onclick: () => select(path, place ? instance!.path : ""),
        ondblclick: (event: Event) => {
          lab.goTo("machine", path);
          consume(event); // in a heading it would enlarge the panel
        },
      },
      h("span", { class: "lrp-dot", "aria-hidden": "true" }),
      h("span", { class: "lrp-tree-around" }),
      h("span", { class: "lrp-tree-name" }),
      h("span", { class: "lrp-tree-settings" }),
      h("span", { class: "lrp-tree-state" }),
    );
  const updateItem = (item: Element, { machine, instance, place }: Row) => {
    const run = besideGraph(store.state);
    const all = instancesOf(run, machine.path);
    const depth = (machine.path.split("/").length - 1) / 2 + (place ? 1 : 0);
    const active = place
      ? stateOf(run, instance!)
      : (machine.states.find(({ path }) => run.lit.includes(path))?.path ?? "");
    const isShown = machine.path === store.state.machine;
    const chosen = all.length > 1 ? (all.find(({ path }) => path === run.instance)?.path ?? "") : "";
    const isSelected = isShown && chosen === (place ? instance!.path : "");
    const [, around, name, settings, state] = item.children;
    setName(around!, machine.parent && !place ? `${nameOf(machine.parent)} ${between} ` : "");
    setName(name!, place || nameOf(machine.path));
    setText(settings!, instance?.settings ?? "");
    setName(state!, place || all.length < 2 ? nameOf(active) : "");
    const path = place ? `${instance!.path}/${nameOf(active)}` : active || machine.path;
    setAttribute(item, "title", [path, instance?.settings].filter(Boolean).join("\n"));
    setAttribute(item, "style", `--lrp-depth: ${depth}`);
    setAttribute(item, "aria-level", depth + 1);
    setAttribute(item, "aria-selected", String(isSelected));
    setAttribute(item, "tabindex", isSelected ? "0" : "-1");
    setAttribute(item, "data-active", Boolean(active));
  };
  const update = () => {
    const shown = areShown(list) ? rowsOf(store.state.program, besideGraph(store.state)) : [];
    reconcile(list, shown, keyOf, make, updateItem);
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
      select(next.dataset.lrpMachine!, next.dataset.lrpInstance ?? "");
      next.focus();
    } else return;
    consume(event);
  });
  store.watch(
    ["program", "lit", "active", "instances", "instance", "machine", "snapshot", "settings"],
    update,
  );
  return { list, update };
}
