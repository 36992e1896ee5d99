/** Hanging indent: the rest of a wrapped line is indented like the beginning of its text. */

import { Decoration } from "@codemirror/view";
import { visibleDecorations } from "./visible";

const MORE = 2; // columns by which the rest of a line is indented further
const DEEPEST = 40;

const byIndent = Array.from({ length: DEEPEST + 1 }, (_, indent) =>
  Decoration.line({
    attributes: { style: `padding-left: calc(6px + ${indent}ch); text-indent: -${indent}ch` },
  }),
);

export const hangingIndent = visibleDecorations((builder, { doc }, from, to) => {
  for (let at = from; at <= to; ) {
    const line = doc.lineAt(at);
    const indent = line.text.search(/\S|$/) + MORE;
    builder.add(line.from, line.from, byIndent[Math.min(indent, DEEPEST)]!);
    at = line.to + 1;
  }
});
