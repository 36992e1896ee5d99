/** Paint a robot: its body, and what its sensors measure. */

import type { Point, Pose } from "../protocol";
import {
  addHeading,
  type Brush,
  drawPath,
  fillAndOutline,
  paintAt,
  setDash,
  traceDisc,
  write,
} from "./brush";
import type { FullRobot } from "./complete";
import { shade } from "./palette";
import type { RobotPose } from "./poses";

/** Seen from two metres, on a projector: px at least. */
export const TEXT = 13;
export const FINE = 1.5;
const RAY = 2.5;
const SPOT = 5;
const BODY = 1.22; // its radius with the bumper, in radii

export function paintStart(brush: Brush, pose: Pose, r: number): void {
  const { c, palette, pixels } = brush;
  paintAt(c, pose, () => {
    traceDisc(c, 0, 0, r);
    addHeading(c, 0.7 * r, 0.1 * r, 0.4 * r);
    c.globalAlpha = 0.6;
    setDash(brush, 3, 3);
    drawPath(c, palette.robotEdge, Math.max(0.006, FINE / pixels));
  });
}

/** The mark on a robot that shows where it heads. */
export function paintHeading(c: CanvasRenderingContext2D, r: number, color: string): void {
  c.beginPath();
  addHeading(c, 0.62 * r, 0.12 * r, 0.34 * r);
  c.fillStyle = color;
  c.fill();
}

export function paintRobot(brush: Brush, size: Point, shape: FullRobot, robot: RobotPose): void {
  const { c, palette, pixels } = brush;
  const [x, y, theta] = robot.pose;
  const r = shape.radius;
  paintAt(c, robot.pose, () => {
    c.fillStyle = palette.robotEdge; // wheels
    c.fillRect(-0.32 * r, 0.82 * r, 0.64 * r, 0.26 * r);
    c.fillRect(-0.32 * r, -1.08 * r, 0.64 * r, 0.26 * r);
    traceDisc(c, 0, 0, r);
    fillAndOutline(c, palette.robot, palette.robotEdge, 0.09 * r);
    paintHeading(c, r, palette.mark);
    if (shape.bumper) {
      c.beginPath();
      c.arc(0, 0, 1.1 * r, -0.9, 0.9);
      c.lineCap = "round";
      if (robot.bumper) drawPath(c, palette.bump, 0.24 * r);
      else drawPath(c, palette.robotEdge, 0.14 * r);
    }
    if (robot.lamp) {
      traceDisc(c, -0.5 * r, 0, 0.26 * r);
      fillAndOutline(c, palette.lamp, palette.robotEdge, 0.06 * r);
    }
    shape.light.forEach((place, i) => {
      const value = robot.lights[i];
      traceDisc(c, ...place, Math.max(0.2 * r, SPOT / pixels));
      const floor = isSeen(value) ? shade(value, palette) : "transparent";
      fillAndOutline(c, floor, palette.bump, Math.max(0.08 * r, FINE / pixels));
    });
  });
  shape.light.forEach((place, i) => {
    const value = robot.lights[i];
    if (!isSeen(value)) return;
    const text = String(Math.round(value));
    const high = Math.max(0.6 * r, TEXT / pixels);
    const [wide, tall] = [(0.36 * text.length + 0.15) * high, 0.6 * high]; // halves of the text's size
    const half = wide * Math.abs(Math.cos(theta)) + tall * Math.abs(Math.sin(theta)); // that way
    const spot = place[0] + Math.max(0.24 * r, (SPOT + FINE) / pixels);
    const beside = (along: number): Point => {
      const [ox, oy] = turned([along, place[1]], theta);
      return [x + ox, y + oy];
    };
    const ahead = beside(Math.max(BODY * r, spot) + half);
    const isCut = ahead.some((at, axis) => {
      const margin = axis ? tall : wide;
      return at < margin || at > size[axis]! - margin;
    });
    write(brush, text, isCut ? beside(-BODY * r - half) : ahead, high, palette.text);
  });
}

