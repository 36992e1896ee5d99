/**
 * The messages between the lab in the page and its session in the kernel.
 *
 * The same types stand in `lrp_jupyter/widgets/protocol.py`, where every message is explained; a
 * test holds the two equal. What they speak of is in `nouns.ts`.
 */

import type {
  BridgeView,
  ChoicesView,
  ConflictView,
  Difference,
  ElementKind,
  FindingView,
  FiredView,
  HungView,
  InkView,
  IssueView,
  Layout,
  PanelView,
  Part,
  Point,
  Pose,
  PrintedView,
  ProgramView,
  Range,
  RateView,
  RestartView,
  SettingsView,
  SpeedView,
  Status,
  ValueView,
  WorldView,
} from "./nouns";

export type * from "./nouns";

/* ------------------------------------------------------------------ page -> kernel */

export interface Hello {
  type: "hello";
  view: string;
  part: Part;
}

export interface Bye {
  type: "bye";
  view: string;
}

export interface Text {
  type: "text";
  view: string;
  seq: number;
  base: number;
  text: string;
}

export interface Credit {
  type: "credit";
  view: string;
  frame: number;
}

export interface Complete {
  type: "complete";
  view: string;
  id: number;
  prefix: string;
  scope: string;
}

export interface Hover {
  type: "hover";
  view: string;
  id: number;
  chain: string;
  scope: string;
}

export interface References {
  type: "references";
  view: string;
  id: number;
  line: number;
  column: number;
}

export interface Inspect {
  type: "inspect";
  view: string;
  id: number;
  kind: ElementKind;
  path: string;
  into: string[];
}

export type Request = Complete | Hover | References | Inspect;

export interface Command {
  type: "command";
  view: string;
  id: number;
  do: Act;
  on?: boolean;
  value?: number;
  name?: string;
  path?: string;
  kind?: ElementKind;
  expression?: string;
  index?: number;
  pose?: Pose;
  points?: Point[];
  width?: number;
  grey?: number;
  key?: string;
  row?: string;
  values?: Record<string, string>;
}

export type Act =
  | "run"
  | "pause"
  | "step"
  | "step_back"
  | "reset"
  | "stop"
  | "rate"
  | "speed"
  | "hold"
  | "apply"
  | "revert"
  | "transition"
  | "teleport"
  | "fire"
  | "set_variable"
  | "rename"
  | "drag_robot"
  | "drag_solid"
  | "drop"
  | "stroke"
  | "erase"
  | "reset_pose"
  | "reset_world"
  | "world"
  | "clear_issues"
  | "pause_on_issue"
  | "on_active_edit"
  | "armed"
  | "bridge"
  | "select"
  | "pin"
  | "arrange"
  | "panel"
  | "load"
  | "take"
  | "keep"
  | "save";

export type FromPage = Hello | Bye | Text | Credit | Request | Command;

/* ------------------------------------------------------------------ kernel -> page */

/** If something moved in the world, one binary buffer comes with it, read by `world/poses.ts`. */
export interface Frame {
  type: "frame";
  view: string;
  frame: number;
  status?: Status;
  reason?: string;
  tick?: number;
  time?: number;
  rate?: RateView;
  speed?: SpeedView;
  revision?: number;
  active?: string[];
  lit?: string[];
  entered?: Record<string, FiredView>;
  fired?: Record<string, FiredView>;
  variables?: Record<string, ValueView | null>;
  events?: Record<string, boolean | null>;
  members?: Record<string, string>;
  issues?: IssueView[];
  gone?: number[];
  restart?: RestartView;
  hung?: HungView | null;
  printed?: PrintedView;
  bridge?: BridgeView;
  panel?: PanelView | null;
  settings?: SettingsView;
  conflict?: ConflictView | null;
  layouts?: Record<string, Layout>;
  ink?: InkView;
}

export interface Answer {
  type: "answer";
  view: string;
  seq: number;
  revision: number;
  text: string | null;
  findings: FindingView[];
  accepted: boolean;
  applied: boolean;
  reason: string;
  program: ProgramView | null;
  layouts: Record<string, Layout> | null;
  pending: Difference | null;
}

export interface Snapshot {
  type: "snapshot";
  view: string;
  name: string;
  text: string;
  revision: number;
  running: string;
  findings: FindingView[];
  program: ProgramView;
  layouts: Record<string, Layout>;
  pending: Difference | null;
  choices: ChoicesView;
  world: WorldView | null;
  frame: Frame;
}

export interface WorldMessage {
  type: "world";
  view: string;
  world: WorldView | null;
}

export interface Option {
  label: string;
  kind: string;
  detail: string;
  info: string;
}

export interface HoverView {
  title: string;
  type: string;
  value: string;
  doc: string;
}

export interface ReferencesView {
  kind: ElementKind;
  path: string;
  name: string;
  definition: Range | null;
  references: Range[];
}

export interface Facet {
  step: string;
  label: string;
  type: string;
  text: string;
  deep: boolean;
}

export interface InspectView {
  title: string;
  type: string;
  text: string;
  source: string;
  facets: Facet[];
  more: number;
}

export interface Reply {
  type: "reply";
  view: string;
  id: number;
  error: string | null;
  options?: Option[];
  hover?: HoverView | null;
  references?: ReferencesView | null;
  inspect?: InspectView;
}

export type FromKernel = Frame | Answer | Snapshot | WorldMessage | Reply;
