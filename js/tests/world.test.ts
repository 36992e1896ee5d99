import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import type { Point, Pose, WorldView } from "../src/protocol";
import { complete } from "../src/world/complete";
import { trailStyles } from "../src/world/legend";
import { barLength, gripAt } from "../src/world/overlay";
import { between, firstPoses, poseBytes, readPoses } from "../src/world/poses";
import { paintRobot, paintSpeech, wrapped } from "../src/world/robot";
import {
  dragged,
  drawn,
  handlesOf,
  keyed,
  poseOf,
  type Shape,
  shaped,
  shapeOf,
  type Thing,
  thingAt,
  thingsOf,
} from "../src/world/things";
import { Trail, trailState } from "../src/world/trail";
import { SMALLEST_ROBOT, Viewport } from "../src/world/viewport";
import fc from "./laws";
import recording from "./page/recording.json";

const view: WorldView = {
  version: 1,
  size: [3, 2],
  seed: 0,
  floor: { strokes: [{ path: [[0, 0]] }] },
  solids: [
    { box: [2, 1, 0.1, 0.4], angle: 0 },
    { circle: [1, 0.5, 0.1], push: 0.3 },
  ],
  robots: [{ pose: [0.5, 1, 0] }],
  zones: {},
};
const world = complete(view);

function buffer(time: number, ...floats: number[]): DataView {
  const data = new DataView(new ArrayBuffer(8 + 4 * floats.length));
  data.setFloat64(0, time, true);
  floats.forEach((value, i) => data.setFloat32(8 + 4 * i, value, true));
  return data;
}

describe("a world's JSON", () => {
  it("is completed with defaults", () => {
    expect(world.floor).toEqual({ grey: 255, strokes: [{ path: [[0, 0]], width: 0.03, grey: 0 }] });
    expect(world.robots[0]).toEqual({
      pose: [0.5, 1, 0],
      name: "",
      radius: 0.08,
      light: [[0.06, 0]],
      bumper: true,
      distance: [[0, 2]],
    });
  });

  it("keeps its own values", () => {
    expect(complete({ ...view, robots: [{ pose: [0, 0, 0], light: [] }] }).robots[0]?.light).toEqual([]);
  });
});

const real = (min: number, max: number) => fc.double({ min, max, noNaN: true });
const place = real(-5, 5);
const angle = real(-Math.PI, Math.PI);
const side = real(0.03, 2);
const boxes = fc.record({ x: place, y: place, angle, box: fc.tuple(side, side) });
const discs = fc.record({ x: place, y: place, angle, radius: side });
const shape: fc.Arbitrary<Shape> = fc.oneof(boxes, discs);

type Solid = NonNullable<WorldView["solids"]>[number];

/** The point so far along the heading of a pose and to the left of it. */
function around({ x, y, angle }: Shape, along: number, aside: number): Point {
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  return [x + along * cos - aside * sin, y + along * sin + aside * cos];
}

function near(found: number[], wanted: number[]): void {
  expect(found).toHaveLength(wanted.length);
  found.forEach((number, i) => expect(number).toBeCloseTo(wanted[i]!, 6));
}

interface Written {
  x: number;
  y: number;
  size: number;
  text: string;
}

/** What is written by someone who paints. */
function writtenBy(paint: (c: never) => void): Written[] {
  const written: Written[] = [];
  const pen = { at: [0, 0] as Point, size: 0 };
  const notes: Record<string, (...given: never[]) => void> = {
    translate: (...point: Point) => void Object.assign(pen, { at: point }),
    scale: (factor: number) => void Object.assign(pen, { size: 12 * factor }),
    fillText: (text: string) => void written.push({ x: pen.at[0], y: pen.at[1], size: pen.size, text }),
  };
  const c = new Proxy({}, { get: (_, name) => notes[String(name)] ?? (() => {}), set: () => true });
  paint(c as never);
  return written;
}

const palette = { dim: false } as never;

/** What is written beside a robot with a light sensor. */
function writtenAt(pose: Pose, sensor: Point, value: number, pixels: number): Written {
  const shape = { ...world.robots[0]!, light: [sensor] };
  const robot = { ...firstPoses(world, null).robots[0]!, pose, lights: [value] };
  return writtenBy((c) => paintRobot({ c, palette, pixels }, world.size, shape, robot))[0]!;
}

