/**
 * The outline of the text when all of its brackets last matched. While one is open, the editor's tree lacks forms
 * that the text had and will have again: they keep their last places, which move with the text.
 */

import { syntaxTree } from "@codemirror/language";
import { type ChangeDesc, type EditorState, StateField } from "@codemirror/state";
import { IterMode, type Tree } from "@lezer/common";
import { outlineOf, treeOf } from "../language/lrp";
import { type Item, Outline } from "../language/outline";
import { movedSpan } from "./texts";

interface Whole {
  /** Of the text in which all brackets last matched, and what has changed since. */
  last: Outline;
  since: ChangeDesc | null;
  now: Outline;
}

/** Every editor has it, so that all that is drawn beside or into the text keeps the same places. */
export const wholeOutline = StateField.define<Whole>({
  create: (state) => next({ last: new Outline([]), since: null }, state),
  update(value, { state, startState, docChanged, changes }) {
    if (!docChanged && syntaxTree(state) === syntaxTree(startState)) return value;
    const { last, since } = value;
    if (!docChanged) return next({ last, since }, state);
    return next({ last, since: since ? since.composeDesc(changes) : changes.desc }, state);
  },
});

export function wholeOutlineOf(state: EditorState): Outline {
  return state.field(wholeOutline).now;
}

function next({ last, since }: Pick<Whole, "last" | "since">, state: EditorState): Whole {
  if (isWhole(treeOf(state))) {
    const now = outlineOf(state);
    return { last: now, since: null, now };
  }
  if (!last.items.length) return { last, since, now: outlineOf(state) }; // it was opened like this
  return { last, since, now: since ? new Outline(last.items.flatMap((item) => moved(item, since))) : last };
}

/** An item at its place after changes; none if its text was deleted. */
function moved(item: Item, changes: ChangeDesc): Item[] {
  const span = movedSpan(item, changes);
  if (!span) return [];
  const [nameFrom, nameTo] = [changes.mapPos(item.nameFrom, 1), changes.mapPos(item.nameTo, -1)];
  return [{ ...item, ...span, nameFrom, nameTo: Math.max(nameFrom, nameTo) }];
}

const checked = new WeakMap<Tree, boolean>();

/** Whether all brackets of the forms match; what is inside blocks does not count. */
function isWhole(tree: Tree): boolean {
  let found = checked.get(tree);
  if (found === undefined) {
    found = true;
    tree.iterate({
      mode: IterMode.IgnoreMounts,
      enter: ({ type }) => {
        if (type.isError) found = false;
        return found;
      },
    });
    checked.set(tree, found);
  }
  return found;
}
