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
    const bridge = { members: [{ name: "odom.x", kind: "property" }] };
    const store = { state: { bridge, members: {}, instances: [], instance: "" } };
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

it("every keyword of the grammar is explained", () => {
  const words = Object.keys(terms).filter((name) => /^_?[a-z]+$/.test(name) && name !== "space");
  expect(Object.keys(FORMS).sort()).toEqual(words.map((name) => name.replace("_", "")).sort());
});
