/** Python in a worker, as the page sees it: a model for the lab, and what the page itself asks of it. */

import type { FromWorker, InLesson, Shared, Site, ToWorker } from "./messages";
import { PageModel } from "./model";

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

export class Python {
  private readonly worker: Worker;
  /** The model of a lab of the program that is open. */
  readonly model = new PageModel((message) => this.post({ do: "message", message }));
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
    if (message.is === "message") this.model.receive(message.message, message.buffers);
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
