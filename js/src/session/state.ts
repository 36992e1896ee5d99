/** The state of a view: one value, changed only by `apply`, which returns the changed fields. */

import type { Camera } from "../graph/camera";
import { isIn, machineOf, nameOf } from "../language/paths";
import {
  type AnswerMessage,
  type Changes,
  type Course,
  type ElementKind,
  EMPTY_VIEW_STATE,
  type FromKernel,
  type OneWay,
  type SnapshotMessage,
  type ViewState,
  type WhatIf,
} from "../protocol";
import { inInstance } from "./instances";

/** How the kernel responds: not yet, at once, late, not for seconds, never again. */
export type Link = "connecting" | "live" | "busy" | "lost" | "dead";

/** A number that is stepped through: its text before, now and one step on, and the program with each. */
export interface Stepped {
  values: readonly [before: string, now: string, beyond: string];
  programs: readonly string[];
}

/** How it goes on; of a number that is stepped through also one step on, with the three values. */
export interface Foretold extends WhatIf {
  tried?: { values: Stepped["values"]; beyond: Course };
}

/** Which of the kept runs have entered each state, and fired each transition. */
export interface Reached {
  /** How many runs there are. */
  runs: number;
  /** Their names, by kind and path of the element. */
  names: ReadonlyMap<string, readonly string[]>;
  conditions: Readonly<Record<string, OneWay>>;
  /** What all of them reach together. */
  words: string;
}

/** What a snapshot brings, of which answers and worlds replace some; its other fields belong to the editor. */
type Told = Omit<
  SnapshotMessage,
  "type" | "view" | "document" | "number" | "seq" | "text" | "revision" | "updates" | "half_typed" | "frame"
>;

export interface LabState extends ViewState, Told {
  link: Link;
  patch: string;
  /** Why the text is not saved with the notebook; empty if it is, or if there is none. */
  unsaved: string;
  /** The machine that this view shows, the element selected in it, and the one in the inspector. */
  machine: string;
  chosen: string;
  /** The instance that is selected, by its path as spawned: see `instances.ts`. Empty: none. */
  instance: string;
  inspected: { kind: ElementKind; path: string } | null;
  /** Zoom and pan of each machine that was shown. */
  cameras: Record<string, Camera>;
  /** Which machine is shown automatically: the one with the innermost active state, the one around the cursor, or none. */
  follow: "active" | "cursor" | "nothing";
  /** What the timeline plots. */
  plots: readonly string[];
  whatIf: Foretold | null;
  /** Why it is not shown how it goes on; empty if it is, or if that was not asked. */
  unforetold: string;
  /** The number that was changed by the last step in the editor, until something else is done there. */
  stepped: Stepped | null;
  /** What the kept runs have reached, where that is to be shown. */
  reached: Reached | null;
}

/** The parts of the run that are shown unasked. */
type Run = Pick<
  LabState,
  | "active"
  | "lit"
  | "users"
  | "instances"
  | "instance"
  | "entered"
  | "fired"
  | "countdowns"
  | "variables"
  | "events"
>;

const NOTHING: Run = {
  ...{ active: [], lit: [], users: {}, instances: [], instance: "" },
  ...{ entered: {}, fired: {}, countdowns: {}, variables: {}, events: {} },
};

/** The run as the graph shows it: a static one shows nothing of it. */
export function inGraph(state: LabState): Run {
  return state.settings.graph === "live" ? state : NOTHING;
}

/** The run as all other parts show it unasked: in a quiet lab, nothing. */
export function besideGraph(state: LabState): Run {
  return state.settings.quiet ? NOTHING : state;
}

export type Topic = keyof LabState | "snapshot";

export function initialState(): LabState {
  return {
    ...EMPTY_VIEW_STATE,
    link: "connecting",
    name: "",
    home: "",
    tab_only: false,
    debugger: "",
    by_hand: "",
    running: "",
    findings: [],
    accepted: true,
    patch: "",
    unsaved: "",
    pending: null,
    choices: { bridges: [], worlds: [], programs: [] },
    world: null,
    machine: "",
    chosen: "",
    instance: "",
    inspected: null,
    cameras: {},
    follow: "nothing",
    plots: [],
    whatIf: null,
    unforetold: "",
    stepped: null,
    reached: null,
  };
}

