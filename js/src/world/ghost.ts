/** How another run goes: the path of the robot in it, and a ghost of the robot at its end. */

import type { Course, Point, Pose, SolidView, WhatIf } from "../protocol";
import { type Brush, drawPath, fillAndOutline, paintAt, setDash, traceDisc } from "./brush";
import type { FullWorld } from "./complete";
import { traceSolid } from "./paint";
import { ofRobot, type Palette, shade } from "./palette";
import { mixed, type Snapshot } from "./poses";
import { paintHeading } from "./robot";

/** Poses with their times: (time, x, y, theta). */
type Way = readonly (readonly number[])[];

const STILL = 0.005; // metres and radians: a ghost in the robot itself would only blur it
const DOT = 5; // px

/** Where the robot is at a time in a way; null before it and after it. */
export function ghostAt(way: Way, time: number): Pose | null {
  const after = way.findIndex((point) => point[0]! >= time);
  if (after < 0 || (after === 0 && way[0]![0] !== time)) return null;
  const [end = 0, x = 0, y = 0, theta = 0] = way[after]!;
  const [begin = 0, fromX = 0, fromY = 0, from = 0] = way[Math.max(0, after - 1)]!;
  const share = end > begin ? (time - begin) / (end - begin) : 1;
  return mixed([fromX, fromY, from], [x, y, theta], share);
}

/** The poses of a way from a time on. */
export function ahead(way: Way, time: number): Pose[] {
  const first = ghostAt(way, time);
  const rest = way
    .filter((point) => point[0]! > time)
    .map(([, x = 0, y = 0, theta = 0]): Pose => [x, y, theta]);
  return first ? [first, ...rest] : rest;
}

export function partingOf({ divergence, changed, recorded }: WhatIf): Point | null {
  if (!divergence) return null;
  const time = Math.max(divergence.time, changed.way[0]?.[0] ?? 0); // it may be in what begins the courses
  const [x, y] = ghostAt(changed.way, time) ?? ghostAt(recorded.way, time) ?? [];
  return x === undefined || y === undefined ? null : [x, y];
}

/** The colours of the changed course and of the recorded one: greys, which no state's trail has. */
export function courseColors(palette: Palette): { changed: string; recorded: string } {
  return { changed: shade(0, palette), recorded: shade(125, palette) };
}

/**
 * Paint how it goes from now on: of each robot the changed course dashed, with a ghost at its end, the recorded one
 * plain; and the outlines of solids that will be elsewhere.
 */
export function paintGhost(brush: Brush, world: FullWorld, whatIf: WhatIf, now: Snapshot): void {
  const { c, palette } = brush;
  const { changed, recorded, divergence } = whatIf;
  const colors = courseColors(palette);
  c.save();
  c.lineJoin = "round";
  for (const [index, pose] of changed.solids) {
    const [solid, before] = [world.solids[index], now.solids[index]];
    if (solid && before && isElsewhere(before, pose)) paintSolid(brush, solid, pose);
  }
  c.lineCap = "butt";
  world.robots.forEach(({ radius }, i) => {
    const wayOf = (course: Course) => (i ? (Object.values(course.others)[i - 1] ?? []) : course.way);
    const next = ahead(wayOf(changed), now.time);
    const other = divergence ? ahead(wayOf(recorded), now.time) : [];
    for (const way of [other, next]) paintWay(brush, way, palette.halo, 7);
    paintWay(brush, other, colors.recorded, 3);
    setDash(brush, 6, 4); // the recorded one is seen in between, where it is the same way
    paintWay(brush, next, colors.changed, 3);
    setDash(brush);
    const [first, last] = [next[0], next.at(-1)];
    if (first && last && isElsewhere(first, last))
      paintRobot({ ...brush, palette: ofRobot(palette, i) }, last, radius);
  });
  c.restore();
}

export function paintParting({ c, palette, pixels }: Brush, whatIf: WhatIf): void {
  const parting = partingOf(whatIf);
  if (!parting) return;
  traceDisc(c, ...parting, DOT / pixels);
  fillAndOutline(c, courseColors(palette).changed, palette.halo, 2.5 / pixels);
}

function isElsewhere(a: Pose, b: Pose): boolean {
  return Math.hypot(b[0] - a[0], b[1] - a[1]) > STILL || Math.abs(b[2] - a[2]) > STILL;
}

/** `width` is in px. */
function paintWay({ c, pixels }: Brush, poses: readonly Pose[], color: string, width: number): void {
  c.beginPath();
  for (const [x, y] of poses) c.lineTo(x, y);
  drawPath(c, color, width / pixels);
}

/** Draw the path in the colour of the changed course. */
function outline({ c, palette, pixels }: Brush): void {
  c.globalAlpha = 0.75;
  drawPath(c, courseColors(palette).changed, Math.max(0.006, 2 / pixels));
}

function paintSolid(brush: Brush, solid: SolidView, pose: Pose): void {
  const { c } = brush;
  paintAt(c, pose, () => {
    traceSolid(c, solid);
    setDash(brush, 6, 4);
    outline(brush);
  });
}

function paintRobot(brush: Brush, pose: Pose, r: number): void {
  const { c, palette } = brush;
  paintAt(c, pose, () => {
    traceDisc(c, 0, 0, r);
    c.globalAlpha = 0.45;
    c.fillStyle = palette.robot;
    c.fill();
    outline(brush);
    paintHeading(c, r, courseColors(palette).changed);
  });
}
