// @vitest-environment happy-dom
import { redo, undo } from "@codemirror/commands";
import { EditorState } from "@codemirror/state";
import { EditorView } from "@codemirror/view";
import { afterEach, beforeEach, describe, expect, it } from "vitest";
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

afterEach(() => view.destroy()); // it parses in the background

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

describe("the forms of behaviours", () => {
  const write = (doc: string) =>
    view.dispatch({ changes: { from: 0, to: view.state.doc.length, insert: doc } });

  it("are read from a transition part by part", () => {
    write(
      "(machine m (state a (machine i (state x))) (state b) (on i . x for 2000 a -> b (effect [n = 1] [\n  k = 2])) " +
        "(exit [y] for [d] {a b} -> c t) (ontime 300 a -> b) (eps a -> b (effect [ n[0] = 1 ])) (eps b -> a (effect [[n for n in k]])) (eps a -> a (effect [n] [k])))",
    );
    const read = (id: string) => Object.values(pen.transition(`m:${id}`)!);
    expect(read("on:a->b")).toEqual(["on", "i . x for 2000", "2000", "[n = 1] [\n  k = 2]"]);
    expect(read("t")).toEqual(["exit", "[y] for [d]", "[d]", ""]);
    expect(read("ontime:a->b")).toEqual(["ontime", "300", "", ""]);
    expect(read("eps:a->b")).toEqual(["eps", "", "", "n[0] = 1"]);
    expect(read("eps:b->a")[3]).toBe("[[n for n in k]]");
    expect(read("eps:a->a")[3]).toBe("[n] [k]");
    expect(pen.transition("m:none")).toBeNull();
  });

  it("are read from what a state spawns: the machine's variables, and the values that it gives them", () => {
    write(
      "(machine car (var me := [robot]) (var n := [2]) (state go)) (machine m (state a (machine i (state x)) " +
        "(onentry [k = 1] (spawn car go (var n := [3]) (var kep := [4])) (spawn i x) (spawn none x))))",
    );
    const found = pen.spawns("m/a").map(({ machine, variables, settings }) => ({
      machine,
      variables: Object.fromEntries(variables),
      settings: Object.fromEntries(settings),
    }));
    expect(found).toEqual([
      { machine: "car", variables: { me: "robot", n: "2" }, settings: { n: "3", kep: "4" } },
      { machine: "m/a/i", variables: {}, settings: {} },
      { machine: "", variables: {}, settings: {} },
    ]);
    expect(pen.spawns("m")).toEqual([]);
  });

  it("wait for the states of machines that the sources can spawn", () => {
    write(
      "(machine car (state go)) (machine m (event e [1]) (state a (machine i (state x))) (state b (machine j (state y))) (eps a -> b))",
    );
    expect(pen.triggers("m").sort()).toEqual(["car.go", "e", "i.x", "j.y"]);
    expect(pen.triggers("m", ["b"]).sort()).toEqual(["car.go", "e", "j.y"]);
  });
});
