/** The plots of a timeline: numbers as a curve with thresholds, truth values as steps. */

import { nameOf, parentOf } from "../language/paths";
import { placesOf } from "../session/instances";
import { s } from "../ui/dom";
import { readableNumber } from "../ui/numbers";
import type { Plotted } from "./happened";
import { named, nearestX, type Scale } from "./scale";

export const PLOT = 40; // px that a plot is high
const LABEL = 10; // px that the name of a threshold is high

/** The names of what is plotted, as short as they can be told apart from each other and from what else is known. */
export function labelsOf(names: readonly string[], known: readonly string[] = []): Map<string, string> {
  const all = [...new Set([...names, ...known])];
  return new Map(
    names.map((name) => {
      if (name.startsWith("robot.")) return [name, name.slice("robot.".length)];
      if (!name.includes("/")) return [name, name];
      const own = name.split("/").slice(-2).join("/"); // its machine and its name
      const others = all.filter((each) => `/${each}`.endsWith(`/${own}`)).map(parentOf);
      return [name, [nameOf(name), placesOf(others).get(parentOf(name))].filter(Boolean).join(" ")];
    }),
  );
}

/** The plot of a name; the names of its thresholds stand in it at the right, or beside it if there is room. */
export function plotOf(
  scale: Scale,
  [name, label]: readonly [name: string, label: string],
  plotted: Plotted,
  y: number,
  isRoomy = false,
): Node[] {
  const { left, width, span } = scale;
  const parts: Node[] = [
    named(label, name, y, PLOT, left),
    s("rect", { class: "lrp-timeline-plot", "data-lrp-plot": name, x: left, y, width, height: PLOT }),
  ];
  const { times, values, thresholds } = plotted;
  const first = Math.max(0, times.findIndex((time) => time >= span.from) - 1);
  const after = times.findIndex((time) => time > span.to);
  const range: [number, number] = [first, after < 0 ? times.length : after + 1];
  if (plotted.kind === "truth") {
    const [high, low] = [y + PLOT / 4, y + PLOT - 6];
    for (const [from, to] of runsOf(times, values, range, scale)) {
      const box = { x: from, y: high, width: to - from, height: low - high };
      if (to > from) parts.push(s("rect", { class: "lrp-timeline-truth", ...box }));
    }
    const yOf = (value: number) => (value ? high : low);
    parts.push(s("path", { class: "lrp-timeline-curve", d: pathOf(times, values, range, scale, yOf, true) }));
    return parts;
  }
  const seen = [values, ...thresholds.values()]
    .flatMap((each) => each.slice(...range))
    .filter((value): value is number => value !== null);
  if (!seen.length) return parts;
  const low = seen.reduce((a, b) => Math.min(a, b));
  const high = seen.reduce((a, b) => Math.max(a, b));
  const yOf = (value: number) => y + PLOT - 4 - ((value - low) / (high - low || 1)) * (PLOT - 8);
  const words = low === high ? readableNumber(low) : `${readableNumber(low)} to ${readableNumber(high)}`;
  parts.push(s("text", { class: "lrp-timeline-range", x: 8, y: y + PLOT - 6 }, words));
  const line = (samples: (number | null)[]) => pathOf(times, samples, range, scale, yOf);
  const free = Array.from({ length: PLOT / LABEL }, (_, row) => y + (row + 1) * LABEL - 1); // rows for names
  for (const [text, samples] of thresholds) {
    const last = samples.slice(...range).findLast((value) => value !== null);
    parts.push(s("path", { class: "lrp-timeline-threshold", d: line(samples) }, s("title", {}, text)));
    if (last === undefined || last === null) continue;
    const near = (base: number) => Math.abs(base - LABEL / 2 - yOf(last));
    const [at] = free.sort((a, b) => near(a) - near(b)).splice(0, 1);
    if (at === undefined) continue; // its line has a title
    const x = left + width + (isRoomy ? 4 : -4);
    parts.push(s("text", { class: "lrp-timeline-limit", "data-beside": isRoomy, x, y: at }, text));
  }
  parts.push(s("path", { class: "lrp-timeline-curve", d: line(values) }));
  return parts;
}

/** A line through samples; of those that are drawn in the same px, the first and last, the least and greatest. */
function pathOf(
  times: number[],
  samples: (number | null)[],
  [from, to]: [number, number],
  scale: Scale,
  yOf: (value: number) => number,
  isStepped = false,
): string {
  let path = "";
  let pen = "M";
  let column: { x: number; values: number[] } | null = null;
  let last: number | undefined;
  const flush = () => {
    if (!column) return;
    const { x, values } = column;
    if (isStepped && pen === "L") values.unshift(last!);
    last = values.at(-1);
    for (const value of values) {
      path += `${pen}${x.toFixed(1)} ${yOf(value).toFixed(1)}`;
      pen = "L";
    }
    column = null;
  };
  for (let index = from; index < to && index < times.length; index++) {
    const value = samples[index];
    if (value === null || value === undefined) {
      flush();
      pen = "M";
      continue;
    }
    const x = nearestX(scale, times[index]!);
    if (column && x - column.x < 1) {
      const [first = value, low = first, high = first] = column.values;
      column.values = [first, Math.min(low, value), Math.max(high, value), value];
    } else {
      flush();
      column = { x, values: [value] };
    }
  }
  flush();
  return path;
}

/** Where a truth value holds: from and to, in px. */
function* runsOf(
  times: number[],
  values: (number | null)[],
  [from, to]: [number, number],
  scale: Scale,
): Generator<[number, number]> {
  let since: number | null = null;
  const x = (index: number) => nearestX(scale, times[Math.min(index, times.length - 1)]!);
  for (let index = from; index < to && index < times.length; index++) {
    if (values[index] && since === null) since = x(index);
    if (!values[index] && since !== null) {
      yield [since, x(index)];
      since = null;
    }
  }
  if (since !== null) yield [since, x(to)];
}