it("a robot has the values of its light sensors beside it, and none on it", () => {
  const robots = fc.record({ angle, along: real(-0.1, 0.1), aside: real(-0.06, 0.06), value: fc.nat(255) });
  fc.assert(
    fc.property(robots, real(30, 500), ({ angle, along, aside, value }, pixels) => {
      const { x, y, size: high, text } = writtenAt([1, 1, angle], [along, aside], value, pixels);
      const beyond = (distance: number, half: number) => Math.max(0, Math.abs(distance) - half);
      const free = Math.hypot(beyond(x - 1, 0.32 * text.length * high), beyond(y - 1, 0.45 * high));
      expect(free).toBeGreaterThan(1.1 * world.robots[0]!.radius);
    }),
  );
});

it("the edge of the world cuts off no value of a light sensor", () => {
  const [width, height] = world.size;
  const walls = fc.record({
    angle,
    x: fc.constantFrom(0.1, width - 0.1),
    y: fc.constantFrom(0.1, height / 2),
  });
  fc.assert(
    fc.property(walls, real(100, 500), ({ angle, x, y }, pixels) => {
      const written = writtenAt([x, y, angle], [0.06, 0], 255, pixels);
      const half = 0.32 * 3 * written.size;
      expect(Math.abs(written.x - width / 2) + half).toBeLessThan(width / 2);
    }),
  );
});

it("what a robot says stands beside it within the world, line by line, wherever it is", () => {
  const [width, height] = world.size;
  const robots = fc.record({ x: real(0, width), y: real(0, height), text: fc.string({ minLength: 1 }) });
  fc.assert(
    fc.property(robots, real(150, 500), ({ x, y, text }, pixels) => {
      const [shape, robot] = [world.robots[0]!, { ...firstPoses(world, null).robots[0]!, pose: [x, y, 1] }];
      const lines = writtenBy((c) =>
        paintSpeech({ c, palette, pixels }, world.size, shape, robot as never, text),
      );
      expect(lines.map(({ text }) => text)).toEqual(wrapped(text));
      for (const line of lines) {
        expect(Math.abs(line.x - width / 2) + 0.3 * line.text.length * line.size).toBeLessThan(width / 2);
        expect(Math.abs(line.y - height / 2) + line.size / 2).toBeLessThan(height / 2);
        expect(Math.abs(line.y - y)).toBeGreaterThan(shape.radius);
      }
      lines.slice(1).forEach(({ y }, i) => expect(y).toBeLessThan(lines[i]!.y - lines[i]!.size));
    }),
  );
});

it("a text is wrapped without losing anything, unless it is too long", () => {
  fc.assert(
    fc.property(fc.lorem({ maxCount: 30 }), (text) => {
      const lines = wrapped(text);
      expect(lines.length).toBeLessThanOrEqual(4);
      for (const line of lines) expect(line.length).toBeLessThanOrEqual(24);
      if (lines.join(" ") === text) return;
      expect(text.length).toBeGreaterThan(48);
      expect(lines[3]).toMatch(/ …$/);
    }),
  );
  expect(wrapped(`It is ${"x".repeat(30)}`)).toEqual(["It is", "x".repeat(24), "x".repeat(6)]);
});

