/** Paint a world: the floor and fixed things once, moving things for every frame. */

import type { Point, Pose, SolidView } from "../protocol";
import { type Brush, drawPath, fillAndOutline, paintAt, setDash, traceBox, traceDisc, write } from "./brush";
import type { FullStroke, FullWorld } from "./complete";
import { ofRobot, shade } from "./palette";
import type { Snapshot } from "./poses";
import { FINE, paintName, paintRays, paintRobot, paintSpeech, TEXT } from "./robot";

export function paintFloor(brush: Brush, world: FullWorld, ink: readonly FullStroke[]): void {
  const { c, palette, pixels } = brush;
  const [width, height] = world.size;
  c.fillStyle = shade(world.floor.grey, palette);
  c.fillRect(0, 0, width, height);
  c.save();
  c.beginPath();
  c.rect(0, 0, width, height);
  c.clip();
  for (const stroke of [...world.floor.strokes, ...ink]) paintStroke(brush, stroke);
  c.restore();
  c.strokeStyle = palette.edge;
  c.lineWidth = Math.max(0.008, FINE / pixels);
  c.strokeRect(0, 0, width, height);
  for (const zone of Object.values(world.zones)) paintZone(brush, zone);
}

export function paintStroke({ c, palette }: Pick<Brush, "c" | "palette">, stroke: FullStroke): void {
  c.lineCap = "round";
  c.lineJoin = "round";
  c.lineWidth = stroke.width;
  c.strokeStyle = shade(stroke.grey, palette);
  c.globalCompositeOperation = stroke.ink ? "darken" : "source-over";
  c.beginPath();
  if (stroke.path) {
    const [first, ...rest] = stroke.path;
    if (first) c.moveTo(...first);
    if (first && !rest.length) c.lineTo(...first);
    for (const point of rest) c.lineTo(...point);
  } else if (stroke.circle) c.arc(...stroke.circle, 0, 2 * Math.PI);
  else if (stroke.arc) {
    const [x = 0, y = 0, radius = 0, first = 0, last = 0] = stroke.arc;
    c.arc(x, y, radius, first, last, last < first);
  }
  c.stroke();
  c.globalCompositeOperation = "source-over";
}

function paintZone(brush: Brush, { circle, box }: FullWorld["zones"][string]): void {
  const { c, palette, pixels } = brush;
  if (circle) traceDisc(c, ...circle);
  else traceBox(c, box ?? []);
  c.fillStyle = palette.zone;
  c.globalAlpha = 0.08;
  c.fill();
  c.globalAlpha = 1;
  setDash(brush, 6, 4);
  drawPath(c, palette.zone, Math.max(0.008, FINE / pixels));
  setDash(brush);
}

export function paintZoneNames(brush: Brush, world: FullWorld): void {
  const size = Math.max(0.06, TEXT / brush.pixels);
  for (const [name, { circle, box }] of Object.entries(world.zones)) {
    const [x = 0, y = 0, width = 0, height = 2 * width] = circle ?? box ?? [];
    const above = y + height / 2 + 0.7 * size;
    const inside = above + 0.6 * size > world.size[1]; // of the world, whose edge would cut it off
    const half = Math.min((0.3 * name.length + 0.4) * size, world.size[0] / 2); // of its letters, about
    const across = Math.min(Math.max(x, half), world.size[0] - half);
    write(brush, name, [across, inside ? y + height / 2 - 0.8 * size : above], size, brush.palette.zone);
  }
}

/** Make the outline of a solid the path of a context that is moved and turned to it. */
export function traceSolid(c: CanvasRenderingContext2D, { circle, box }: SolidView): void {
  if (circle) traceDisc(c, 0, 0, circle[2]);
  else traceBox(c, [0, 0, ...(box?.slice(2) ?? [])]);
}

function paintSolid({ c, palette }: Brush, solid: SolidView, pose: Pose): void {
  const standing = typeof solid.push === "number" ? palette.pushable : palette.solid;
  paintAt(c, pose, () => {
    traceSolid(c, solid);
    fillAndOutline(c, solid.patrol ? palette.moving : standing, palette.solidEdge, 0.006);
  });
}

/** The path of a solid that moves by itself, as a dotted line. */
function paintPatrol(brush: Brush, points: readonly Point[]): void {
  const { c, palette, pixels } = brush;
  c.save();
  c.beginPath();
  for (const point of points) c.lineTo(...point);
  c.lineCap = c.lineJoin = "round";
  setDash(brush, 0, 5);
  drawPath(c, palette.moving, Math.max(0.006, FINE / pixels));
  c.restore();
}

/** The solids, and up to where robots see them. */
export function paintSolids(brush: Brush, world: FullWorld, now: Snapshot): void {
  const { c } = brush;
  c.save();
  c.beginPath(); // rays end where the world does
  c.rect(0, 0, ...world.size);
  c.clip();
  world.robots.forEach((shape, i) => {
    const robot = now.robots[i];
    if (robot) paintRays(brush, shape, robot);
  });
  c.restore();
  for (const { patrol } of world.solids) if (patrol) paintPatrol(brush, patrol);
  world.solids.forEach((solid, i) => {
    const pose = now.solids[i];
    if (pose) paintSolid(brush, solid, pose);
  });
}

export function paintRobots(brush: Brush, world: FullWorld, now: Snapshot, says: readonly string[]): void {
  world.robots.forEach((shape, i) => {
    const robot = now.robots[i];
    if (!robot) return;
    const own = { ...brush, palette: ofRobot(brush.palette, i) };
    paintRobot(own, world.size, shape, robot);
    if (world.robots.length > 1) paintName(own, shape, robot);
  });
  world.robots.forEach((shape, i) => {
    const [robot, text] = [now.robots[i], says[i]];
    if (robot && text) paintSpeech(brush, world.size, shape, robot, text);
  });
}
