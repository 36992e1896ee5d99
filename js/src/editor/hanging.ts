/** Hanging indent: the rest of a wrapped line is indented like the beginning of its text. */

import { RangeSetBuilder } from "@codemirror/state";
import {
  Decoration,
  type DecorationSet,
  type EditorView,
  ViewPlugin,
  type ViewUpdate,
} from "@codemirror/view";

const MORE = 2; // columns by which the rest of a line is indented further
const DEEPEST = 40;

const byIndent = Array.from({ length: DEEPEST + 1 }, (_, indent) =>
  Decoration.line({
    attributes: { style: `padding-left: calc(6px + ${indent}ch); text-indent: -${indent}ch` },
  }),
);

export const hangingIndent = ViewPlugin.fromClass(
  class {
    decorations: DecorationSet;

    constructor(view: EditorView) {
      this.decorations = hang(view);
    }

    update(update: ViewUpdate): void {
      if (update.docChanged || update.viewportChanged) this.decorations = hang(update.view);
    }
  },
  { decorations: (plugin) => plugin.decorations },
);

function hang(view: EditorView): DecorationSet {
  const builder = new RangeSetBuilder<Decoration>();
  for (const { from, to } of view.visibleRanges) {
    for (let at = from; at <= to; ) {
      const line = view.state.doc.lineAt(at);
      const indent = line.text.search(/\S|$/) + MORE;
      builder.add(line.from, line.from, byIndent[Math.min(indent, DEEPEST)]!);
      at = line.to + 1;
    }
  }
  return builder.finish();
}
