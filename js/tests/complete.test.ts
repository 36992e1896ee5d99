import { CompletionContext } from "@codemirror/autocomplete";
import { EditorState } from "@codemirror/state";
import { describe, expect, it } from "vitest";
import { offered } from "../src/editor/complete";
import { FORMS } from "../src/editor/forms";
import * as terms from "../src/language/parser.terms";

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

it("every keyword of the grammar is explained", () => {
  const words = Object.keys(terms).filter((name) => /^_?[a-z]+$/.test(name) && name !== "space");
  expect(Object.keys(FORMS).sort()).toEqual(words.map((name) => name.replace("_", "")).sort());
});
