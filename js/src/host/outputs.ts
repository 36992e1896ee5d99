/**
 * A notebook that two users share. JupyterLab trusts only outputs that its own user has run, and shows those
 * that come from the other user's page as text. But both pages have the same kernel, whose widgets run in both.
 * So the output of a lab that runs here is shown; other outputs and the shared document stay as they are.
 */

import { type Notebook, type WidgetManager, widgetsIn } from "./notebook";

const OURS = "lrp_jupyter."; // how the classes of the package begin

/** Marks a notebook, because each lab in it is a module of its own. */
const SHOWN = Symbol.for("lrp-shared");

/** Show labs in a notebook, now and whenever its content changes. */
export function showLabs(manager: WidgetManager | undefined): void {
  const notebook = manager?.context as (Notebook & { [SHOWN]?: true }) | undefined;
  if (!manager || !notebook?.model?.contentChanged) return;
  show(notebook, manager);
  if (notebook[SHOWN]) return;
  notebook[SHOWN] = true;
  notebook.model.contentChanged.connect(() => show(notebook, manager));
}

function show(notebook: Notebook, manager: WidgetManager): void {
  for (const { widget, output, outputs, index } of widgetsIn(notebook)) {
    if (output.trusted || !manager.has_model?.(widget)) continue;
    manager.get_model?.(widget).then(
      (model) => {
        if (output.trusted || !model.comm_live || !String(model.get("_anywidget_id")).startsWith(OURS))
          return;
        output.trusted = true;
        if (outputs.get(index) === output) outputs.stateChanged.emit(index);
      },
      () => {}, // it cannot be opened: the text says more than a view of it
    );
  }
}
