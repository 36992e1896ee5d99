/** Paint a world: the floor and fixed things once, robots and moving things for every frame. */

import type { Point, Pose, SolidView } from "../protocol";
import type { FullRobot, FullStroke, FullWorld } from "./complete";
import type { RobotPose, Snapshot } from "./poses";

/** Seen from two metres, on a projector: px at least. */
const TEXT = 13;
const FINE = 1.5;
const RAY = 2.5;
const SPOT = 5;

type Canvas = CanvasRenderingContext2D;

/** Colours, from the stylesheet; greys of the floor are real, only dimmed in the dark. */
export interface Palette {
  accent: string;
  ink: string;
  paper: string;
  grid: string;
  trail: string[];
  outside: string;
  edge: string;
  solid: string;
  pushable: string;
  moving: string;
  solidEdge: string;
  zone: string;
  robot: string;
  robotEdge: string;
  mark: string;
  /** The colours of the second robot, the third … */
  others: { robot: string; robotEdge: string; mark: string }[];
  bump: string;
  lamp: string;
  ray: string;
  text: string;
  halo: string;
  dim: boolean;
  font: string;
}

/** A palette with the colours of one of several robots. */
export function ofRobot(palette: Palette, index: number): Palette {
  const { others } = palette;
  const number = index % (others.length + 1);
  return number ? { ...palette, ...others[number - 1] } : palette;
}

export function shade(grey: number, palette: Palette): string {
  const value = Math.round(palette.dim ? 22 + grey * 0.78 : grey);
  return `rgb(${value} ${value} ${value})`;
}

/** The floor with everything drawn on it. The context is in metres, y up. */
export function paintFloor(
  c: Canvas,
  world: FullWorld,
  ink: readonly FullStroke[],
  palette: Palette,
  pixels: number,
): void {
  const [width, height] = world.size;
  c.fillStyle = shade(world.floor.grey, palette);
  c.fillRect(0, 0, width, height);
  c.save();
  c.beginPath();
  c.rect(0, 0, width, height);
  c.clip();
  for (const stroke of world.floor.strokes) paintStroke(c, stroke, palette);
  for (const stroke of ink) paintStroke(c, stroke, palette);
  c.restore();
  c.strokeStyle = palette.edge;
  c.lineWidth = Math.max(0.008, FINE / pixels);
  c.strokeRect(0, 0, width, height);
  for (const [name, zone] of Object.entries(world.zones)) paintZone(c, world, name, zone, palette, pixels);
}

