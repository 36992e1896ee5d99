/**
 * Which machine the graph shows: the one that the user has chosen, wherever they type; or, with *Follow the cursor*,
 * the one around the cursor.
 */

import { type Extension, Transaction } from "@codemirror/state";
import { ViewPlugin, type ViewUpdate } from "@codemirror/view";
import { DRAWN } from "../editor/pen";
import { outlineOf } from "../language/lrp";
import type { Lab, Store } from "../session/store";
import { iconButton } from "../ui/button";
import { isOn, keepOn } from "../ui/kept";
import { isDrawnIn } from "./inside";

const KEPT = "follow-cursor";

/** Show a machine, and stop following the active one, which would soon replace it. */
export function showMachine(store: Store, path: string): void {
  if (path === store.state.machine) return;
  if (store.state.follow === "active") store.set("follow", "nothing");
  store.set("machine", path);
}

/** The switch in the toolbar of the graph; its position is kept for other labs and after a reload. */
export function cursorSwitch(store: Store): HTMLButtonElement {
  const follows = () => store.state.follow === "cursor";
  const element = iconButton(
    "cursor",
    "Follow the cursor: show the machine in which it is",
    "follow-cursor",
    () => store.set("follow", follows() ? "nothing" : "cursor"),
  );
  if (isOn(KEPT, false)) store.set("follow", "cursor");
  store.watch(["follow"], () => {
    element.setAttribute("aria-pressed", String(follows()));
    if (follows() !== isOn(KEPT, false)) keepOn(KEPT, follows());
  });
  return element;
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
