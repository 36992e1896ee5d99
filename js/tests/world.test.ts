import { describe, expect, it } from "vitest";
import type { WorldView } from "../src/protocol";
import { complete } from "../src/world/complete";
import { between, firstPoses, poseBytes, readPoses } from "../src/world/poses";
import { nudged, targetAt } from "../src/world/tools";
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

  it.each([
    [0, false, false],
    [1, true, false],
    [2, false, true],
  ])("have the flags %i for bumper %s and pen %s", (flags, bumper, pen) => {
    const now = readPoses(world, buffer(1.5, 0.5, 1, 0.25, flags, 0.125, 200, 1, 1.5, 0.5, 0))!;
    expect(now.robots[0]).toMatchObject({ bumper, pen });
  });

  it("need 36 bytes for one robot", () => {
    expect(poseBytes({ ...world, solids: [] })).toBe(36);
  });

  it("of another world are not read", () => {
    expect(readPoses(world, buffer(0, 1, 2, 3))).toBeNull();
  });

  it("as the kernel packs them fit the world as the kernel describes it", () => {
    const real = complete(recording.snapshot.world as unknown as WorldView);
    const bytes = Uint8Array.from(atob(recording.frames[0]!.poses), (char) => char.charCodeAt(0));
    expect(readPoses(real, new DataView(bytes.buffer))?.robots).toHaveLength(1);
  });

  it("turn the short way round between two pictures", () => {
    const [a, b] = [firstPoses(world), firstPoses(world)];
    a.robots[0]!.pose = [0, 0, 3.1];
    b.robots[0]!.pose = [0.1, 0, -3.1];
    const [x, , theta] = between(a, b, 0.5).robots[0]!.pose;
    expect(x).toBeCloseTo(0.05);
    expect(Math.abs(theta)).toBeGreaterThan(3.1);
  });

  it("jump where the robot was put, instead of gliding", () => {
    const [a, b] = [firstPoses(world), firstPoses(world)];
    b.robots[0]!.pose = [2.5, 1, 0];
    expect(between(a, b, 0.5).robots[0]!.pose[0]).toBe(2.5);
  });
});

describe("the pointer", () => {
  const now = firstPoses(world);

  it("finds the robot before what is below it", () => {
    expect(targetAt(world, now, [0.52, 1.02])).toMatchObject({ do: "drag_robot", index: 0 });
  });

  it("finds walls and round things", () => {
    expect(targetAt(world, now, [2.03, 1.15])).toMatchObject({ do: "drag_solid", index: 0 });
    expect(targetAt(world, now, [1.05, 0.5])).toMatchObject({ do: "drag_solid", index: 1 });
  });

  it("finds a turned wall at its present place", () => {
    const turned = { ...now, solids: [[2, 1, Math.PI / 2], now.solids[1]] } as typeof now;
    expect(targetAt(world, turned, [2.15, 1])).toMatchObject({ index: 0 });
    expect(targetAt(world, turned, [2, 1.15])).toBeNull();
  });
});

it("keys move and turn the robot", () => {
  expect(nudged([1, 1, 0], "ArrowLeft")).toEqual([0.98, 1, 0]);
  expect(nudged([1, 1, 0], "[")?.[2]).toBeGreaterThan(0);
  expect(nudged([1, 1, 0], "x")).toBeNull();
});
