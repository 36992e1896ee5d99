// @vitest-environment happy-dom
import { describe, expect, it } from "vitest";
import { differentLines, drawDifference, summaryOf } from "../src/ui/difference";
import fc from "./laws";

const SIGNS = { both: " ", present: "-", other: "+" };

function shown(present: string, other: string): string {
  return differentLines(present, other)
    .map(({ text, where }) => SIGNS[where] + text)
    .join("|");
}

/** Texts of few different lines, so that many are common. */
const text = fc.array(fc.constantFrom("a", "b", "c"), { maxLength: 9 }).map((lines) => lines.join("\n"));

/** How many lines two texts have in common, in their order. */
function common([line, ...a]: string[], b: string[]): number {
  if (line === undefined || !b.length) return 0;
  const at = b.indexOf(line);
  return Math.max(common(a, b), at < 0 ? 0 : 1 + common(a, b.slice(at + 1)));
}

describe("the difference of two texts", () => {
  it("keeps common lines, and marks those of one text alone", () => {
    expect(shown("a\nb\nc\nd", "a\nc\nx\nd")).toBe(" a|-b| c|+x| d");
    expect(shown("a\nb", "a\nb")).toBe(" a| b");
    expect(shown("", "a")).toBe("-|+a");
  });

  it("contains both texts, and marks as few lines as can be", () => {
    fc.assert(
      fc.property(text, text, (present, other) => {
        const lines = differentLines(present, other);
        const without = (where: string) =>
          lines.filter((line) => line.where !== where).map(({ text }) => text);
        expect(without("other").join("\n")).toBe(present);
        expect(without("present").join("\n")).toBe(other);
        const both = lines.filter(({ where }) => where === "both").length;
        expect(both).toBe(common(present.split("\n"), other.split("\n")));
      }),
    );
  });

  it("ignores line ends, of which an editor decides", () => {
    expect(shown("a\r\nb\r\n", "a\nb")).toBe(" a| b");
    expect(summaryOf(differentLines("a\r\nb\r\n", "a\nb"))).toBe("Only line ends differ");
  });

  it("is found at once for long texts without a common line", () => {
    const long = (name: string) => Array.from({ length: 5000 }, (_, n) => `${name}${n}`).join("\n");
    const lines = differentLines(long("a"), long("b"));
    expect(lines.filter(({ where }) => where === "other")).toHaveLength(5000);
    expect(lines.filter(({ where }) => where === "present")).toHaveLength(5000);
  });

  it("is marked by sign and element, with characters that cannot be seen written out", () => {
    const [same, gone, come] = drawDifference(differentLines("a\nb", "a\n\u202ec"));
    expect(same!.outerHTML).toBe('<span class="lrp-line">  a\n</span>');
    expect(gone!.outerHTML).toBe('<del class="lrp-line">− b\n</del>');
    expect(come!.textContent).toBe("+ <U+202E>c\n");
  });

  it("has a heading with its size", () => {
    expect(summaryOf(differentLines("a\nb", "a\nc\nd"))).toBe("What differs: 2 lines there (+), 1 here (−)");
  });
});
