/**
 * A tap shows the cards that a pointer shows where it rests; they stay until the cursor leaves the line, or
 * something is typed.
 */

import type { Extension, Transaction } from "@codemirror/state";
import { activateHover, closeHoverTooltips, EditorView } from "@codemirror/view";
import { isTouch, pointOf } from "../ui/point";
import { scrubbed } from "./scrub";

export function taps(): Extension {
  let isTapped = false;
  return EditorView.domEventHandlers({
    pointerdown(event) {
      isTapped = isTouch(event);
    },
    click(event, view) {
      const offset = isTapped && event.detail < 2 ? view.posAtCoords(pointOf(event)) : null;
      if (offset === null) return;
      const line = view.state.doc.lineAt(offset).number;
      // the browser puts the cursor there later, or, at the first tap, not at all
      view.dispatch({ selection: { anchor: offset }, effects: closeHoverTooltips });
      const isElsewhere = ({ newDoc, newSelection }: Transaction) =>
        newDoc.lineAt(newSelection.main.head).number !== line;
      activateHover(view, offset, 1, {
        until: (transaction) =>
          !view.hasFocus ||
          (!transaction.annotation(scrubbed) && (transaction.docChanged || isElsewhere(transaction))),
      });
    },
  });
}
