/** The extension of JupyterLab and Jupyter Notebook: a federated module, which the page shares its packages with. */

import type { JupyterFrontEnd, JupyterFrontEndPlugin } from "@jupyterlab/application";
import { IEditorExtensionRegistry, IEditorLanguageRegistry } from "@jupyterlab/codemirror";
import { followText } from "./cells";
import { MIME, support } from "./language";
import "./style.css";

const language: JupyterFrontEndPlugin<void> = {
  id: "lrp-jupyter:language",
  description: "The language of %%lrp cells and of .lrp files.",
  autoStart: true,
  requires: [IEditorLanguageRegistry, IEditorExtensionRegistry],
  activate(
    _app: JupyterFrontEnd,
    languages: IEditorLanguageRegistry,
    extensions: IEditorExtensionRegistry,
  ): void {
    languages.addLanguage({
      name: "lrp",
      displayName: "LRP",
      mime: MIME,
      extensions: ["lrp"],
      support: support(),
    });
    extensions.addExtension({
      name: "lrp-jupyter:cell",
      factory({ inline, model }) {
        if (inline) followText(model);
        return null;
      },
    });
  },
};

export default [language];
