/** The courses of an answer about what comes next: what they are called, how they are drawn, whether they differ. */

import type { Course, Pose } from "../protocol";
import type { Foretold } from "../session/state";
import { type Palette, shade } from "./palette";

/** Poses with their times: (time, x, y, theta). */
export type Way = readonly (readonly number[])[];

const STILL = 0.005; // metres and radians: a ghost in the robot itself would only blur it

/** A course as it is drawn, and what it is called. */
export interface Drawn {
  course: Course;
  name: string;
  title: string;
  color: string;
  dash: readonly number[]; // px
  isNow: boolean;
  /** The value of a number with which it goes so; a ghost at the end has it. */
  label: string;
}

/** The courses, in greys, which no state's trail has; each is seen between the dashes of the next. */
export function coursesOf({ changed, recorded, divergence, tried }: Foretold, palette: Palette): Drawn[] {
  const [black, grey] = [shade(0, palette), shade(125, palette)];
  const plain = { course: recorded, color: grey, dash: [], isNow: false };
  const dashed = { course: changed, color: black, dash: [6, 4], isNow: true };
  if (tried) {
    const [before, now, beyond] = tried.values;
    const courses = [
      { ...plain, course: tried.beyond, dash: [1.5, 3.5], ...called("next", beyond, "one step further") },
      { ...plain, ...called("before", before, "as before") },
      { ...dashed, ...called("now", now, "now") },
    ];
    return courses.filter(({ label }, i) => courses.findLastIndex((each) => each.label === label) === i);
  }
  if (!divergence) return [{ ...dashed, name: "what comes next", title: "How it goes on", label: "" }];
  const now = { ...dashed, name: "with the edit", title: "How it goes with the edit", label: "" };
  const before = { ...plain, name: "as recorded", title: "How it was recorded", label: "" };
  return [before, now];
}

function called(what: string, label: string, how: string): Pick<Drawn, "name" | "title" | "label"> {
  return { label, name: `${what} ${label}`, title: `How it goes ${how}, with ${label}` };
}

/** Whether the world goes another way in one of two courses. */
export function isOther(a: Course, b: Course): boolean {
  const ways = ({ way, others }: Course) => [way, ...Object.values(others)];
  return (
    ways(a).some((way, i) =>
      way.some(([, ...pose], at) => isElsewhere(pose, poseIn(ways(b)[i]?.[at], pose))),
    ) ||
    a.solids.some(([index, pose]) =>
      isElsewhere(pose, b.solids.find(([other]) => other === index)?.[1] ?? pose),
    )
  );
}

function poseIn(point: readonly number[] | undefined, otherwise: Pose): Pose {
  const [, x, y, theta] = point ?? [];
  return x === undefined || y === undefined || theta === undefined ? otherwise : [x, y, theta];
}

export function wayOf({ way, others }: Course, robot: number): Way {
  return robot ? (Object.values(others)[robot - 1] ?? []) : way;
}

export function isElsewhere(a: Pose, b: Pose): boolean {
  return Math.hypot(b[0] - a[0], b[1] - a[1]) > STILL || Math.abs(b[2] - a[2]) > STILL;
}
