/** Several cursors: the browser draws the main selection, layers beside the text the others. */

import { EditorState, type Extension } from "@codemirror/state";
import { layer, RectangleMarker } from "@codemirror/view";

const others = (above: boolean, kind: string): Extension =>
  layer({
    above,
    class: "lrp-cursors",
    update: ({ docChanged, selectionSet }) => docChanged || selectionSet,
    markers: (view) => {
      const { main, ranges } = view.state.selection;
      return ranges
        .filter((range) => range !== main && range.empty === above)
        .flatMap((range) => RectangleMarker.forRange(view, kind, range));
    },
  });

export const severalCursors: Extension = [
  EditorState.allowMultipleSelections.of(true),
  others(false, "lrp-selection"),
  others(true, "lrp-cursor"),
];
