// @vitest-environment happy-dom

import { history, undo } from "@codemirror/commands";
import { EditorState } from "@codemirror/state";
import { EditorView, runScopeHandlers } from "@codemirror/view";
import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { numberAt, scrubbing, stepped } from "../src/editor/scrub";
import { taps } from "../src/editor/tap";
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
    ["(on m.s for |2000 a -> b)", "2000"],
    ["(var side := [-1|])", "-1"],
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

describe("a tap on a number", () => {
  const finger = (type: string, clientX = 0) =>
    new PointerEvent(type, { clientX, pointerType: "touch", buttons: 1, bubbles: true });
  const ignore = (event: Event) => event.stopImmediatePropagation(); // it comes later in a browser
  beforeEach(() => document.addEventListener("selectionchange", ignore, true));
  afterEach(() => document.removeEventListener("selectionchange", ignore, true));
  const open = () => {
    const extensions = [history(), scrubbing({ store: new Store() } as unknown as Lab), taps()];
    const view = new EditorView({
      parent: document.body,
      state: EditorState.create({ doc: "[300 + n]", extensions }),
    });
    Object.assign(view, { posAtCoords: () => 2 });
    view.focus();
    view.contentDOM.dispatchEvent(finger("pointerdown"));
    view.contentDOM.dispatchEvent(finger("click"));
    const strip = document.querySelector<HTMLElement>(".lrp-scrub")!;
    Object.assign(strip, { setPointerCapture() {}, hasPointerCapture: () => false });
    strip.getBoundingClientRect = () => new DOMRect(0, 0, 240, 36);
    return { view, strip };
  };

  it("shows a strip that changes it by a drag, and step by step at its ends; each is undone as a whole", () => {
    const { view, strip } = open();
    const text = () => view.state.doc.toString();
    strip.dispatchEvent(finger("pointerdown", 100));
    window.dispatchEvent(finger("pointermove", 120));
    window.dispatchEvent(finger("pointermove", 140));
    window.dispatchEvent(finger("pointerup", 140));
    expect(text()).toBe("[400 + n]");
    strip.dispatchEvent(finger("pointerdown", 10));
    window.dispatchEvent(finger("pointerup", 10));
    expect(text()).toBe("[390 + n]");
    undo(view);
    undo(view);
    expect(text()).toBe("[300 + n]");
    view.destroy();
  });

  it("shows it until something is typed", () => {
    const { view } = open();
    view.dispatch({ changes: { from: 8, insert: "m" }, userEvent: "input.type" });
    expect(document.querySelector(".lrp-scrub")).toBeNull();
    view.destroy();
  });
});
