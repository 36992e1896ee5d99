/** What a view knows of its session: one value, changed only by `apply`, which tells what changed. */

import type { GraphLayout } from "../graph/layout";
import type {
  BridgeView,
  ChoicesView,
  ConflictView,
  Difference,
  FindingView,
  FiredView,
  Frame,
  FromKernel,
  HungView,
  IssueView,
  PanelView,
  ProgramView,
  RateView,
  RestartView,
  SettingsView,
  SpeedView,
  Status,
  ValueView,
  WorldView,
} from "../protocol";

/** How the page hears the kernel: not yet, live, commands wait, nothing for seconds, never again. */
export type Link = "connecting" | "live" | "busy" | "lost" | "dead";

export interface LabState {
  link: Link;
  name: string;
  revision: number;
  running: string;
  findings: FindingView[];
  accepted: boolean;
  patch: string;
  program: ProgramView;
  layouts: Record<string, GraphLayout>;
  pending: Difference | null;
  choices: ChoicesView;
  world: WorldView | null;
  status: Status;
  reason: string;
  tick: number;
  time: number;
  rate: RateView;
  speed: SpeedView;
  active: string[];
  lit: Set<string>;
  entered: Record<string, FiredView>;
  fired: Record<string, FiredView>;
  variables: Map<string, ValueView>;
  events: Record<string, boolean | null>;
  members: Record<string, string>;
  issues: Map<number, IssueView>;
  restart: RestartView | null;
  hung: HungView | null;
  printed: string[];
  bridge: BridgeView;
  panel: PanelView | null;
  settings: SettingsView;
  conflict: ConflictView | null;
  /** The machine that this view looks at, and the element chosen in it. */
  machine: string;
  chosen: string;
  follow: boolean;
}

export type Topic = keyof LabState | "snapshot";

const PRINTED_KEPT = 500;

export function initialState(): LabState {
  return {
    link: "connecting",
    name: "",
    revision: 0,
    running: "",
    findings: [],
    accepted: true,
    patch: "",
    program: { variables: [], events: [], machines: [] },
    layouts: {},
    pending: null,
    choices: { bridges: [], worlds: [], programs: [] },
    world: null,
    status: "ready",
    reason: "",
    tick: 0,
    time: 0,
    rate: { wanted: 10, achieved: 0 },
    speed: { wanted: 1, achieved: 0 },
    active: [],
    lit: new Set(),
    entered: {},
    fired: {},
    variables: new Map(),
    events: {},
    members: {},
    issues: new Map(),
    restart: null,
    hung: null,
    printed: [],
    bridge: { name: "", status: "", sentence: "", hardware: false, armed: true, members: [] },
    panel: null,
    settings: { hold: false, on_active_edit: "restart", pause_on_issue: false },
    conflict: null,
    machine: "",
    chosen: "",
    follow: false,
  };
}

/** Take a message in. */
export function apply(state: LabState, message: FromKernel): Set<Topic> {
  const changed = new Set<Topic>();
  const put = <K extends keyof LabState>(key: K, value: LabState[K]) => {
    state[key] = value;
    changed.add(key);
  };
  switch (message.type) {
    case "snapshot": {
      const { link, machine, chosen, follow } = state;
      Object.assign(state, initialState(), { link, machine, chosen, follow });
      for (const key of Object.keys(state) as Topic[]) changed.add(key);
      changed.add("snapshot");
      const { name, revision, running, findings, program, layouts, pending, choices, world } = message;
      Object.assign(state, { name, revision, running, findings, program, layouts, pending, choices, world });
      mergeFrame(message.frame, state, put);
      lookSomewhere(state);
      break;
    }
    case "frame":
      mergeFrame(message, state, put);
      break;
    case "answer":
      put("findings", message.findings);
      put("accepted", message.accepted);
      put("patch", message.reason);
      put("pending", message.pending);
      if (message.program) put("program", message.program);
      if (message.layouts) put("layouts", { ...state.layouts, ...message.layouts });
      if (message.program && lookSomewhere(state)) changed.add("machine");
      break;
    case "world":
      put("world", message.world);
      break;
  }
  if (state.follow && changed.has("lit") && followActive(state)) changed.add("machine");
  return changed;
}

function mergeFrame(
  frame: Frame,
  state: LabState,
  put: <K extends keyof LabState>(key: K, value: LabState[K]) => void,
): void {
  const {
    type,
    view,
    frame: _number,
    lit,
    entered,
    fired,
    variables,
    events,
    members,
    layouts,
    ink: _drawnByTheWorld,
    ...rest
  } = frame;
  const { issues, gone, printed, ...plain } = rest;
  for (const [key, value] of Object.entries(plain)) put(key as keyof LabState, value as never);
  if (lit) put("lit", new Set(lit));
  if (entered) put("entered", { ...state.entered, ...entered });
  if (fired) put("fired", { ...state.fired, ...fired });
  if (events) put("events", { ...state.events, ...events });
  if (members) put("members", { ...state.members, ...members });
  if (layouts) put("layouts", { ...state.layouts, ...layouts });
  if (variables) {
    const all = new Map(state.variables);
    for (const [path, value] of Object.entries(variables)) {
      if (value) all.set(path, value);
      else all.delete(path);
    }
    put("variables", all);
  }
  if (issues || gone) {
    const all = new Map(state.issues);
    for (const id of gone ?? []) all.delete(id);
    for (const issue of issues ?? []) all.set(issue.id, issue);
    put("issues", all);
  }
  if (printed) put("printed", [...state.printed, ...printed.lines].slice(-PRINTED_KEPT));
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
