/** What the kept runs have reached of the program: in words, and whether it is shown. */

import { transitionAt } from "../language/paths";
import type { CoverageView, ElementKind, OneWay, ProgramView } from "../protocol";
import type { LabState, Reached } from "../session/state";
import type { Lab } from "../session/store";
import { KeptSwitch } from "../ui/kept";
import { keyOf } from "./breakpoints";

const MOST_NAMES = 8; // in a sentence
const VERBS: Partial<Record<ElementKind, string>> = { state: "entered", transition: "fired" };

/** The switch of the coverage; while it is on, the state has what was reached last, also while runs are run again. */
export function coverageSwitch({ store }: Pick<Lab, "store">): KeptSwitch {
  let last: Reached | null = null;
  let known: CoverageView | null = null;
  const show = () => {
    const { runs, program, settings } = store.state;
    const isShown = shown.on && runs !== null && !settings.quiet;
    if (isShown && runs.coverage && runs.coverage !== known) {
      known = runs.coverage;
      last = reachedBy(known, runs.names, program);
    }
    store.set("reached", isShown ? last : null);
  };
  const shown = new KeptSwitch("coverage", false, show);
  store.watch(["runs", "settings", "snapshot"], (changed) => {
    if (changed.has("snapshot")) last = known = null;
    show();
  });
  return shown;
}

/** What was reached, by the names of the runs; what no run reaches has none of them. */
export function reachedBy(
  { states, transitions, conditions, words }: CoverageView,
  names: readonly string[],
  { machines }: Pick<ProgramView, "machines">,
): Reached {
  const reached = new Map<string, readonly string[]>();
  for (const machine of machines) {
    for (const { path } of machine.states) reached.set(keyOf("state", path), []);
    for (const { id } of machine.transitions) reached.set(keyOf("transition", id), []);
  }
  const named = (numbers: readonly number[]) => numbers.flatMap((number) => names[number] ?? []);
  for (const [path, numbers] of Object.entries(states)) reached.set(keyOf("state", path), named(numbers));
  for (const [path, numbers] of Object.entries(transitions))
    reached.set(keyOf("transition", transitionAt(path)), named(numbers));
  const ways = Object.entries(conditions).map(([path, way]) => [transitionAt(path), way]);
  return { runs: names.length, names: reached, conditions: Object.fromEntries(ways), words };
}

/** How many runs reach an element; null where that is not shown, or not known. */
export function timesReached(reached: Reached | null, kind: ElementKind, path: string): number | null {
  return reached?.names.get(keyOf(kind, path))?.length ?? null;
}

/** How the condition of an element comes out in all runs, if it is tested and always comes out alike. */
export function onlyWay(reached: Reached | null, kind: ElementKind, path: string): OneWay | null {
  const way = kind === "transition" ? reached?.conditions[path] : null;
  return way && way !== "never tested" ? way : null;
}

/** Which runs reach an element, and how its condition comes out; empty where that is not shown, or not known. */
export function reachWords({ reached }: Pick<LabState, "reached">, kind: ElementKind, path: string): string {
  const names = reached?.names.get(keyOf(kind, path));
  if (!reached || !names) return "";
  const [verb, way] = [VERBS[kind], kind === "transition" ? reached.conditions[path] : null];
  const words = names.length
    ? `${verb} in ${names.length} of ${counted(reached.runs)}: ${listed(names)}`
    : `not ${verb} in any run`;
  return way ? `${words}; its condition was ${way}` : words;
}

export const counted = (runs: number) => (runs === 1 ? "1 run" : `${runs} runs`);

function listed(names: readonly string[]): string {
  const more = names.length - MOST_NAMES;
  return names.slice(0, MOST_NAMES).join(", ") + (more > 0 ? ` and ${more} more` : "");
}
