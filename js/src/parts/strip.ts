/** The strip of a kept run: the states of one machine as they were recorded, and as they are now, below. */

import { nameOf } from "../language/paths";
import type { KeptRunView } from "../protocol";
import { s } from "../ui/dom";
import type { Style } from "../world/palette";

const LANE = 7; // px
const GAP = 2;
const BEYOND = 2; // px of the mark of a difference, above and below
export const STRIP = 2 * LANE + GAP;

export type Courses = Pick<KeptRunView, "seconds" | "recorded" | "now" | "differs">;

interface Visit {
  state: string;
  from: number; // s
  to: number;
}

/** How long a strip is, in seconds. */
export function lengthOf({ seconds, recorded, now }: Courses): number {
  return Math.max(seconds, recorded.at(-1)?.[0] ?? 0, now.at(-1)?.[0] ?? 0);
}

/** The visits of states; between the end of a machine and its next start there is none. */
export function visitsOf(entered: KeptRunView["now"], end: number): Visit[] {
  return entered
    .map(([from, state], index) => ({ state, from, to: entered[index + 1]?.[0] ?? end }))
    .filter(({ state }) => state !== "");
}

export function drawStrip(svg: SVGSVGElement, run: Courses, styleOf: (state: string) => Style): void {
  const end = lengthOf(run);
  svg.setAttribute("viewBox", `0 0 ${end || 1} ${STRIP}`);
  const still = { "vector-effect": "non-scaling-stroke", fill: "none" };
  const parts = [run.recorded, run.now].flatMap((entered, lane) => {
    const y = LANE / 2 + lane * (LANE + GAP);
    const lines = new Map<string, string>([["", `M0 ${y}H${end}`]]); // by state: few elements, also of many visits
    for (const { state, from, to } of visitsOf(entered, end))
      lines.set(state, `${lines.get(state) ?? ""}M${from} ${y}H${to}`);
    return [...lines].map(([state, d]) => {
      const { color, dash } = state ? styleOf(state) : { color: "var(--lrp-line)", dash: [] };
      const dashes = dash.length ? { "stroke-dasharray": dash.join(" ") } : {};
      return s("path", { d, stroke: color, "stroke-width": LANE, ...dashes, ...still });
    });
  });
  const mark = run.differs && `M${run.differs[0]} ${-BEYOND}V${STRIP + BEYOND}`;
  svg.replaceChildren(
    ...parts,
    ...(mark ? [s("path", { class: "lrp-strip-differs", d: mark, ...still })] : []),
  );
}

/** What is at a place of a strip: `x` and `y` are parts of its width and height. */
export function stripWords(run: Courses, x: number, y: number): string {
  const end = lengthOf(run);
  const time = x * end;
  const [course, entered] = y < 0.5 ? (["recorded", run.recorded] as const) : (["now", run.now] as const);
  const visit = visitsOf(entered, end).find(({ from, to }) => from <= time && time < to);
  const what = visit
    ? `${nameOf(visit.state)}, ${visit.from.toFixed(1)} to ${visit.to.toFixed(1)} s`
    : `no state at ${time.toFixed(1)} s`;
  return `${course}: ${what}`;
}
