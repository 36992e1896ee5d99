// @vitest-environment happy-dom
import { redo, undo } from "@codemirror/commands";
import { EditorState } from "@codemirror/state";
import { EditorView } from "@codemirror/view";
import { beforeEach, describe, expect, it } from "vitest";
import { Pen, renameOf, renames, sharedEffects } from "../src/editor/pen";
import { steps } from "../src/editor/steps";
import { lrp } from "../src/language/lrp";
import type { ReplyMessage, TextEdit } from "../src/protocol";
import type { Lab } from "../src/session/store";

const TEXT = "(machine m\n  (state a)\n  (event go [1])\n  (on go a -> a))\n";

let asked: { text: string; act: string }[];
let answer: TextEdit[] | string;
let sent: unknown[];
let view: EditorView;
let pen: Pen;
let meanwhile: () => void;

const at = (line: number, column: number, length = 0) => ({
  line,
  column,
  end_line: line,
  end_column: column + length,
});

beforeEach(() => {
  [asked, sent, answer] = [[], [], []];
  meanwhile = () => {};
  view = new EditorView({
    state: EditorState.create({
      doc: TEXT,
      extensions: [
        steps,
        renames,
        lrp(),
        EditorView.updateListener.of((update) => {
          const [transaction] = update.transactions;
          if (update.docChanged) sent.push(renameOf(sharedEffects(transaction!)) ?? view.state.sliceDoc());
        }),
      ],
    }),
  });
  const ask = async (question: { text: string; act: string }): Promise<ReplyMessage> => {
    asked.push(question);
    meanwhile();
    const base = { type: "reply" as const, view: "", id: 1 };
    return typeof answer === "string" ? { ...base, error: answer } : { ...base, error: null, edits: answer };
  };
  pen = new Pen(view, { ask } as unknown as Lab);
});

describe("what is drawn", () => {
  it("is one step of the history", async () => {
    answer = [
      { range: at(2, 12), text: "\n  (state b)" },
      { range: at(4, 17), text: "\n  (eps a -> b)" },
    ];
    expect(await pen.draw({ act: "transition", kind: "state", path: "m/a", to: "b" })).toBeNull();
    expect(asked[0]).toMatchObject({ text: TEXT, act: "transition" });
    expect(view.state.sliceDoc()).toBe(
      "(machine m\n  (state a)\n  (state b)\n  (event go [1])\n  (on go a -> a)\n  (eps a -> b))\n",
    );
    undo(view);
    expect(view.state.sliceDoc()).toBe(TEXT);
  });

  it("comes after what must be known before it, unless it is refused", async () => {
    const first = () => sent.push("first");
    answer = "No.";
    await pen.draw({ act: "state", kind: "machine", path: "m" }, first);
    expect(sent).toEqual([]);
    answer = [{ range: at(1, 1), text: ";" }];
    await pen.draw({ act: "state", kind: "machine", path: "m" }, first);
    expect(sent).toEqual(["first", `;${TEXT}`]);
  });

  it("is asked for again when the text changed meanwhile", async () => {
    meanwhile = () => {
      if (asked.length === 1) view.dispatch({ changes: { from: 0, insert: "; é\n" } });
    };
    answer = [{ range: at(1, 1), text: ";" }];
    expect(await pen.draw({ act: "state", kind: "machine", path: "m" })).toBeNull();
    expect(asked.map(({ text }) => text)).toEqual([TEXT, `; é\n${TEXT}`]);
    expect(view.state.sliceDoc()).toBe(`;; é\n${TEXT}`);
  });

  it("is refused with the kernel's sentence, and changes nothing", async () => {
    answer = "There is no state `m/q`.";
    expect(await pen.draw({ act: "delete", kind: "state", path: "m/q" })).toBe(answer);
    expect(view.state.sliceDoc()).toBe(TEXT);
  });

  it("is a rename in both directions of the history, not a text", async () => {
    answer = [{ range: at(2, 10, 1), text: "bb" }];
    await pen.draw({ act: "rename", kind: "state", path: "m/a", to: "bb" });
    undo(view);
    redo(view);
    view.dispatch({ changes: { from: 0, insert: ";" } });
    expect(sent.slice(0, 3)).toEqual([
      { kind: "state", path: "m/a", name: "bb" },
      { kind: "state", path: "m/bb", name: "a" },
      { kind: "state", path: "m/a", name: "bb" },
    ]);
    expect(sent[3]).toMatch(/^;/);
  });
});

it("knows the source and the triggers of the machine that is drawn on", () => {
  expect(pen.source("transition", "m:on:a->a")).toBe("on go a -> a");
  expect(pen.triggers("m")).toEqual(["go"]);
});
