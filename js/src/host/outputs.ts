/**
 * The outputs of a notebook that show labs. What is saved of one is its picture and its text, which every reader
 * shows. A widget, which readers prefer to both, would be missing where no kernel runs, or be loaded over the
 * network; so it is not saved, and a page with the kernel shows the lab in place of its picture. So it does with a
 * lab that another user of a shared notebook has run: JupyterLab shows what its own user has not run as text.
 */

import { labsIn, type Notebook, saveOutput, VIEW, type WidgetManager } from "./notebook";

const OURS = "lrp_jupyter."; // how the classes of the package begin

/** Marks a notebook, because each lab in it is a module of its own. */
const SHOWN = Symbol.for("lrp-shown");

/** Show labs in a notebook, now and whenever its content changes. */
export function showLabs(manager: WidgetManager | undefined): void {
  const notebook = manager?.context as (Notebook & { [SHOWN]?: true }) | undefined;
  if (!manager || !notebook?.model?.contentChanged) return;
  show(notebook, manager);
  if (notebook[SHOWN]) return;
  notebook[SHOWN] = true;
  notebook.model.contentChanged.connect(() => show(notebook, manager));
  notebook.saveState.connect(() => show(notebook, manager));
}

function show(notebook: Notebook, manager: WidgetManager): void {
  for (const { widget, output, outputs, cell, index } of labsIn(notebook)) {
    saveOutput(cell, index, { [VIEW]: undefined });
    const isShown = () => output.trusted && VIEW in output.data;
    if (isShown() || !manager.has_model?.(widget)) continue;
    manager.get_model?.(widget).then(
      (model) => {
        if (isShown() || !model.comm_live || !String(model.get("_anywidget_id")).startsWith(OURS)) return;
        output.trusted = true;
        // its own data: `setData` would change what is saved, here and for other users
        output.toJSON().data[VIEW] = { version_major: 2, version_minor: 0, model_id: widget };
        if (outputs.get(index) === output) outputs.stateChanged.emit(index);
      },
      () => {}, // it cannot be opened: the picture says more than a view of it
    );
  }
}
