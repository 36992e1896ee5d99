/**
 * The outline of the text when all of its brackets last matched. While one is open, the editor's tree lacks forms
 * that the text had and will have again: they keep their last places, which move with the text.
 */

import { syntaxTree } from "@codemirror/language";
import type { ChangeDesc, EditorState } from "@codemirror/state";
import { IterMode, type Tree } from "@lezer/common";
import { outlineOf } from "../language/lrp";
import { type Item, Outline } from "../language/outline";

export class WholeOutline {
  private last = new Outline([]);
  private since: ChangeDesc | null = null;

  /** The outline after a change of the text, or of its tree. */
  update(state: EditorState, changes: ChangeDesc | null): Outline {
    if (isWhole(syntaxTree(state))) {
      this.last = outlineOf(state);
      this.since = null;
      return this.last;
    }
    if (changes) this.since = this.since ? this.since.composeDesc(changes) : changes;
    const { since } = this;
    return since ? new Outline(this.last.items.map((item) => moved(item, since))) : this.last;
  }
}

function moved(item: Item, changes: ChangeDesc): Item {
  const [from, to] = [changes.mapPos(item.from, 1), changes.mapPos(item.to, -1)];
  const [nameFrom, nameTo] = [changes.mapPos(item.nameFrom, 1), changes.mapPos(item.nameTo, -1)];
  return { ...item, from, to: Math.max(from, to), nameFrom, nameTo: Math.max(nameFrom, nameTo) };
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
