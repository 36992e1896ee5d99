/** Where the robot has been, coloured by the state that was active there. */

import { machinesIn, statesOn } from "../graph/inside";
import { parentOf } from "../language/paths";
import type { Layout, Pose } from "../protocol";

/** What is at most so old fades; what is older stays as a faint line. */
export const FADES = 10; // s
const KEPT = 600; // s
const MOST = 6000; // points
const JUMP = 0.25; // metres between two points: it was put there, not driven
const STILL = 0.002; // metres
const RESTED = 0.5; // s

/** A point of the trail: when, where, in which state (its path); `apart`: it was put there, not driven. */
export interface TrailPoint {
  time: number;
  x: number;
  y: number;
  state: string;
  apart: boolean;
}

export class Trail {
  points: TrailPoint[] = [];
  /** Until when the robot has been at the last point. */
  private until = 0;

  add(time: number, [x, y]: Pose, state: string): void {
    const { points } = this;
    while (points.length && points.at(-1)!.time >= time) points.pop(); // stepped back
    const last = points.at(-1);
    const way = last ? Math.hypot(x - last.x, y - last.y) : 0;
    if (!last || last.state !== state || way > STILL) {
      if (last && this.until < time && this.until - last.time > RESTED)
        points.push({ ...last, time: this.until, apart: false });
      points.push({ time, x, y, state, apart: way > JUMP });
    }
    this.until = time;
    if (points.length <= MOST && points[0]!.time > time - KEPT) return;
    const old = this.after(time - KEPT);
    if (old > 1) points.splice(0, old - 1); // the line to the first one begins before
    if (points.length > MOST) this.points = thinned(points, time - FADES);
  }

  clear(): void {
    this.points = [];
  }

  /** The index of the first point that is later than a time. */
  after(time: number): number {
    let [low, high] = [0, this.points.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.points[middle]!.time > time) high = middle;
      else low = middle + 1;
    }
    return low;
  }

  /**
   * The pieces between two points that fade at a time, each in the state of its end; `share` is 1 for a new
   * one, 0 for the oldest.
   */
  pieces(now: number): { from: TrailPoint; to: TrailPoint; share: number }[] {
    const pieces = [];
    const end = this.after(now);
    for (let i = Math.max(1, this.after(now - FADES)); i < end; i++) {
      const [from, to] = [this.points[i - 1]!, this.points[i]!];
      const share = 1 - (now - to.time) / FADES;
      if (share > 0 && !to.apart) pieces.push({ from, to, share });
    }
    return pieces;
  }

  /** The states in which the robot was between two points, each with its lines, of more points where they join. */
  lines(first: number, end: number): Map<string, TrailPoint[][]> {
    const lines = new Map<string, TrailPoint[][]>();
    let line: TrailPoint[] = [];
    for (let i = Math.max(1, first); i < end; i++) {
      const [from, to] = [this.points[i - 1]!, this.points[i]!];
      if (to.apart) continue;
      if (line.at(-1) !== from || line[1]!.state !== to.state) {
        line = [from];
        const others = lines.get(to.state);
        if (others) others.push(line);
        else lines.set(to.state, [line]);
      }
      line.push(to);
    }
    return lines;
  }

  /** The states of the pieces that fade, in the order in which they were active first. */
  states(now: number): string[] {
    return [...new Set(this.pieces(now).map(({ to }) => to.state))];
  }

  /** When and in which state the robot was next to a place, at most `reach` metres away; the last time of several. */
  near(x: number, y: number, reach: number): { time: number; state: string } | null {
    let best: { time: number; state: string } | null = null;
    let least = reach;
    for (let i = 1; i < this.points.length; i++) {
      const [from, to] = [this.points[i - 1]!, this.points[i]!];
      if (to.apart) continue;
      const [dx, dy] = [to.x - from.x, to.y - from.y];
      const along = ((x - from.x) * dx + (y - from.y) * dy) / (dx * dx + dy * dy || 1);
      const share = Math.min(1, Math.max(0, along));
      const away = Math.hypot(x - from.x - share * dx, y - from.y - share * dy);
      if (away > least) continue;
      least = away;
      best = { time: from.time + share * (to.time - from.time), state: to.state };
    }
    return best;
  }
}

/** Half as many points at most, farther apart the more there are; what is later than `recent` stays as it is. */
function thinned(points: readonly TrailPoint[], recent: number): TrailPoint[] {
  let kept: TrailPoint[] = [];
  for (let spacing = 2 * STILL; spacing < 1; spacing *= 2) {
    kept = [];
    points.forEach((point, i) => {
      const [last, next] = [kept.at(-1), points[i + 1]];
      const isEnd = !next || next.state !== point.state || next.apart || point.apart || isAt(next, point);
      if (isEnd || point.time > recent || !last || isAt(last, point) || distance(last, point) > spacing)
        kept.push(point);
    });
    if (kept.length <= MOST / 2) return kept;
  }
  return kept.slice(-MOST / 2);
}

const distance = (a: TrailPoint, b: TrailPoint) => Math.hypot(b.x - a.x, b.y - a.y);
const isAt = (a: TrailPoint, b: TrailPoint) => a.x === b.x && a.y === b.y;

/**
 * The state whose colour the trail gets: the innermost active one of the first machine, outside of machines that
 * several states spawn, whose states would not tell why the robot is where it is.
 */
export function trailState(active: readonly string[], layouts: Record<string, Layout>): string {
  const states = statesOn(active[0] ?? "", layouts);
  const spawned =
    states.length < 2 ? [] : Object.values(layouts).flatMap((layout) => layout.states.flatMap(machinesIn));
  const isShared = (path: string) => spawned.filter((each) => each === parentOf(path)).length > 1;
  const end = states.findIndex((path, index) => index > 0 && isShared(path));
  return states.at(end < 0 ? -1 : end - 1) ?? "";
}
