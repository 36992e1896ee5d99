import { existsSync, readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { blockEndIn } from "../src/language/blocks";
import { parser } from "../src/language/parser";

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
  text: string;
  start?: number;
  end: number;
}

/** Offsets in the corpus count characters, as Python does. */
const units = (text: string, characters: number) => [...text].slice(0, characters).join("").length;

describe.runIf(existsSync(CORPUS))("the corpus that the kernel's scanner shares", () => {
  const cases: Case[] = existsSync(CORPUS) ? JSON.parse(readFileSync(CORPUS, "utf8")) : [];

  it.each(cases)("$text", ({ text, start = 0, end }) => {
    const wanted = end < 0 ? -1 : units(text, end);
    expect(blockEndIn(text, units(text, start))).toBe(wanted);
  });

  it.each(cases.filter(({ end }) => end > 0))("$text, in a program", ({ text, start = 0, end }) => {
    const program = `(running ${[...text].slice(start).join("")}`;
    const python = parser.parse(program).topNode.firstChild?.getChild("Block")?.getChild("Python");
    expect(python?.to ?? 10).toBe(9 + units([...text].slice(start).join(""), end - start));
  });
});