describe("poses", () => {
  it("are read: robots first, then what can be pushed; the rest is unchanged", () => {
    const now = readPoses(
      world,
      buffer(1.5, 0.5, 1, 0.25, 3, 0.125, 200, Number.POSITIVE_INFINITY, 1.5, 0.5, 0),
    )!;
    expect(now.time).toBe(1.5);
    expect(now.robots).toEqual([
      {
        pose: [0.5, 1, 0.25],
        bumper: true,
        pen: true,
        lamp: false,
        speed: 0.125,
        lights: [200],
        distances: [Number.POSITIVE_INFINITY],
      },
    ]);
    expect(now.solids).toEqual([
      [2, 1, 0],
      [1.5, 0.5, 0],
    ]);
  });

  it("also tell where what moves by itself is", () => {
    const solids: WorldView["solids"] = [
      { box: [2, 1, 0.1, 0.4], patrol: [[2, 1] as Point, [2, 1.5] as Point] },
      { box: [1, 1, 0.1, 0.1] },
    ];
    const now = readPoses(complete({ ...view, solids }), buffer(0, 0.5, 1, 0, 0, 0, 255, 1, 2, 1.25, 0))!;
    expect(now.solids).toEqual([
      [2, 1.25, 0],
      [1, 1, 0],
    ]);
  });

  it.each([
    [0, false, false, false],
    [1, true, false, false],
    [2, false, true, false],
    [4, false, false, true],
  ])("have the flags %i for bumper %s, pen %s and lamp %s", (flags, bumper, pen, lamp) => {
    const now = readPoses(world, buffer(1.5, 0.5, 1, 0.25, flags, 0.125, 200, 1, 1.5, 0.5, 0))!;
    expect(now.robots[0]).toMatchObject({ bumper, pen, lamp });
  });

  it("need 36 bytes for one robot", () => {
    expect(poseBytes({ ...world, solids: [] })).toBe(36);
  });

  it("are read for every robot of a world", () => {
    const two = complete({ ...view, solids: [], robots: [...view.robots, { pose: [1, 1, 0], light: [] }] });
    const now = readPoses(two, buffer(0, 0.5, 1, 0, 0, 0, 200, 1.5, 1.25, 1, 0.5, 1, 0.25, 0.75))!;
    expect(now.robots.map(({ pose }) => pose)).toEqual([
      [0.5, 1, 0],
      [1.25, 1, 0.5],
    ]);
    expect(now.robots.map(({ bumper, distances }) => [bumper, ...distances])).toEqual([
      [false, 1.5],
      [true, 0.75],
    ]);
  });

  it("of another world are not read", () => {
    expect(readPoses(world, buffer(0, 1, 2, 3))).toBeNull();
  });

  it("as the kernel packs them fit the world as the kernel describes it", () => {
    const real = complete(recording.snapshot.world as unknown as WorldView);
    const bytes = Uint8Array.from(atob(recording.frames[0]!.poses), (char) => char.charCodeAt(0));
    expect(readPoses(real, new DataView(bytes.buffer))?.robots).toHaveLength(1);
  });

  it("between two pictures are in proportion, and turn the short way round", () => {
    const some = fc.record({ x: place, y: place, angle, way: real(-0.17, 0.17), aside: real(-0.17, 0.17) });
    fc.assert(
      fc.property(some, real(-3, 3), real(0, 1), ({ x, y, angle, way, aside }, turn, share) => {
        const [a, b] = [firstPoses(world), firstPoses(world)];
        a.robots[0]!.pose = [x, y, angle];
        b.robots[0]!.pose = [x + way, y + aside, angle + turn + 2 * Math.PI];
        near(between(a, b, share).robots[0]!.pose, [
          x + share * way,
          y + share * aside,
          angle + share * turn,
        ]);
      }),
    );
  });

  it("jump where the robot was put, instead of gliding", () => {
    const [a, b] = [firstPoses(world), firstPoses(world)];
    b.robots[0]!.pose = [2.5, 1, 0];
    expect(between(a, b, 0.5).robots[0]!.pose[0]).toBe(2.5);
  });
});

describe("the pointer", () => {
  const now = firstPoses(world);
  const shown = (thing: Thing) => shapeOf(world, now, thing);

  it("finds the robot before what is below it", () => {
    expect(thingAt(world, shown, [0.52, 1.02], 0.02)).toEqual({ kind: "robot", index: 0 });
  });

  it("finds what it is on, however that is turned, thin things within the grip", () => {
    fc.assert(
      fc.property(shape, real(0, 0.05), real(-2, 2), real(-2, 2), (shape, grip, u, v) => {
        const { x, y, angle, box, radius = 0 } = shape;
        const [along, aside] = box ? [(u * box[0]) / 2, (v * box[1]) / 2] : [u * radius, v * radius];
        const beyond = box
          ? Math.max(Math.abs(along) - box[0] / 2, Math.abs(aside) - box[1] / 2)
          : Math.hypot(along, aside) - radius;
        fc.pre(Math.abs(beyond - grip) > 1e-6);
        const solid: Solid = box ? { box: [0, 0, ...box] } : { circle: [0, 0, radius] };
        const two = complete({ ...view, solids: [{ circle: [99, 99, 1] }, solid], robots: [] });
        const now = { ...firstPoses(two), solids: [[99, 99, 0] as Pose, [x, y, angle] as Pose] };
        const found = thingAt(two, (thing) => shapeOf(two, now, thing), around(shape, along, aside), grip);
        expect(found).toEqual(beyond < grip ? { kind: "solid", index: 1 } : null);
      }),
    );
  });

  it("finds the start once the robot has left it", () => {
    const away = { ...now, robots: [{ ...now.robots[0]!, pose: [1.5, 1.5, 0] as Pose }] };
    expect(thingAt(world, (thing) => shapeOf(world, away, thing), [0.5, 1], 0)).toEqual({
      kind: "start",
      index: 0,
    });
  });

  it("catches a zone at its rim, so that what is inside of it stays within reach", () => {
    const zoned = { ...world, zones: { goal: { circle: [1, 1.5, 0.3] as Pose } } };
    const shown = (thing: Thing) => shapeOf(zoned, now, thing);
    expect(thingAt(zoned, shown, [1.3, 1.5], 0.02)).toEqual({ kind: "zone", name: "goal" });
    expect(thingAt(zoned, shown, [1, 1.5], 0.02)).toBeNull();
  });

  it("catches the handles of what is selected", () => {
    const wall: Thing = { kind: "solid", index: 0 };
    const shape = shapeOf(world, now, wall)!;
    expect(gripAt(wall, shape, [2.05, 1.2], 200)?.grip).toBe("size");
    expect(gripAt(wall, shape, [2.05 + 22 / 200, 1], 200)?.grip).toBe("turn");
    expect(gripAt(wall, shape, [2, 1], 200)).toBeNull();
  });
});

