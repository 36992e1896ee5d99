/** Brackets in colours by their depth, those of Python included; each with the one that it belongs to. */

import { syntaxTree } from "@codemirror/language";
import { Decoration } from "@codemirror/view";
import type { SyntaxNode } from "@lezer/common";
import { visibleDecorations } from "./visible";

const COLOURS = 5;
const BRACKET = /^[()[\]{}]$/;

const byDepth = Array.from({ length: COLOURS }, (_, depth) =>
  Decoration.mark({ class: `lrp-bracket-${depth}` }),
);

export const rainbow = visibleDecorations((builder, state, from, to) => {
  let depth = -1; // of the innermost node with brackets around
  syntaxTree(state).iterate({
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
});

function isBracketed({ firstChild, lastChild }: SyntaxNode): boolean {
  return /^[([{]$/.test(firstChild?.name ?? "") || /^[)\]}]$/.test(lastChild?.name ?? "");
}
