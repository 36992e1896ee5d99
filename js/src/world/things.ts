/** The things of a world that can be selected, moved, turned, resized: pure geometry. */

import type { Point, Pose } from "../protocol";
import type { FullWorld } from "./complete";
import type { Snapshot } from "./poses";

export type Thing =
  | { kind: "robot"; index: number }
  | { kind: "solid"; index: number }
  | { kind: "start"; index: number }
  | { kind: "zone"; name: string };

/** Where a thing is and how large: a box of this size, else a disc of this radius. */
export interface Shape {
  x: number;
  y: number;
  angle: number;
  box?: Point;
  radius?: number;
}

/** What a pointer holds of a thing: all of it, its heading, or a corner or rim. */
export type Grip = "move" | "turn" | "size";

const SMALLEST = 0.03; // metres
const TURN_GRIP = 22; // px from the rim to the handle that turns

/** A text for each thing, by which it is found in a map. */
export const keyOf = (thing: Thing | null) => JSON.stringify(thing);

export function same(one: Thing | null, other: Thing | null): boolean {
  return keyOf(one) === keyOf(other);
}

/** The present shape of a thing; null if it is not there. */
export function shapeOf(world: FullWorld, now: Snapshot, thing: Thing): Shape | null {
  if (thing.kind === "zone") {
    const { box, circle } = world.zones[thing.name] ?? {};
    const [x = 0, y = 0] = box ?? circle ?? [];
    return box || circle ? { x, y, angle: 0, ...sized(box, circle) } : null;
  }
  if (thing.kind === "solid") {
    const [solid, pose] = [world.solids[thing.index], now.solids[thing.index]];
    return solid && pose
      ? { x: pose[0], y: pose[1], angle: pose[2], ...sized(solid.box, solid.circle) }
      : null;
  }
  const robot = world.robots[thing.index];
  const pose = thing.kind === "robot" ? now.robots[thing.index]?.pose : robot?.pose;
  return robot && pose ? { x: pose[0], y: pose[1], angle: pose[2], radius: robot.radius } : null;
}

function sized(box?: number[], circle?: number[]): Pick<Shape, "box" | "radius"> {
  return box ? { box: [box[2] ?? 0, box[3] ?? 0] } : { radius: circle?.[2] ?? 0 };
}

/** The things of a world, those that lie above others first. */
export function thingsOf(world: FullWorld): Thing[] {
  const indices = (items: readonly unknown[]) => items.map((_, i) => items.length - 1 - i);
  return [
    ...indices(world.robots).map((index): Thing => ({ kind: "robot", index })),
    ...indices(world.robots).map((index): Thing => ({ kind: "start", index })),
    ...indices(world.solids).map((index): Thing => ({ kind: "solid", index })),
    ...Object.keys(world.zones)
      .reverse()
      .map((name): Thing => ({ kind: "zone", name })),
  ];
}

/**
 * The thing at a point, of those that are shown in these shapes; small and thin ones and the rims of zones can be
 * caught within `grip` metres.
 */
export function thingAt(
  world: FullWorld,
  shown: (thing: Thing) => Shape | null,
  point: Point,
  grip: number,
): Thing | null {
  return (
    thingsOf(world).find((thing) => {
      const shape = shown(thing);
      if (!shape) return false;
      // what lies inside a zone stays within reach, and so does the floor, to pan
      if (thing.kind === "zone") return covers(shape, point, grip) && !covers(shape, point, -grip);
      const { radius = 0 } = shape;
      return covers(shape, point, thing.kind === "robot" ? Math.max(radius * 0.25, grip - radius) : grip);
    }) ?? null
  );
}

/** Whether a shape, made so many metres larger all around, covers a point. */
export function covers(shape: Shape, point: Point, grip: number): boolean {
  const [along, aside] = within(shape, point);
  if (!shape.box) return Math.hypot(along, aside) <= (shape.radius ?? 0) + grip;
  return Math.abs(along) <= shape.box[0] / 2 + grip && Math.abs(aside) <= shape.box[1] / 2 + grip;
}

/** A point seen from the middle of a shape, in its own directions. */
function within({ x, y, angle }: Shape, [px, py]: Point): Point {
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  return [(px - x) * cos + (py - y) * sin, (py - y) * cos - (px - x) * sin];
}

/** The inverse of `within`. */
function without({ x, y, angle }: Shape, [along, aside]: Point): Point {
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  return [x + along * cos - aside * sin, y + along * sin + aside * cos];
}

export interface Handle {
  grip: Grip;
  at: Point;
}