describe("a drag", () => {
  const box: Shape = { x: 1, y: 1, angle: Math.PI / 2, box: [0.4, 0.2] };

  it("moves by the way of the pointer", () => {
    expect(dragged(box, "move", [1, 1], [1.5, 0.75])).toEqual({ ...box, x: 1.5, y: 0.75 });
  });

  it("at a corner keeps the corner across, and brings this one to the pointer", () => {
    fc.assert(
      fc.property(boxes, fc.nat(3), real(-0.1, 1), real(-0.1, 1), (shape, corner, wider, higher) => {
        const [width, height] = shape.box;
        const handles = handlesOf({ kind: "solid", index: 0 }, shape, 100);
        const from = handles.filter(({ grip }) => grip === "size")[corner]!.at;
        const [a, b] = [corner < 2 ? 1 : -1, corner % 2 ? -1 : 1];
        near(from, around(shape, (a * width) / 2, (b * height) / 2));
        const fixed = around(shape, (-a * width) / 2, (-b * height) / 2);
        const to = around(shape, a * (width / 2 + wider), b * (height / 2 + higher));
        const next = dragged(shape, "size", from, to);
        near(next.box!, [Math.max(0.03, width + wider), Math.max(0.03, height + higher)]);
        near(around(next, (-a * next.box![0]) / 2, (-b * next.box![1]) / 2), fixed);
      }),
    );
  });

  it("never makes a thing so small that it cannot be caught", () => {
    expect(dragged(box, "size", [0.9, 1.2], [3, -3]).box!.every((length) => length >= 0.03)).toBe(true);
    expect(dragged({ x: 0, y: 0, angle: 0, radius: 1 }, "size", [1, 0], [0, 0]).radius).toBeGreaterThan(0);
  });

  it("turns towards the pointer, exactly where that is near a round angle", () => {
    expect(dragged(box, "turn", [1, 1.3], [1.02, 2]).angle).toBe(Math.PI / 2);
    expect(dragged(box, "turn", [1, 1.3], [1 + Math.cos(0.4), 1 + Math.sin(0.4)]).angle).toBeCloseTo(0.4);
  });

  it("draws walls along it, boxes across it, zones around its start", () => {
    fc.assert(
      fc.property(place, place, angle, real(0.1, 2), (x, y, angle, length) => {
        const to = around({ x, y, angle }, length, 0);
        const wall = drawn("wall", [x, y], to);
        near([wall.x - x, wall.y - y], around({ x: 0, y: 0, angle: wall.angle }, length / 2, 0));
        near(wall.box!, [length + 0.04, 0.04]);
        expect(Math.cos(wall.angle - angle)).toBeGreaterThan(Math.cos(0.06));
        const box = drawn("box", [x, y], to);
        near([box.x, box.y, box.angle], [(x + to[0]) / 2, (y + to[1]) / 2, 0]);
        near(box.box!, [Math.max(0.03, Math.abs(to[0] - x)), Math.max(0.03, Math.abs(to[1] - y))]);
        const zone = drawn("zone", [x, y], to);
        near([zone.x, zone.y, zone.radius!], [x, y, length]);
      }),
    );
  });

  it("that is a click draws something of a usual size", () => {
    for (const tool of ["wall", "box", "zone"] as const) {
      const { box: size, radius } = drawn(tool, [1, 1], [1, 1]);
      expect(Math.max(...(size ?? [radius!]))).toBeGreaterThan(0.1);
    }
  });
});

