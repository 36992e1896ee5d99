/**
 * What the arrows count: a bar below the label of each that waits for a time, and what their cards say of it.
 *
 * The page learns a moment; from there the browser fills a bar by an animation that needs neither styles nor layout of
 * the page, and goes on where the page is hidden for a while. An SVG has no such animations, so the bars are in a layer
 * of their own above it.
 */

import { machineOf, parentOf } from "../language/paths";
import { reachWords } from "../parts/coverage";
import type { Inside, Layout, TransitionShape } from "../protocol";
import { meant } from "../session/instances";
import { inGraph, type LabState } from "../session/state";
import { h, reconcile, setAttribute } from "../ui/dom";
import type { Camera } from "./camera";
import { statesOn } from "./inside";

const SHORTEST = 300; // ms of a time that can be seen to pass
const DRIFT = 120; // ms by which a moment may be told late
const NARROWEST = 24; // px
const ABOVE = 1.5; // px, from the lower edge of a label
const FILLING = ["scaleX(0)", "scaleX(1)"].map((transform) => ({ transform }));

/** The time that a transition waits for, and how much of it has passed; all in seconds. */
export interface Count {
  since: number;
  passed: number;
  whole: number;
}

/** What the transitions wait for, by id: of several instances the selected one, or the one that is further on. */
export function countsOf(state: LabState): Map<string, Count> {
  const counts = new Map<string, Count>();
  const run = inGraph(state);
  for (const [path, [since, delay]] of Object.entries(run.countdowns)) {
    const spawned = machineOf(path);
    const instance = run.instances.find((each) => each.path === spawned);
    if (instance && !meant(run, instance.machine).includes(instance)) continue;
    const id = parentOf(statesOn(`${spawned}/*`, state.layouts).at(-1)!) + path.slice(spawned.length);
    const whole = delay / 1000;
    const passed = Math.min(whole, Math.max(0, state.time - since));
    const other = counts.get(id);
    if (!other || passed / whole > other.passed / other.whole) counts.set(id, { since, passed, whole });
  }
  return counts;
}

interface Placed {
  shape: TransitionShape;
  machine: string;
  x: number;
  y: number;
}

interface Bar extends Placed {
  count: Count;
}

export class CountBars {
  private readonly drawing = h("div");
  readonly element = h("div", { class: "lrp-counts", "aria-hidden": "true" }, this.drawing);
  private placed = new Map<string, Placed[]>();
  /** What the animations that run are of, and when they end. */
  private readonly running = new WeakMap<Element, { of: string; end: number; animation: Animation }>();

  constructor(private readonly state: LabState) {}

  place({ x, y, scale }: Camera): void {
    this.drawing.style.transform = `translate(${x}px, ${y}px) scale(${scale})`;
  }

  draw(places: readonly Inside[], layouts: Record<string, Layout>): void {
    this.placed = new Map();
    for (const each of places.flatMap((place) => arrowsIn(place, layouts))) {
      const { id } = each.shape;
      this.placed.set(id, [...(this.placed.get(id) ?? []), each]);
    }
    this.update();
  }

  update(): void {
    const { status, looking, link, speed, achieved_speed } = this.state;
    const lasts = status === "running" && !looking && link !== "lost" && link !== "dead";
    const pace = achieved_speed || speed || 1; // seconds of the run in one of the wall
    const counts = [...countsOf(this.state)].filter(
      ([, { whole }]) => !lasts || (1000 * whole) / pace >= SHORTEST,
    );
    if (!counts.length && !this.drawing.firstChild) return;
    const { lit } = inGraph(this.state);
    const bars = counts.flatMap(([id, count]): Bar[] =>
      (this.placed.get(id) ?? []).flatMap((each) => {
        const { source } = each.shape;
        return source === "*" || lit.includes(`${each.machine}/${source}`) ? [{ ...each, count }] : [];
      }),
    );
    const isStill = matchMedia("(prefers-reduced-motion: reduce)").matches;
    reconcile(
      this.drawing,
      bars,
      ({ shape, machine }) => `${machine} ${shape.id} ${shape.source}`,
      () => h("div", {}, h("div")),
      (element, bar) => {
        const { label, style } = bar.shape;
        const width = Math.max(NARROWEST, label.width - 4);
        const [left, top] = [bar.x + label.x - width / 2, bar.y + label.y + label.height / 2 - ABOVE];
        setAttribute(element, "class", `lrp-count lrp-${style}`);
        setAttribute(element, "style", `left: ${left}px; top: ${top}px; width: ${width}px`);
        setAttribute(element, "data-fills", lasts && !isStill);
        if (lasts && !isStill) this.run(element, bar.count, pace);
        else this.stand(element, bar.count, isStill && lasts);
      },
    );
  }

