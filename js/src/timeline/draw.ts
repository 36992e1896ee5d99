/**
 * The drawing of a timeline: lanes, marks, plots, the axis of time. Only what can be seen is drawn: the time in
 * the window, and the lanes and plots in the part to which the panel is scrolled. A program may have hundreds.
 */

import { nameOf, parentOf } from "../language/paths";
import type { HappeningKind } from "../protocol";
import { s, setAttribute, unmarked } from "../ui/dom";
import type { Style } from "../world/palette";
import { type Lane, type Mark, type Plotted, placesIn, type Segment } from "./happened";
import { PLOT, plotOf } from "./plots";
import { named, nearestX, type Scale, ticksOf, timeText, xOf } from "./scale";

/** Another course of the same machines: how it goes with an edit. */
interface Other {
  lanes: readonly Lane[];
  end: number;
  divergence: { time: number; text: string } | null;
}

/** A lane: what the states of its machine were, and below it what they are in the other course. */
interface Row {
  machine: string;
  depth: number;
  recorded: Lane | null;
  other: Lane | null;
}

export interface Drawing extends Scale {
  /** The part that can be seen, in px from the top. */
  sight: { top: number; bottom: number };
  /** The end of the known run, in seconds: visits that last are drawn up to here. */
  now: number;
  /** How many machines the program has. */
  machines: number;
  lanes: readonly Lane[];
  marks: readonly Mark[];
  plots: readonly [string, Plotted][];
  /** Their names, as short as they can be told apart. */
  labels: ReadonlyMap<string, string>;
  /** The lanes of another course, and where it differs first. */
  other: Other | null;
  styleOf(state: string): Style;
}

const AXIS = 18; // px
const MARKS = 14;
const LANE = 18;
const LANES = [2, 4] as const; // for which there is room, at least and at most
const WORDS = 12; // px of a bar in which a name can be read
const NARROW = 8; // px of a visit at which nobody can aim: all of a lane are drawn together
const GAP = 3;
/** How far from the last mark of its kind one is drawn, in px. */
const APART: Partial<Record<HappeningKind, number>> = { command: 3, edit: 12 };
const MOST_WORDS = 10; // marks in one place that are named
const LETTER = 6; // px, about
const MARK_SHAPES: Partial<Record<HappeningKind, string>> = {
  edit: "M-3 4V1L1-3l3 3-4 4zM-4 5h8v1h-8z",
  restart: "M0-4a4 4 0 1 1-3.800 2.700l1.400.5A2.500 2.500 0 1 0 0-2.500V0l-3.500-3.200L0-6z",
  issue: "M0-5l5 9h-10zM-.7-2v3.200h1.400V-2zm0 4v1.200h1.400V2z",
  pause: "M-3.500-4h2.500v8h-2.500zM1-4h2.500v8H1z",
  command: "M-1-3h2v6h-2z",
  hand: "M-4-4L4 0 .8 1 0 4.500z",
};

function rowsOf({ lanes, other }: Pick<Drawing, "lanes" | "other">): Row[] {
  const rows: Row[] = lanes.map((lane) => ({ ...lane, recorded: lane, other: null }));
  for (const lane of other?.lanes ?? []) {
    const row = rows.find(({ machine }) => machine === lane.machine);
    if (row) row.other = lane;
    else {
      const outer = rows.findLastIndex(({ machine }) => lane.machine.startsWith(`${machine}/`));
      rows.splice(outer < 0 ? rows.length : outer + 1, 0, { ...lane, recorded: null, other: lane });
    }
  }
  return rows;
}

/** The height of a row, in px: two courses share it, and may have all the room that there is. */
function rowHeight(count: number, { other, machines }: Pick<Drawing, "other" | "machines">): number {
  return other ? Math.max(LANE, roomForLanes(machines) / Math.max(1, count)) : LANE;
}

/** The height of a drawing, in px. */
export function heightOf(drawing: Pick<Drawing, "lanes" | "plots" | "other" | "machines">): number {
  const { length } = rowsOf(drawing);
  return (
    roomFor(drawing) + (Math.max(1, length) * rowHeight(length, drawing) - roomForLanes(drawing.machines))
  );
}

function roomForLanes(machines: number): number {
  const [least, most] = LANES;
  return LANE * Math.min(most, Math.max(least, machines));
}

/**
 * The height of the panel for a drawing, in px: it does not change while machines start and end, nor while
 * another course is shown, or everything above it would move under the pointer. What is higher can be scrolled.
 */
