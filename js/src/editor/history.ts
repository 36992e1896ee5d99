/** The value at the cursor, or at the end of its line, over the last half minute. */

import type { EditorState, Extension } from "@codemirror/state";
import { keymap } from "@codemirror/view";
import { outlineOf } from "../language/lrp";
import { openHistory } from "../parts/history";
import type { Lab } from "../session/store";
import { ofEvent, ofReading, ofVariable, type Subject } from "../timeline/spark";
import { chainAt, partOf } from "./context";

const LONGEST = 80; // letters of a reading's name

/** What has a value at an offset: a name, with the condition in which it stands. */
export function subjectAt(lab: Lab, state: EditorState, offset: number): Subject | null {
  const chain = chainAt(state, offset);
  if (!chain) return null;
  const found = outlineOf(state);
  const event = found.around(chain.from, "event");
  const isDefined = event?.nameFrom === chain.from;
  const within = isDefined ? "" : (event?.path ?? "");
  const rest = /^[\w.]*/.exec(state.sliceDoc(chain.to, chain.to + LONGEST))![0];
  const { members } = lab.store.state.bridge;
  const reading = members.find(
    ({ name, kind }) => kind === "variable" && `robot.${name}` === chain.text + rest,
  );
  if (reading) return { ...ofReading(reading.name), event: within };
  const scope = found.around(chain.from, "machine")?.path ?? "";
  const called = (kind: "variable" | "event") =>
    found.inScope(kind, scope).find(({ name }) => name === chain.text);
  const variable = isDefined
    ? undefined
    : (called("variable") ?? partOf(state, scope, "variable", chain.text));
  if (variable) return { ...ofVariable(variable.path), event: within };
  const named = called("event");
  return named ? ofEvent(named.path) : null;
}

/** What has its value at the end of a line. */
function subjectOfLine(state: EditorState, offset: number): Subject | null {
  const { from, to } = state.doc.lineAt(offset);
  const item = outlineOf(state).items.find(
    (each) => from <= each.to && each.to <= to && (each.kind === "variable" || each.kind === "event"),
  );
  if (!item) return null;
  return item.kind === "event" ? ofEvent(item.path) : ofVariable(item.path);
}

/** Shift+Alt+H shows the history of the value at the cursor. */
export function historyAtCursor(lab: Lab): Extension {
  return keymap.of([
    {
      key: "Shift-Alt-h",
      run: (view) => {
        const { head } = view.state.selection.main;
        const subject = subjectAt(lab, view.state, head) ?? subjectOfLine(view.state, head);
        const at = view.coordsAtPos(head);
        if (!subject || !at || lab.store.state.settings.quiet) return false;
        openHistory(lab, subject, { x: at.left, y: at.bottom });
        return true;
      },
    },
  ]);
}
