/**
 * Which machine the graph shows: the one that the user has chosen, wherever they type; or, with *Follow the cursor*,
 * the one around the cursor.
 */

import { type Extension, Transaction } from "@codemirror/state";
import { ViewPlugin, type ViewUpdate } from "@codemirror/view";
import { DRAWN } from "../editor/pen";
import { outlineOf } from "../language/lrp";
import type { LabState } from "../session/state";
import type { Lab, Store } from "../session/store";
import { iconButton } from "../ui/button";
import { setHidden } from "../ui/dom";
import { isOn, keepOn } from "../ui/kept";
import { isDrawnIn } from "./inside";

type Followed = LabState["follow"];

/** The names under which the browser keeps the switches. */
const KEPT = { active: "follow-active", cursor: "follow-cursor" };

/** Show a machine, and stop following the active one, which would soon replace it. */
export function showMachine(store: Store, path: string): void {
  if (path === store.state.machine) return;
  if (store.state.follow === "active") store.set("follow", "nothing");
  store.set("machine", path);
}

/** Follow something, in other labs and after a reload, too. */
export function follow(store: Store, what: Followed): void {
  store.set("follow", what);
  for (const [each, name] of Object.entries(KEPT)) keepOn(name, each === what);
}

/** The switches in the heading of the graph. */
export function followSwitches(store: Store): HTMLButtonElement[] {
  const active = "Follow the run: show the machine of the innermost active state";
  const cursor = "Follow the cursor: show the machine in which it is";
  if (isOn(KEPT.cursor, false)) store.set("follow", "cursor");
  else if (isOn(KEPT.active, false)) store.set("follow", "active");
  const switches = {
    active: iconButton("follow", active, "follow", () => flip("active")),
    cursor: iconButton("cursor", cursor, "follow-cursor", () => flip("cursor")),
  };
  const flip = (what: Followed) => follow(store, store.state.follow === what ? "nothing" : what);
  store.watch(["follow"], () => {
    for (const [what, element] of Object.entries(switches))
      element.setAttribute("aria-pressed", String(store.state.follow === what));
  });
  store.watch(["settings"], () => setHidden(switches.active, store.state.settings.quiet));
  return Object.values(switches);
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
