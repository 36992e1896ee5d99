/** The page's copy of what happened in a run: merged from the kernel's answers, arranged in lanes. No DOM. */

import { machineOf, nameOf, parentOf, transitionAt } from "../language/paths";
import type { Happening, HappeningKind, Plot, Timeline } from "../protocol";
import { placesOf } from "../session/instances";

/** A visit of a state. */
export interface Segment {
  /** The machine, as spawned. */
  lane: string;
  state: string;
  /** The transition that led there; empty if the state was spawned or forced. */
  by: string;
  text: string;
  tick: number;
  begin: number; // s
  /** Infinity while it lasts. */
  end: number;
}

/** A machine with the visits of its states, whichever state of the machine around it spawned it. */
export interface Lane {
  /** See `laneOf`. */
  machine: string;
  /** How many lanes it is nested in. */
  depth: number;
  segments: Segment[];
}

export interface Mark {
  kind: HappeningKind;
  tick: number;
  time: number;
  text: string;
}

/** The samples of one name; every threshold has as many values. */
export interface Plotted {
  kind: Plot["kind"];
  /** The last tick that is known. */
  tick: number;
  times: number[];
  values: (number | null)[];
  thresholds: Map<string, (number | null)[]>;
}

const SPARE = 500; // happenings older than the recording before they are dropped

export class Happened {
  /** Changes when ticks are undone, or elements renamed; null until the kernel has answered. */
  epoch: number | null = null;
  first = 0;
  last = 0;
  /** Seconds of the first and of the last tick. */
  begin = 0;
  end = 0;
  names: readonly string[] = [];
  readonly plots = new Map<string, Plotted>();
  happenings: Happening[] = [];
  private arranged: Lane[] | null = null;

  merge(view: Timeline): void {
    const { epoch, first, last, begin, end, names, kept } = view;
    if (kept < 0) this.plots.clear();
    const stays = this.happenings.filter(({ tick }) => tick <= kept);
    Object.assign(this, { epoch, first, last, begin, end, names });
    this.happenings = [...stays, ...view.happenings];
    this.trim();
    for (const plot of view.plots) this.plot(plot);
    this.arranged = null;
  }

  lanes(): Lane[] {
    this.arranged ??= lanesOf(this.happenings);
    return this.arranged;
  }

  /** The tick of the next change after a tick, or of the last one before it; null if there is none. */
  changeFrom(tick: number, forward: boolean): number | null {
    const changes = this.happenings.filter(({ kind, tick }) => kind !== "command" && tick >= this.first);
    const found = forward
      ? changes.find((each) => each.tick > tick)
      : changes.findLast((each) => each.tick < tick);
    return found?.tick ?? null;
  }

  /** The visit with which another one ended; null if it lasts, or its machine ended. */
  after({ lane, state, tick }: Pick<Segment, "lane" | "state" | "tick">): Segment | null {
    const segments = this.visitsOf(lane);
    const index = segments.findIndex((each) => each.state === state && each.tick === tick);
    const next = segments[index + 1];
    return next && next.begin === segments[index]?.end ? next : null;
  }

  /** The machine whose transition led to a visit, as spawned: for an `exit`, the one that ended. */
  leader({ lane, state, tick, by }: Segment): string {
    if (machineOf(by) === parentOf(state)) return lane;
    const segments = this.visitsOf(lane);
    const index = segments.findIndex((each) => each.state === state && each.tick === tick);
    return `${lane}/${nameOf(segments[index - 1]?.state ?? "")}/${nameOf(machineOf(by))}`;
  }

  /** The visits of the states of a machine as spawned. */
  private visitsOf(instance: string): Segment[] {
    const segments = this.lanes().find(({ machine }) => machine === laneOf(instance))?.segments ?? [];
    return segments.filter(({ lane }) => lane === instance);
  }

  marks(): Mark[] {
    return this.happenings.filter(({ kind }) => kind !== "entered" && kind !== "ended");
  }

  /** Drop what is no longer recorded, but for the states that are active at its beginning. */
  private trim(): void {
    const old = this.happenings.filter(({ tick }) => tick < this.first);
    if (old.length < SPARE) return;
    const active = new Map<string, Happening>();
    for (const each of old) {
      if (each.kind === "entered") active.set(each.lane, each);
      else if (each.kind === "ended") active.delete(each.lane);
      else if (each.kind === "restart") active.clear();
    }
    this.happenings = [...active.values(), ...this.happenings.filter(({ tick }) => tick >= this.first)];
  }

