/**
 * What a saved notebook shows where no kernel runs. Jupyter prefers an output's widget to its picture and
 * reports "model not found" where the widget is gone. So the notebook is saved with a widget of Jupyter's own
 * under the same name, which shows the picture; while the lab lives, it precedes it.
 */

import { type Notebook, PICTURE, widgetsIn } from "./notebook";

const STATE = "application/vnd.jupyter.widget-state+json";
const OURS = "lrp-still";

type Widgets = Record<string, { state?: { _dom_classes?: string[] } }>;

/** Marks a notebook, because each lab in it is a module of its own. */
const STORED = Symbol.for("lrp-pictures");

/** Store the pictures with every saving of a notebook. */
export function storePictures(notebook: Notebook & { [STORED]?: true }): void {
  if (notebook[STORED]) return;
  notebook[STORED] = true;
  notebook.saveState.connect((_, state) => {
    if (state === "started") store(notebook);
  });
}

function store(notebook: Notebook): void {
  const widgets = notebook.model.getMetadata("widgets") as Record<string, { state: Widgets }> | undefined;
  const others = Object.entries(widgets?.[STATE]?.state ?? {}).filter(
    ([, widget]) => !widget.state?._dom_classes?.includes(OURS),
  );
  const pictures: [string, object][] = [];
  for (const { widget, output } of widgetsIn(notebook)) {
    const picture = output.data[PICTURE];
    if (typeof picture === "string" && picture.includes(OURS)) pictures.push([widget, shows(picture)]);
  }
  if (!pictures.length && others.length === Object.keys(widgets?.[STATE]?.state ?? {}).length) return;
  const state = Object.fromEntries([...others, ...pictures]);
  notebook.model.setMetadata("widgets", {
    ...widgets,
    [STATE]: { version_major: 2, version_minor: 0, state },
  });
}

/** A widget of Jupyter's that shows a picture; as an image, whose styles concern nothing else. */
function shows(picture: string): object {
  const image = document.createElement("img");
  image.src = `data:${PICTURE},${picture.replace(/[%#"]/g, encodeURIComponent)}`;
  image.style.maxWidth = "100%";
  image.alt = "State graph and world when the cell was run";
  return {
    model_name: "HTMLModel",
    model_module: "@jupyter-widgets/controls",
    model_module_version: "2.0.0",
    state: { value: image.outerHTML, _dom_classes: [OURS] },
  };
}
