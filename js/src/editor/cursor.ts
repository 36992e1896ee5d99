/** The cursor: kept over a reload of the page, per lab, in this tab; and moved to a place by scrolling the editor alone. */

import type { Command, EditorView } from "@codemirror/view";
import type { Lab } from "../session/store";
import { Kept } from "../ui/kept";

const cursors = new Kept(() => sessionStorage, "lrp-cursor-");

export function rememberCursor(name: string, offset: number): void {
  if (name) cursors.set(name, String(offset));
}

export function rememberedCursor(name: string): number {
  return Number(cursors.get(name)) || 0;
}

export function reveal(view: EditorView, offset: number): void {
  const scroller = view.scrollDOM;
  const { top, bottom } = view.lineBlockAt(offset);
  const height = scroller.clientHeight;
  if (top >= scroller.scrollTop && bottom <= scroller.scrollTop + height) return;
  scroller.scrollTop = Math.max(0, (top + bottom - height) / 2);
}

export function select(view: EditorView, from: number, to: number): void {
  view.dispatch({ selection: { anchor: from, head: to }, userEvent: "select" });
  reveal(view, from);
}

/** A key that acts at the cursor. */
export function atCursor(lab: Lab, act: (view: EditorView, lab: Lab, offset: number) => unknown): Command {
  return (view) => {
    void act(view, lab, view.state.selection.main.head);
    return true;
  };
}
