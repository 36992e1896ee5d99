import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { blockEnd } from "../src/language/blocks";
import { parser } from "../src/language/parser";

const blockEndIn = (text: string, start: number) =>
  blockEnd((offset) => (offset < text.length ? text.charCodeAt(offset) : -1), start);

const CORPUS = new URL("../../tests/language/blocks.json", import.meta.url);

const closed = [
  "[]",
  "[x[0]]",
  "['a]']",
  '["a\\"]"]',
  "[# ]\n1]",
  "['''a]\n]''']",
  "[f'{x[0]}]']",
  "[f'{x!r:>{w[0]}}]']",
  "[rf'\\{a}]']",
  "[f'{{]}}']",
  "[f\"{d[']']}\"]",
  "[f'{'nested ]'}']",
  "['open\n]",
  "[if'a]']",
  "[f'\\N{RIGHT SQUARE BRACKET}]']",
  "[(]",
];

describe("a block", () => {
  it.each(closed)("%j ends at its last character", (text) => {
    expect(blockEndIn(text, 0)).toBe(text.length - 1);
  });

  it.each(["[", "[x", "['''a]", "[f'''{x]", "[# ]"])("%j is not closed", (text) => {
    expect(blockEndIn(text, 0)).toBe(-1);
  });
});

interface Case {
  name: string;
  text: string;
  end: number;
}

/** Offsets in the corpus count characters, as Python does. */
const units = (text: string, characters: number) =>
  characters < 0 ? -1 : [...text].slice(0, characters).join("").length;

describe("the corpus that the kernel's scanner shares", () => {
  const { blocks }: { blocks: Case[] } = JSON.parse(readFileSync(CORPUS, "utf8"));

  it("is there", () => {
    expect(blocks.length).toBeGreaterThan(20);
  });

  it.each(blocks)("$name", ({ text, end }) => {
    expect(blockEndIn(text, 0)).toBe(units(text, end));
  });

  it.each(blocks.filter(({ end }) => end > 0))("$name, in a program", ({ text, end }) => {
    const before = "(running ";
    const block = parser.parse(before + text).topNode.firstChild?.getChild("Block");
    expect(block?.to).toBe(before.length + units(text, end) + 1);
  });
});
