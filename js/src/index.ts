/** The widget: one class for every part of the lab; its `view` trait says which one. */

import type { HostedModel } from "./host/notebook";
import { openLab } from "./lab";
import type { PartName } from "./protocol";
import type { Model } from "./session/connection";

interface Context {
  model: Model & HostedModel & { get(name: string): unknown };
  el: HTMLElement;
}

function render({ model, el }: Context): () => void {
  return openLab(model, (model.get("view") as PartName) || "lab", el);
}

export default { render };
