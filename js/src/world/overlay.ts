/** What lies over a world for the person who watches or edits it: grid, trail, scale bar, what is selected. */

import type { Point } from "../protocol";
import { type Brush, drawPath, fillAndOutline, paintAt, setDash, traceBox, traceDisc, write } from "./brush";
import type { Style } from "./palette";
import { type Handle, handlesOf, type Shape, type Thing } from "./things";
import type { Trail, TrailPoint } from "./trail";

/** Lines every so many metres, the wider the less is magnified; fine ones are at least this far apart. */
const GRID = [0.1, 0.25, 0.5, 1, 2, 5, 10, 50, 100];
const APART = 18; // px
const BAR = 100; // px that the scale bar is long at most
const GRID_TEXT = 88; // px for what stands beside it
const INSET = 8; // px: the edge of the world is not interrupted
const HANDLE = 5; // px
export const GRIP = HANDLE + 5; // px from the middle of a handle that hold it
/** How opaque the trail is where it no longer fades, and after the moment looked at. */
export const OLDER = 0.4;
export const LATER = 0.2;

/** The distance between the lines of the grid, in metres. */
function gridStep(pixels: number): number {
  return GRID.find((metres) => metres * pixels >= APART) ?? GRID.at(-1)!;
}

export function paintGrid({ c, palette, pixels }: Brush, [width, height]: [number, number]): void {
  const step = gridStep(pixels);
  c.beginPath();
  for (let x = step; x < width - 1e-9; x += step) {
    c.moveTo(x, 0);
    c.lineTo(x, height);
  }
  for (let y = step; y < height - 1e-9; y += step) {
    c.moveTo(0, y);
    c.lineTo(width, y);
  }
  drawPath(c, palette.grid, 1 / pixels);
}

/** A round length that is easily compared with the picture. */
export function barLength(pixels: number): number {
  const lengths = [-2, -1, 0, 1, 2, 3].flatMap((power) => [1, 2, 5].map((digit) => digit * 10 ** power));
  return lengths.findLast((length) => length * pixels <= BAR) ?? lengths[0]!;
}

/** A scale bar at the lower left, with the width of the grid; the context is in pixels, y down. */
export function paintBar(brush: Brush, height: number, grid: boolean): void {
  const { c, palette, pixels } = brush;
  const length = barLength(pixels);
  const [left, base, long] = [INSET + 6.5, height - INSET - 6.5, length * pixels];
  c.fillStyle = palette.paper;
  c.globalAlpha = 0.8;
  c.beginPath();
  c.roundRect(left - 6, base - 22, long + 12 + (grid ? GRID_TEXT : 0), 28, 4);
  c.fill();
  c.globalAlpha = 1;
  c.lineCap = "square";
  c.beginPath();
  c.moveTo(left, base - 5);
  c.lineTo(left, base);
  c.lineTo(left + long, base);
  c.lineTo(left + long, base - 5);
  drawPath(c, palette.ink, 1.5);
  c.save();
  c.scale(1, -1); // `write` turns y up
  const words = (text: string, x: number, y: number, align: CanvasTextAlign) =>
    write(brush, text, [x, y - base], 12, palette.ink, { align, halo: false });
  words(metres(length), left + long / 2, 10, "center");
  if (grid) words(`grid ${metres(gridStep(pixels))}`, left + long + 14, 6, "left");
  c.restore();
}

function metres(length: number): string {
  return length < 1 ? `${Math.round(length * 100)} cm` : `${length} m`;
}

const widths = (pixels: number) => [Math.max(0.014, 4 / pixels), Math.max(0.024, 7 / pixels)] as const;

/** The faint part of a trail: from one point to another, given by their indices. Each state has a colour. */
export function paintFaintTrail(
  brush: Brush,
  trail: Trail,
  [first, end]: [number, number],
  alpha: number,
  styleOf: (state: string) => Style,
): void {
  if (first >= end) return;
  const { c, palette, pixels } = brush;
  const [width, wide] = widths(pixels);
  const all = trail.lines(first, end);
  const trace = (lines: Iterable<TrailPoint[]>) => {
    c.beginPath(); // one for all of them: laps over each other stay faint
    for (const [begin, ...points] of lines) {
      c.moveTo(begin!.x, begin!.y);
      for (const { x, y } of points) c.lineTo(x, y);
    }
    c.stroke();
  };
  c.save();
  c.lineCap = "butt";
  c.globalAlpha = alpha;
  c.strokeStyle = palette.halo; // around the colours, which would be lost on a black line
  c.lineWidth = wide;
  trace([...all.values()].flat());
  c.lineWidth = width;
  for (const [state, lines] of all) {
    const { color, dash } = styleOf(state);
    c.strokeStyle = color;
    setDash(brush, ...dash);
    trace(lines);
  }
  c.restore();
}

/** The part of a trail that fades: newer pieces are opaque, older ones as faint as all before them. */
export function paintTrail(brush: Brush, trail: Trail, now: number, styleOf: (state: string) => Style): void {
  const { c, palette, pixels } = brush;
  c.save();
  c.lineCap = "butt";
  const [width, wide] = widths(pixels);
  const pieces = trail.pieces(now);
  const stroke = ({ from, to, share }: (typeof pieces)[number], thick: number) => {
    c.globalAlpha = OLDER + (1 - OLDER) * share;
    c.lineWidth = thick;
    c.beginPath();
    c.moveTo(from.x, from.y);
    c.lineTo(to.x, to.y);
    c.stroke();
  };
  c.strokeStyle = palette.halo;
  for (const piece of pieces) stroke(piece, wide);
  let along = 0; // the pattern of dashes runs on from piece to piece
  for (const piece of pieces) {
    const { from, to } = piece;
    const { color, dash } = styleOf(to.state);
    c.strokeStyle = color;
    setDash(brush, ...dash);
    c.lineDashOffset = along;
    along += Math.hypot(to.x - from.x, to.y - from.y);
    stroke(piece, width);
  }
  c.restore();
}

/** The outline of a shape; `dash` in px. */
export function paintOutline(brush: Brush, { x, y, angle, box, radius = 0 }: Shape, ...dash: number[]): void {
  const { c, palette, pixels } = brush;
  paintAt(c, [x, y, angle], () => {
    if (box) traceBox(c, [0, 0, ...box]);
    else traceDisc(c, 0, 0, radius);
    setDash(brush, ...dash);
    drawPath(c, palette.accent, 2 / pixels);
  });
}

/** A selected thing: its outline and its handles, squares to resize and a disc to turn. */
export function paintSelection(brush: Brush, thing: Thing, shape: Shape): void {
  const { c, palette, pixels } = brush;
  paintOutline(brush, shape);
  const half = HANDLE / pixels;
  for (const { grip, at } of handlesOf(thing, shape, pixels)) {
    if (grip === "turn") {
      c.beginPath();
      c.moveTo(shape.x, shape.y);
      c.lineTo(...at);
      drawPath(c, palette.accent, 1.5 / pixels);
      traceDisc(c, ...at, half);
    } else traceBox(c, [...at, 2 * half, 2 * half]);
    fillAndOutline(c, palette.paper, palette.accent, 2 / pixels);
  }
}

/** What a pointer would hold of a selected thing, at most so many px away. */
export function gripAt(
  thing: Thing,
  shape: Shape,
  [x, y]: Point,
  pixels: number,
  reach = GRIP,
): Handle | null {
  const near = ({ at }: Handle) => Math.hypot(at[0] - x, at[1] - y) <= reach / pixels;
  return handlesOf(thing, shape, pixels).find(near) ?? null;
}
