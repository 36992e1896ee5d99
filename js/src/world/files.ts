/** The world as files: saved and opened as JSON, as a picture of what is shown or of all of it. */

import type { Lab } from "../session/store";
import { h } from "../ui/dom";
import { savePicture } from "../ui/picture";
import type { Stage } from "./stage";

export function savePng(lab: Lab, stage: Stage): Promise<void> {
  return savePicture(`${nameOf(lab)}.png`, stage.image(), lab.notify);
}

/** Save a drawing, which can be enlarged without loss: of the whole world, or of its remembered motion. */
export async function saveDrawing(lab: Lab, type: "world_picture" | "world_animation"): Promise<void> {
  const { svg, error } = await lab.ask({ type });
  const name = `${nameOf(lab)}${type === "world_animation" ? "-run" : ""}.svg`;
  if (error) lab.notify(error);
  else if (svg) await savePicture(name, new Blob([svg], { type: "image/svg+xml" }), lab.notify);
}

function nameOf(lab: Lab): string {
  const { name, world } = lab.store.state;
  return [name, world?.name].filter(Boolean).join("-") || "world";
}

/** Ask for a file and continue in its world. */
export function openWorld(lab: Lab): void {
  const input = h("input", {
    type: "file",
    accept: ".json,application/json",
    onchange: async () => {
      const file = input.files?.[0];
      if (file) await lab.act({ do: "world_text", text: await file.text() });
    },
  });
  input.click();
}
