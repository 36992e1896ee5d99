/** The fixes of what is marked at the cursor, in a menu: by key what the cards offer to the pointer. */

import { type Action, forEachDiagnostic } from "@codemirror/lint";
import type { EditorView } from "@codemirror/view";
import type { Lab } from "../session/store";
import { item, openMenu } from "../ui/menu";

export function openFixes(view: EditorView, lab: Lab): boolean {
  const { head } = view.state.selection.main;
  const line = view.state.doc.lineAt(head);
  const here: Action[] = [];
  const inLine: Action[] = [];
  forEachDiagnostic(view.state, ({ actions = [] }, from, to) => {
    if (from <= head && head <= to) here.push(...actions);
    else if (from <= line.to && to >= line.from) inLine.push(...actions);
  });
  const actions = here.length ? here : inLine;
  const at = view.coordsAtPos(head);
  if (!at || !actions.length) {
    lab.notify("Nothing in this line can be fixed automatically.");
    return true;
  }
  const items = actions.map(({ name, apply }) => item(name, "fix", () => apply(view, head, head)));
  openMenu(lab.root, { x: at.left, y: at.bottom }, items, "Fixes");
  return true;
}
