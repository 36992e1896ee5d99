// @vitest-environment happy-dom

import { EditorState } from "@codemirror/state";
import { EditorView, type ViewUpdate } from "@codemirror/view";
import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { NUMBER_AFTER, Typing, WORD_AFTER } from "../src/editor/typing";

let view: EditorView;
let typing: Typing;
let sent: [number | null, boolean][];

beforeEach(() => {
  vi.useFakeTimers();
  sent = [];
  typing = new Typing((hasCursor, meant) =>
    sent.push([hasCursor ? view.state.selection.main.head : null, meant]),
  );
  const listener = EditorView.updateListener.of((update: ViewUpdate) => {
    if (update.docChanged) typing.changed(update);
    else if (update.selectionSet) typing.moved(update);
  });
  const doc = "(on dark left -> right) [robot.light.data] [0.2]";
  view = new EditorView({ state: EditorState.create({ doc, extensions: listener }) });
});
afterEach(() => {
  typing.stop();
  view.destroy();
  vi.useRealTimers();
});

function insert(after: string, text: string, userEvent = "input.type"): number {
  const at = view.state.doc.toString().indexOf(after) + after.length;
  view.dispatch({ changes: { from: at, insert: text }, selection: { anchor: at + text.length }, userEvent });
  return at + text.length;
}

const move = (anchor: number): void => view.dispatch({ selection: { anchor } });

it("a word is meant when nothing was typed for a while, if anything waits for it", () => {
  const end = insert("righ", "x");
  vi.advanceTimersByTime(WORD_AFTER - 1);
  expect(sent).toEqual([[end, false]]);
  vi.advanceTimersByTime(1);
  expect(sent).toEqual([
    [end, false],
    [end, true],
  ]);
});

it("a word for which nothing waits is not sent again", () => {
  insert("righ", "x");
  typing.answered(false);
  vi.advanceTimersByTime(WORD_AFTER);
  move(0);
  expect(sent).toHaveLength(1);
});

it("a number is meant sooner than a word", () => {
  insert("0.2", "5");
  vi.advanceTimersByTime(NUMBER_AFTER);
  expect(sent.map(([, meant]) => meant)).toEqual([false, true]);
});

it("each letter begins the wait again", () => {
  insert("righ", "x");
  vi.advanceTimersByTime(WORD_AFTER - 100);
  insert("righx", "y");
  vi.advanceTimersByTime(WORD_AFTER - 100);
  expect(sent.map(([, meant]) => meant)).toEqual([false, false]);
});

it("a word is meant at once when the cursor leaves it, and not while it is in it", () => {
  const end = insert("righ", "x");
  typing.answered(true);
  move(end - 2);
  expect(sent).toHaveLength(1);
  move(end + 3);
  expect(sent.at(-1)).toEqual([end + 3, true]);
  typing.answered(false);
  vi.advanceTimersByTime(WORD_AFTER);
  expect(sent).toHaveLength(2);
});

it("only the last name of a dotted one is left", () => {
  const end = insert("robot.light.dat", "x");
  typing.answered(true);
  move(end - "datx".length - 1);
  expect(sent.at(-1)?.[1]).toBe(true);
});

it("a word is meant when the editor loses the focus", () => {
  insert("righ", "x");
  typing.left();
  expect(sent.at(-1)).toEqual([null, true]);
});

it("what was not typed is meant at once", () => {
  insert("righ", "x", "input.paste");
  insert("righ", "x", "undo");
  expect(sent.map(([, meant]) => meant)).toEqual([true, true]);
});

it("while something waits although it is meant, each movement of the cursor is sent", () => {
  insert("righ", "x", "input.paste");
  typing.answered(true);
  move(3);
  typing.answered(false);
  move(4);
  expect(sent.slice(1)).toEqual([[3, true]]);
});
