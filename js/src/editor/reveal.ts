/** Showing a place by scrolling the editor alone: CodeMirror's own way scrolls the notebook as well. */

import type { EditorView } from "@codemirror/view";

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
