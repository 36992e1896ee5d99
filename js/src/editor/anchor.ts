/** What one reads stays where it is in the window, while the editor gets another place or size. */

import type { EditorView } from "@codemirror/view";

const LINE = 20; // px of a line that stays in sight

/** Make a change around the editor, and scroll so that the cursor, or else the first line in sight, does not move. */
export function keepInPlace(view: EditorView, change: () => void): void {
  const { scrollDOM, contentDOM, state } = view;
  const sight = scrollDOM.getBoundingClientRect();
  const heightOf = (offset: number) => view.coordsAtPos(offset)?.top;
  const cursor = heightOf(state.selection.main.head);
  const isInSight = cursor !== undefined && cursor >= sight.top && cursor + LINE <= sight.bottom;
  const { left } = contentDOM.getBoundingClientRect();
  const anchor = isInSight
    ? state.selection.main.head
    : view.posAtCoords({ x: left + 1, y: sight.top + 1 }, false);
  const before = heightOf(anchor);
  change();
  if (before === undefined) return;
  view.requestMeasure({
    read() {
      const { top, bottom } = scrollDOM.getBoundingClientRect();
      const after = heightOf(anchor);
      const wanted = Math.max(top, Math.min(bottom - LINE, before));
      return after === undefined ? 0 : after - wanted;
    },
    write(moved) {
      scrollDOM.scrollTop += moved;
    },
  });
}
