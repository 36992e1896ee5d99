// @vitest-environment happy-dom

import { history, undo } from "@codemirror/commands";
import { EditorState } from "@codemirror/state";
import { EditorView, runScopeHandlers } from "@codemirror/view";
import { describe, expect, it } from "vitest";
import { numberAt, scrubbing, stepped } from "../src/editor/scrub";
import { type Lab, Store } from "../src/session/store";

describe("the number that the cursor touches", () => {
  const at = (marked: string): string | undefined => {
    const doc = marked.replace("|", "");
    return numberAt(EditorState.create({ doc }), marked.indexOf("|"))?.text;
  };

  it.each([
    ["[0.|25]", "0.25"],
    ["[|-0.2]", "-0.2"],
    ["(ontime 500| a -> b)", "500"],
    ["[n -1|]", "1"],
    ["[f(n)-1|]", "1"],
    ["[x = -1|]", "-1"],
    ["[.5|]", ".5"],
  ])("in %s is %s", (marked, text) => expect(at(marked)).toBe(text));

  it.each(["state2| a", "[0.25] |", "[1e5|]", "(state a| 5)", "[0x10|]"])("in %s is none", (marked) =>
    expect(at(marked)).toBeUndefined(),
  );
});

describe("a step", () => {
  it.each([
    ["0.2", 1, "0.21"],
    ["0.25", -1, "0.24"],
    ["1.5", 1, "1.6"],
    ["-0.2", 25, "0.05"],
    ["0.05", 1, "0.051"],
    ["0.0", 1, "0.1"],
    ["0.1", -10, "0.00"],
    ["500", 1, "510"],
    ["500", -60, "-100"],
    ["8", 1, "9"],
    ["0", -1, "-1"],
    ["12.5", 1, "12.6"],
  ])("from %s by %i leads to %s", (text, steps, next) => expect(stepped(text, steps)).toBe(next));
});

describe("the keys", () => {
  const lab = { store: new Store() } as unknown as Lab;
  const press = (view: EditorView, key: string, shiftKey = false) =>
    runScopeHandlers(view, new KeyboardEvent("keydown", { key, altKey: true, shiftKey }), "editor");
  const open = (doc: string, anchor: number) =>
    new EditorView({
      state: EditorState.create({ doc, selection: { anchor }, extensions: [history(), scrubbing(lab)] }),
    });

  it("step the number at the cursor, and are undone together", () => {
    const view = open("[0.20 + 1]", 3);
    press(view, "ArrowUp");
    press(view, "ArrowUp");
    press(view, "ArrowDown", true);
    expect(view.state.doc.toString()).toBe("[0.12 + 1]");
    undo(view);
    expect(view.state.doc.toString()).toBe("[0.20 + 1]");
    expect(press(view, "ArrowUp")).toBe(true);
    view.destroy();
  });

  it("tell the lab the values and the programs of the gesture, until something else is done", async () => {
    const view = open("[2 + 7]", 2);
    press(view, "ArrowUp");
    press(view, "ArrowUp");
    expect(lab.store.state.stepped).toEqual({
      values: ["2", "4", "5"],
      programs: ["[2 + 7]", "[4 + 7]", "[5 + 7]"],
    });
    press(view, "ArrowDown");
    expect(lab.store.state.stepped?.values).toEqual(["2", "3", "2"]);
    view.dispatch({ selection: { anchor: 6 } });
    expect(lab.store.state.stepped).toBeNull();
    view.destroy();
  });

  it("begin another step of undo at another number", () => {
    const view = open("[2 + 7]", 2);
    press(view, "ArrowUp");
    view.dispatch({ selection: { anchor: 6 } });
    press(view, "ArrowUp");
    expect(view.state.doc.toString()).toBe("[3 + 8]");
    undo(view);
    expect(view.state.doc.toString()).toBe("[3 + 7]");
    view.destroy();
  });

  it("begin a step of undo of their own at a number that was selected, after what was typed", () => {
    const view = open("[2 + ]", 5);
    view.dispatch({ ...view.state.replaceSelection("7"), userEvent: "input.type" });
    view.dispatch({ selection: { anchor: 5, head: 6 } });
    press(view, "ArrowUp");
    expect(view.state.doc.toString()).toBe("[2 + 8]");
    undo(view);
    expect(view.state.doc.toString()).toBe("[2 + 7]");
    view.destroy();
  });

  it("are left to others where there is no number", () => {
    const view = open("(state a)", 8);
    expect(press(view, "ArrowUp")).toBe(false);
    view.destroy();
  });
});
