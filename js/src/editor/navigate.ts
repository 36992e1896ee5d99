/** Go to definition and rename, both answered by the kernel, which alone knows Python's scopes. */

import { type Extension, StateEffect, StateField } from "@codemirror/state";
import { type EditorView, keymap, showTooltip, type Tooltip } from "@codemirror/view";
import type { ReferencesView } from "../protocol";
import type { Lab } from "../session/store";
import { h } from "../ui/dom";
import { editing } from "../ui/editing";
import { atCursor, select } from "./cursor";
import { placeOf, spanOf } from "./places";

async function references(view: EditorView, lab: Lab, offset: number): Promise<ReferencesView | null> {
  const reply = await lab.ask({ type: "references", ...placeOf(view.state.doc, offset) });
  if (reply.error) lab.notify(reply.error);
  return reply.references ?? null;
}

export async function goToDefinition(view: EditorView, lab: Lab, offset: number): Promise<void> {
  const { doc } = view.state;
  const found = await references(view, lab, offset);
  if (!found?.definition || view.state.doc !== doc) return;
  const { from, to } = spanOf(doc, found.definition);
  select(view, from, to);
}

const asking = StateEffect.define<Tooltip | null>();

const renameField = StateField.define<Tooltip | null>({
  create: () => null,
  update(value, transaction) {
    for (const effect of transaction.effects) if (effect.is(asking)) return effect.value;
    return transaction.docChanged ? null : value;
  },
  provide: (field) => showTooltip.from(field),
});

/** Ask for a new name at the place of the old one. */
export async function rename(view: EditorView, lab: Lab, offset: number): Promise<void> {
  const found = await references(view, lab, offset);
  if (!found) {
    lab.notify("There is no name here that can be renamed.");
    return;
  }
  const close = () => {
    view.dispatch({ effects: asking.of(null) });
    view.focus();
  };
  const create = () => {
    const { kind, path, name } = found;
    const draw = async (text: string) =>
      (await lab.pen?.draw({ act: "rename", kind, path, to: text.trim() })) ?? null;
    const { input, error } = editing(name, `New name of ${kind} ${name}`, draw, close);
    const places = `${found.references.length} ${found.references.length === 1 ? "place" : "places"}`;
    const dom = h("div", { class: "lrp-rename" }, input, h("span", { class: "lrp-faint" }, places), error);
    return {
      dom,
      mount: () => {
        input.focus();
        input.select();
      },
    };
  };
  view.dispatch({ effects: asking.of({ pos: offset, above: true, create }) });
}

export function navigation(lab: Lab): Extension {
  return [
    renameField,
    keymap.of([
      { key: "F12", run: atCursor(lab, goToDefinition) },
      { key: "F2", run: atCursor(lab, rename) },
    ]),
  ];
}