  private run(element: Element, { since, passed, whole }: Count, pace: number): void {
    const length = (1000 * whole) / pace;
    const elapsed = (1000 * passed) / pace;
    const end = performance.now() + length - elapsed;
    const of = `${since} ${whole}`;
    const known = this.running.get(element);
    if (known?.of === of && Math.abs(known.end - end) < DRIFT + length / 50) return;
    known?.animation.cancel();
    const animation = element.firstElementChild!.animate(FILLING, {
      ...{ duration: length, delay: -elapsed, fill: "both" },
    });
    this.running.set(element, { of, end, animation });
  }

  /** Without motion, a bar grows in few steps. */
  private stand(element: Element, { passed, whole }: Count, inSteps: boolean): void {
    this.running.get(element)?.animation.cancel();
    this.running.delete(element);
    const share = passed / whole;
    const shown = inSteps ? Math.floor(10 * share) / 10 : Number(share.toFixed(3));
    setAttribute(element.firstElementChild!, "style", `transform: scaleX(${shown})`);
  }
}

/** The arrows of a machine, and of those that are drawn inside its states, with where their drawing begins. */
function arrowsIn({ machine, x, y }: Inside, layouts: Record<string, Layout>): Placed[] {
  const { transitions = [], states = [] } = layouts[machine] ?? {};
  const inner = states.flatMap((state) =>
    state.inside.flatMap((each) =>
      arrowsIn({ machine: each.machine, x: x + state.x + each.x, y: y + state.y + each.y }, layouts),
    ),
  );
  return [...transitions.map((shape) => ({ shape, machine, x, y })), ...inner];
}

/** What the card of an arrow says: the transition, what of its time has passed, and the state that it waits for. */
export function cardOf(state: LabState, shape: TransitionShape, machine: string): string {
  const user = `${machine}/${shape.source}`;
  const isLeft = shape.source === "*" || inGraph(state).lit.includes(user);
  const count = isLeft && countsOf(state).get(shape.id);
  const lines = [shape.title];
  if (count) {
    const time = `${count.passed.toFixed(1)} s of ${Number(count.whole.toFixed(3))} s`;
    lines.push(shape.kind === "ontime" ? `${time} have passed` : `has held for ${time}`);
  }
  if (shape.watched) {
    const found = watchedStates(state, shape, machine);
    lines.push(...found.map((name) => `${shape.watched} is in ${name}`));
    if (!found.length && isLeft) lines.push(`${shape.watched} does not run`);
  }
  const reached = reachWords(state, "transition", shape.id);
  return [...lines, ...(reached ? [reached] : [])].join("\n");
}

/** The states in which the machine is that a transition waits for: one for each instance that it would leave. */
function watchedStates(state: LabState, { source, watched }: TransitionShape, machine: string): string[] {
  const found = inGraph(state).active.flatMap((path) => {
    const names = path.split("/");
    return statesOn(path, state.layouts).flatMap((id, at) => {
      const isUser = source === "*" ? parentOf(id) === machine : id === `${machine}/${source}`;
      return isUser && names[2 * at + 2] === watched ? [names[2 * at + 3]!] : [];
    });
  });
  return [...new Set(found)];
}
