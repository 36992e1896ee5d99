// @vitest-environment happy-dom
import { redo, undo } from "@codemirror/commands";
import { EditorState, Transaction } from "@codemirror/state";
import { EditorView } from "@codemirror/view";
import { beforeEach, describe, expect, it } from "vitest";
import { steps } from "../src/editor/steps";

let view: EditorView;

const text = () => view.state.sliceDoc();

function type(letters: string): void {
  for (const letter of letters) {
    const { head } = view.state.selection.main;
    const change = { changes: { from: head, insert: letter }, selection: { anchor: head + 1 } };
    view.dispatch({ ...change, userEvent: "input.type" });
  }
}

beforeEach(() => {
  view = new EditorView({ state: EditorState.create({ extensions: steps }) });
});

describe("a step of undo", () => {
  it("is what was typed in one go", () => {
    type("(machine m)");
    undo(view);
    expect(text()).toBe("");
  });

  it.each([
    ["from the cell", () => view.dispatch({ changes: { from: 1, to: 3 } })],
    ["from a menu", () => view.dispatch({ changes: { from: 1, to: 3 }, userEvent: "input.format" })],
  ])("is a change %s, however soon it comes", (_, change) => {
    type("abc");
    change();
    expect(text()).toBe("a");
    type("d");
    expect(text()).toBe("ad");
    undo(view);
    expect(text()).toBe("a");
    undo(view);
    expect(text()).toBe("abc");
    undo(view);
    expect(text()).toBe("");
    redo(view);
    expect(text()).toBe("abc");
  });

  it("is not what another view or the kernel has changed, nor does that divide what is typed", () => {
    type("ab");
    const remote = [Transaction.remote.of(true), Transaction.addToHistory.of(false)];
    view.dispatch({ changes: { from: 0, insert: "x" }, annotations: remote });
    type("c");
    expect(text()).toBe("xabc");
    undo(view);
    expect(text()).toBe("x");
  });
});
