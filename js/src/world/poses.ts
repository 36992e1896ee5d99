/** The buffer of a `Frame` message, written by `pack_poses` in `lrp_jupyter/widgets/views/world_state.py`. */

import type { Pose, SolidView } from "../protocol";
import type { FullWorld } from "./complete";

export interface RobotPose {
  pose: Pose;
  bumper: boolean;
  pen: boolean;
  lamp: boolean;
  speed: number;
  lights: number[];
  distances: number[];
}

export interface Snapshot {
  time: number;
  robots: RobotPose[];
  /** Of every solid of the world, including fixed ones. */
  solids: Pose[];
}

/** Whether a solid can be elsewhere in the next frame: it can be pushed, or moves by itself. */
const canMove = ({ push, patrol }: SolidView) => typeof push === "number" || patrol !== undefined;

export function poseBytes(world: FullWorld): number {
  let floats = 0;
  for (const { light, distance } of world.robots) floats += 5 + light.length + distance.length;
  floats += 3 * world.solids.filter(canMove).length;
  return 8 + 4 * floats;
}

/** Read a buffer; null if it is of another world (a frame may overtake the world's description). */
export function readPoses(world: FullWorld, buffer: DataView): Snapshot | null {
  if (buffer.byteLength !== poseBytes(world)) return null;
  let at = 8;
  const next = () => {
    at += 4;
    return buffer.getFloat32(at - 4, true);
  };
  const pose = (): Pose => [next(), next(), next()];
  const robots = world.robots.map(({ light, distance }) => {
    const place = pose();
    const flags = next();
    const speed = next();
    const [lights, distances] = [light.map(next), distance.map(next)];
    const [bumper, pen, lamp] = [1, 2, 4].map((bit) => (flags & bit) !== 0) as [boolean, boolean, boolean];
    return { pose: place, bumper, pen, lamp, speed, lights, distances };
  });
  const standing = standingPoses(world);
  const solids = world.solids.map((solid, i) => (canMove(solid) ? pose() : standing[i]!));
  return { time: buffer.getFloat64(0, true), robots, solids };
}

function standingPoses(world: FullWorld): Pose[] {
  return world.solids.map(({ box, circle, angle = 0 }) => {
    const [x = 0, y = 0] = box ?? circle ?? [];
    return [x, y, angle];
  });
}

/** A world as it is described, before the first poses come; robots stay where they were seen `last`. */
export function firstPoses(world: FullWorld, last: Snapshot | null = null): Snapshot {
  const known = last?.robots.length === world.robots.length ? last : null;
  const robots = world.robots.map(({ pose, light, distance }) => ({
    pose,
    bumper: false,
    pen: false,
    lamp: false,
    speed: 0,
    lights: light.map(() => Number.NaN),
    distances: distance.map(() => Number.POSITIVE_INFINITY),
  }));
  return { time: known?.time ?? 0, robots: known?.robots ?? robots, solids: standingPoses(world) };
}

/** Between two poses, `share` of the way from the first to the second; a turn is the shorter one. */
export function mixed(from: Pose, to: Pose, share: number): Pose {
  const turn = Math.atan2(Math.sin(to[2] - from[2]), Math.cos(to[2] - from[2]));
  return [from[0] + (to[0] - from[0]) * share, from[1] + (to[1] - from[1]) * share, from[2] + turn * share];
}

const JUMP = 0.25; // metres between two frames: put there, not driven

/** Between two snapshots, `share` of the way from the first to the second. */
export function between(a: Snapshot, b: Snapshot, share: number): Snapshot {
  const mix = (from: Pose | undefined, to: Pose): Pose =>
    from && Math.hypot(to[0] - from[0], to[1] - from[1]) <= JUMP ? mixed(from, to, share) : to;
  return {
    time: b.time,
    robots: b.robots.map((robot, i) => ({ ...robot, pose: mix(a.robots[i]?.pose, robot.pose) })),
    solids: b.solids.map((pose, i) => mix(a.solids[i], pose)),
  };
}
