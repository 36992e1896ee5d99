/** How another run goes: the way of the robot in it, and a ghost of the robot at its end. */

import type { Point, Pose, WhatIfView } from "../protocol";
import type { Palette } from "./paint";

type Canvas = CanvasRenderingContext2D;
/** Poses with their times: (time, x, y, theta). */
type Way = readonly (readonly number[])[];

const STILL = 0.005; // metres and radians: a ghost in the robot itself would only blur it
const DOT = 6; // px

/** Where the robot is at a time in a way; null before it and after it. */
export function ghostAt(way: Way, time: number): Pose | null {
  const after = way.findIndex((point) => point[0]! >= time);
  if (after < 0 || (after === 0 && way[0]![0] !== time)) return null;
  const [end = 0, x = 0, y = 0, theta = 0] = way[after]!;
  const [begin = 0, fromX = 0, fromY = 0, from = 0] = way[Math.max(0, after - 1)]!;
  const share = end > begin ? (time - begin) / (end - begin) : 1;
  const turn = Math.atan2(Math.sin(theta - from), Math.cos(theta - from));
  return [fromX + (x - fromX) * share, fromY + (y - fromY) * share, from + turn * share];
}

/** The poses of a way from a time on. */
export function ahead(way: Way, time: number): Pose[] {
  const first = ghostAt(way, time);
  const rest = way
    .filter((point) => point[0]! > time)
    .map(([, x = 0, y = 0, theta = 0]): Pose => [x, y, theta]);
  return first ? [first, ...rest] : rest;
}

/** Where the two courses part. */
export function partingOf({ divergence, changed, recorded, begin }: WhatIfView): Point | null {
  if (!divergence) return null;
  const time = Math.max(begin, divergence.time);
  const [x, y] = ghostAt(changed.way, time) ?? ghostAt(recorded.way, time) ?? [];
  return x === undefined || y === undefined ? null : [x, y];
}

/** Paint how it goes from a time on: the changed course dashed, with a ghost at its end, the recorded one plain. */
export function paintGhost(
  c: Canvas,
  whatIf: WhatIfView,
  now: number,
  radius: number,
  palette: Palette,
  pixels: number,
): void {
  const changed = ahead(whatIf.changed.way, now);
  const parting = partingOf(whatIf);
  c.save();
  c.lineCap = c.lineJoin = "round";
  if (whatIf.divergence) paintWay(c, ahead(whatIf.recorded.way, now), palette.robotEdge, [], palette, pixels);
  paintWay(c, changed, palette.accent, [7, 6], palette, pixels);
  if (parting) {
    c.beginPath();
    c.arc(...parting, DOT / pixels, 0, 2 * Math.PI);
    c.fillStyle = palette.accent;
    c.strokeStyle = palette.halo;
    c.lineWidth = 2 / pixels;
    c.fill();
    c.stroke();
  }
  const [first, last] = [changed[0], changed.at(-1)];
  if (first && last && isElsewhere(first, last)) paintRobot(c, last, radius, palette, pixels);
  c.restore();
}

function isElsewhere(a: Pose, b: Pose): boolean {
  return Math.hypot(b[0] - a[0], b[1] - a[1]) > STILL || Math.abs(b[2] - a[2]) > STILL;
}

function paintWay(
  c: Canvas,
  poses: readonly Pose[],
  color: string,
  dash: number[],
  palette: Palette,
  pixels: number,
): void {
  c.beginPath();
  for (const [x, y] of poses) c.lineTo(x, y);
  c.strokeStyle = palette.halo;
  c.lineWidth = 6 / pixels;
  c.stroke();
  c.setLineDash(dash.map((length) => length / pixels));
  c.strokeStyle = color;
  c.lineWidth = 2.5 / pixels;
  c.stroke();
  c.setLineDash([]);
}

function paintRobot(c: Canvas, [x, y, theta]: Pose, r: number, palette: Palette, pixels: number): void {
  c.save();
  c.translate(x, y);
  c.rotate(theta);
  c.beginPath();
  c.arc(0, 0, r, 0, 2 * Math.PI);
  c.globalAlpha = 0.45;
  c.fillStyle = palette.robot;
  c.fill();
  c.globalAlpha = 0.75;
  c.strokeStyle = palette.accent;
  c.lineWidth = Math.max(0.006, 2 / pixels);
  c.stroke();
  c.beginPath();
  c.moveTo(0.62 * r, 0);
  c.lineTo(0.12 * r, 0.34 * r);
  c.lineTo(0.12 * r, -0.34 * r);
  c.closePath();
  c.fillStyle = palette.accent;
  c.fill();
  c.restore();
}
