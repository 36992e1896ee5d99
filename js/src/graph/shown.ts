/**
 * Which machine the graph shows: the one that the user has chosen, wherever they type; or, with *Follow the cursor*,
 * the one around the cursor.
 */

import { type Extension, Transaction } from "@codemirror/state";
import { ViewPlugin, type ViewUpdate } from "@codemirror/view";
import { DRAWN } from "../editor/pen";
import { outlineOf } from "../language/lrp";
import { parentOf } from "../language/paths";
import { besideGraph, type LabState } from "../session/state";
import type { Lab, Store } from "../session/store";
import { iconButton } from "../ui/button";
import { setHidden } from "../ui/dom";
import { isOn, keepOn } from "../ui/kept";
import { whenSteady } from "../ui/timers";
import { isDrawnIn, statesOn } from "./inside";

const STEADY = 1000; // ms

type Followed = LabState["follow"];

/** The names under which the browser keeps the switches. */
const KEPT = { active: "follow-active", cursor: "follow-cursor" };

/** Show a machine, and stop following the active one, which would soon replace it. */
export function showMachine(store: Store, path: string): void {
  if (store.state.follow === "active") store.set("follow", "nothing");
  store.set("machine", path);
}

/** Follow something, in other labs and after a reload, too. */
export function follow(store: Store, what: Followed): void {
  store.set("follow", what);
  for (const [each, name] of Object.entries(KEPT)) keepOn(name, each === what);
}

/** Follow what the user chose to follow; at first the run. */
export function followAsKept(store: Store): void {
  const kept = isOn(KEPT.cursor, false) ? "cursor" : isOn(KEPT.active, true) ? "active" : "nothing";
  store.set("follow", kept);
}

/** The switches in the heading of the graph. */
export function followSwitches(store: Store): HTMLButtonElement[] {
  const active = "Follow the run: show the machine of the innermost active state";
  const cursor = "Follow the cursor: show the machine in which it is";
  followAsKept(store);
  const switches = {
    active: iconButton("follow", active, "follow", () => flip("active")),
    cursor: iconButton("cursor", cursor, "follow-cursor", () => flip("cursor")),
  };
  const flip = (what: Followed) => flipFollow(store, what);
  store.watch(["follow"], () => {
    for (const [what, element] of Object.entries(switches))
      element.setAttribute("aria-pressed", String(store.state.follow === what));
  });
  store.watch(["settings"], () => setHidden(switches.active, store.state.settings.quiet));
  return Object.values(switches);
}

export function flipFollow(store: Store, what: Followed): void {
  follow(store, store.state.follow === what ? "nothing" : what);
}

/**
 * Follow the run while that is wanted: show the machine of the innermost active state when it has been the same for
 * a while, so that nothing swings where states change often; `reveal` brings the state into view, later still.
 * `choose` leaves those that may be shown.
 */
export function followRun(
  { store, closed }: Pick<Lab, "store" | "closed">,
  areSeen: (machines: readonly string[]) => boolean = (machines) =>
    isDrawnIn(machines.at(-1)!, store.state.machine, store.state.layouts),
  isBusy: () => boolean = () => false,
  reveal: () => void = () => {},
  draw: (machine: string) => void = (machine) => store.set("machine", machine),
  choose: (machines: string[]) => string[] = (machines) => machines,
): void {
  const isWanted = () => store.state.follow === "active" && store.state.settings.graph === "live";
  /** The innermost active state, and those in which it is. */
  const active = () => {
    const depth = (path: string) => path.split("/").length;
    const innermost = besideGraph(store.state).active.reduce((a, b) => (depth(b) > depth(a) ? b : a), "");
    return innermost ? statesOn(innermost, store.state.layouts) : [];
  };
  const machines = () => choose(active().map(parentOf));
  const show = () => {
    const shown = machines();
    if (!shown.length || areSeen(shown) || !isWanted()) return true;
    if (isBusy()) return false;
    draw(shown.at(-1)!);
    return true;
  };
  const look = () => {
    if (isWanted()) reveal();
    return true;
  };
  const shows = whenSteady(STEADY, closed, show);
  const looks = whenSteady(STEADY, closed, look);
  store.watch(["lit", "snapshot"], () => {
    shows(machines().join(" "));
    looks(active().join(" "));
  });
  let before = store.state.follow;
  store.watch(["follow"], () => {
    if (store.state.follow !== before && show()) look(); // the user has just asked for it
    before = store.state.follow;
  });
}

/** Follow the cursor while that is wanted: show its machine as soon as it is in the program. */
export function followCursor({ store }: Lab): Extension {
  let wanted = "";
  const show = () => {
    const { program, machine, layouts, settings } = store.state;
    if (settings.graph !== "live" || !program.machines.some(({ path }) => path === wanted)) return;
    if (!isDrawnIn(wanted, machine, layouts)) showMachine(store, wanted);
    wanted = "";
  };
  return ViewPlugin.define((view) => {
    const look = () => {
      if (store.state.follow !== "cursor") return;
      wanted = outlineOf(view.state).around(view.state.selection.main.head, "machine")?.path ?? "";
      show();
    };
    const watches = [store.watch(["follow"], look), store.watch(["program"], show)];
    return {
      update({ docChanged, selectionSet, transactions }: ViewUpdate) {
        if (!docChanged && !selectionSet) return;
        if (transactions.some((each) => each.annotation(Transaction.remote) || each.isUserEvent(DRAWN)))
          return;
        look();
      },
      destroy: () => watches.forEach((end) => end()),
    };
  });
}
