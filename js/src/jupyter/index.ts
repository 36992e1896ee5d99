/** The plugins of JupyterLab and Jupyter Notebook: a federated module, with which the page shares its packages. */

import type { JupyterFrontEndPlugin } from "@jupyterlab/application";
import { IEditorExtensionRegistry, IEditorLanguageRegistry } from "@jupyterlab/codemirror";
import { followText } from "./cells";
import { commands } from "./commands";
import { files } from "./files";
import { MIME, support } from "./language";
import "./style.css";

const language: JupyterFrontEndPlugin<void> = {
  id: "lrp-jupyter:language",
  description: "The language of %%lrp cells and of .lrp files.",
  autoStart: true,
  requires: [IEditorLanguageRegistry, IEditorExtensionRegistry],
  activate(_app, languages: IEditorLanguageRegistry, extensions: IEditorExtensionRegistry) {
    const [name, mime] = ["lrp", MIME];
    languages.addLanguage({ name, displayName: "LRP", mime, extensions: ["lrp"], support: support() });
    extensions.addExtension({
      name: "lrp-jupyter:cell",
      factory({ inline, model }) {
        if (inline) followText(model);
        return null;
      },
    });
  },
};

export default [language, files, commands];