  private plot({ name, kind, times, values, thresholds }: Plot): void {
    let known = this.plots.get(name);
    if (!known) {
      known = { kind, tick: 0, times: [], values: [], thresholds: new Map() };
      this.plots.set(name, known);
    }
    const before = known.times.length;
    if (values.some((value) => value !== null)) known.kind = kind;
    known.tick = this.last;
    known.times.push(...times);
    known.values.push(...values);
    for (const { text, values } of thresholds) {
      const samples = known.thresholds.get(text) ?? [];
      known.thresholds.set(text, samples);
      while (samples.length < before) samples.push(null);
      samples.push(...values);
    }
    const old = known.times.findIndex((time) => time >= this.begin);
    for (const samples of known.thresholds.values()) {
      while (samples.length < known.times.length) samples.push(null);
      if (old > SPARE) samples.splice(0, old);
    }
    if (old > SPARE) {
      known.times.splice(0, old);
      known.values.splice(0, old);
    }
  }
}

/**
 * The lane of a machine as spawned: its path without states. Of the states of one machine one is active at a time, so
 * what they spawn shares a lane.
 */
const laneOf = (instance: string) =>
  instance
    .split("/")
    .filter((_, index) => index % 2 === 0)
    .join("/");

/** The visits of states, by machine; a machine stands below the one that it is nested in. */
export function lanesOf(happenings: readonly Happening[]): Lane[] {
  const instances = new Map<string, Segment[]>();
  const close = (segments: Segment[], time: number) => {
    const last = segments.at(-1);
    if (last && last.end === Number.POSITIVE_INFINITY) last.end = time;
  };
  for (const { kind, lane, state, by, text, tick, time } of happenings) {
    if (kind === "entered") {
      const segments = instances.get(lane) ?? [];
      instances.set(lane, segments);
      close(segments, time);
      segments.push({
        lane,
        state,
        by: transitionAt(by),
        text,
        tick,
        begin: time,
        end: Number.POSITIVE_INFINITY,
      });
    } else if (kind === "ended") close(instances.get(lane) ?? [], time);
    else if (kind === "restart") for (const segments of instances.values()) close(segments, time);
  }
  const lanes = new Map<string, Segment[]>();
  for (const [instance, segments] of instances) {
    const lane = laneOf(instance);
    lanes.set(lane, [...(lanes.get(lane) ?? []), ...segments]);
  }
  const order = new Map([...lanes.keys()].map((machine, index) => [machine, index]));
  return [...lanes]
    .map(([machine, segments]) => {
      const names = machine.split("/");
      const place = names.flatMap((_, index) => order.get(names.slice(0, index + 1).join("/")) ?? []);
      segments.sort((a, b) => a.begin - b.begin);
      return { machine, depth: place.length - 1, segments, place };
    })
    .sort((a, b) => compared(a.place, b.place))
    .map(({ place, ...lane }) => lane);
}

/** Where machines run that have several lanes, as short as they can be told apart; by lane. */
export function placesIn(lanes: readonly Lane[]): Map<string, string> {
  return apart(lanes.map(({ machine, segments }) => [segments[0]?.state ?? "", machine]));
}

/** Where machines run that had several instances, as short as they can be told apart; by path as spawned. */
export function placesOfInstances(lanes: readonly Lane[]): Map<string, string> {
  return apart(lanes.flatMap(({ segments }) => segments.map(({ state, lane }) => [state, lane])));
}

/** Tell the paths of a machine apart, each given with one of its states. */
function apart(paths: readonly (readonly [state: string, path: string])[]): Map<string, string> {
  const machines = new Map<string, Set<string>>(); // by path in the text
  for (const [state, path] of paths) {
    const defined = parentOf(state);
    machines.set(defined, (machines.get(defined) ?? new Set()).add(path));
  }
  return new Map([...machines.values()].flatMap((each) => [...placesOf([...each])]));
}

function compared(a: number[], b: number[]): number {
  const index = a.findIndex((each, i) => each !== b[i]);
  if (index < 0) return a.length - b.length;
  return index < b.length ? a[index]! - b[index]! : 1;
}

/** The visit that lasts at a time, in seconds. */
export function segmentAt(lane: Lane, time: number): Segment | null {
  return lane.segments.findLast(({ begin, end }) => begin <= time && time < end) ?? null;
}

/** The last sample that is not after a time. */
export function valueAt({ times, values }: Plotted, time: number): number | null {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle]! <= time + 1e-6) low = middle + 1;
    else high = middle;
  }
  return values[low - 1] ?? null;
}
