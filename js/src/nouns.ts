/**
 * What the messages between page and kernel speak of. The same types stand in
 * `lrp_jupyter/widgets/nouns.py`, where each is explained; a test holds the two equal. One field per
 * line, no nested literal types: that test reads this file.
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
  press: string;
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
  button: string;
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

/* ------------------------------------------------------------------ layout (lrp_jupyter/views/layout.py) */

export type Layout = import("./graph/layout").GraphLayout;
