/** The last half minute of a value, with the thresholds of its condition: the plots of a timeline, in small. */

import { nameOf, parentOf } from "../language/paths";
import type { Plot } from "../protocol";
import { placeOf } from "../session/instances";
import { newest } from "../session/newest";
import type { Lab } from "../session/store";
import { h, s, setAttribute, setHidden } from "../ui/dom";
import { readableNumber } from "../ui/numbers";
import { labelsOf, PLOT, plotOf } from "./plots";

const SECONDS = 30;
const LEAST = 5; // s of the axis
const INTERVAL = 300; // ms between two questions
const LEFT = 84; // px for names
const RIGHT = 88; // for those of thresholds
const WIDTH = 364;
const GAP = 3;
const AXIS = 14;

/** What is shown: variables and readings by name, with the thresholds of an event, or what that reads. */
export interface Subject {
  names: string[];
  event: string;
}

export interface Spark {
  element: HTMLElement;
  /** What is plotted, once it is known. */
  names(): string[];
  close(): void;
}

export const ofVariable = (path: string): Subject => ({ names: [path], event: "" });
export const ofReading = (name: string): Subject => ({ names: [`robot.${name}`], event: "" });
export const ofEvent = (path: string): Subject => ({ names: [], event: path });

export function titleOf(lab: Lab, { names: [name], event }: Subject): string {
  if (name?.startsWith("robot.")) return name;
  const place = placeOf(lab.store.state, parentOf(name ?? ""));
  return place ? `${nameOf(name!)} in ${place}` : nameOf(name ?? event);
}

/** Ask for what can be drawn of a value, up to the moment that is shown. */
export async function plotsOf(lab: Lab, subject: Subject): Promise<{ plots: Plot[]; error?: string }> {
  const seconds = SECONDS + (lab.store.state.looking?.ago ?? 0);
  const { plots = [], error } = await lab.ask({ type: "plots", ...subject, seconds });
  return {
    plots: plots.filter(({ values }) => values.some((value) => value !== null)),
    ...(error && { error }),
  };
}

/** Draw a value while it is shown; `drawn` is told after every answer why there is nothing, or nothing. */
export function spark(lab: Lab, subject: Subject, drawn: (reason: string) => void = () => {}): Spark {
  const { store } = lab;
  const closing = new AbortController();
  const svg = s("svg", { class: "lrp-timeline-drawing", width: WIDTH, role: "img" });
  const element = h("div", { class: "lrp-history", hidden: true }, svg);
  let plots: Plot[] = [];
  let asked = Number.NEGATIVE_INFINITY;
  const ask = newest(
    closing.signal,
    () => asked + INTERVAL,
    async () => {
      asked = performance.now();
      const { looking, time } = store.state;
      const answer = await plotsOf(lab, subject);
      if (closing.signal.aborted) return;
      plots = answer.plots;
      const to = looking ? looking.time : Math.max(time, plots[0]?.times.at(-1) ?? 0);
      draw(svg, plots, to, looking ? `${to.toFixed(1)} s` : "now");
      setAttribute(svg, "aria-label", plots.map(inWords).join(". "));
      setHidden(element, !plots.length);
      drawn(plots.length ? "" : (answer.error ?? "No number was recorded."));
    },
  );
  const end = store.watch(["tick", "looking"], ask);
  return {
    element,
    names: () => plots.map(({ name }) => name),
    close() {
      end();
      closing.abort();
    },
  };
}

/** A plot for those who do not see it. */
function inWords({ name, kind, values, thresholds }: Plot): string {
  const numbers = values.filter((value) => value !== null);
  const text = (value: number) => (kind === "truth" ? (value ? "True" : "False") : readableNumber(value));
  const last = (samples: readonly (number | null)[]) => text(samples.findLast((each) => each !== null) ?? 0);
  const [low, high] = [Math.min(...numbers), Math.max(...numbers)];
  const range = low === high ? text(low) : `${text(low)} to ${text(high)}, now ${last(values)}`;
  return [`${name}: ${range}`, ...thresholds.map((each) => `${each.text}: ${last(each.values)}`)].join("; ");
}

function draw(svg: SVGElement, plots: readonly Plot[], to: number, until: string): void {
  const first = Math.min(...plots.flatMap(({ times }) => times.slice(0, 1)));
  const from = Math.min(to - LEAST, Math.max(to - SECONDS, first));
  const width = WIDTH - LEFT - RIGHT;
  const scale = { span: { from, to }, left: LEFT, width };
  const height = plots.length * (PLOT + GAP);
  const labels = labelsOf(plots.map(({ name }) => name));
  svg.setAttribute("height", String(plots.length ? height + AXIS : 0));
  const axis = [
    s(
      "text",
      { class: "lrp-timeline-range", x: LEFT, y: height + AXIS - 3 },
      `${Math.round(to - from)} s ago`,
    ),
    s("text", { class: "lrp-timeline-now", x: LEFT + width, y: height + AXIS - 3 }, until),
  ];
  svg.replaceChildren(
    ...plots.flatMap(({ name, kind, times, values, thresholds }, index) => {
      const known = new Map(thresholds.map(({ text, values: each }) => [text, each]));
      const plotted = { kind, tick: 0, times, values, thresholds: known };
      return plotOf(scale, [name, labels.get(name)!], plotted, index * (PLOT + GAP), true);
    }),
    ...(plots.length ? axis : []),
  );
}