describe("keys", () => {
  const robot: Shape = { x: 1, y: 1, angle: 0, radius: 0.08 };

  it("move and turn", () => {
    expect(keyed(robot, "ArrowLeft", false)).toMatchObject({ x: 0.98, y: 1 });
    expect(keyed(robot, "[", false)!.angle).toBeGreaterThan(0);
    expect(keyed(robot, "]", false)!.angle).toBeLessThan(0);
    expect(keyed(robot, "x", false)).toBeNull();
  });

  it("resize with Shift", () => {
    expect(keyed({ ...robot, box: [0.2, 0.2] }, "ArrowRight", true)!.box![0]).toBeCloseTo(0.22);
    expect(keyed(robot, "ArrowDown", true)!.radius).toBeLessThan(0.08);
  });

  it("reach everything, one after the other", () => {
    expect(thingsOf({ ...world, zones: { goal: { circle: [1, 1, 0.2] } } })).toEqual([
      { kind: "robot", index: 0 },
      { kind: "start", index: 0 },
      { kind: "solid", index: 1 },
      { kind: "solid", index: 0 },
      { kind: "zone", name: "goal" },
    ]);
  });
});

it("what is placed is written in thousandths", () => {
  const shape: Shape = { x: 1.00049, y: 2.12345, angle: 0.33333, box: [0.1 + 0.2, 0.5] };
  expect(poseOf(shape)).toEqual([1, 2.123, 0.333]);
  expect(shaped(shape)).toEqual({ box: [1, 2.123, 0.3, 0.5] });
  expect(shaped({ x: 1, y: 1, angle: 0, radius: 0.25 })).toEqual({ circle: [1, 1, 0.25] });
});

