/** The widget: one class for every part of the lab; its `view` trait says which one. */

import type { HostedModel } from "./host/notebook";
import { showLabs } from "./host/outputs";
import { openLab } from "./lab";
import type { PartName } from "./protocol";
import type { Model } from "./session/connection";

interface Context {
  model: Model & HostedModel & { get(name: string): unknown };
  el: HTMLElement;
}

/** Runs in every page of the kernel, whether it shows the widget or not. */
function initialize({ model }: Omit<Context, "el">): void {
  showLabs(model.widget_manager);
}

function render({ model, el }: Context): () => void {
  return openLab(model, (model.get("view") as PartName) || "lab", el);
}

export default { initialize, render };
