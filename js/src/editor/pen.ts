/**
 * What is drawn on the state graph becomes edits of the text: the kernel computes them for the text as it is
 * here, and they are one step of undo. A rename, and its undo, are sent as such: a state that
 * is renamed stays active.
 */

import { invertedEffects } from "@codemirror/commands";
import { type Extension, StateEffect, type Transaction } from "@codemirror/state";
import type { EditorView } from "@codemirror/view";
import { outlineOf } from "../language/lrp";
import { nameOf, parentOf } from "../language/paths";
import type { DrawRequest, ElementKind } from "../protocol";
import type { Lab } from "../session/store";
import { visibleMachines } from "./context";
import { changesOf } from "./places";

/** One act on the graph, without what the message adds. */
export type Act = Omit<DrawRequest, "view" | "id" | "type" | "text">;

interface Rename {
  kind: ElementKind;
  path: string;
  name: string;
}

/** The user event of what is drawn: it is not typed, so the graph keeps showing the machine drawn on. */
export const DRAWN = "input.draw";

const renaming = StateEffect.define<Rename>();
const MOST_TRIES = 3; // the text changed meanwhile

/** Where a path's last name begins: after a slash or, of a transition, after a colon. */
function cut(path: string): number {
  return Math.max(path.lastIndexOf("/"), path.lastIndexOf(":")) + 1;
}

const inverse = ({ kind, path, name }: Rename): Rename => ({
  kind,
  path: path.slice(0, cut(path)) + name,
  name: path.slice(cut(path)),
});

/** Undo of a rename is the opposite rename. */
export const renames: Extension = invertedEffects.of(({ effects }) =>
  effects.filter((effect) => effect.is(renaming)).map((effect) => renaming.of(inverse(effect.value))),
);

/** What is sent along with changes: that they are a rename, by drawing, undo or redo. */
export const sharedEffects = ({ effects }: Transaction): StateEffect<Rename>[] =>
  effects.filter((effect) => effect.is(renaming));

/** The rename that changes with these effects are; else null. */
export function renameOf(effects: readonly StateEffect<unknown>[] | undefined): Rename | null {
  const found = effects?.find((effect) => effect.is(renaming));
  return found?.is(renaming) ? found.value : null;
}

export class Pen {
  constructor(
    private readonly view: EditorView,
    private readonly lab: Lab,
  ) {}

  /** Apply an act to the text, after `first`; resolves to the sentence that refuses it, or null. */
  async draw(act: Act, first = () => {}): Promise<string | null> {
    const { view } = this;
    for (let tries = 0; tries < MOST_TRIES; tries++) {
      const { doc } = view.state;
      const reply = await this.lab.ask({ type: "draw", text: view.state.sliceDoc(), ...act });
      if (reply.error) return reply.error;
      if (view.state.doc !== doc) continue;
      const changes = changesOf(doc, reply.edits);
      if (!changes.length) return null;
      const { kind, path } = act;
      first();
      view.dispatch({
        changes,
        userEvent: DRAWN,
        effects: act.act === "rename" ? renaming.of({ kind, path, name: act.to ?? "" }) : [],
      });
      return null;
    }
    return "The text changed while this was drawn. Try again.";
  }

  /** The text of an element's form, without its brackets. */
  source(kind: ElementKind, path: string): string {
    const item = outlineOf(this.view.state).find(kind, path);
    return item ? this.view.state.sliceDoc(item.from + 1, item.to - 1).trim() : "";
  }

  /** The names that a trigger in a machine can be. */
  triggers(machine: string): string[] {
    const { state } = this.view;
    const found = outlineOf(state);
    const states = visibleMachines(state, machine).flatMap((path) => found.statesOf(path));
    return [
      ...(["event", "variable"] as const).flatMap((kind) =>
        found.inScope(kind, machine).map(({ name }) => name),
      ),
      ...states.map(({ path, name }) => `${nameOf(parentOf(path))}.${name}`),
    ];
  }
}
