import { Text } from "@codemirror/state";
import { expect, it } from "vitest";
import { offsetAt, placeOf, spanOf } from "../src/editor/places";

const doc = Text.of(["a𝄞b", "", "𝄞𝄞"]);

it("counts a character outside the basic plane as one column and two offsets", () => {
  expect(offsetAt(doc, 1, 3)).toBe(3);
  expect(placeOf(doc, 3)).toEqual({ line: 1, column: 3 });
  expect(spanOf(doc, { line: 3, column: 2, end_line: 3, end_column: 3 })).toEqual({ from: 8, to: 10 });
});

it("clamps places outside the text to its ends", () => {
  expect(offsetAt(doc, 0, 1)).toBe(0);
  expect(offsetAt(doc, 2, 9)).toBe(5);
  expect(offsetAt(doc, 9, 1)).toBe(doc.length);
});

it("converts there and back at every character", () => {
  for (const [line, columns] of [
    [1, 4],
    [2, 1],
    [3, 3],
  ] as const) {
    for (let column = 1; column <= columns; column++) {
      expect(placeOf(doc, offsetAt(doc, line, column))).toEqual({ line, column });
    }
  }
});
