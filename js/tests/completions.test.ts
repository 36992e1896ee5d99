import { readFileSync } from "node:fs";
import { CompletionContext } from "@codemirror/autocomplete";
import { EditorState } from "@codemirror/state";
import { expect, it } from "vitest";
import { complete } from "../src/editor/complete";
import { lrp } from "../src/language/lrp";
import type { Lab } from "../src/session/store";

/** What the language server offers is tested with the same file. */
const { program, offered } = JSON.parse(readFileSync("../tests/editors/completions.json", "utf8")) as {
  program: string;
  offered: [string, string[]][];
};
const NOTHING = { active: [], instances: [], lit: [], variables: {}, events: {} };
const store = { state: { ...NOTHING, settings: {}, bridge: { members: [] }, members: {} } };
const lab = { ask: () => Promise.resolve({ options: [] }), store } as unknown as Lab;

it.each(offered)("what may stand in %j is offered", async (part, labels) => {
  const text = part.startsWith("@") ? program.replace("@", part.slice(1)) : part;
  const offset = text.indexOf("|");
  const doc = text.slice(0, offset) + text.slice(offset + 1);
  const context = new CompletionContext(EditorState.create({ doc, extensions: lrp() }), offset, true);
  const found = (await complete(context, lab))?.options ?? [];
  expect(found.map(({ label }) => label).sort()).toEqual(labels);
});
