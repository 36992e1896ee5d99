/**
 * The running program in its text: active states, the last fired transitions, and the values of
 * variables and events faintly at the ends of their lines.
 */

import { syntaxTree } from "@codemirror/language";
import { type EditorState, type Range, StateEffect } from "@codemirror/state";
import {
  Decoration,
  type DecorationSet,
  type EditorView,
  ViewPlugin,
  type ViewUpdate,
  WidgetType,
} from "@codemirror/view";
import { lastFired } from "../graph/marks";
import { outlineOf } from "../language/lrp";
import type { LabState } from "../session/state";
import { h } from "../ui/dom";

/** An effect: something that is drawn here has changed. */
export const liveChanged = StateEffect.define<null>();

const LONGEST = 60;

class ValueWidget extends WidgetType {
  constructor(readonly text: string) {
    super();
  }

  override eq(other: ValueWidget): boolean {
    return other.text === this.text;
  }

  override toDOM(): HTMLElement {
    return h("span", { class: "lrp-inline-value", "aria-hidden": "true" }, this.text);
  }

  override updateDOM(dom: HTMLElement): boolean {
    dom.textContent = this.text;
    return true;
  }

  override ignoreEvent(): boolean {
    return true;
  }
}

const activeLine = Decoration.line({ class: "lrp-line-active" });
const firedMark = Decoration.mark({ class: "lrp-text-fired" });

/** The part of the state that determines the marks, without the values. */
export function marksOf({ lit, fired, program }: LabState): string {
  return [...lit, ...program.machines.map(({ path }) => lastFired(fired, path))].join(" ");
}

/** Draws the run of the program; `values` returns whether values are shown. */
export function live(state: LabState, values: () => boolean) {
  return ViewPlugin.fromClass(
    class {
      decorations: DecorationSet;

      constructor(view: EditorView) {
        this.decorations = decorate(view.state, state, values());
      }

      update(update: ViewUpdate): void {
        const changed = update.transactions.some((tr) => tr.effects.some((effect) => effect.is(liveChanged)));
        const parsed = syntaxTree(update.startState) !== syntaxTree(update.state);
        if (changed || parsed || update.docChanged)
          this.decorations = decorate(update.state, state, values());
      }
    },
    { decorations: (plugin) => plugin.decorations },
  );
}

function decorate(editor: EditorState, lab: LabState, values: boolean): DecorationSet {
  const found = outlineOf(editor);
  const marks: Range<Decoration>[] = [];
  const lines = new Set<number>();
  for (const path of lab.lit) {
    const item = found.find("state", path);
    if (!item) continue;
    const innermost = !lab.lit.some((other) => other.startsWith(`${path}/`));
    const last = innermost ? editor.doc.lineAt(item.to).number : editor.doc.lineAt(item.nameTo).number;
    for (let line = editor.doc.lineAt(item.from).number; line <= last; line++) lines.add(line);
  }
  for (const line of lines) marks.push(activeLine.range(editor.doc.line(line).from));
  for (const machine of lab.program.machines) {
    const item = found.find("transition", lastFired(lab.fired, machine.path));
    if (item) marks.push(firedMark.range(item.from, item.to));
  }
  if (values) {
    for (const [line, text] of lineValues(editor, lab)) {
      const widget = Decoration.widget({ widget: new ValueWidget(text), side: 1 });
      marks.push(widget.range(editor.doc.line(line).to));
    }
  }
  return Decoration.set(marks, true);
}

/** The annotation at the end of each line. */
function lineValues(editor: EditorState, lab: LabState): Map<number, string> {
  const texts = new Map<number, string[]>();
  for (const item of outlineOf(editor).items) {
    const value = shownValue(item.kind, item.path, lab);
    if (value === null) continue;
    const line = editor.doc.lineAt(item.to).number;
    const list = texts.get(line) ?? [];
    texts.set(line, [...list, `${item.name} = ${value}`]);
  }
  const alone = (list: string[]) =>
    list.length === 1 ? list[0]!.slice(list[0]!.indexOf(" = ") + 3) : list.join("   ");
  return new Map([...texts].map(([line, list]) => [line, alone(list)]));
}

function shownValue(kind: string, path: string, lab: LabState): string | null {
  const text =
    kind === "variable" ? lab.variables[path]?.text : kind === "event" ? eventText(lab, path) : undefined;
  if (text === undefined) return null;
  return text.length > LONGEST ? `${text.slice(0, LONGEST)}…` : text;
}

function eventText(lab: LabState, path: string): string | undefined {
  const value = lab.events[path];
  return value === undefined || value === null ? undefined : value ? "True" : "False";
}
