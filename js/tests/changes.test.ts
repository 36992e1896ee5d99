/**
 * The kernel maps changes as CodeMirror does: `changes.json`, written by this test (`UPDATE=1`), holds what the
 * real one makes of random changes, and `tests/widgets/test_changes.py` compares the kernel's with it.
 */

import { readFileSync, writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { ChangeSet, Text } from "@codemirror/state";
import { expect, it } from "vitest";

const FILE = fileURLToPath(new URL("../../tests/widgets/changes.json", import.meta.url));
const CASES = 600;

/** Whole numbers below a limit, the same ones each time. */
function numbers(seed: number): (limit: number) => number {
  let state = seed;
  return (limit) => {
    state = (Math.imul(state, 1103515245) + 12345) & 0x7fffffff;
    return (state >> 8) % limit;
  };
}

function cases(): unknown[] {
  const random = numbers(20);
  const words = ["", "", "x", "yz", "\n", "a\n\nb", "𝄞"];
  const text = () => Array.from({ length: random(5) }, () => words[random(words.length)]).join("");
  const changes = (length: number) => {
    const specs = [];
    for (let at = random(length + 1); at <= length && random(4); at += random(4)) {
      const to = Math.min(length, at + random(4));
      specs.push({ from: at, to, insert: Text.of(text().split("\n")) });
      at = to;
    }
    return ChangeSet.of(specs, length);
  };
  return Array.from({ length: CASES }, () => {
    const doc = Text.of(`abc\nd${text()}`.slice(0, random(9)).split("\n"));
    const [a, b] = [changes(doc.length), changes(doc.length)];
    return {
      text: doc.toString(),
      a: a.toJSON(),
      b: b.toJSON(),
      after_a: b.map(a).toJSON(),
      before_b: a.map(b, true).toJSON(),
      both: b.map(a).apply(a.apply(doc)).toString(),
    };
  });
}

it("CodeMirror maps changes as it did when the kernel was compared with it", () => {
  const found = `${JSON.stringify(cases(), null, 0).replaceAll('},{"text"', '},\n{"text"')}\n`;
  if (process.env.UPDATE) writeFileSync(FILE, found);
  expect(readFileSync(FILE, "utf8")).toBe(found);
});
