/** The world as files: saved and opened as JSON, as a picture of what is shown or of all of it. */

import type { Lab } from "../session/store";
import type { Stage } from "./stage";

/** Save a file on the user's computer. */
export function download(name: string, content: Blob): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** Save what the canvas shows. */
export async function savePng(lab: Lab, stage: Stage): Promise<void> {
  const content = await stage.image();
  if (content) download(`${nameOf(lab)}.png`, content);
}

/** Save a drawing of the whole world, which can be enlarged without loss. */
export async function saveSvg(lab: Lab): Promise<void> {
  const { svg, error } = await lab.ask({ type: "world_picture" });
  if (error) lab.notify(error);
  else if (svg) download(`${nameOf(lab)}.svg`, new Blob([svg], { type: "image/svg+xml" }));
}

function nameOf(lab: Lab): string {
  const { name, world } = lab.store.state;
  return [name, world?.name].filter(Boolean).join("-") || "world";
}

/** Ask for a file and continue in its world. */
export function openWorld(lab: Lab): void {
  const input = document.createElement("input");
  input.type = "file";
  input.accept = ".json,application/json";
  input.addEventListener("change", async () => {
    const file = input.files?.[0];
    if (file) await lab.act({ do: "world_text", text: await file.text() });
  });
  input.click();
}
