/** A program as a notebook of its own, where the notebooks of the site keep theirs: in this browser. */

import localforage from "localforage";
import type { Shared } from "./messages";

/** The name that the site's configuration gives to the storage of its notebooks. */
const STORAGE = "lrp-notebooks";

const code = (id: string, source: string) => ({
  cell_type: "code",
  execution_count: null,
  id,
  metadata: {},
  outputs: [],
  source,
});

/** Write the notebook, unless one of this name is there; return the address that opens it. */
export async function writeNotebook({ program, text, world, challenge }: Shared): Promise<string> {
  const files = localforage.createInstance({ name: STORAGE, storeName: "files", version: 1 });
  let path = `${program}.ipynb`;
  for (let number = 2; (await files.getItem(path)) !== null; number++) path = `${program} ${number}.ipynb`;
  const robot = world === "none" ? " --bridge none" : ` --world "${world}"`;
  const options = challenge ? ` --challenge "${challenge}"` : world && robot;
  const content = {
    cells: [code("load", "%load_ext lrp_jupyter"), code("program", `%%lrp ${program}${options}\n${text}`)],
    metadata: {
      kernelspec: { display_name: "Python (Pyodide)", language: "python", name: "python" },
      language_info: { name: "python" },
    },
    nbformat: 4,
    nbformat_minor: 5,
  };
  const now = new Date().toISOString();
  await files.setItem(path, {
    name: path,
    path,
    type: "notebook",
    format: "json",
    mimetype: "application/x-ipynb+json",
    content,
    size: JSON.stringify(content).length,
    created: now,
    last_modified: now,
    writable: true,
  });
  return `jupyter/notebooks/index.html?path=${encodeURIComponent(path)}`;
}