describe("the trail", () => {
  function driven(...states: string[]): Trail {
    const trail = new Trail();
    states.forEach((state, i) => trail.add(i, [i * 0.1, 0, 0], state));
    return trail;
  }

  it("fades over ten seconds, and what is older stays", () => {
    const trail = driven(...Array.from({ length: 30 }, () => "m/a"));
    const pieces = trail.pieces(29);
    expect(pieces).toHaveLength(10);
    expect(pieces[0]!.share).toBeCloseTo(0.1);
    expect(pieces.at(-1)!.share).toBe(1);
    expect(trail.points).toHaveLength(30);
    expect([...trail.lines(1, trail.after(19))].map(([state, lines]) => [state, lines.length])).toEqual([
      ["m/a", 1],
    ]);
  });

  it("is kept for ten minutes, in bounded memory, on the same way", () => {
    const trail = new Trail();
    const place = (time: number): [number, number, number] => [Math.cos(0.3 * time), Math.sin(0.3 * time), 0];
    for (let i = 0; i < 30_000; i++)
      trail.add(i / 30, place(i / 30), Math.floor(i / 300) % 2 ? "m/a" : "m/b");
    expect(trail.points.length).toBeLessThanOrEqual(6000);
    expect(trail.points[0]!.time).toBeGreaterThan(395);
    expect(trail.points[0]!.time).toBeLessThanOrEqual(400.1);
    trail.points.forEach((point, i) => {
      const before = trail.points[i - 1];
      if (before) expect(Math.hypot(point.x - before.x, point.y - before.y)).toBeLessThan(0.25);
    });
    const near = trail.near(...(place(990).slice(0, 2) as [number, number]), 0.05)!;
    expect(near.time).toBeGreaterThan(970);
    expect(trail.pieces(999.9).length).toBeGreaterThan(250); // what fades is as fine as ever
  });

  it("keeps the times at which the robot came and left where it stood", () => {
    const trail = new Trail();
    trail.add(0, [0, 0, 0], "m/a");
    trail.add(1, [0.1, 0, 0], "m/a");
    for (let time = 2; time <= 50; time++) trail.add(time, [0.1, 0, 0], "m/a");
    trail.add(51, [0.2, 0, 0], "m/a");
    expect(trail.points.map(({ time }) => time)).toEqual([0, 1, 50, 51]);
    expect(trail.near(0.15, 0, 0.01)!.time).toBeCloseTo(50.5);
  });

  it("shows the states in it, each piece in the state of its end", () => {
    const trail = driven("m/a", "m/a", "m/b");
    expect(trail.pieces(2).map(({ to }) => to.state)).toEqual(["m/a", "m/b"]);
    expect(trail.states(2)).toEqual(["m/a", "m/b"]);
    expect(trail.near(0.15, 0.01, 0.02)).toEqual({ state: "m/b", time: expect.closeTo(1.5) });
    expect(trail.near(0.15, 0.5, 0.02)).toBeNull();
  });

  it("is shortened by stepping back, and interrupted where the robot was put elsewhere", () => {
    const trail = driven("m/a", "m/a", "m/a");
    trail.add(0.5, [0.05, 0, 0], "m/a");
    expect(trail.points.map(({ time }) => time)).toEqual([0, 0.5]);
    trail.add(1, [2, 1, 0], "m/a");
    expect(trail.pieces(1)).toHaveLength(1);
  });

  it("is in the state that is active inside of all others", () => {
    expect(trailState(["m/a/inner/x", "n/b"], {})).toBe("m/a/inner/x");
    expect(trailState([], {})).toBe("");
  });

  it("is in a state of a machine that is written elsewhere, unless several states spawn it", () => {
    const uses = (machine: string, ...spawns: string[]) => ({
      states: [{ id: `${machine}/s`, machines: [], spawns: spawns.map((each) => ({ machine: each })) }],
    });
    const layouts = (...used: ReturnType<typeof uses>[]) =>
      Object.fromEntries(used.map((each) => [each.states[0]!.id.split("/")[0], each])) as never;
    const active = ["m/s/part/s/move/go", "n/s/move/go"];
    expect(trailState(active, layouts(uses("m", "part"), uses("part", "move")))).toBe("move/go");
    const shared = layouts(uses("m", "part"), uses("part", "move"), uses("n", "move"));
    expect(trailState(active, shared)).toBe("part/s");
  });

  it("has a colour for every state, those that come again have a dash, those with machines in them stripes", () => {
    const states = ["a", "b", "c"].map((name) => ({ path: `m/${name}`, machines: [] as string[] }));
    states.unshift({ path: "m/outer", machines: ["m/outer/n"] });
    const machine = { path: "m", parent: null, states, transitions: [], variables: [], events: [] };
    const style = trailStyles({ variables: [], events: [], machines: [machine], main: "m" }, ["red", "blue"]);
    expect(style("m/a")).toEqual({ color: "red", dash: [] });
    expect(style("m/b")).toEqual({ color: "blue", dash: [] });
    expect(style("m/c").color).toBe("red");
    expect(style("m/c").dash.length).toBeGreaterThan(0);
    expect(style("m/outer").color).toBe("blue"); // after all others
    expect(style("m/outer").dash).not.toEqual(style("m/c").dash);
  });

  it("has other styles for states of another program than for those of this one", () => {
    const states = [{ path: "m/a", machines: [] }];
    const machine = { path: "m", parent: null, states, transitions: [], variables: [], events: [] };
    const style = trailStyles({ variables: [], events: [], machines: [machine], main: "m" }, [
      "red",
      "blue",
      "green",
    ]);
    expect(["m/gone", "m/a", "m/new", "m/gone"].map((state) => style(state).color)).toEqual([
      "blue",
      "red",
      "green",
      "blue",
    ]);
  });

  it("has the same styles wherever a program is drawn, whatever is seen first there", () => {
    const states = [{ path: "m/a", machines: [] }];
    const machine = { path: "m", parent: null, states, transitions: [], variables: [], events: [] };
    const program = { variables: [], events: [], machines: [machine], main: "m" };
    const [trail, timeline] = [trailStyles(program, ["r", "g", "b"]), trailStyles(program, ["R", "G", "B"])];
    expect(["m/old", "m/older"].map((state) => trail(state).color)).toEqual(["g", "b"]);
    expect(["m/older", "m/old", "m/a"].map((state) => timeline(state).color)).toEqual(["B", "G", "R"]);
  });
});

/** Linear RGB, as seen without one kind of cones. Machado, Oliveira and Fernandes 2009, severity 1. */
const VISIONS = {
  usual: [1, 0, 0, 0, 1, 0, 0, 0, 1],
  "without red": [
    0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998,
  ],
  "without green": [0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.01182, 0.04294, 0.968881],
  "without blue": [1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.3039],
};

