/** The worker in which Python runs. The folder of kept texts is stored by the browser. */

import type { loadPyodide, PyodideInterface } from "pyodide";
import { Folder } from "./folder";
import type { FromWorker, Site, ToWorker } from "./messages";

interface Opened {
  receive(message: string): void;
  stored(): void;
  shared(): string;
  close(): void;
}

const FOLDER = "/lab";
const STORED_EVERY = 250; // ms

let python: PyodideInterface;
let opened: Opened | null = null;
let held: FromWorker[] | null = null; // answers, until what they answer is stored
let folder: Folder | null = null; // once it is loaded: a folder that is not must not replace what is stored

const post = (message: FromWorker, transfer: Transferable[] = []) =>
  (postMessage as (message: unknown, transfer: Transferable[]) => void)(message, transfer);

async function start(site: Site, base: string): Promise<void> {
  const at = (path: string) => new URL(path, base).href;
  post({ is: "step", step: "Loading Python" });
  const module: { loadPyodide: typeof loadPyodide } = await import(at(`${site.python}pyodide.mjs`));
  python = await module.loadPyodide({ indexURL: at(site.python), lockFileURL: at(site.lock) });
  post({ is: "step", step: "Loading the simulator" });
  await python.loadPackage([...site.packages, at(site.wheel)], { messageCallback: () => {} });
  const texts = new Folder(python.FS, FOLDER);
  try {
    await texts.load();
    folder = texts;
  } catch {
    post({ is: "unkept" });
  }
  python.FS.chdir(FOLDER);
  void storeAgain();
  post({ is: "step", step: "Starting the robot" });
  python.pyimport("lrp_jupyter.widgets.site_worker");
  post({ is: "ready" });
}

/** Have the browser store the folder. */
async function store(): Promise<void> {
  await folder?.store().catch(() => post({ is: "unkept" }));
}

async function storeAgain(): Promise<void> {
  await store();
  setTimeout(storeAgain, STORED_EVERY);
}

/** Have a message handled, and answer when what it has changed is stored: Python may not return from the next one. */
async function receive(message: string): Promise<void> {
  held = [];
  opened?.receive(message);
  await store();
  opened?.stored();
  held.forEach((each) => void post(each));
  held = null;
}

function send(message: string, buffers: { toJs(): Uint8Array[]; destroy(): void }): void {
  const bytes = buffers.toJs();
  buffers.destroy();
  const answer: FromWorker = { is: "message", message, buffers: bytes };
  if (held) held.push(answer);
  else post(answer);
}

async function handle(message: ToWorker): Promise<void> {
  if (message.do === "start") await start(message.site, message.base);
  if (message.do === "open") {
    opened?.close();
    opened = null;
    opened = python
      .pyimport("lrp_jupyter.widgets.site_worker")
      .open_program(JSON.stringify(message.wanted), send);
    post({ is: "opened" });
  }
  if (message.do === "message") await receive(message.message);
  if (message.do === "text" && opened) post({ is: "text", ...JSON.parse(opened.shared()) });
  if (message.do === "ping") post({ is: "pong" });
}

/** The last line of a Python traceback says what is wrong. */
function sentenceOf(error: unknown): string {
  const lines = String((error as Error).message ?? error)
    .trim()
    .split("\n");
  return lines.at(-1)!.replace(/^[\w.]*Error: /, "");
}

let handled = Promise.resolve(); // one after the other
addEventListener("message", ({ data }: MessageEvent<ToWorker>) => {
  handled = handled
    .then(() => handle(data))
    .catch((error) => post({ is: "failed", sentence: sentenceOf(error) }));
});
