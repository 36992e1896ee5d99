// @vitest-environment happy-dom
/** What the editor draws into the text goes on, whatever is done to the text. */

import { redo, undo } from "@codemirror/commands";
import { forceParsing } from "@codemirror/language";
import { StateEffect } from "@codemirror/state";
import { type EditorView, ViewPlugin } from "@codemirror/view";
import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { AGAIN_AFTER } from "../src/editor/alive";
import { Editor } from "../src/editor/editor";
import { placeHands } from "../src/editor/hands";
import { liveChanged } from "../src/editor/live";
import type { SnapshotMessage } from "../src/protocol";
import { Connection } from "../src/session/connection";
import { type Lab, Store } from "../src/session/store";
import fc from "./laws";

const TEXT = `(machine m
  (var n := [0])
  (event go [n > 1])
  (state a (running [n += 1]))
  (state b)
  (on go a -> b)
  (on [n > 5] a -> b named))
(spawn m a)`;
const LIVE = [".lrp-line-active", ".lrp-text-fired", ".lrp-inline-value", "[class^=lrp-bracket]"];

let editor: Editor;
let reported: unknown[];

const failures = () => reported.map(String);

/** How many there are of each, once the text is parsed, which the editor does in slices of time. */
function drawn(): number[] {
  forceParsing(editor.view, editor.view.state.doc.length, Number.POSITIVE_INFINITY);
  return LIVE.map((selector) => editor.view.dom.querySelectorAll(selector).length);
}

/** An editor without a kernel, in which the program runs. */
function open(): void {
  reported = [];
  const closed = new AbortController().signal;
  const store = new Store();
  const lab = { store, root: document.createElement("div"), closed } as unknown as Lab;
  const model = { send: () => {}, on: () => {}, off: () => {} };
  const clock = { now: () => 0, every: () => () => {} };
  editor = new Editor(lab, new Connection(model, "editor", { message: () => {}, link: () => {} }, clock));
  const fired = (at: number) => [1, at];
  Object.assign(store.state, {
    lit: ["m/a"],
    fired: { "m:named": fired(2) },
    variables: { "m/n": ["3", 3] },
    events: { "m/go": true },
  });
  editor.begin({ document: "d", text: TEXT, running: TEXT, revision: 0, updates: null } as SnapshotMessage);
}

beforeEach(() => {
  vi.stubGlobal("reportError", (error: unknown) => reported.push(error));
  open();
});
afterEach(() => {
  editor.close();
  vi.unstubAllGlobals();
  vi.useRealTimers();
});

/** A share of the text's length, so that every place of any text can come up. */
const place = fc.double({ min: 0, max: 1, noNaN: true });
const PIECES = ["", "", "(", ")", "[", "]", "x", "\n", "(on go b -> a)", "(state c)", "; 𝄞 ", '"'];
const act = fc.oneof(
  fc.record({ from: place, to: place, insert: fc.constantFrom(...PIECES) }),
  fc.record({ line: place }),
  fc.record({ hands: fc.tuple(fc.nat(999), fc.nat(999)) }),
  fc.constantFrom("undo" as const, "redo" as const, "run" as const),
);

function does(view: EditorView, done: typeof act extends fc.Arbitrary<infer Act> ? Act : never): void {
  const { doc } = view.state;
  const at = (share: number) => Math.round(share * doc.length);
  if (done === "undo") undo(view);
  else if (done === "redo") redo(view);
  else if (done === "run") view.dispatch({ effects: liveChanged.of(null) });
  else if ("hands" in done) placeHands(view, [["other", { revision: 0, selection: done.hands }]], null);
  else if ("line" in done) {
    const { from, to } = doc.lineAt(at(done.line));
    view.dispatch({ changes: { from, to: Math.min(to + 1, doc.length) }, userEvent: "delete" });
  } else {
    const [from, to] = [at(done.from), at(done.to)].sort((a, b) => a - b) as [number, number];
    view.dispatch({ changes: { from, to, insert: done.insert }, userEvent: "input.type" });
  }
}

it("nothing that is drawn fails, whatever is typed, deleted and undone, and all of it is there again", () => {
  fc.assert(
    fc.property(fc.array(act, { maxLength: 25 }), (acts) => {
      open();
      const before = drawn();
      expect(Math.min(...before)).toBeGreaterThan(0);
      for (const each of acts) does(editor.view, each);
      while (undo(editor.view));
      expect(failures()).toEqual([]);
      expect(editor.text).toBe(TEXT);
      expect(drawn()).toEqual(before);
      editor.close();
    }),
    { numRuns: 100 },
  );
});

it("a plugin that throws begins again, in the same text and with its history", () => {
  vi.useFakeTimers();
  let fails = true;
  const plugin = ViewPlugin.define(() => ({
    update: () => {
      if (fails) throw new Error("a fault of the page");
      seen++;
    },
  }));
  let seen = 0;
  const { view } = editor;
  view.dispatch({ effects: StateEffect.appendConfig.of(plugin) });
  view.dispatch({ changes: { from: 0, insert: "; " }, selection: { anchor: 2 } });
  expect(failures()).toEqual(["Error: a fault of the page"]);
  fails = false;
  view.dispatch({ changes: { from: 2, insert: "x" } });
  expect(seen).toBe(0);
  vi.advanceTimersByTime(AGAIN_AFTER);
  view.dispatch({ changes: { from: 3, insert: "\n" } });
  expect(seen).toBeGreaterThan(0);
  expect([editor.text, view.state.selection.main.head]).toEqual([`; x\n${TEXT}`, 2]);
  while (undo(view));
  expect(editor.text).toBe(TEXT);
  expect(failures().length).toBe(1);
});

it("a part of the page that fails does not keep what changed from the others", async () => {
  const store = new Store();
  const told: string[] = [];
  let begun = false;
  store.watch(["machine"], () => {
    if (begun) throw new Error("a fault of the page");
  });
  store.watch(["machine"], () => told.push(store.state.machine));
  begun = true;
  store.set("machine", "m");
  await new Promise(requestAnimationFrame);
  expect(told).toEqual(["", "m"]);
  expect(failures()).toEqual(["Error: a fault of the page"]);
});
