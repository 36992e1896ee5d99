/** The scale of a timeline: names at the left, and beside them the time, from left to right. */

import { s } from "../ui/dom";

export interface Span {
  from: number; // s
  to: number;
}

export interface Scale {
  span: Span;
  /** The part in which time passes, in px; names stand to its left. */
  left: number;
  width: number;
}

const NAME = 18; // px that a name is high
const ROUND = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600];

export function xOf({ span, left, width }: Scale, time: number): number {
  return left + ((time - span.from) / (span.to - span.from)) * width;
}

/** The place of a time, or the end that is nearest to it. */
export function nearestX(scale: Scale, time: number): number {
  return Math.min(scale.left + scale.width, Math.max(scale.left, xOf(scale, time)));
}

export function timeOf({ span, left, width }: Scale, x: number): number {
  return span.from + ((x - left) / width) * (span.to - span.from);
}

/** Times at which the axis has a number. */
export function ticksOf({ from, to }: Span, width: number): number[] {
  const least = ((to - from) / Math.max(1, width)) * 64;
  const step = ROUND.find((each) => each >= least) ?? Math.ceil(least / 600) * 600;
  const ticks = [];
  for (let index = Math.ceil(from / step); index * step <= to; index++) ticks.push(index * step);
  return ticks;
}

export function timeText(time: number, isFine: boolean): string {
  const seconds = isFine ? time.toFixed(1) : String(Math.round(time));
  if (time < 60) return `${seconds} s`;
  const minutes = Math.floor(Number(seconds) / 60);
  const rest = Number(seconds) - 60 * minutes;
  return `${minutes}:${(isFine ? rest.toFixed(1) : String(rest)).padStart(isFine ? 4 : 2, "0")}`;
}

/** A name in the left column; what is too long is cut. */
export function named(text: string, title: string, y: number, height: number, left: number, depth = 0): Node {
  const x = 8 + 8 * depth;
  return s(
    "svg",
    { x, y, width: Math.max(0, left - x - 4), height },
    s("title", {}, title),
    s("text", { class: "lrp-timeline-name", x: 0, y: Math.min(height, NAME) - 5 }, text),
  );
}
