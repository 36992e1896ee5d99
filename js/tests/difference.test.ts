// @vitest-environment happy-dom
import { describe, expect, it } from "vitest";
import { differentLines, drawDifference, summaryOf } from "../src/ui/difference";

const SIGNS = { both: " ", present: "-", other: "+" };

function shown(present: string, other: string): string {
  return differentLines(present, other)
    .map(({ text, where }) => SIGNS[where] + text)
    .join("|");
}

/** Texts of few different lines, so that many are common. */
function* texts(count: number): Generator<string> {
  let seed = 7;
  const random = (below: number) => {
    seed = (seed * 48271) % 2147483647;
    return seed % below;
  };
  for (let n = 0; n < count; n++) {
    yield Array.from({ length: random(9) }, () => "abc"[random(3)]).join("\n");
  }
}

describe("the difference of two texts", () => {
  it("keeps common lines, and marks those of one text alone", () => {
    expect(shown("a\nb\nc\nd", "a\nc\nx\nd")).toBe(" a|-b| c|+x| d");
    expect(shown("a\nb", "a\nb")).toBe(" a| b");
    expect(shown("", "a")).toBe("-|+a");
  });

  it("contains both texts, whatever they are", () => {
    const [first, second] = [[...texts(200)], [...texts(400)].slice(200)];
    first.forEach((present, n) => {
      const other = second[n]!;
      const lines = differentLines(present, other);
      const of = (where: string) => lines.filter((line) => line.where !== where).map(({ text }) => text);
      expect(of("other").join("\n")).toBe(present);
      expect(of("present").join("\n")).toBe(other);
    });
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
