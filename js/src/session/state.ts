/** What a view knows of its session: one value, changed only by `apply`, which returns what changed. */

import {
  type Changes,
  type ChoicesView,
  type Difference,
  EMPTY_VIEW_STATE,
  type FindingView,
  type FromKernel,
  type ViewState,
  type WorldView,
} from "../protocol";

/** How the page hears the kernel: not yet, live, commands wait, nothing for seconds, never again. */
export type Link = "connecting" | "live" | "busy" | "lost" | "dead";

export interface LabState extends ViewState {
  link: Link;
  name: string;
  running: string;
  findings: FindingView[];
  accepted: boolean;
  patch: string;
  pending: Difference | null;
  choices: ChoicesView;
  world: WorldView | null;
  /** The machine that this view looks at, and the element chosen in it. */
  machine: string;
  chosen: string;
  follow: boolean;
}

export type Topic = keyof LabState | "snapshot";

export function initialState(): LabState {
  return {
    ...EMPTY_VIEW_STATE,
    link: "connecting",
    name: "",
    running: "",
    findings: [],
    accepted: true,
    patch: "",
    pending: null,
    choices: { bridges: [], worlds: [], programs: [] },
    world: null,
    machine: "",
    chosen: "",
    follow: false,
  };
}

/** Apply a message; returns the fields that changed. */
export function apply(state: LabState, message: FromKernel): Set<Topic> {
  const changed = new Set<Topic>();
  const put = (fields: Partial<LabState>) => {
    Object.assign(state, fields);
    for (const key of Object.keys(fields) as Topic[]) changed.add(key);
  };
  switch (message.type) {
    case "snapshot": {
      const { type, view, text, revision, frame, ...fields } = message;
      const { link, machine, chosen, follow } = state;
      put({
        ...initialState(),
        link,
        machine,
        chosen,
        follow,
        ...fields,
        ...merged(EMPTY_VIEW_STATE, frame),
      });
      changed.add("snapshot");
      break;
    }
    case "frame":
      put(merged(state, message));
      break;
    case "answer": {
      const { findings, accepted, reason, pending } = message;
      put({ findings, accepted, patch: reason, pending });
      break;
    }
    case "world":
      put({ world: message.world });
      break;
  }
  if (changed.has("program") && lookSomewhere(state)) changed.add("machine");
  if (state.follow && changed.has("lit") && followActive(state)) changed.add("machine");
  return changed;
}

/** The fields that a frame changes, with their new values: objects entry by entry, null takes one away. */
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

/** Look at the first machine that there is, when the one looked at is gone. */
function lookSomewhere(state: LabState): boolean {
  const machines = state.program.machines;
  if (machines.some((machine) => machine.path === state.machine)) return false;
  const around = machines.findLast((machine) => `${state.machine}/`.startsWith(`${machine.path}/`));
  state.machine = (around ?? machines[0])?.path ?? "";
  return true;
}

/** Look at the machine of the innermost active state. */
function followActive(state: LabState): boolean {
  let deepest = "";
  for (const path of state.lit) if (path.split("/").length > deepest.split("/").length) deepest = path;
  const machine = deepest.slice(0, Math.max(0, deepest.lastIndexOf("/")));
  if (!machine || machine === state.machine) return false;
  state.machine = machine;
  return true;
}
