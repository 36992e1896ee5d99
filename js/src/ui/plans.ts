/**
 * How the lab's panels divide its room. The world comes first, in its own proportions: it stands beside the program,
 * or lies below it where that makes it larger. The program keeps its lines, and in a large room has the whole height.
 * The other panels share the rest.
 *
 * The program begins at the top left, so that it stays where it is when the world grows or is another one.
 */

import type { Division, Plan } from "./boxes";

/** What is large: the program and the world, the world, or the world and the graph. */
export const ARRANGEMENTS = ["work", "world", "demo"] as const;
export type Arrangement = (typeof ARRANGEMENTS)[number];
/** An arrangement, or that of the program and the world while an earlier moment is shown: with a larger world. */
export type Shape = Arrangement | "past";

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
const EDITOR = 58; // percent of the width that a program has over the world
const COLUMN = 360; // px in which a program can be read
const GRAPH = 200; // px
const GOAL = 200; // px, with its heading
const NARROW = 300; // px of the lists: four tabs
const LARGE: Size = { width: 780, height: 290 }; // px of a graph and the lists side by side
const LEAST = 750; // px: with less room the panels lie one below the other
const FLAT = 160; // px: the least height of a world, of which its tools and its legend are a part
const ROBOT = 1; // the proportions of a robot's panel, which holds more than a picture
/** The world's part of the lab, as far as there is room. */
const PART = { work: 0.305, tall: 0.35, past: 0.5, world: 0.5, demo: 0.42 } as const;

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
export function planFor(room: Room, shown: Shown, shape: Shape): Plan | null {
  if (room.width < LEAST) return null;
  if (shown.hasGoal) return challenge(room, shown, shape);
  if (shape === "demo") return demo(room, shown);
  if (programOf(shape) === "work" && hasRoomUnder(room, shown))
    return tall(room, overGraph(room, shown, shape), shape);
  const isBeside = !shown.aspect || isWiderBeside(room, shown, programOf(shape));
  const world = (isBeside ? besideProgram : belowProgram)(room, shown, shape);
  if (isBeside) return beside(room, world, shape);
  return shape === "work" ? below(room, world) : large(room, world, shape);
}

function isWiderBeside(room: Room, shown: Shown, shape: Shape): boolean {
  return besideProgram(room, shown, shape).width >= belowProgram(room, shown, shape).width;
}

/** The largest world beside the program. */
function besideProgram({ width, height, lab }: Room, { aspect }: Shown, shape: Shape): Size {
  const isWork = shape === "work";
  return fitted(PART[shape] * lab, aspect, {
    width: width - (isWork ? Math.max(COLUMN, 0.34 * width) : 280),
    height: Math.max(height / 2, height - HEAD - (aspect ? (isWork ? LISTS : LISTS / 2) + HEAD : GRAPH)),
  });
}

/** The largest world below the program. */
function belowProgram({ width, height, lab }: Room, { aspect }: Shown, shape: Shape): Size {
  const isWork = shape === "work";
  return fitted(PART[shape] * lab, aspect, {
    width: width - (isWork ? GRAPH : 0),
    height: height - HEAD - (isWork ? PROGRAM + HEAD : GRAPH),
  });
}

/** The largest world beside the program, over the graph and the lists. */
function overGraph({ width, height, lab }: Room, { aspect }: Shown, shape: Shape): Size {
  const isPast = shape === "past";
  return fitted((isPast ? PART.past : PART.tall) * lab, aspect, {
    width: width - (isPast ? 280 : Math.max(1.2 * COLUMN, 0.3 * width)),
    height: height - HEAD - (isPast ? GRAPH : LARGE.height),
  });
}

/** Whether the graph and the lists have room under a world that is large enough. */
function hasRoomUnder(room: Room, shown: Shown): boolean {
  const { width, height } = overGraph(room, shown, "work");
  return shown.aspect !== null && width >= LARGE.width && width * height > 0.25 * room.lab;
}

/** Whose kind of plan and whose bars of the program a shape has: these stay while an earlier moment is shown. */
const programOf = (shape: Shape) => (shape === "past" ? "work" : shape);

/** The world stands beside the program. */
function beside({ width, height }: Room, world: Size, shape: Shape): Plan {
  return columns(
    `${shape}-beside`,
    "Width of the world",
    100 - (100 * world.width) / width,
    rows(`${programOf(shape)}-program`, "Height of the editor", programIn(height), "editor", "machines"),
    rows(`${shape}-world`, "Height of the world", (100 * (world.height + HEAD)) / height, "world", "lists"),
  );
}

/** The program has the whole height; the graph and the lists lie under the world. */
function tall({ width, height }: Room, world: Size, shape: Shape): Plan {
  return columns(
    `${shape}-tall`,
    "Width of the world",
    100 - (100 * world.width) / width,
    "editor",
    rows(
      `${shape}-tall-world`,
      "Height of the world",
      (100 * (world.height + HEAD)) / height,
      "world",
      columns(
        `${programOf(shape)}-tall-graph`,
        "Width of the graph",
        100 - (100 * NARROW) / world.width,
        "machines",
        "lists",
      ),
    ),
  );
}

/** The world lies below the program, the lists beside it, the graph beside the program. */
function below({ width, height }: Room, world: Size): Plan {
  return rows(
    "work-below",
    "Height of the world",
    100 - (100 * (world.height + HEAD)) / height,
    columns("work-editor", "Width of the editor", EDITOR, "editor", "machines"),
    columns("work-width", "Width of the world", (100 * world.width) / width, "world", "lists"),
  );
}

/** The world lies below everything else. */
function large({ height }: Room, world: Size, shape: Shape): Plan {
  return rows(
    `${shape}-below`,
    "Height of the world",
    100 - (100 * (world.height + HEAD)) / height,
    columns(
      `${programOf(shape)}-editor`,
      "Width of the editor",
      shape === "past" ? EDITOR : 44,
      "editor",
      columns(`${shape}-graph`, "Width of the graph", 46, "machines", "lists"),
    ),
    "world",
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
function challenge({ width, height, lab }: Room, { aspect }: Shown, shape: Shape): Plan {
  const most = height - HEAD - GOAL;
  const world = fitted(PART[shape] * lab, aspect, {
    width: (shape === "work" ? 0.46 : 0.6) * width,
    height: most,
  });
  return columns(
    `${shape}-goal`,
    "Width of the world",
    Math.max(44, (100 * world.width) / width),
    rows(
      `${shape}-goal-world`,
      "Height of the goal",
      100 - (100 * (Math.max(Math.min(FLAT, most), world.height) + HEAD)) / height,
      "goal",
      "world",
    ),
    rows(
      `${programOf(shape)}-goal-program`,
      "Height of the editor",
      programIn(height),
      "editor",
      columns(`${programOf(shape)}-goal-graph`, "Width of the graph", 42, "machines", "lists"),
    ),
  );
}

/** The share of the program above another panel, in percent; in a low lab it has fewer lines. */
function programIn(height: number): number {
  return Math.min(65, Math.max(52, (100 * (PROGRAM + HEAD)) / height));
}

type Parts = readonly [first: Plan, second: Plan];

/** Two parts side by side, or one above the other; the first gets `share` percent. */
const columns = (name: string, label: string, share: number, ...parts: Parts): Division => ({
  ...{ name, label, share, axis: "columns", parts },
});
const rows = (name: string, label: string, share: number, ...parts: Parts): Division => ({
  ...{ name, label, share, axis: "rows", parts },
});