/** CIE L*a*b* of a colour, seen through a matrix. */
function lab(hex: string, matrix: number[]): number[] {
  const linear = [1, 3, 5].map((at) => {
    const share = Number.parseInt(hex.slice(at, at + 2), 16) / 255;
    return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
  });
  const times = (rows: number[], v: number[]) =>
    [0, 3, 6].map((row) => rows[row]! * v[0]! + rows[row + 1]! * v[1]! + rows[row + 2]! * v[2]!);
  const seen = times(matrix, linear).map((value) => Math.min(1, Math.max(0, value)));
  const toXyz = [0.4339, 0.3762, 0.1899, 0.2126, 0.7152, 0.0722, 0.0178, 0.1098, 0.8725]; // of white: 1 1 1
  const [x = 0, y = 0, z = 0] = times(toXyz, seen).map((t) =>
    t > 0.00886 ? Math.cbrt(t) : 7.787 * t + 16 / 116,
  );
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

it.each(Object.entries(VISIONS))("the colours of the trail are told apart with %s vision", (_, matrix) => {
  const css = readFileSync(new URL("../src/style/tokens.css", import.meta.url), "utf-8");
  const colors = [...css.matchAll(/--lrp-world-trail-\d: (#\w{6})/g)].map(([, hex]) => lab(hex!, matrix));
  const floor = lab("#ffffff", matrix);
  expect(colors).toHaveLength(8);
  const away = (a: number[], b: number[]) => Math.hypot(...a.map((value, i) => value - b[i]!));
  for (const [i, color] of colors.entries()) {
    expect(away(color, floor)).toBeGreaterThan(25);
    for (const other of colors.slice(0, i)) expect(away(color, other)).toBeGreaterThan(10);
  }
});

describe("what is shown", () => {
  const size: Point = [3, 2];
  const room = (width: number, height: number, at: Point = [0.5, 1]) => {
    const viewport = new Viewport(() => 0.08);
    viewport.resize(width, height, size, at);
    return viewport;
  };

  it("is all of the world where the robot is large enough in it", () => {
    const viewport = room(1000, 800);
    expect(viewport.follow).toBe(false);
    expect(viewport.outside([0, 0])[0]).toBeGreaterThan(0);
    expect(viewport.outside([3, 2])[0]).toBeLessThan(1000);
    expect(viewport.outside([3, 2])[1]).toBeGreaterThan(0);
  });

  it("is the surroundings of the robot where it would be too small to be seen", () => {
    const viewport = room(300, 300);
    expect(0.16 * viewport.scale).toBeCloseTo(SMALLEST_ROBOT);
    expect(viewport.follow).toBe(true);
    const [x] = viewport.outside([0.5, 1]);
    expect(x).toBeGreaterThan(0);
    expect(viewport.keepInSight([2.9, 1], size)).toBe(true);
    expect(viewport.outside([2.9, 1])[0]).toBeLessThan(300);
    expect(viewport.keepInSight([2.9, 1], size)).toBe(false);
  });

  it("keeps the point under the pointer when it is magnified", () => {
    const viewport = room(1000, 800);
    const point = viewport.inside(700, 200);
    viewport.zoom(2, size, 700, 200);
    expect(viewport.outside(point)[0]).toBeCloseTo(700);
    expect(viewport.outside(point)[1]).toBeCloseTo(200);
  });

  it("is magnified when the robot is followed, and all again when that is wanted", () => {
    const viewport = room(1000, 800);
    const { scale } = viewport;
    viewport.begin([0.5, 1], size);
    expect(viewport.scale).toBeCloseTo(2 * scale);
    viewport.showAll(size);
    expect(viewport.scale).toBeCloseTo(scale);
    expect(viewport.follow).toBe(false);
  });

  it("is the surroundings of the robot from the beginning where the user once chose that", () => {
    const viewport = new Viewport(() => 0.08);
    viewport.alwaysFollows = true;
    viewport.resize(1000, 800, size, [0.5, 1]);
    expect(viewport.follow).toBe(true);
    expect(viewport.scale).toBeCloseTo(2 * room(1000, 800).scale);
  });

  it.each([20, 57, 150, 333, 1200])("has a bar of a round length at %i px per metre", (pixels) => {
    const length = barLength(pixels);
    expect(length * pixels).toBeGreaterThanOrEqual(40);
    expect(length * pixels).toBeLessThanOrEqual(100);
    expect(["1", "2", "5"]).toContain(length.toExponential()[0]);
  });
});
