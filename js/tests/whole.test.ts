import { ensureSyntaxTree } from "@codemirror/language";
import { EditorState } from "@codemirror/state";
import { expect, it } from "vitest";
import { WholeOutline } from "../src/editor/whole";
import { lrp } from "../src/language/lrp";

const PROGRAM = "(machine m (state a (running [x])) (state b) (on go a -> b))";

function parsed(state: EditorState): EditorState {
  ensureSyntaxTree(state, state.doc.length, 5000);
  return state.update({}).state; // which has the whole tree, however slow the machine is
}

function marked(old: string, text: string, path: string): string {
  const whole = new WholeOutline();
  let state = parsed(EditorState.create({ doc: PROGRAM, extensions: lrp() }));
  whole.update(state, null);
  const from = PROGRAM.indexOf(old);
  const { state: next, changes } = state.update({ changes: { from, to: from + old.length, insert: text } });
  state = parsed(next);
  const found = whole.update(state, changes).find("state", path);
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
