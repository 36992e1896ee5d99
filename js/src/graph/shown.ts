/** Which machine the graph shows: one that is chosen, or the one in which the user types. */

import { type Extension, Transaction } from "@codemirror/state";
import { ViewPlugin, type ViewUpdate } from "@codemirror/view";
import { DRAWN } from "../editor/pen";
import { outlineOf } from "../language/lrp";
import type { Lab, Store } from "../session/store";
import { isDrawnIn } from "./inside";

/** Show a machine. One that is not the active one would not be shown for long while the graph follows. */
export function showMachine(store: Store, path: string): void {
  if (path === store.state.machine) return;
  store.set("follow", false);
  store.set("machine", path);
}

/** Show the machine in which the user types, as soon as it is in the program. */
export function showTyped({ store }: Lab): Extension {
  let typed = "";
  const show = () => {
    const { program, machine, layouts, settings } = store.state;
    if (settings.graph !== "live" || !program.machines.some(({ path }) => path === typed)) return;
    if (!isDrawnIn(typed, machine, layouts)) showMachine(store, typed);
    typed = "";
  };
  return ViewPlugin.define(() => ({
    update({ docChanged, transactions, state }: ViewUpdate) {
      if (!docChanged) return;
      if (transactions.some((each) => each.annotation(Transaction.remote) || each.isUserEvent(DRAWN))) return;
      typed = outlineOf(state).around(state.selection.main.head, "machine")?.path ?? "";
      show();
    },
    destroy: store.watch(["program"], show),
  }));
}
