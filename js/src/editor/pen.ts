/**
 * What is drawn on the state graph becomes edits of the text: the kernel computes them for the text as it is
 * here, and they are one step of undo. A rename, and its undo, are sent as such: a state that
 * is renamed stays active.
 */

import { invertedEffects } from "@codemirror/commands";
import { type Extension, StateEffect, type Transaction } from "@codemirror/state";
import type { EditorView } from "@codemirror/view";
import type { SyntaxNode } from "@lezer/common";
import { outlineOf, treeOf } from "../language/lrp";
import { nameOf, parentOf } from "../language/paths";
import type { DrawRequest, ElementKind } from "../protocol";
import type { Lab } from "../session/store";
import { machineSpawned, visibleMachines } from "./context";
import { changesOf } from "./places";

/** One act on the graph, without what the message adds. */
export type Act = Omit<DrawRequest, "view" | "id" | "type" | "text">;

interface Rename {
  kind: ElementKind;
  path: string;
  name: string;
}

/**
 * A transition as it is written: what it waits for with its `for`, the delay of that, and the code of its effect, in
 * its brackets where that is more than a line.
 */
export interface WrittenTransition {
  keyword: string;
  trigger: string;
  hold: string;
  effect: string;
}

/** A machine that a state spawns: its variables with their initialisers, and the values that the state gives them. */
export interface WrittenSpawn {
  machine: string;
  variables: Map<string, string>;
  settings: Map<string, string>;
}

/** The user event of what is drawn: it is not typed, so the graph keeps showing the machine drawn on. */
export const DRAWN = "input.draw";

const renaming = StateEffect.define<Rename>();
const PLAIN = /^\[\s*[^[\s].*\]$/; // a block whose code reads the same without its brackets
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

  private form(kind: ElementKind, path: string): SyntaxNode | null {
    const { state } = this.view;
    const item = outlineOf(state).find(kind, path);
    return item ? treeOf(state).resolve(item.from, 1).parent : null;
  }

  transition(path: string): WrittenTransition | null {
    const form = this.form("transition", path);
    const keyword = form?.getChild("Keyword");
    if (!form || !keyword) return null;
    const read = (from: number, to: number) => this.view.state.sliceDoc(from, to);
    const text = (node: SyntaxNode | null | undefined) => (node ? read(node.from, node.to) : "");
    const word = text(keyword);
    const trigger = word === "eps" ? null : keyword.nextSibling;
    const held = form.getChildren("Keyword")[1];
    const hold = held?.nextSibling;
    const last = hold ?? trigger;
    const blocks = form.getChild("Action")?.getChildren("Block") ?? [];
    const effect = blocks.length ? read(blocks[0]!.from, blocks.at(-1)!.to) : "";
    return {
      keyword: word,
      trigger: trigger && last ? read(trigger.from, last.to) : "",
      hold: text(hold),
      effect: blocks.length === 1 && PLAIN.test(effect) ? effect.slice(1, -1).trim() : effect,
    };
  }

  spawns(path: string): WrittenSpawn[] {
    const spawns = this.form("state", path)
      ?.getChildren("Action")
      .flatMap((action) => action.getChildren("Spawn"));
    return (spawns ?? []).map((spawn) => {
      const machine = machineSpawned(spawn, this.view.state, parentOf(path));
      const form = machine ? this.form("machine", machine) : null;
      return { machine, variables: this.initialisers(form), settings: this.initialisers(spawn) };
    });
  }

  private initialisers(form: SyntaxNode | null): Map<string, string> {
    const text = (node: SyntaxNode | null) => (node ? this.view.state.sliceDoc(node.from, node.to) : "");
    return new Map(
      form
        ?.getChildren("Variable")
        .map((each) => [text(each.getChild("Definition")), text(each.getChild("Block")).slice(1, -1).trim()]),
    );
  }

  /** The names that a trigger in a machine can be; `sources`: of its states, those that it leaves, else all. */
  triggers(machine: string, sources?: readonly string[]): string[] {
    const { state } = this.view;
    const found = outlineOf(state);
    const isSeen = (user: string) => parentOf(user) !== machine || !sources || sources.includes(nameOf(user));
    const states = visibleMachines(state, machine)
      .filter((path) => isSeen(parentOf(path)))
      .flatMap((path) => found.statesOf(path));
    return [
      ...(["event", "variable"] as const).flatMap((kind) =>
        found.inScope(kind, machine).map(({ name }) => name),
      ),
      ...states.map(({ path, name }) => `${nameOf(parentOf(path))}.${name}`),
    ];
  }
}
