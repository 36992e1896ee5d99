/** The language of a cell: that of its notebook, or LRP while it begins with the magic. */

import type { CodeEditor } from "@jupyterlab/codeeditor";
import { isLrp, MIME } from "./language";

const followed = new WeakSet<CodeEditor.IModel>();

/** Give a cell the language of its text, now and whenever it is changed. */
export function followText(model: CodeEditor.IModel & { type?: string }): void {
  if (followed.has(model) || (model.type ?? "code") !== "code") return;
  followed.add(model);
  let other = model.mimeType; // that of the notebook
  const update = () => {
    if (model.mimeType !== MIME) other = model.mimeType;
    model.mimeType = isLrp(model.sharedModel.getSource()) ? MIME : other;
  };
  model.sharedModel.changed.connect(update);
  model.mimeTypeChanged.connect(update);
  update();
}
