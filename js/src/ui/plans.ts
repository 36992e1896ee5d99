/** How the lab's panels divide its room, by its width. */

import type { Division, Plan } from "./boxes";

type Parts = readonly [first: Plan, second: Plan];

/** Two parts side by side, or one above the other; the first gets `share` percent. */
const beside = (name: string, label: string, share: number, ...parts: Parts): Division => ({
  ...{ name, label, share, axis: "columns", parts },
});
const stacked = (name: string, label: string, share: number, ...parts: Parts): Division => ({
  ...{ name, label, share, axis: "rows", parts },
});

const lists = stacked("lists", "Height of the variables", 62, "variables", "issues");

const three = beside(
  "three",
  "Width of the world",
  60,
  beside("three-editor", "Width of the editor", 55, "editor", "machines"),
  { ...stacked("three-world", "Height of the world", 50, "world", lists), robotShare: 68 },
);

/** The two pictures above the texts: a robot can be seen where a third column would leave no room for it. */
const two = beside(
  "two",
  "Width of the world",
  39,
  stacked("two-graph", "Height of the graph", 55, "machines", lists),
  { ...stacked("two-world", "Height of the world", 44, "world", "editor"), robotShare: 58 },
);

/** A challenge: what is to be done and the world at the left, the program at the right. */
const goal = stacked("goal", "Height of the goal", 42, "goal", "world");

const goalWide = beside(
  "goal-wide",
  "Width of the world",
  42,
  goal,
  stacked(
    "goal-editor",
    "Height of the editor",
    56,
    "editor",
    beside("goal-graph", "Width of the graph", 62, "machines", lists),
  ),
);

const goalNarrow = beside(
  "goal-narrow",
  "Width of the world",
  46,
  goal,
  stacked(
    "goal-program",
    "Height of the editor",
    50,
    "editor",
    stacked("goal-lists", "Height of the graph", 60, "machines", lists),
  ),
);

/** The plan for a width in px; null: panels one below the other, as high as they need to be. */
export function planFor(width: number, hasGoal: boolean): Plan | null {
  if (width < 750) return null;
  if (hasGoal) return width >= 1150 ? goalWide : goalNarrow;
  return width >= 1350 ? three : two;
}