export function paintStroke(c: Canvas, stroke: FullStroke, palette: Palette): void {
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

function paintZone(
  c: Canvas,
  world: FullWorld,
  name: string,
  zone: FullWorld["zones"][string],
  palette: Palette,
  pixels: number,
): void {
  c.beginPath();
  if (zone.circle) c.arc(...zone.circle, 0, 2 * Math.PI);
  else if (zone.box) {
    const [x = 0, y = 0, width = 0, height = 0] = zone.box;
    c.rect(x - width / 2, y - height / 2, width, height);
  }
  c.fillStyle = palette.zone;
  c.globalAlpha = 0.08;
  c.fill();
  c.globalAlpha = 1;
  c.strokeStyle = palette.zone;
  c.lineWidth = Math.max(0.008, FINE / pixels);
  c.setLineDash([6 / pixels, 4 / pixels]);
  c.stroke();
  c.setLineDash([]);
  const [x = 0, y = 0, width = 0, height = 2 * width] = zone.circle ?? zone.box ?? [];
  const size = Math.max(0.06, TEXT / pixels);
  const above = y + height / 2 + 0.7 * size;
  const inside = above + 0.6 * size > world.size[1]; // of the world, whose edge would cut it off
  const at = inside ? y + height / 2 - 0.8 * size : above;
  write(c, name, x, at, size, palette.zone, "center", palette.font, palette.halo);
}

/** Text stands upright although y points up. */
export function write(
  c: Canvas,
  text: string,
  x: number,
  y: number,
  size: number,
  color: string,
  align: CanvasTextAlign,
  font: string,
  halo = "",
): void {
  c.save();
  c.translate(x, y);
  c.scale(size / 12, -size / 12);
  c.font = `600 12px ${font}`;
  c.textAlign = align;
  c.textBaseline = "middle";
  if (halo) {
    c.lineWidth = 3;
    c.lineJoin = "round";
    c.strokeStyle = halo;
    c.strokeText(text, 0, 0);
  }
  c.fillStyle = color;
  c.fillText(text, 0, 0);
  c.restore();
}

/** Make the outline of a solid at a pose the path of a context, which is moved and turned there. */
export function traceSolid(c: Canvas, solid: SolidView, pose: Pose): void {
  c.translate(pose[0], pose[1]);
  c.rotate(pose[2]);
  c.beginPath();
  if (solid.circle) c.arc(0, 0, solid.circle[2], 0, 2 * Math.PI);
  else if (solid.box) {
    const [, , width = 0, height = 0] = solid.box;
    c.rect(-width / 2, -height / 2, width, height);
  }
}

function paintSolid(c: Canvas, solid: SolidView, pose: Pose, palette: Palette): void {
  c.save();
  traceSolid(c, solid, pose);
  const standing = typeof solid.push === "number" ? palette.pushable : palette.solid;
  c.fillStyle = solid.patrol ? palette.moving : standing;
  c.strokeStyle = palette.solidEdge;
  c.lineWidth = 0.006;
  c.fill();
  c.stroke();
  c.restore();
}

/** The path of a solid that moves by itself, as a dotted line. */
function paintPatrol(c: Canvas, points: readonly Point[], palette: Palette, pixels: number): void {
  c.save();
  c.beginPath();
  for (const point of points) c.lineTo(...point);
  c.lineCap = c.lineJoin = "round";
  c.lineWidth = Math.max(0.006, FINE / pixels);
  c.setLineDash([0, 5 / pixels]);
  c.strokeStyle = palette.moving;
  c.stroke();
  c.restore();
}

/** Everything that moves; `pixels` is how many make a metre, so that texts stay legible. */
export function paintMovers(
  c: Canvas,
  world: FullWorld,
  now: Snapshot,
  palette: Palette,
  pixels: number,
): void {
  c.save();
  c.beginPath(); // rays end where the world does
  c.rect(0, 0, ...world.size);
  c.clip();
  world.robots.forEach((shape, i) => {
    const robot = now.robots[i];
    if (robot) paintRays(c, shape, robot, palette, pixels);
  });
  c.restore();
  for (const { patrol } of world.solids) if (patrol) paintPatrol(c, patrol, palette, pixels);
  world.solids.forEach((solid, i) => {
    const pose = now.solids[i];
    if (pose) paintSolid(c, solid, pose, palette);
  });
  world.robots.forEach((shape, i) => {
    const robot = now.robots[i];
    if (!robot) return;
    paintRobot(c, shape, robot, ofRobot(palette, i), pixels);
    if (world.robots.length > 1) paintName(c, shape, robot, ofRobot(palette, i), pixels);
  });
}

/** The outline of a robot where it starts. */
export function paintStart(
  c: Canvas,
  [x, y, theta]: Pose,
  r: number,
  palette: Palette,
  pixels: number,
): void {
  c.save();
  c.translate(x, y);
  c.rotate(theta);
  c.beginPath();
  c.arc(0, 0, r, 0, 2 * Math.PI);
  c.moveTo(0.7 * r, 0);
  c.lineTo(0.1 * r, 0.4 * r);
  c.lineTo(0.1 * r, -0.4 * r);
  c.closePath();
  c.strokeStyle = palette.robotEdge;
  c.globalAlpha = 0.6;
  c.lineWidth = Math.max(0.006, FINE / pixels);
  c.setLineDash([3 / pixels, 3 / pixels]);
  c.stroke();
  c.restore();
}

function paintRobot(c: Canvas, shape: FullRobot, robot: RobotPose, palette: Palette, pixels: number): void {
  const [x, y, theta] = robot.pose;
  const r = shape.radius;
  c.save();
  c.translate(x, y);
  c.rotate(theta);
  c.fillStyle = palette.robotEdge; // wheels
  c.fillRect(-0.32 * r, 0.82 * r, 0.64 * r, 0.26 * r);
  c.fillRect(-0.32 * r, -1.08 * r, 0.64 * r, 0.26 * r);
  c.beginPath();
  c.arc(0, 0, r, 0, 2 * Math.PI);
  c.fillStyle = palette.robot;
  c.strokeStyle = palette.robotEdge;
  c.lineWidth = 0.09 * r;
  c.fill();
  c.stroke();
  c.beginPath(); // its heading
  c.moveTo(0.62 * r, 0);
  c.lineTo(0.12 * r, 0.34 * r);
  c.lineTo(0.12 * r, -0.34 * r);
  c.closePath();
  c.fillStyle = palette.mark;
  c.fill();
  if (shape.bumper) {
    c.beginPath();
    c.arc(0, 0, 1.1 * r, -0.9, 0.9);
    c.lineWidth = robot.bumper ? 0.24 * r : 0.14 * r;
    c.lineCap = "round";
    c.strokeStyle = robot.bumper ? palette.bump : palette.robotEdge;
    c.stroke();
  }
  if (robot.lamp) paintLamp(c, r, palette);
  shape.light.forEach((place, i) => paintLight(c, r, place, robot.lights[i], palette, pixels));
  c.restore();
  shape.light.forEach((place, i) => {
    const value = robot.lights[i];
    if (value === undefined || !Number.isFinite(value)) return;
    const [lx, ly] = turned(place, theta);
    const size = Math.max(0.6 * r, TEXT / pixels);
    const [ox, oy] = turned([r + 0.8 * size, 0], theta);
    const text = String(Math.round(value));
    write(c, text, x + lx + ox, y + ly + oy, size, palette.text, "center", palette.font, palette.halo);
  });
}

/** The name of a robot, above it. */
function paintName(
  c: Canvas,
  { name, radius }: FullRobot,
  { pose: [x, y] }: RobotPose,
  palette: Palette,
  pixels: number,
): void {
  const size = Math.max(0.05, TEXT / pixels);
  write(c, name, x, y + radius + 0.9 * size, size, palette.robotEdge, "center", palette.font, palette.halo);
}

function paintLamp(c: Canvas, r: number, palette: Palette): void {
  c.beginPath();
  c.arc(-0.5 * r, 0, 0.26 * r, 0, 2 * Math.PI);
  c.fillStyle = palette.lamp;
  c.strokeStyle = palette.robotEdge;
  c.lineWidth = 0.06 * r;
  c.fill();
  c.stroke();
}

function paintRays(c: Canvas, shape: FullRobot, robot: RobotPose, palette: Palette, pixels: number): void {
  const [x, y, theta] = robot.pose;
  c.save();
  c.translate(x, y);
  c.rotate(theta);
  shape.distance.forEach(([angle, reach], i) =>
    paintRay(c, shape.radius, angle, reach, robot.distances[i], palette, pixels),
  );
  c.restore();
}

function turned([x, y]: Point, theta: number): Point {
  return [x * Math.cos(theta) - y * Math.sin(theta), x * Math.sin(theta) + y * Math.cos(theta)];
}

function paintRay(
  c: Canvas,
  r: number,
  angle: number,
  reach: number,
  distance: number | undefined,
  palette: Palette,
  pixels: number,
): void {
  const seen = distance !== undefined && Number.isFinite(distance);
  const length = seen ? distance : reach;
  const [x, y] = [Math.cos(angle), Math.sin(angle)];
  c.strokeStyle = palette.ray;
  c.globalAlpha = seen ? 0.95 : 0.45;
  c.lineWidth = Math.max(0.005, RAY / pixels);
  c.setLineDash([6 / pixels, 4 / pixels]);
  c.beginPath();
  c.moveTo(x * r, y * r);
  c.lineTo(x * (r + length), y * (r + length));
  c.stroke();
  c.setLineDash([]);
  if (seen) {
    c.beginPath();
    c.arc(x * (r + length), y * (r + length), Math.max(0.012, (2 * RAY) / pixels), 0, 2 * Math.PI);
    c.fillStyle = palette.ray;
    c.fill();
  }
  c.globalAlpha = 1;
}

function paintLight(
  c: Canvas,
  r: number,
  [x, y]: Point,
  value: number | undefined,
  palette: Palette,
  pixels: number,
): void {
  c.beginPath();
  c.arc(x, y, Math.max(0.2 * r, SPOT / pixels), 0, 2 * Math.PI);
  c.fillStyle = value === undefined || !Number.isFinite(value) ? "transparent" : shade(value, palette);
  c.strokeStyle = palette.bump;
  c.lineWidth = Math.max(0.08 * r, FINE / pixels);
  c.fill();
  c.stroke();
}