export function paintName(brush: Brush, { name, radius }: FullRobot, { pose: [x, y] }: RobotPose): void {
  const size = Math.max(0.05, TEXT / brush.pixels);
  write(brush, name, [x, y + radius + 0.9 * size], size, brush.palette.robotEdge);
}

const [LINE, LINES] = [24, 4]; // characters of a line of what a robot says, and how many lines

/** Write what a robot says into a bubble, below it in the upper half of the world, within the world's width. */
export function paintSpeech(
  brush: Brush,
  size: Point,
  shape: FullRobot,
  robot: RobotPose,
  text: string,
): void {
  const { c, palette, pixels } = brush;
  const [x, y] = robot.pose;
  const high = Math.max(0.05, TEXT / pixels);
  const lines = wrapped(text);
  const half = Math.min(size[0] / 2, (0.3 * Math.max(...lines.map(({ length }) => length)) + 0.4) * high);
  const middle = Math.min(size[0] - half, Math.max(half, x));
  const up = y > size[1] / 2 ? -1 : 1;
  const near = y + up * (shape.radius + 0.7 * high);
  const tall = (1.2 * lines.length + 0.5) * high;
  c.beginPath();
  c.roundRect(middle - half, Math.min(near, near + up * tall), 2 * half, tall, 0.4 * high);
  c.moveTo(x - 0.35 * high, near);
  c.lineTo(x, near - up * 0.55 * high);
  c.lineTo(x + 0.35 * high, near);
  fillAndOutline(c, palette.paper, palette.ink, Math.max(0.005, FINE / pixels));
  const top = Math.max(near, near + up * tall) - 0.85 * high;
  lines.forEach((line, i) => {
    write(brush, line, [middle, top - 1.2 * i * high], high, palette.ink, { halo: false });
  });
}

/** The lines of a text; what is too long for them ends with dots. */
export function wrapped(text: string): string[] {
  const lines = [""];
  for (const word of text.split(/\s+/).flatMap((word) => word.match(/.{1,24}/gu) ?? [])) {
    const line = lines[lines.length - 1]!;
    const longer = line ? `${line} ${word}` : word;
    if (longer.length <= LINE) lines[lines.length - 1] = longer;
    else lines.push(word);
  }
  if (lines.length <= LINES) return lines;
  return [...lines.slice(0, LINES - 1), `${lines[LINES - 1]!.slice(0, LINE - 2)} …`];
}

export function paintRays(brush: Brush, { radius, distance }: FullRobot, robot: RobotPose): void {
  paintAt(brush.c, robot.pose, () =>
    distance.forEach(([angle, reach], i) => paintRay(brush, radius, angle, reach, robot.distances[i])),
  );
}

function paintRay(brush: Brush, r: number, angle: number, reach: number, distance: number | undefined): void {
  const { c, palette, pixels } = brush;
  const seen = isSeen(distance);
  const end = r + (seen ? distance : reach);
  const [x, y] = [Math.cos(angle), Math.sin(angle)];
  c.globalAlpha = seen ? 0.95 : 0.45;
  setDash(brush, 6, 4);
  c.beginPath();
  c.moveTo(x * r, y * r);
  c.lineTo(x * end, y * end);
  drawPath(c, palette.ray, Math.max(0.005, RAY / pixels));
  setDash(brush);
  if (seen) {
    traceDisc(c, x * end, y * end, Math.max(0.012, (2 * RAY) / pixels));
    c.fillStyle = palette.ray;
    c.fill();
  }
  c.globalAlpha = 1;
}

/** Whether a sensor measures anything. */
function isSeen(value: number | undefined): value is number {
  return value !== undefined && Number.isFinite(value);
}

function turned([x, y]: Point, theta: number): Point {
  return [x * Math.cos(theta) - y * Math.sin(theta), x * Math.sin(theta) + y * Math.cos(theta)];
}
