import { ChangeSet, Text } from "@codemirror/state";
import { describe, expect, it } from "vitest";
import { difference, Tracked } from "../src/editor/texts";

const text = (value: string) => Text.of(value.split("\n"));
const at = (line: number, column: number, end: number) => ({ line, column, end_line: line, end_column: end });

function patched(old: string, next: string): string {
  const changes = difference(text(old), text(next));
  return changes ? ChangeSet.of(changes, old.length).apply(text(old)).toString() : old;
}

describe("applying a text from elsewhere", () => {
  it.each([
    ["abc", "abc"],
    ["abc", "axc"],
    ["", "new"],
    ["old", ""],
    ["aaa", "aa"],
    ["a\nb\nc", "a\nc"],
    ["abab", "ababab"],
    ["𝄞", "𝄟"],
  ])("makes %j into %j", (old, next) => {
    expect(patched(old, next)).toBe(next);
  });

  it("touches only what differs", () => {
    expect(difference(text("(state a) (state b)"), text("(state a) (state c)"))).toMatchObject({
      from: 17,
      to: 18,
    });
    expect(difference(text("same"), text("same"))).toBeNull();
  });

  it("never splits a character", () => {
    expect(difference(text("a𝄞b"), text("a𝄟b"))).toMatchObject({ from: 1, to: 3 });
    expect(difference(text("a𝄞b"), text("a𝔞b"))).toMatchObject({ from: 1, to: 3 });
  });
});

describe("a place in a text of the past", () => {
  it("moves with what was typed before it", () => {
    const tracked = new Tracked();
    tracked.begin(text("one two"));
    tracked.add(ChangeSet.of({ from: 0, insert: "zero " }, 7));
    expect(tracked.span(at(1, 5, 8))).toEqual({ from: 9, to: 12 });
  });

  it("is gone when what it covered was deleted", () => {
    const tracked = new Tracked();
    tracked.begin(text("one two"));
    tracked.add(ChangeSet.of({ from: 3, to: 7 }, 7));
    expect(tracked.span(at(1, 5, 8))).toBeNull();
  });

  it("does not grow when something is typed at its end", () => {
    const tracked = new Tracked();
    tracked.begin(text("one"));
    tracked.add(ChangeSet.of({ from: 3, insert: "!" }, 3));
    expect(tracked.span(at(1, 1, 4))).toEqual({ from: 0, to: 3 });
  });

  it("counts a character outside the basic plane as one column", () => {
    const tracked = new Tracked();
    tracked.begin(text("𝄞𝄞 x"));
    expect(tracked.span(at(1, 4, 5))).toEqual({ from: 5, to: 6 });
  });

  it("is found in a text that differs from the one that it refers to", () => {
    const tracked = new Tracked();
    tracked.differs(text("one three"), text("one big three"));
    expect(tracked.span(at(1, 5, 10))).toEqual({ from: 8, to: 13 });
  });
});
