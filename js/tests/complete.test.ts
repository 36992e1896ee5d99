import { CompletionContext } from "@codemirror/autocomplete";
import { EditorState } from "@codemirror/state";
import { afterEach, describe, expect, it, vi } from "vitest";
import { complete, offered } from "../src/editor/complete";
import { FORMS } from "../src/editor/forms";
import { lrp } from "../src/language/lrp";
import * as terms from "../src/language/parser.terms";
import type { Lab } from "../src/session/store";

function offer(word: string, explicit = false) {
  const context = new CompletionContext(EditorState.create({ doc: word }), word.length, explicit);
  return offered(context, 0, [{ label: "rest" }, { label: "restless" }]);
}

describe("completion", () => {
  it("is offered while the word is begun", () => {
    expect(offer("res")?.options).toHaveLength(2);
    expect(offer("restl")?.options).toHaveLength(2);
  });
  it("ends with the word that is complete, so that Enter begins a line", () => {
    expect(offer("rest")).toBeNull();
    const { validFor } = offer("res")!;
    const valid = validFor as (word: string) => boolean;
    expect([valid("res"), valid("rest"), valid("rest ")]).toEqual([true, false, false]);
  });
  it("is offered when it is asked for", () => {
    expect(offer("rest", true)?.options).toHaveLength(2);
  });
});

describe("completion with the kernel", () => {
  const labels = async (expression: string, delay: number) => {
    vi.useFakeTimers();
    const doc = `(machine m (state a (running [${expression}])))`;
    const context = new CompletionContext(
      EditorState.create({ doc, extensions: lrp() }),
      doc.indexOf("]"),
      false,
    );
    const store = { state: { bridge: { members: [{ name: "odom.x", kind: "property" }] }, members: {} } };
    const reply = { options: [{ label: "x" }, { label: "pose" }] };
    const ask = () => new Promise((resolve) => setTimeout(() => resolve(reply), delay));
    const result = complete(context, { ask, store } as unknown as Lab);
    await vi.advanceTimersByTimeAsync(delay);
    return (await result)?.options.map(({ label }) => label);
  };
  afterEach(() => {
    vi.useRealTimers();
  });

  it("offers what both know, once, if it answers soon", async () => {
    expect(await labels("robot.odom.", 200)).toEqual(["x", "pose"]);
  });
  it("offers what is known in the page, if it does not", async () => {
    expect(await labels("robot.odom.", 30_000)).toEqual(["x"]);
  });
  it("waits for it, however long, where nothing is known in the page", async () => {
    expect(await labels("robot.light.", 30_000)).toEqual(["x", "pose"]);
  });
});

describe("completion of a behaviour", () => {
  const PROGRAM = `(event near [1])
(machine move (var tries := [0]) (var side := [[1]]) (state send) (state reached))
(machine m
  (var own := [1])
  (state carrying (onentry (spawn move send X)) (running [P]))
  (state look (machine part (state s)))
  (on near Y carrying -> look Z)
  T)`;
  const NOTHING = { active: [], lit: ["move/reached"], variables: {}, events: { near: true } };
  const store = { state: { ...NOTHING, settings: {}, bridge: { members: [] }, members: {} } };
  const ask = () => Promise.resolve({ options: [{ label: "elapsed" }, { label: "dt" }] });

  /** What is offered at the `|` of something written at a mark; each option with what it inserts, unless that is a snippet. */
  async function offeredAt(mark: string, written: string, explicit = true) {
    const text = PROGRAM.replace(mark, written).replace(/\b[XYZTP]\b/g, "");
    const offset = text.indexOf("|");
    const state = EditorState.create({ doc: text.replace("|", ""), extensions: lrp() });
    const result = await complete(new CompletionContext(state, offset, explicit), {
      ask,
      store,
    } as unknown as Lab);
    return (result?.options ?? []).map(({ label, apply }) => (typeof apply === "string" ? apply : label));
  }

  it("offers events and the machines that can be spawned as what is waited for, then their states", async () => {
    expect(await offeredAt("T", "(on |)")).toEqual(["near", "part.", "move."]);
    expect(await offeredAt("T", "(on m|.reached)")).toEqual(["near", "part", "move"]);
    expect(await offeredAt("T", "(on move.|)")).toEqual(["send", "reached"]);
    expect(await offeredAt("T", "(on move.re|)", false)).toEqual(["send", "reached"]);
    expect(await offeredAt("T", "(on part.|)")).toEqual(["s"]);
    expect(await offeredAt("T", "(on m.|)")).toEqual([]);
  });
  it("offers `for` beside the source, and then delays", async () => {
    expect(await offeredAt("T", "(on near |)")).toEqual(["carrying", "look", "for"]);
    expect(await offeredAt("T", "(on move.reached f|)", false)).toEqual(["carrying", "look", "for"]);
    expect(await offeredAt("T", "(on near for |)")).toEqual(["own"]);
    expect(await offeredAt("T", "(on near for own |)")).toEqual(["carrying", "look"]);
    expect(await offeredAt("T", "(ontime 200 |)")).toEqual(["carrying", "look"]);
  });
  it("offers an effect after the destination, where that is asked for", async () => {
    expect(await offeredAt("Z", "|")).toEqual(["(effect […])"]);
    expect(await offeredAt("Z", "n|", false)).toEqual([]);
    expect(await offeredAt("Z", "(|)", false)).toEqual(["effect"]);
  });
  it("offers the variables of the machine in a spawn", async () => {
    expect(await offeredAt("X", "(|)", false)).toEqual(["var"]);
    expect(await offeredAt("X", "(var |)")).toEqual(["tries", "side"]);
    expect(await offeredAt("X", "(var s| := [2])")).toEqual(["tries", "side"]);
  });
  it("offers events, machines and times in blocks, and what a machine gives", async () => {
    expect(await offeredAt("P", "|")).toEqual([
      ...["own", "robot", "near", "part.", "move.", "elapsed", "dt"],
    ]);
    expect(await offeredAt("P", "move.|")).toEqual(["state", "tries", "side", "elapsed", "dt"]);
    expect(await offeredAt("P", "move.state == '|'")).toEqual(["send", "reached"]);
    expect(await offeredAt("P", "x or move.state not in ('send', \"r|\")", false)).toEqual([
      "send",
      "reached",
    ]);
    expect(await offeredAt("P", "own.state == '|'")).toEqual([]);
  });
});

it("every keyword of the grammar is explained", () => {
  const words = Object.keys(terms).filter((name) => /^_?[a-z]+$/.test(name) && name !== "space");
  expect(Object.keys(FORMS).sort()).toEqual(words.map((name) => name.replace("_", "")).sort());
});
