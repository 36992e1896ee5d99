/** What differs between two texts, line by line, for a reader who has to choose one. */

import { h, visible } from "./dom";

interface Line {
  text: string;
  /** In which text it is. */
  where: "both" | "present" | "other";
}

const MOST = 4_000_000; // pairs of lines that are compared; beyond, all lines between the ends differ

/** The lines of both texts in their order, each common line once. */
export function differentLines(present: string, other: string): Line[] {
  const a = plain(present).split("\n");
  const b = plain(other).split("\n");
  let start = 0;
  while (start < Math.min(a.length, b.length) && a[start] === b[start]) start++;
  let end = 0;
  const most = Math.min(a.length, b.length) - start;
  while (end < most && a[a.length - 1 - end] === b[b.length - 1 - end]) end++;
  const as = (where: Line["where"]) => (text: string) => ({ text, where });
  return [
    ...a.slice(0, start).map(as("both")),
    ...between(a.slice(start, a.length - end), b.slice(start, b.length - end)),
    ...a.slice(a.length - end).map(as("both")),
  ];
}

/** A text as the cell of a notebook holds it: with one kind of line ends, and none at its end. */
export function plain(text: string): string {
  return text.replace(/\r\n?/g, "\n").replace(/\n$/, "");
}

/** Along a longest common subsequence. */
function between(a: string[], b: string[]): Line[] {
  const width = b.length + 1;
  const isLong = (a.length + 1) * width > MOST;
  const common = new Uint32Array(isLong ? 0 : (a.length + 1) * width); // of the lines from i and j on
  for (let i = a.length - 1; i >= 0 && !isLong; i--) {
    for (let j = b.length - 1; j >= 0; j--) {
      const [down, right] = [common[(i + 1) * width + j]!, common[i * width + j + 1]!];
      common[i * width + j] = a[i] === b[j] ? common[(i + 1) * width + j + 1]! + 1 : Math.max(down, right);
    }
  }
  const lines: Line[] = [];
  let [i, j] = [0, 0];
  while (i < a.length || j < b.length) {
    const isLeft = j === b.length || isLong || common[(i + 1) * width + j]! >= common[i * width + j + 1]!;
    if (!isLong && i < a.length && a[i] === b[j]) {
      lines.push({ text: a[i++]!, where: "both" });
      j++;
    } else if (i < a.length && isLeft) lines.push({ text: a[i++]!, where: "present" });
    else lines.push({ text: b[j++]!, where: "other" });
  }
  return lines;
}

/** Scroll to the first line that differs, once the lines are drawn. */
export function scrollToDifference(inside: HTMLElement): void {
  const first = inside.querySelector("ins, del");
  if (!first) return;
  const above = first.getBoundingClientRect().top - inside.getBoundingClientRect().top;
  inside.scrollTop += above - inside.clientHeight / 4;
}

/** The lines as elements: inserted those of the other text alone, deleted those of the present one alone. */
export function drawDifference(lines: Line[]): HTMLElement[] {
  return lines.map(({ text, where }) => {
    const [tag, sign] = ({ both: ["span", "  "], present: ["del", "− "], other: ["ins", "+ "] } as const)[
      where
    ];
    return h(tag, { class: "lrp-line" }, `${sign}${visible(text)}\n`);
  });
}

/** How many lines differ, for a heading. */
export function summaryOf(lines: Line[]): string {
  const count = (where: Line["where"]) => lines.filter((line) => line.where === where).length;
  const [more, less] = [count("other"), count("present")];
  if (!more && !less) return "Only line ends differ";
  return `What differs: ${more} ${more === 1 ? "line" : "lines"} there (+), ${less} here (−)`;
}