export function roomFor({ plots, machines }: Pick<Drawing, "plots" | "machines">): number {
  return AXIS + MARKS + roomForLanes(machines) + plots.length * (PLOT + GAP) + GAP;
}

/** The lane at so many px from the top; null between and below the recorded ones. */
export function laneAt(drawing: Drawing, y: number): Lane | null {
  const rows = rowsOf(drawing);
  const place = (y - AXIS - MARKS) / rowHeight(rows.length, drawing);
  const isOther = drawing.other && place % 1 >= 0.5;
  return (!isOther && rows[Math.floor(place)]?.recorded) || null;
}

export function draw(svg: SVGSVGElement, drawing: Drawing): void {
  const { left, width, plots, other, sight } = drawing;
  const height = heightOf(drawing);
  const isSeen = (y: number, height: number) => y < sight.bottom && y + height > sight.top;
  const parts: Node[] = [];
  const top: Node[] = [s("rect", { width: left + width + AXIS, height: AXIS + MARKS })];
  const times = ticksOf(drawing.span, width);
  const isFine = times.length > 1 && times[1]! - times[0]! < 0.99;
  for (const time of times) {
    const x = xOf(drawing, time);
    const line = (y2: number) => s("line", { class: "lrp-timeline-grid", x1: x, x2: x, y1: AXIS, y2 });
    parts.push(line(height));
    top.push(
      line(AXIS + MARKS),
      s("text", { class: "lrp-timeline-time", x, y: AXIS - 5 }, timeText(time, isFine)),
    );
  }
  top.push(...marksOf(drawing, AXIS + MARKS / 2));
  let y = AXIS + MARKS;
  const rows = rowsOf(drawing);
  const row = rowHeight(rows.length, drawing);
  const course = other ? row / 2 : row;
  const places = placesIn([...drawing.lanes, ...(other?.lanes ?? [])]);
  for (const { machine, depth, recorded, other: changed } of rows) {
    if (isSeen(y, row)) {
      const name = [nameOf(machine), places.get(machine)].filter(Boolean).join(" ");
      parts.push(named(name, machine, y, row, left, depth));
      if (recorded) parts.push(...laneOf(drawing, recorded, [y, course], drawing.now, false));
      if (changed && other) parts.push(...laneOf(drawing, changed, [y + course, course], other.end, true));
    }
    y += row;
  }
  y = Math.max(y, AXIS + MARKS + LANE);
  if (other?.divergence) {
    const x = xOf(drawing, other.divergence.time);
    if (x >= left && x <= left + width) {
      const title = s("title", {}, unmarked(other.divergence.text));
      parts.push(s("line", { class: "lrp-timeline-divergence", x1: x, x2: x, y1: AXIS, y2: y }, title));
    }
  }
  for (const [name, plotted] of plots) {
    y += GAP;
    if (isSeen(y, PLOT)) parts.push(...plotOf(drawing, [name, drawing.labels.get(name) ?? name], plotted, y));
    y += PLOT;
  }
  svg.setAttribute("height", String(height));
  svg.replaceChildren(...parts, s("g", { class: "lrp-timeline-top" }, ...top));
}

/** The width of a label, in px. */
export const widthOf = (text: string) => LETTER * text.length + 2 * GAP;

/** Leave out the numbers of the axis that something covers, each from and to so many px. */
export function clearAxis(svg: SVGSVGElement, covers: readonly (readonly [number, number])[]): void {
  for (const time of svg.querySelectorAll(".lrp-timeline-time")) {
    const [x, half] = [Number(time.getAttribute("x")), widthOf(time.textContent ?? "") / 2];
    const isCovered = covers.some(([from, to]) => x + half > from && x - half < to);
    setAttribute(time, "visibility", isCovered ? "hidden" : null);
  }
}

