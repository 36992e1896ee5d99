/** Brackets in colours by their depth, those of Python included; each with the one that it belongs to. */

import { syntaxTree } from "@codemirror/language";
import { RangeSetBuilder } from "@codemirror/state";
import {
  Decoration,
  type DecorationSet,
  type EditorView,
  ViewPlugin,
  type ViewUpdate,
} from "@codemirror/view";
import type { SyntaxNode } from "@lezer/common";

const COLOURS = 5;
const BRACKET = /^[()[\]{}]$/;

const byDepth = Array.from({ length: COLOURS }, (_, depth) =>
  Decoration.mark({ class: `lrp-bracket-${depth}` }),
);

export const rainbow = ViewPlugin.fromClass(
  class {
    decorations: DecorationSet;

    constructor(view: EditorView) {
      this.decorations = coloured(view);
    }

    update(update: ViewUpdate): void {
      const parsed = syntaxTree(update.startState) !== syntaxTree(update.state);
      if (update.docChanged || update.viewportChanged || parsed) this.decorations = coloured(update.view);
    }
  },
  { decorations: (plugin) => plugin.decorations },
);

function coloured(view: EditorView): DecorationSet {
  const builder = new RangeSetBuilder<Decoration>();
  for (const { from, to } of view.visibleRanges) {
    let depth = -1; // of the innermost node with brackets around
    syntaxTree(view.state).iterate({
      from,
      to,
      enter: (node) => {
        if (BRACKET.test(node.name)) builder.add(node.from, node.to, byDepth[Math.max(depth, 0) % COLOURS]!);
        else if (isBracketed(node.node)) depth++;
      },
      leave: (node) => {
        if (!BRACKET.test(node.name) && isBracketed(node.node)) depth--;
      },
    });
  }
  return builder.finish();
}

function isBracketed({ firstChild, lastChild }: SyntaxNode): boolean {
  return /^[([{]$/.test(firstChild?.name ?? "") || /^[)\]}]$/.test(lastChild?.name ?? "");
}
