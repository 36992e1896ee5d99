/** What lies over a world for the person who watches or edits it: grid, trail, scale bar, what is selected. */

import type { Palette } from "./paint";
import { write } from "./paint";
import type { Grip, Shape, Thing } from "./things";
import { handlesOf } from "./things";
import type { Trail, TrailPoint } from "./trail";

type Canvas = CanvasRenderingContext2D;

/** Lines every so many metres, the wider the less is magnified; fine ones are at least this far apart. */
const GRID = [0.1, 0.25, 0.5, 1, 2, 5, 10, 50, 100];
const APART = 18; // px
const BAR = 100; // px that the scale bar is long at most
const GRID_TEXT = 88; // px for what stands beside it
const HANDLE = 5; // px
/** How opaque the trail is where it no longer fades, and after the moment looked at. */
export const OLDER = 0.4;
export const LATER = 0.2;

/** The distance between the lines of the grid, in metres. */
export function gridStep(pixels: number): number {
  return GRID.find((metres) => metres * pixels >= APART) ?? GRID.at(-1)!;
}

/** A grid; the context is in metres, `pixels` make one. */
export function paintGrid(
  c: Canvas,
  [width, height]: [number, number],
  palette: Palette,
  pixels: number,
): void {
  const step = gridStep(pixels);
  c.strokeStyle = palette.grid;
  c.lineWidth = 1 / pixels;
  c.beginPath();
  for (let x = step; x < width - 1e-9; x += step) {
    c.moveTo(x, 0);
    c.lineTo(x, height);
  }
  for (let y = step; y < height - 1e-9; y += step) {
    c.moveTo(0, y);
    c.lineTo(width, y);
  }
  c.stroke();
}

/** A round length that is easily compared with the picture. */
export function barLength(pixels: number): number {
  const lengths = [-2, -1, 0, 1, 2, 3].flatMap((power) => [1, 2, 5].map((digit) => digit * 10 ** power));
  return lengths.findLast((length) => length * pixels <= BAR) ?? lengths[0]!;
}

/** A scale bar at the lower left, with the width of the grid; the context is in pixels, y down. */
export function paintBar(c: Canvas, height: number, palette: Palette, pixels: number, grid: boolean): void {
  const length = barLength(pixels);
  const [left, base, long] = [10.5, height - 10.5, length * pixels];
  c.fillStyle = palette.paper;
  c.globalAlpha = 0.8;
  c.beginPath();
  c.roundRect(left - 6, base - 22, long + 12 + (grid ? GRID_TEXT : 0), 28, 4);
  c.fill();
  c.globalAlpha = 1;
  c.lineCap = "square";
  c.strokeStyle = palette.ink;
  c.lineWidth = 1.5;
  c.beginPath();
  c.moveTo(left, base - 5);
  c.lineTo(left, base);
  c.lineTo(left + long, base);
  c.lineTo(left + long, base - 5);
  c.stroke();
  c.save();
  c.scale(1, -1); // `write` turns y up
  write(c, metres(length), left + long / 2, 10 - base, 12, palette.ink, "center", palette.font);
  const width = `grid ${metres(gridStep(pixels))}`;
  if (grid) write(c, width, left + long + 14, 6 - base, 12, palette.ink, "left", palette.font);
  c.restore();
}

/** A length as it is written. */
export function metres(length: number): string {
  return length < 1 ? `${Math.round(length * 100)} cm` : `${length} m`;
}

type Style = (state: string) => { color: string; dash: number[] };

const widths = (pixels: number) => [Math.max(0.014, 4 / pixels), Math.max(0.024, 7 / pixels)] as const;

/** The faint part of a trail: from one point to another, given by their indices. Each state has a colour. */
export function paintFaintTrail(
  c: Canvas,
  trail: Trail,
  [first, end]: [number, number],
  alpha: number,
  style: Style,
  palette: Palette,
  pixels: number,
): void {
  if (first >= end) return;
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
    const { color, dash } = style(state);
    c.strokeStyle = color;
    c.setLineDash(dash.map((length) => length / pixels));
    trace(lines);
  }
  c.restore();
}

/** The part of a trail that fades: newer pieces are opaque, older ones as faint as all before them. */
export function paintTrail(
  c: Canvas,
  trail: Trail,
  now: number,
  style: Style,
  palette: Palette,
  pixels: number,
): void {
  c.save();
  c.lineCap = "butt";
  const [width, wide] = widths(pixels);
  const pieces = trail.pieces(now);
  const stroke = (thick: number, from: TrailPoint, to: TrailPoint) => {
    c.lineWidth = thick;
    c.beginPath();
    c.moveTo(from.x, from.y);
    c.lineTo(to.x, to.y);
    c.stroke();
  };
  c.strokeStyle = palette.halo;
  for (const { from, to, share } of pieces) {
    c.globalAlpha = OLDER + (1 - OLDER) * share;
    stroke(wide, from, to);
  }
  let along = 0; // the pattern of dashes runs on from piece to piece
  for (const { from, to, share } of pieces) {
    const { color, dash } = style(to.state);
    c.strokeStyle = color;
    c.globalAlpha = OLDER + (1 - OLDER) * share;
    c.setLineDash(dash.map((length) => length / pixels));
    c.lineDashOffset = along;
    along += Math.hypot(to.x - from.x, to.y - from.y);
    stroke(width, from, to);
  }
  c.restore();
}

/** The outline of a shape. */
export function paintOutline(
  c: Canvas,
  shape: Shape,
  palette: Palette,
  pixels: number,
  dashed = false,
): void {
  c.save();
  c.translate(shape.x, shape.y);
  c.rotate(shape.angle);
  c.beginPath();
  if (shape.box) c.rect(-shape.box[0] / 2, -shape.box[1] / 2, ...shape.box);
  else c.arc(0, 0, shape.radius ?? 0, 0, 2 * Math.PI);
  c.strokeStyle = palette.accent;
  c.lineWidth = 2 / pixels;
  if (dashed) c.setLineDash([5 / pixels, 4 / pixels]);
  c.stroke();
  c.restore();
}

/** A selected thing: its outline and its handles, squares to resize and a disc to turn. */
export function paintSelection(
  c: Canvas,
  thing: Thing,
  shape: Shape,
  palette: Palette,
  pixels: number,
): void {
  paintOutline(c, shape, palette, pixels);
  const half = HANDLE / pixels;
  for (const { grip, at } of handlesOf(thing, shape, pixels)) {
    c.beginPath();
    if (grip === "turn") {
      c.moveTo(shape.x, shape.y);
      c.lineTo(...at);
      c.strokeStyle = palette.accent;
      c.lineWidth = 1.5 / pixels;
      c.stroke();
      c.beginPath();
      c.arc(...at, half, 0, 2 * Math.PI);
    } else c.rect(at[0] - half, at[1] - half, 2 * half, 2 * half);
    c.fillStyle = palette.paper;
    c.fill();
    c.strokeStyle = palette.accent;
    c.lineWidth = 2 / pixels;
    c.stroke();
  }
}

/** What a pointer would hold of a selected thing. */
export function gripAt(
  thing: Thing,
  shape: Shape,
  [x, y]: [number, number],
  pixels: number,
): { grip: Grip; at: [number, number] } | null {
  const reach = (HANDLE + 5) / pixels;
  return handlesOf(thing, shape, pixels).find(({ at }) => Math.hypot(at[0] - x, at[1] - y) <= reach) ?? null;
}
