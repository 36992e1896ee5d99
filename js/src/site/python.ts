/** Python in a worker, as the page sees it: a model for the lab, and what the page itself asks of it. */

import type { Model } from "../session/connection";
import type { Packed } from "../session/plain";
import type { FromWorker, InLesson, Shared, Site, ToWorker } from "./messages";

const PING_EVERY = 1000; // ms
const SILENT_AFTER = 8000;

interface Watching {
  /** What is being done before Python is ready. */
  step(step: string): void;
  /** Python does not answer, or answers again. */
  silent(on: boolean): void;
  /** The browser does not store what is typed. */
  unkept(): void;
}

type Receive = (message: Packed, buffers: Uint8Array[]) => void;

export class Python {
  private readonly worker: Worker;
  private readonly receivers = new Set<Receive>();
  private waiting: {
    is: FromWorker["is"];
    resolve: (message: FromWorker) => void;
    reject: (error: Error) => void;
  }[] = [];
  private heard = performance.now();
  private timer = 0;

  constructor(
    script: URL,
    private readonly watching: Watching,
  ) {
    this.worker = new Worker(script, { type: "module" });
    this.worker.addEventListener("message", ({ data }) => this.handle(data));
    this.worker.addEventListener("error", (event) => {
      this.handle({ is: "failed", sentence: event.message || `\`${script.pathname}\` cannot be loaded.` });
    });
  }

  async start(site: Site, base: string): Promise<void> {
    await this.ask({ do: "start", site, base }, "ready");
    this.heard = performance.now();
    this.timer = window.setInterval(() => this.watch(), PING_EVERY);
  }

  async open(wanted: InLesson, again: boolean, hung: boolean): Promise<void> {
    await this.ask({ do: "open", wanted: { ...wanted, again, hung } }, "opened");
  }

  /** What can be shared of the program that is open. */
  async shared(): Promise<Shared> {
    return (await this.ask({ do: "text" }, "text")) as FromWorker & Shared;
  }

  /** The model of a lab of the program that is open. */
  model(): Model & { get(name: string): unknown } {
    return {
      send: (content) => this.post({ do: "message", message: (content as Packed).json }),
      on: (event, callback) => {
        if (event === "msg:custom") this.receivers.add(callback as Receive);
      },
      off: (_event, callback) => void this.receivers.delete(callback as Receive),
      get: (name) => (name === "view" ? "lab" : undefined),
    };
  }

  end(): void {
    clearInterval(this.timer);
    this.worker.terminate();
  }

  private post(message: ToWorker): void {
    this.worker.postMessage(message);
  }

  private ask(message: ToWorker, is: FromWorker["is"]): Promise<FromWorker> {
    return new Promise((resolve, reject) => {
      this.waiting.push({ is, resolve, reject });
      this.post(message);
    });
  }

  private handle(message: FromWorker): void {
    this.heard = performance.now();
    this.watching.silent(false);
    if (message.is === "step") this.watching.step(message.step);
    if (message.is === "unkept") this.watching.unkept();
    if (message.is === "message") {
      for (const receive of this.receivers) receive({ json: message.message }, message.buffers);
    }
    const index = this.waiting.findIndex(({ is }) => is === message.is || message.is === "failed");
    if (index < 0) return;
    const [{ resolve, reject }] = this.waiting.splice(index, 1) as [(typeof this.waiting)[0]];
    if (message.is === "failed") reject(new Error(message.sentence));
    else resolve(message);
  }

  /** Ask for a sign of life. */
  private watch(): void {
    if (performance.now() - this.heard > SILENT_AFTER) this.watching.silent(true);
    this.post({ do: "ping" });
  }
}
