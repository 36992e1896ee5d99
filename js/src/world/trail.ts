/** Where the robot has been in the last seconds, coloured by the state that was active there. */

import type { Pose } from "../protocol";

const SECONDS = 10;
const JUMP = 0.25; // metres between two points: it was put there, not driven
const STILL = 0.002; // metres

/** A point of the trail: when, where, in which state (its path). */
export interface TrailPoint {
  time: number;
  x: number;
  y: number;
  state: string;
}

export class Trail {
  points: TrailPoint[] = [];

  add(time: number, [x, y]: Pose, state: string): void {
    const { points } = this;
    while (points.length && points.at(-1)!.time >= time) points.pop(); // stepped back
    const last = points.at(-1);
    if (!last || last.state !== state || Math.hypot(x - last.x, y - last.y) > STILL)
      points.push({ time, x, y, state });
    const old = points.findIndex((point) => point.time > time - SECONDS);
    if (old > 1) points.splice(0, old - 1); // the line to the first one begins before
  }

  clear(): void {
    this.points = [];
  }

  /** The pieces between two points, each in the state of its end; `share` is 1 for a new one, 0 for the oldest. */
  pieces(now: number): { from: TrailPoint; to: TrailPoint; share: number }[] {
    const pieces = [];
    for (let i = 1; i < this.points.length; i++) {
      const [from, to] = [this.points[i - 1]!, this.points[i]!];
      const share = 1 - (now - to.time) / SECONDS;
      if (share > 0 && Math.hypot(to.x - from.x, to.y - from.y) <= JUMP) pieces.push({ from, to, share });
    }
    return pieces;
  }

  /** The states that can be seen in the trail, in the order in which they were active first. */
  states(now: number): string[] {
    return [...new Set(this.pieces(now).map(({ to }) => to.state))];
  }

  /** The point of the trail next to a place, at most `reach` metres away. */
  near(x: number, y: number, reach: number, now: number): TrailPoint | null {
    let best: TrailPoint | null = null;
    let least = reach;
    for (const { from, to } of this.pieces(now)) {
      const [dx, dy] = [to.x - from.x, to.y - from.y];
      const along = ((x - from.x) * dx + (y - from.y) * dy) / (dx * dx + dy * dy || 1);
      const share = Math.min(1, Math.max(0, along));
      const away = Math.hypot(x - from.x - share * dx, y - from.y - share * dy);
      if (away <= least) [best, least] = [to, away];
    }
    return best;
  }
}

/** The state whose colour the trail gets: the innermost active one of the first machine that has one. */
export function trailState(lit: readonly string[]): string {
  return lit.find((path) => !lit.some((other) => other.startsWith(`${path}/`))) ?? "";
}
