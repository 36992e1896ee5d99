import { EditorState } from "@codemirror/state";
import { expect, it } from "vitest";
import { wholeOutline, wholeOutlineOf } from "../src/editor/whole";
import { lrp } from "../src/language/lrp";

const PROGRAM = "(machine m (state a (running [x])) (state b) (on go a -> b))";

function open(doc: string): EditorState {
  return EditorState.create({ doc, extensions: [lrp(), wholeOutline] });
}

function marked(old: string, text: string, path: string): string {
  const from = PROGRAM.indexOf(old);
  const changes = { from, to: from + old.length, insert: text };
  const state = open(PROGRAM).update({ changes }).state;
  const found = wholeOutlineOf(state).find("state", path);
  return found ? state.sliceDoc(found.from, found.to) : "";
}

it("is that of the text while its brackets match", () => {
  expect(marked("(running [x])", "(running [x]) (onexit [y])", "m/a")).toBe(
    "(state a (running [x]) (onexit [y]))",
  );
  expect(marked("state b", "state c", "m/b")).toBe("");
});

it.each([
  ["a bracket is open before a state", "(machine m", "(machine m (event", "(state a (running [x]))"],
  ["a bracket is open in it", "[x])", "[x]", "(state a (running [x])"],
  ["a bracket too many is in it", "[x])", "[x]))", "(state a (running [x])))"],
])("keeps the place of a state while %s", (_, old, text, expected) => {
  expect(marked(old, text, "m/a")).toBe(expected);
});

it("keeps the place of what comes after an open bracket", () => {
  expect(marked("(running [x])", "(running [x]", "m/b")).toBe("(state b)");
});

it("is what is there of a text that was opened with an open bracket", () => {
  expect(wholeOutlineOf(open(PROGRAM.slice(0, -1))).find("state", "m/b")?.name).toBe("b");
});
