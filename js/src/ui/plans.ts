/**
 * How the lab's panels divide its room. The world comes first, in its own proportions: it stands beside the program,
 * or lies above it where that makes it larger. The program keeps its lines, and in a large room has the whole height.
 * The other panels share the rest.
 */

import type { Division, Plan } from "./boxes";

/** What is large: the program and the world, the world, or the world and the graph. */
export const ARRANGEMENTS = ["work", "world", "demo"] as const;
export type Arrangement = (typeof ARRANGEMENTS)[number];

/** In px; `lab` is the area of the whole lab. */
export interface Room {
  width: number;
  height: number;
  lab: number;
}

export interface Shown {
  hasGoal: boolean;
  /** The width of the world, divided by its height; null where a robot's panel is in its place. */
  aspect: number | null;
}

export const HEAD = 28; // px of a panel's heading
export const PROGRAM = 14 * 17 + 8; // px of fourteen lines
const LISTS = 140; // px in which three issues can be read
const COLUMN = 360; // px in which a program can be read
const GRAPH = 200; // px
const NARROW = 300; // px of the lists: four tabs
const LARGE: Size = { width: 780, height: 290 }; // px of a graph and the lists side by side
const LEAST = 750; // px: with less room the panels lie one below the other
const ROBOT = 1; // the proportions of a robot's panel, which holds more than a picture
/** The world's part of the lab, as far as there is room. */
const PART = { work: 0.305, tall: 0.35, world: 0.5, demo: 0.42 } as const;

interface Size {
  width: number;
  height: number;
}

/** The largest world of these proportions: a part of the lab, within limits in px. */
function fitted(area: number, aspect: number | null, most: Size): Size {
  const proportions = aspect ?? ROBOT;
  const height = Math.min(Math.sqrt(area / proportions), most.height, most.width / proportions);
  return { width: height * proportions, height };
}

/** The plan for a room; null: panels one below the other, as high as they need to be. */
export function planFor(room: Room, shown: Shown, arrangement: Arrangement): Plan | null {
  if (room.width < LEAST) return null;
  if (shown.hasGoal) return challenge(room, shown, arrangement);
  if (arrangement === "demo") return demo(room, shown);
  const { width, height, lab } = room;
  const isWork = arrangement === "work";
  if (isWork && shown.aspect) {
    const under = fitted(PART.tall * lab, shown.aspect, {
      width: width - Math.max(COLUMN, 0.3 * width),
      height: height - HEAD - LARGE.height,
    });
    if (under.width >= LARGE.width && under.width * under.height > 0.25 * lab) return tall(room, under);
  }
  const besideIt = fitted(PART[arrangement] * lab, shown.aspect, {
    width: width - (isWork ? Math.max(COLUMN, 0.34 * width) : 280),
    height: height - HEAD - (shown.aspect ? (isWork ? LISTS : LISTS / 2) + HEAD : GRAPH),
  });
  const aboveIt = fitted(PART[arrangement] * lab, shown.aspect, {
    width: width - (isWork ? GRAPH : 0),
    height: height - HEAD - (isWork ? PROGRAM + HEAD : GRAPH),
  });
  if (!shown.aspect || besideIt.width >= aboveIt.width) return beside(room, besideIt, arrangement);
  return isWork ? above(room, aboveIt) : large(room, aboveIt);
}

/** The world stands beside the program. */
function beside({ width, height }: Room, world: Size, name: string): Plan {
  return columns(
    `${name}-beside`,
    "Width of the world",
    100 - (100 * world.width) / width,
    rows(`${name}-program`, "Height of the editor", programIn(height), "editor", "machines"),
    rows(`${name}-world`, "Height of the world", (100 * (world.height + HEAD)) / height, "world", "lists"),
  );
}

/** The program has the whole height; the graph and the lists lie under the world. */
function tall({ width, height }: Room, world: Size): Plan {
  return columns(
    "work-tall",
    "Width of the world",
    100 - (100 * world.width) / width,
    "editor",
    rows(
      "work-tall-world",
      "Height of the world",
      (100 * (world.height + HEAD)) / height,
      "world",
      columns(
        "work-tall-graph",
        "Width of the graph",
        100 - (100 * NARROW) / world.width,
        "machines",
        "lists",
      ),
    ),
  );
}

/** The world lies above the program, the lists beside it, the graph beside the program. */
function above({ width, height }: Room, world: Size): Plan {
  return rows(
    "work-above",
    "Height of the world",
    (100 * (world.height + HEAD)) / height,
    columns("work-width", "Width of the world", (100 * world.width) / width, "world", "lists"),
    columns("work-editor", "Width of the editor", 58, "editor", "machines"),
  );
}

/** The world lies above everything else. */
function large({ height }: Room, world: Size): Plan {
  return rows(
    "world-above",
    "Height of the world",
    (100 * (world.height + HEAD)) / height,
    "world",
    columns(
      "world-editor",
      "Width of the editor",
      44,
      "editor",
      columns("world-graph", "Width of the graph", 46, "machines", "lists"),
    ),
  );
}

/** The pictures for all to see; the program and the lists at the side. */
function demo({ width, height, lab }: Room, { aspect }: Shown): Plan {
  const world = fitted(PART.demo * lab, aspect, {
    width: 0.7 * width,
    height: height - HEAD - GRAPH - HEAD,
  });
  return columns(
    "demo",
    "Width of the editor",
    30,
    rows("demo-lists", "Height of the editor", 64, "editor", "lists"),
    rows("demo-world", "Height of the world", (100 * (world.height + HEAD)) / height, "world", "machines"),
  );
}

/** A challenge: what is to be done and the world at the left, the program at the right. */
function challenge({ width, height, lab }: Room, { aspect }: Shown, arrangement: Arrangement): Plan {
  const world = fitted(PART[arrangement] * lab, aspect, {
    width: (arrangement === "work" ? 0.46 : 0.6) * width,
    height: height - HEAD - 240,
  });
  return columns(
    `${arrangement}-goal`,
    "Width of the world",
    Math.max(44, (100 * world.width) / width),
    rows(
      `${arrangement}-goal-world`,
      "Height of the goal",
      100 - (100 * (world.height + HEAD)) / height,
      "goal",
      "world",
    ),
    rows(
      `${arrangement}-goal-program`,
      "Height of the editor",
      programIn(height),
      "editor",
      columns(`${arrangement}-goal-graph`, "Width of the graph", 42, "machines", "lists"),
    ),
  );
}

/** The share of the program above another panel, in percent. */
function programIn(height: number): number {
  return Math.max(52, (100 * (PROGRAM + HEAD)) / height);
}

type Parts = readonly [first: Plan, second: Plan];

/** Two parts side by side, or one above the other; the first gets `share` percent. */
const columns = (name: string, label: string, share: number, ...parts: Parts): Division => ({
  ...{ name, label, share, axis: "columns", parts },
});
const rows = (name: string, label: string, share: number, ...parts: Parts): Division => ({
  ...{ name, label, share, axis: "rows", parts },
});
