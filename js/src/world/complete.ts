/** A world with everything in it that its JSON leaves out as usual; the values are those of `sim/world.py`. */

import type { Point, RobotShape, StrokeView, WorldView } from "../protocol";

export type FullStroke = StrokeView & { width: number; grey: number };
export type FullRobot = Required<RobotShape>;

export interface FullWorld extends Omit<WorldView, "floor" | "robots"> {
  floor: { grey: number; strokes: FullStroke[] };
  robots: FullRobot[];
}

const ROBOT = {
  name: "",
  radius: 0.08,
  light: [[0.06, 0]] as Point[],
  bumper: true,
  distance: [[0, 2]] as Point[],
};

export function completeStroke(stroke: StrokeView): FullStroke {
  return { width: 0.03, grey: 0, ...stroke };
}

export function complete(world: WorldView): FullWorld {
  const { grey = 255, strokes = [] } = world.floor;
  return {
    ...world,
    floor: { grey, strokes: strokes.map(completeStroke) },
    robots: world.robots.map((robot) => ({ ...ROBOT, ...robot })),
  };
}
