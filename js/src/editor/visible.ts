/** Decorations of the text that is seen, made again whenever that, or its tree, changes. */

import { syntaxTree } from "@codemirror/language";
import { type EditorState, RangeSetBuilder } from "@codemirror/state";
import {
  type Decoration,
  type DecorationSet,
  type EditorView,
  ViewPlugin,
  type ViewUpdate,
} from "@codemirror/view";

/** `add` adds the decorations between two offsets, in their order. */
export function visibleDecorations(
  add: (builder: RangeSetBuilder<Decoration>, state: EditorState, from: number, to: number) => void,
) {
  const make = ({ state, visibleRanges }: EditorView): DecorationSet => {
    const builder = new RangeSetBuilder<Decoration>();
    for (const { from, to } of visibleRanges) add(builder, state, from, to);
    return builder.finish();
  };
  return ViewPlugin.fromClass(
    class {
      decorations: DecorationSet;

      constructor(view: EditorView) {
        this.decorations = make(view);
      }

      update({ docChanged, viewportChanged, startState, state, view }: ViewUpdate): void {
        if (docChanged || viewportChanged || syntaxTree(startState) !== syntaxTree(state))
          this.decorations = make(view);
      }
    },
    { decorations: (plugin) => plugin.decorations },
  );
}
