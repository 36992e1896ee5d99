/**
 * Between the wire's places (lines and columns in characters) and the editor's (UTF-16 offsets). A
 * character outside the basic plane is one column and two offsets. Nothing else in the page converts.
 */

import type { Text } from "@codemirror/state";
import type { TextEdit, TextRange } from "../protocol";

export interface Span {
  from: number;
  to: number;
}

/** The offset of a line and column; what lies outside the text becomes its nearest end. */
export function offsetAt(doc: Text, line: number, column: number): number {
  if (line < 1) return 0;
  if (line > doc.lines) return doc.length;
  const { from, text } = doc.line(line);
  let offset = 0;
  for (let left = column - 1; left > 0 && offset < text.length; left--) {
    offset += text.codePointAt(offset)! > 0xffff ? 2 : 1;
  }
  return from + offset;
}

/** The offsets of a range, never backwards. */
export function spanOf(doc: Text, range: TextRange): Span {
  const from = offsetAt(doc, range.line, range.column);
  return { from, to: Math.max(from, offsetAt(doc, range.end_line, range.end_column)) };
}

export function changesOf(doc: Text, edits: readonly TextEdit[] = []): (Span & { insert: string })[] {
  return edits.map(({ range, text }) => ({ ...spanOf(doc, range), insert: text }));
}

export function placeOf(doc: Text, offset: number): { line: number; column: number } {
  const line = doc.lineAt(offset);
  return { line: line.number, column: [...line.text.slice(0, offset - line.from)].length + 1 };
}
