/** How another run goes: the path of the robot in it, and a ghost of the robot at its end. */

import type { Point, Pose, SolidView, WhatIf } from "../protocol";
import type { Foretold } from "../session/state";
import { type Brush, drawPath, fillAndOutline, paintAt, setDash, traceDisc, write } from "./brush";
import type { FullWorld } from "./complete";
import { coursesOf, type Drawn, isElsewhere, type Way, wayOf } from "./courses";
import { traceSolid } from "./paint";
import { ofRobot, shade } from "./palette";
import { mixed, type Snapshot } from "./poses";
import { paintHeading } from "./robot";

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

/**
 * Paint how it goes from now on: of each robot the changed course dashed, with a ghost at its end, the recorded one
 * plain; and the outlines of solids that will be elsewhere.
 */
export function paintGhost(brush: Brush, world: FullWorld, whatIf: Foretold, now: Snapshot): void {
  const { c, palette } = brush;
  c.save();
  c.lineJoin = "round";
  for (const [index, pose] of whatIf.changed.solids) {
    const [solid, before] = [world.solids[index], now.solids[index]];
    if (solid && before && isElsewhere(before, pose)) paintSolid(brush, solid, pose);
  }
  c.lineCap = "butt";
  const courses = coursesOf(whatIf, palette);
  world.robots.forEach(({ radius }, i) => {
    const drawn = courses.map((each) => ({ ...each, poses: ahead(wayOf(each.course, i), now.time) }));
    for (const { poses } of drawn) paintWay(brush, poses, palette.halo, 7);
    for (const { poses, color, dash } of drawn) {
      setDash(brush, ...dash);
      paintWay(brush, poses, color, 3);
    }
    setDash(brush);
    const ghosts = drawn.flatMap(({ poses: [first, ...rest], ...each }) => {
      const last = rest.at(-1);
      const isShown = first && last && (each.isNow || each.label) && isElsewhere(first, last);
      return isShown ? [{ ...each, last }] : [];
    });
    for (const ghost of ghosts) paintRobot({ ...brush, palette: ofRobot(palette, i) }, ghost, radius);
    paintLabels(brush, world, radius, ghosts);
  });
  c.restore();
}

const LABEL = 12; // px that the letters are high
const LETTER = 7; // px that a digit is wide
const PILL = 16; // px around them

type Ghost = Drawn & { last: Pose };

/** Write the labels of ghosts beside them, each at its own height. */
function paintLabels(brush: Brush, { size }: FullWorld, radius: number, ghosts: readonly Ghost[]): void {
  const { c, palette, pixels } = brush;
  const labelled = ghosts.filter(({ label }) => label).sort((a, b) => b.last[1] - a.last[1]);
  const heights = spread(
    labelled.map(({ last }) => last[1]),
    (PILL + 2) / pixels,
  );
  labelled.forEach(({ last: [x], label, color, isNow }, i) => {
    const width = (label.length * LETTER + PILL / 2) / pixels;
    const beside = radius + 4 / pixels;
    const left = x + beside + width > size[0] ? x - beside - width : x + beside;
    const [y, height] = [heights[i]!, PILL / pixels];
    c.beginPath();
    c.roundRect(left, y - height / 2, width, height, height / 3);
    const [ink, ground] = isNow ? [palette.halo, color] : [color, palette.halo];
    fillAndOutline(c, ground, color, 1 / pixels);
    write(brush, label, [left + width / 2, y], LABEL / pixels, ink, { halo: false });
  });
}

/** Falling heights, moved apart to be `gap` from each other, as near as that to where they were. */
export function spread(heights: readonly number[], gap: number): number[] {
  const placed = [...heights];
  for (let i = 1; i < placed.length; i++) placed[i] = Math.min(placed[i]!, placed[i - 1]! - gap);
  const shift = heights.reduce((sum, height, i) => sum + height - placed[i]!, 0) / (heights.length || 1);
  return placed.map((height) => height + shift);
}

export function paintParting({ c, palette, pixels }: Brush, whatIf: Foretold): void {
  const parting = whatIf.tried ? null : partingOf(whatIf);
  if (!parting) return;
  traceDisc(c, ...parting, DOT / pixels);
  fillAndOutline(c, shade(0, palette), palette.halo, 2.5 / pixels);
}

/** `width` is in px. */
function paintWay({ c, pixels }: Brush, poses: readonly Pose[], color: string, width: number): void {
  c.beginPath();
  for (const [x, y] of poses) c.lineTo(x, y);
  drawPath(c, color, width / pixels);
}

function outline({ c, pixels }: Brush, color: string): void {
  c.globalAlpha = 0.75;
  drawPath(c, color, Math.max(0.006, 2 / pixels));
}

function paintSolid(brush: Brush, solid: SolidView, pose: Pose): void {
  const { c } = brush;
  paintAt(c, pose, () => {
    traceSolid(c, solid);
    setDash(brush, 6, 4);
    outline(brush, shade(0, brush.palette));
  });
}

function paintRobot(brush: Brush, { last, color, dash, isNow, label }: Ghost, r: number): void {
  const { c, palette } = brush;
  paintAt(c, last, () => {
    traceDisc(c, 0, 0, r);
    c.globalAlpha = isNow ? 0.45 : 0.1;
    c.fillStyle = palette.robot;
    c.fill();
    if (label) setDash(brush, ...dash);
    outline(brush, color);
    paintHeading(c, r, color);
  });
}
