/**
 * The running program in its text: active states, the last fired transitions, and the values of
 * variables and events faintly at the right of their lines.
 */

import { syntaxTree } from "@codemirror/language";
import {
  type EditorState,
  type Extension,
  type Range,
  StateEffect,
  type Transaction,
} from "@codemirror/state";
import { Decoration, type DecorationSet, WidgetType } from "@codemirror/view";
import { lastFired } from "../graph/marks";
import type { Outline } from "../language/outline";
import { history } from "../parts/history";
import { valuesOf } from "../session/instances";
import { besideGraph, type LabState } from "../session/state";
import { ofEvent, ofVariable, type Subject } from "../timeline/spark";
import { shortened } from "../ui/cut";
import { h, reconcile, setAttribute, setText } from "../ui/dom";
import { readable } from "../ui/numbers";
import { testedEvents } from "./tested";
import { decorating } from "./visible";
import { wholeOutline, wholeOutlineOf } from "./whole";

/** An effect: something that is drawn here has changed. */
export const liveChanged = StateEffect.define<null>();

const LONGEST = 60;
const HISTORY: Record<string, (path: string) => Subject> = { event: ofEvent, variable: ofVariable };
const CALL = /\brobot\.(\w+)(?=\s*\()/g;
const FAILED = /^(aborted|rejected|lost)/;

class ValueWidget extends WidgetType {
  constructor(private readonly values: readonly Value[]) {
    super();
  }

  override eq(other: ValueWidget): boolean {
    return JSON.stringify(other.values) === JSON.stringify(this.values);
  }

  override toDOM(): HTMLElement {
    const values = h("span", { class: "lrp-values" });
    const dom = h("span", { class: "lrp-inline-value", "aria-hidden": "true" }, values);
    this.updateDOM(dom);
    return dom;
  }

  override updateDOM(dom: HTMLElement): boolean {
    const named = this.values.length > 1;
    reconcile(
      dom.firstElementChild!,
      this.values,
      ({ kind, path }) => `${kind} ${path}`,
      ({ kind, path }) => h("span", HISTORY[kind] ? history(HISTORY[kind](path)) : {}),
      (part, { kind, name, text, stale, failed }) => {
        setAttribute(part, "data-stale", stale);
        setAttribute(part, "data-failed", failed);
        setAttribute(part, "title", kind === "task" && text);
        setText(part, named ? `${name} = ${text}` : text);
      },
    );
    return true;
  }

  override ignoreEvent(): boolean {
    return true;
  }
}

const activeLine = Decoration.line({ class: "lrp-line-active" });
const firedMark = Decoration.mark({ class: "lrp-text-fired" });

/** The part of the state that determines the marks, without the values of variables and events. */
export function marksOf(state: LabState): string {
  const { lit, fired } = besideGraph(state);
  return [...lit, ...lastFired(fired), ...tasksIn(state).values()].join(" ");
}

/** What has become of the tasks that are asked for, by their names. */
function tasksIn({ bridge, members }: LabState): Map<string, string> {
  const asked = bridge.members.filter(({ kind, name }) => kind === "task" && members[name]);
  return new Map(asked.map(({ name }) => [name, members[name]!]));
}

/** Draws the run of the program; `values` returns whether values are shown. */
export function live(state: LabState, values: () => boolean): Extension {
  const isOfRun = ({ effects }: Transaction) => effects.some((effect) => effect.is(liveChanged));
  return [
    wholeOutline,
    decorating(
      (view) => decorate(view.state, wholeOutlineOf(view.state), state, values()),
      ({ transactions }) => transactions.some(isOfRun),
    ),
  ];
}

function decorate(editor: EditorState, found: Outline, lab: LabState, values: boolean): DecorationSet {
  const marks: Range<Decoration>[] = [];
  const lines = new Set<number>();
  const { lit, fired } = besideGraph(lab);
  for (const path of lit) {
    const item = found.find("state", path);
    if (!item) continue;
    const innermost = !lit.some((other) => other.startsWith(`${path}/`));
    const last = innermost ? editor.doc.lineAt(item.to).number : editor.doc.lineAt(item.nameTo).number;
    for (let line = editor.doc.lineAt(item.from).number; line <= last; line++) lines.add(line);
  }
  for (const line of lines) marks.push(activeLine.range(editor.doc.line(line).from));
  for (const path of lastFired(fired)) {
    const item = found.find("transition", path);
    if (item) marks.push(firedMark.range(item.from, item.to));
  }
  if (values) {
    for (const [line, shown] of lineValues(editor, found, lab)) {
      const widget = Decoration.widget({ widget: new ValueWidget(shown), side: 1 });
      marks.push(widget.range(editor.doc.line(line).to));
    }
  }
  return Decoration.set(marks, true);
}

/** What is shown at the end of a line; an event that is not tested now has its last value, and a task may have failed. */
interface Value {
  kind: string;
  path: string;
  name: string;
  text: string;
  stale?: boolean;
  failed?: boolean;
}

function lineValues(editor: EditorState, outline: Outline, lab: LabState): Map<number, Value[]> {
  const lines = new Map<number, Value[]>();
  const add = (at: number, ...values: Value[]) => {
    const line = editor.doc.lineAt(at).number;
    lines.set(line, [...(lines.get(line) ?? []), ...values]);
  };
  const tested = testedEvents(lab);
  for (const { kind, path, name, to } of outline.items) {
    const shown = shownValues(kind, path, lab);
    if (!shown.length) continue;
    const values = shown.map(({ place, path: at, text }) => {
      const part = shown.length > 1 ? `${name} ${place}` : name;
      const stale = kind === "event" && !tested.has(at);
      return { kind, path: place ? at : path, name: part, text: shortened(readable(text), LONGEST), stale };
    });
    add(to, ...values);
  }
  for (const [at, task] of tasksOf(editor, outline, lab)) add(at, task);
  return lines;
}

/** The tasks that the active states ask for, and where they do. */
function* tasksOf(editor: EditorState, outline: Outline, lab: LabState): Iterable<[number, Value]> {
  const { lit } = besideGraph(lab);
  const tasks = tasksIn(lab);
  if (!tasks.size) return;
  for (const { index, 1: path = "" } of editor.doc.toString().matchAll(CALL)) {
    const [text, state] = [tasks.get(path), outline.around(index, "state")];
    if (!text || !state || !lit.includes(state.path) || !isName(editor, index)) continue;
    yield [index, { kind: "task", path, name: path, text, failed: FAILED.test(text) }];
  }
}

function isName(editor: EditorState, offset: number): boolean {
  return syntaxTree(editor).resolveInner(offset, 1).name === "VariableName";
}

/** The value of a variable, or the last one of an event, in each instance of its machine that is meant. */
function shownValues(kind: string, path: string, lab: LabState): ReturnType<typeof valuesOf> {
  return kind === "variable" || kind === "event" ? valuesOf(besideGraph(lab), kind, path) : [];
}