/** The handles of a selected thing; `pixels` make a metre. */
export function handlesOf(thing: Thing, shape: Shape, pixels: number): Handle[] {
  const reach = TURN_GRIP / pixels;
  const half: Point = shape.box ? [shape.box[0] / 2, shape.box[1] / 2] : [shape.radius!, shape.radius!];
  const handles: Handle[] = [];
  if (thing.kind !== "zone" && (shape.box || thing.kind !== "solid"))
    handles.push({ grip: "turn", at: without(shape, [half[0] + reach, 0]) });
  if (thing.kind === "start" || thing.kind === "robot") return handles;
  const corners = shape.box ? [1, -1].flatMap((a) => [1, -1].map((b): Point => [a, b])) : [[1, 0] as Point];
  for (const [a, b] of corners)
    handles.push({ grip: "size", at: without(shape, [a * half[0], b * half[1]]) });
  return handles;
}

/** The shape after a drag from one point to another. A box keeps the corner across from the one dragged. */
export function dragged(shape: Shape, grip: Grip, from: Point, to: Point): Shape {
  if (grip === "move") return { ...shape, x: shape.x + to[0] - from[0], y: shape.y + to[1] - from[1] };
  if (grip === "turn") return { ...shape, angle: rounded(Math.atan2(to[1] - shape.y, to[0] - shape.x)) };
  if (!shape.box)
    return { ...shape, radius: Math.max(SMALLEST, Math.hypot(to[0] - shape.x, to[1] - shape.y)) };
  const begin = within(shape, from);
  const sides: Point = [Math.sign(begin[0]) || 1, Math.sign(begin[1]) || 1];
  const fixed: Point = [(-sides[0] * shape.box[0]) / 2, (-sides[1] * shape.box[1]) / 2];
  const end = within(shape, to);
  const size: Point = [
    Math.max(SMALLEST, sides[0] * (end[0] - fixed[0])),
    Math.max(SMALLEST, sides[1] * (end[1] - fixed[1])),
  ];
  const [x, y] = without(shape, [fixed[0] + (sides[0] * size[0]) / 2, fixed[1] + (sides[1] * size[1]) / 2]);
  return { ...shape, x, y, box: size };
}

/** An angle near a multiple of 15° becomes that. */
function rounded(angle: number): number {
  const step = Math.PI / 12;
  const near = Math.round(angle / step) * step;
  return Math.abs(angle - near) < 0.06 ? near : angle;
}

/** The shape after a key: arrows move, with Shift resize, `[` and `]` turn; null for other keys. */
export function keyed(shape: Shape, key: string, resize: boolean): Shape | null {
  const step = 0.02;
  const ways: Record<string, Point> = {
    ArrowLeft: [-step, 0],
    ArrowRight: [step, 0],
    ArrowUp: [0, step],
    ArrowDown: [0, -step],
  };
  const way = ways[key];
  if (way && resize) {
    const larger = (length: number, by: number) => Math.max(SMALLEST, length + by);
    if (shape.box) return { ...shape, box: [larger(shape.box[0], way[0]), larger(shape.box[1], way[1])] };
    return { ...shape, radius: larger(shape.radius ?? 0, (way[0] + way[1]) / 2) };
  }
  if (way) return { ...shape, x: shape.x + way[0], y: shape.y + way[1] };
  if (key === "[" || key === "]")
    return { ...shape, angle: shape.angle + (key === "[" ? 1 : -1) * (Math.PI / 18) };
  return null;
}

/** The shape that a drag with a tool draws: a wall along it, a box between its ends, a zone around its start. */
export function drawn(tool: "wall" | "box" | "zone", [x, y]: Point, [tx, ty]: Point, steps = false): Shape {
  const length = Math.hypot(tx - x, ty - y);
  if (tool === "zone") return { x, y, angle: 0, radius: length < SMALLEST ? 0.25 : length };
  if (tool === "box") {
    const [width, height] = [Math.abs(tx - x), Math.abs(ty - y)];
    if (length < 2 * SMALLEST) return { x, y, angle: 0, box: [0.2, 0.2] };
    return {
      x: (x + tx) / 2,
      y: (y + ty) / 2,
      angle: 0,
      box: [Math.max(SMALLEST, width), Math.max(SMALLEST, height)],
    };
  }
  if (length < 2 * SMALLEST) return { x, y, angle: 0, box: [0.5, 0.04] };
  const exact = Math.atan2(ty - y, tx - x);
  const angle = steps ? Math.round(exact / (Math.PI / 12)) * (Math.PI / 12) : rounded(exact);
  return {
    x: x + (Math.cos(angle) * length) / 2,
    y: y + (Math.sin(angle) * length) / 2,
    angle,
    box: [length + 0.04, 0.04],
  };
}

/** Thousandths are enough for a person, and keep files short. */
export function poseOf({ x, y, angle }: Shape): Pose {
  return [thousandth(x), thousandth(y), thousandth(angle)];
}

/** A shape as the world's JSON has it. */
export function shaped(shape: Shape): { box: [number, number, number, number] } | { circle: Pose } {
  const [x, y] = poseOf(shape);
  if (!shape.box) return { circle: [x, y, thousandth(shape.radius ?? 0)] };
  return { box: [x, y, thousandth(shape.box[0]), thousandth(shape.box[1])] };
}

function thousandth(number: number): number {
  return Math.round(number * 1000) / 1000;
}