function marksOf(drawing: Drawing, y: number): Node[] {
  const { left, width, marks } = drawing;
  const shown: Node[] = [];
  const last = new Map<HappeningKind, { x: number; title: Element; count: number }>();
  for (const { kind, tick, time, text } of marks) {
    const x = xOf(drawing, time);
    const shape = MARK_SHAPES[kind];
    if (!shape || x < left || x > left + width) continue;
    const words = `${time.toFixed(1)} s: ${unmarked(text)}`;
    const before = last.get(kind);
    if (before && x - before.x < (APART[kind] ?? 6)) {
      if (kind === "edit") before.x = x; // one goes on being typed
      before.count += 1;
      if (before.count < MOST_WORDS) before.title.append(`\n${words}`);
      else if (before.count === MOST_WORDS) before.title.append("\n…");
      continue;
    }
    const title = s("title", {}, words);
    last.set(kind, { x, title, count: 1 });
    shown.push(
      s(
        "g",
        {
          class: "lrp-timeline-mark",
          "data-kind": kind,
          "data-lrp-mark": kind,
          "data-tick": tick,
          transform: `translate(${x.toFixed(1)} ${y})`,
        },
        title,
        kind === "command"
          ? null
          : s("rect", { class: "lrp-timeline-hit", x: -5, y: -7, width: 10, height: 14 }),
        s("path", { d: shape }),
      ),
    );
  }
  return shown;
}

/** Draw the visits of a machine at a height, in px. */
function laneOf(
  drawing: Drawing,
  { segments }: Lane,
  [y, height]: [number, number],
  now: number,
  isOther: boolean,
): Node[] {
  const { span, styleOf } = drawing;
  const parts: Node[] = [];
  const bar: Bar = { y: y + height / 9, height: (height * 7) / 9, isOther };
  const narrow = new Map<string, string>(); // by colour
  let blurred = Number.NEGATIVE_INFINITY; // up to where visits too short to see were drawn
  for (const segment of segments) {
    if (segment.end < span.from || segment.begin > span.to) continue;
    const from = nearestX(drawing, segment.begin);
    const to = nearestX(drawing, Math.min(segment.end, now));
    if (to - from < 1 && to <= blurred) continue;
    blurred = Math.max(blurred, from + 1);
    const style = styleOf(segment.state);
    if (to - from >= NARROW) parts.push(visit(segment, from, to - from, bar, style));
    else {
      const line = `M${from.toFixed(1)} 0h${Math.max(1, to - from).toFixed(1)}`;
      narrow.set(style.color, (narrow.get(style.color) ?? "") + line);
    }
  }
  for (const [color, d] of narrow)
    parts.push(s("g", { transform: `translate(0 ${bar.y})` }, ...bars(bar, color, { d })));
  return parts;
}

interface Bar {
  y: number;
  height: number;
  isOther: boolean;
}

/** The bars of visits along a path at the height 0: a wide pale one above a thin one. */
function bars(
  { height, isOther }: Bar,
  color: string,
  line: { d: string; "stroke-dasharray"?: string },
): Node[] {
  const bar = (y: number, thickness: number, opacity: number) =>
    s("path", {
      ...{ ...line, transform: `translate(0 ${y})`, fill: "none" },
      ...{ stroke: color, "stroke-width": thickness, "stroke-opacity": opacity },
    });
  return [bar(height / 2, height, isOther ? 0.2 : 0.32), bar(height - 1, 2, 1)];
}

function visit(segment: Segment, x: number, width: number, bar: Bar, { color, dash }: Style): Node {
  const { lane, state, by, text, tick, begin, end } = segment;
  const { y, height, isOther } = bar;
  const until = end === Number.POSITIVE_INFINITY ? "" : ` to ${end.toFixed(1)} s`;
  const course = isOther ? "With the edit: " : "";
  const place = lane.includes("/") ? ` in ${parentOf(lane)}` : "";
  const line = {
    d: `M0 0h${width.toFixed(1)}`,
    ...(dash.length ? { "stroke-dasharray": dash.join(" ") } : {}),
  };
  const isNamed = height >= WORDS && width >= LETTER * nameOf(state).length + 10;
  return s(
    "svg",
    {
      class: "lrp-timeline-visit",
      "data-lrp-visit": state,
      "data-lane": lane,
      "data-by": by,
      "data-tick": tick,
      "data-begin": begin,
      "data-other": isOther,
      x: x.toFixed(1),
      y,
      width: width.toFixed(1),
      height,
    },
    s(
      "title",
      {},
      `${course}${nameOf(state)}${place}, from ${begin.toFixed(1)} s${until}. ${unmarked(text)}`,
    ),
    s("rect", { class: "lrp-timeline-hit", width, height }), // between the stripes, too
    ...bars(bar, color, line),
    s("rect", { width: 2, height, fill: color }),
    isNamed && s("text", { x: 6, y: height - 4 }, nameOf(state)),
  );
}
