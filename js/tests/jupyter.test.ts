// @vitest-environment happy-dom
import { CompletionContext } from "@codemirror/autocomplete";
import { EditorState } from "@codemirror/state";
import { describe, expect, it } from "vitest";
import { complete } from "../src/editor/complete";
import { isLrp, KNOWN, support } from "../src/jupyter/language";

const CELL =
  "%%lrp m --world walls\n(var pace := [1])\n(machine m (state go (running [])) (on [True] go -> go))";

/** The words that are offered after a piece of the cell, in which more is typed. */
async function offered(after: string, typed: string): Promise<string[]> {
  const place = CELL.indexOf(after) + after.length;
  const doc = CELL.slice(0, place) + typed + CELL.slice(place);
  const state = EditorState.create({ doc, extensions: support() });
  const found = await complete(new CompletionContext(state, place + typed.length, false), KNOWN);
  return (found?.options ?? []).map(({ label }) => label);
}

describe("a cell without a lab", () => {
  it("offers forms, names and the members of the simulated robot", async () => {
    expect(await offered("(state go ", "(r")).toContain("running");
    expect(await offered("-> go)", " (on [True] g")).toContain("go");
    expect(await offered("(running [", "p")).toEqual(expect.arrayContaining(["pace", "robot"]));
    expect(await offered("(running [", "robot.")).toEqual(expect.arrayContaining(["move", "bumper", "scan"]));
  });
  it("offers nothing in its first line, whose options the kernel knows", async () => {
    expect(await offered("%%lrp m", " m")).toEqual([]);
  });
  it("begins with the magic, and with nothing else", () => {
    expect(["%%lrp", "%%lrp m\n(state", "%%lrp\n"].every(isLrp)).toBe(true);
    expect(["%lrp m", " %%lrp m", "%%lrpx", "x = 1\n%%lrp", ""].some(isLrp)).toBe(false);
  });
});
