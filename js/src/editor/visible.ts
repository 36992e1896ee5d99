/** Decorations that are made again whenever what they show changes. */

import { syntaxTree } from "@codemirror/language";
import { type EditorState, type Extension, RangeSetBuilder } from "@codemirror/state";
import {
  type Decoration,
  type DecorationSet,
  type EditorView,
  ViewPlugin,
  type ViewUpdate,
} from "@codemirror/view";

/** Decorations that `make` makes at first, when the text or its tree changes, and when another update `concerns` them. */
export function decorating(
  make: (view: EditorView) => DecorationSet,
  concerns: (update: ViewUpdate) => boolean,
): Extension {
  return ViewPlugin.fromClass(
    class {
      decorations: DecorationSet;

      constructor(view: EditorView) {
        this.decorations = make(view);
      }

      update(update: ViewUpdate): void {
        const { docChanged, startState, state, view } = update;
        if (docChanged || syntaxTree(startState) !== syntaxTree(state) || concerns(update))
          this.decorations = make(view);
      }
    },
    { decorations: (plugin) => plugin.decorations },
  );
}

/** Decorations of the text that is seen; `add` adds those between two offsets, in their order. */
export function visibleDecorations(
  add: (builder: RangeSetBuilder<Decoration>, state: EditorState, from: number, to: number) => void,
): Extension {
  return decorating(
    ({ state, visibleRanges }) => {
      const builder = new RangeSetBuilder<Decoration>();
      for (const { from, to } of visibleRanges) add(builder, state, from, to);
      return builder.finish();
    },
    ({ viewportChanged }) => viewportChanged,
  );
}
