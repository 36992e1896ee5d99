/**
 * The messages between the lab in the page and its session in the kernel.
 *
 * The same types stand in `lrp_jupyter/widgets/protocol.py`, where every message is explained; a
 * test holds the two equal. One field per line, no nested literal types: that test reads this file.
 *
 * Places in texts are lines and columns from 1, columns in characters (code points), as the language
 * counts them. Only the page knows UTF-16: `text/places.ts` converts, nothing else does.
 */

export type Part = "lab" | "controls" | "editor" | "tree" | "graph" | "variables" | "issues" | "world";
export type Status = "ready" | "running" | "paused" | "hung" | "stopped" | "broken" | "closed";
export type Severity = "error" | "warning" | "hint";
export type OnActiveEdit = "restart" | "keep";
export type ElementKind = "machine" | "state" | "transition" | "event" | "variable" | "robot";
export type TransitionKind = "on" | "ontime" | "eps" | "exit";
export type Point = [number, number];
export type Pose = [number, number, number];

export interface Range {
  line: number;
  column: number;
  end_line: number;
  end_column: number;
}

export interface TextEdit {
  range: Range;
  text: string;
}

export interface QuickFix {
  title: string;
  edits: TextEdit[];
}

export interface FindingView {
  code: string;
  severity: Severity;
  message: string;
  range: Range;
  fix: QuickFix | null;
}

export interface IssueView {
  id: number;
  code: string;
  severity: Severity;
  kind: string;
  element: string;
  message: string;
  revision: number;
  range: Range | null;
  traceback: string;
  first_tick: number;
  last_tick: number;
  count: number;
  resolved: boolean;
}

export interface ValueView {
  text: string;
  number: number | null;
}

export interface StateItem {
  path: string;
  machines: string[];
}

export interface TransitionItem {
  id: string;
  kind: TransitionKind;
  trigger: string;
  source: string;
  destination: string;
}

export interface MachineItem {
  path: string;
  parent: string | null;
  states: StateItem[];
  transitions: TransitionItem[];
  variables: string[];
  events: string[];
}

export interface ProgramView {
  variables: string[];
  events: string[];
  machines: MachineItem[];
}

export interface Difference {
  added: string[];
  removed: string[];
  changed: string[];
  moved: string[];
}

export interface RateView {
  wanted: number;
  achieved: number;
}

export interface SpeedView {
  wanted: number;
  achieved: number;
}

export interface FiredView {
  count: number;
  tick: number;
}

export interface RestartView {
  count: number;
  tick: number;
  reason: string;
}

export interface HungView {
  where: string;
  seconds: number;
}

export interface PrintedView {
  first: number;
  lines: string[];
}

export interface MemberView {
  name: string;
  kind: string;
  type: string;
  unit: string;
  doc: string;
  insert: string;
}

export interface BridgeView {
  name: string;
  status: string;
  sentence: string;
  hardware: boolean;
  armed: boolean;
  members: MemberView[];
}

export interface PanelField {
  key: string;
  label: string;
  kind: "text" | "number" | "choice" | "switch" | "value";
  value: string;
  choices: string[];
  unit: string;
}

export interface PanelButton {
  key: string;
  label: string;
}

export interface PanelTable {
  key: string;
  title: string;
  columns: string[];
  keys: string[];
  rows: string[][];
  buttons: PanelButton[];
}

export interface PanelQuestion {
  key: string;
  text: string;
  default: string;
}

export interface PanelView {
  title: string;
  fields: PanelField[];
  tables: PanelTable[];
  buttons: PanelButton[];
  questions: PanelQuestion[];
}

export interface Stroke {
  path?: Point[];
  circle?: Pose;
  arc?: number[];
  width?: number;
  grey?: number;
  ink?: boolean;
}

export interface Floor {
  grey?: number;
  strokes?: Stroke[];
}

export interface Solid {
  box?: number[];
  circle?: Pose;
  angle?: number;
  name?: string;
  push?: number | null;
}

export interface RobotShape {
  pose: Pose;
  radius?: number;
  light?: Point[];
  bumper?: boolean;
  distance?: Point[];
}

export interface Zone {
  circle?: Pose;
  box?: number[];
}

export interface WorldView {
  version: number;
  name?: string;
  open?: boolean;
  size: Point;
  seed: number;
  floor: Floor;
  solids: Solid[];
  robots: RobotShape[];
  zones: Record<string, Zone>;
}

export interface InkView {
  first: number;
  strokes: Stroke[];
}

export interface SettingsView {
  hold: boolean;
  on_active_edit: OnActiveEdit;
  pause_on_issue: boolean;
}

export interface ConflictView {
  text: string;
  sentence: string;
}

export interface ChoicesView {
  bridges: string[];
  worlds: string[];
  programs: string[];
}

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

/** Comes with one binary buffer, read by `world/poses.ts`. */
export interface Poses {
  type: "poses";
  view: string;
  frame: number;
  ink?: InkView;
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

export type FromKernel = Frame | Answer | Snapshot | WorldMessage | Poses | Reply;

/* ------------------------------------------------------------------ layout (lrp_jupyter/views/layout.py) */

export type Layout = import("./graph/layout").GraphLayout;