/** Apply a message; returns the fields that changed. */
export function apply(state: LabState, message: FromKernel): Set<Topic> {
  let changes: Partial<LabState> = {};
  if (message.type === "frame") {
    changes = { ...merged(state, message), ...carriedOver(state, message.moved) };
  } else if (message.type === "snapshot") {
    const { type, view, document, number, seq, text, revision, updates, half_typed, frame, ...fields } =
      message;
    const waits = message.accepted && !message.pending && text !== message.running;
    const { link, machine, chosen, instance, inspected, cameras, follow } = state;
    changes = {
      ...initialState(),
      ...{ link, machine, chosen, instance, inspected, cameras, follow },
      ...fields,
      patch: waits ? "not running yet" : "",
      ...merged(EMPTY_VIEW_STATE, frame),
      ...carriedOver(state, frame.moved),
    };
  } else if (message.type === "answer") {
    const { accepted, applied, reason, pending } = message;
    const findings = isJudged(message) ? message.findings : state.findings;
    changes = { findings, accepted, patch: applied ? "" : reason, pending };
  } else if (message.type === "world") changes = { world: message.world };
  Object.assign(state, changes);
  const changed = new Set(Object.keys(changes) as Topic[]);
  if (message.type === "snapshot") changed.add("snapshot");
  if (changed.has("program") && showAnother(state)) changed.add("machine");
  return changed;
}

/** Whether a text is a program, or left as it is; until then, views show the findings of the last one that was. */
export function isJudged({ accepted, half_typed }: AnswerMessage): boolean {
  return accepted || !half_typed;
}

/**
 * What this view remembers of elements, under the paths that an edit or a rename gave them. Edits that the
 * state already knows were applied before; the others are applied in their order.
 */
function carriedOver(state: LabState, moved: Changes<ViewState>["moved"]): Partial<LabState> {
  let { machine, chosen, instance, inspected, cameras } = state;
  for (const [revision, elements] of Object.entries(moved ?? {})) {
    if (!elements || revision in state.moved) continue;
    const now = (kind: ElementKind, path: string) =>
      elements.find((element) => element.kind === kind && element.old === path)?.new ?? path;
    machine = now("machine", machine);
    cameras = Object.fromEntries(Object.entries(cameras).map(([path, each]) => [now("machine", path), each]));
    chosen = now(chosen.includes(":") ? "transition" : "state", chosen);
    instance = afterMoves(state, instance, now);
    if (inspected) {
      const { kind, path } = inspected;
      const known = state.instances.find(
        (each) => each.path === machineOf(path) && each.machine !== each.path,
      );
      const place = known && afterMoves(state, known.path, now);
      const element = now(kind, known ? inInstance(path, known.machine) : path);
      inspected = { kind, path: place ? inInstance(element, place) : element };
    }
  }
  const fields: Partial<LabState> = {};
  if (cameras !== state.cameras) fields.cameras = cameras;
  if (machine !== state.machine) fields.machine = machine;
  if (instance !== state.instance) fields.instance = instance;
  if (chosen !== state.chosen) fields.chosen = chosen;
  if (inspected?.path !== state.inspected?.path) fields.inspected = inspected;
  return fields;
}

/** The path of an instance after elements have moved: each machine and state on it with its new name. */
function afterMoves(
  { instances }: Pick<ViewState, "instances">,
  instance: string,
  now: (kind: ElementKind, path: string) => string,
): string {
  const names = instance.split("/");
  let machine = "";
  return names
    .map((name, index) => {
      const path = names.slice(0, index + 1).join("/");
      if (index % 2) return nameOf(now("state", `${machine}/${name}`));
      machine = instances.find((each) => each.path === path)?.machine ?? path;
      return nameOf(now("machine", machine));
    })
    .join("/");
}

/** The fields that a frame changes, with their new values: objects entry by entry, null removes one. */
function merged(state: ViewState, frame: Changes<ViewState>): Partial<ViewState> {
  const fields: Record<string, unknown> = {};
  for (const key of Object.keys(EMPTY_VIEW_STATE) as (keyof ViewState)[]) {
    if (!(key in frame)) continue;
    const [old, now] = [state[key], frame[key]];
    fields[key] = isObject(old) && isObject(now) ? withoutNull({ ...old, ...now }) : now;
  }
  return fields;
}

function isObject(value: unknown): value is object {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

function withoutNull(entries: object): object {
  return Object.fromEntries(Object.entries(entries).filter(([, value]) => value !== null));
}

/** Show the first machine if the one shown no longer exists. */
function showAnother(state: LabState): boolean {
  const machines = state.program.machines;
  if (machines.some((machine) => machine.path === state.machine)) return false;
  const around = machines.findLast(({ path }) => isIn(state.machine, path));
  state.machine = around?.path ?? state.program.main;
  return true;
}
