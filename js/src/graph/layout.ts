/** The drawing of one machine, as `lrp_jupyter/views/layout.py` makes it; explained there. All numbers px. */

export interface Place {
  x: number;
  y: number;
  gone?: number;
  pinned?: boolean;
}

export interface Label {
  text: string;
  x: number;
  y: number;
  width: number;
  height: number;
}

export interface Start {
  x: number;
  y: number;
  radius: number;
  d: string;
  head: string;
}

export interface StateShape {
  id: string;
  name: string;
  kind: string;
  x: number;
  y: number;
  width: number;
  height: number;
  label: string;
  nested: string;
  machines: string[];
  title: string;
  start: Start | null;
}

export interface TransitionShape {
  id: string;
  name: string;
  kind: string;
  style: string;
  source: string;
  destination: string;
  d: string;
  head: string;
  mark: string;
  label: Label;
  title: string;
  broken: string | null;
}

export interface Port {
  x: number;
  y: number;
  name: string;
  label: Label;
  missing: boolean;
}

/** Boxes are `[left, top, width, height]`. */
export interface GraphLayout {
  machine: string;
  name: string;
  view: number[];
  frame: number[];
  states: StateShape[];
  transitions: TransitionShape[];
  ports: Port[];
  places: Record<string, Place>;
}
