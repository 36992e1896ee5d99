/**
 * The WebSocket of a page to its run: opened again and again while it is lost, until this page is refused. What
 * is asked while there is none is answered when there is one again.
 */

import type { FromPage } from "../protocol";
import { PageModel } from "../site/model";

/** What the run says of itself, before anything else. */
export interface About {
  name: string;
  /** The file that the program is written to; empty if it is kept nowhere. */
  file: string;
  read_only: boolean;
}

interface Told {
  /** It is connected. */
  here(about: About): void;
  /** The connection is lost, and tried again. */
  away(): void;
  /** This page is refused, perhaps for now, or the run has ended; `code` says which. */
  over(code: number): void;
  /** Something that was done here has not reached the run. */
  missed(): void;
}

const SILENT_AFTER = 8000; // ms; the run says something every second
const LOOK_EVERY = 1000;
const FIRST_WAIT = 500;
const LONGEST_WAIT = 8000;
/** The run has ended; another one may begin, with the token of this page. */
const ENDED = 4410;
/** Whether no other try would change why it was closed. */
const isFinal = (code: number) => code === 1009 || (code >= 4400 && code < 4500 && code !== ENDED);
/** Commands that the lab sends without a person's action. */
const UNASKED: ReadonlySet<string> = new Set(["fit", "recover", "put_into_cell"]);
const LOST =
  "The connection was lost before this was answered. Look whether it has happened, and do it again if not.";

export class RunSocket {
  readonly model = new PageModel((json) => this.post(json));
  private socket: WebSocket | null = null;
  private isOpen = false;
  private isOver = false;
  private hasEnded = false;
  private heard = 0;
  private wait = FIRST_WAIT;
  private buffers: ArrayBuffer[] = [];
  private retry: ReturnType<typeof setTimeout> | undefined;
  /** What is not answered, by number: the view that has asked. */
  private readonly asked = new Map<number, string>();
  /** What was asked of the connection before. */
  private lost: [number, string][] = [];

  constructor(
    private readonly address: URL,
    private readonly token: string,
    private readonly told: Told,
  ) {
    setInterval(() => this.look(), LOOK_EVERY);
    addEventListener("online", () => this.open());
    document.addEventListener("visibilitychange", () => !document.hidden && this.open());
    this.open();
  }

  /** Open it, if it is not. */
  private open(): void {
    if (this.socket || this.isOver) return;
    clearTimeout(this.retry);
    this.heard = performance.now();
    const socket = new WebSocket(this.address);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.addEventListener("open", () => socket === this.socket && socket.send(this.token));
    socket.addEventListener("message", ({ data }) => socket === this.socket && this.receive(data));
    socket.addEventListener("close", ({ code }) => socket === this.socket && this.close(code));
  }

  private receive(data: string | ArrayBuffer): void {
    this.heard = performance.now();
    if (data instanceof ArrayBuffer) {
      this.buffers.push(data);
      return;
    }
    const buffers = this.buffers.splice(0);
    if (!this.isOpen) {
      this.isOpen = true;
      this.hasEnded = false;
      this.wait = FIRST_WAIT;
      this.told.here(JSON.parse(data));
      return;
    }
    this.model.receive(data, buffers);
    for (const [id, view] of this.lost.splice(0))
      this.model.receive(JSON.stringify({ type: "reply", view, id, error: LOST }), []);
    if (!this.asked.size) return;
    const message = JSON.parse(data);
    if (message.type === "reply") this.asked.delete(message.id);
  }

  private post(json: string): void {
    const message: FromPage = JSON.parse(json);
    if ("id" in message && message.id) this.asked.set(message.id, message.view);
    if (this.isOpen) this.socket?.send(json);
    else if (message.type === "command" && !UNASKED.has(message.do) && !this.hasEnded) this.told.missed();
  }

  /** It is closed, or silent for so long that it must be. */
  private close(code: number): void {
    this.socket = null;
    this.isOpen = false;
    this.buffers = [];
    this.lost = [...this.lost, ...this.asked];
    this.asked.clear();
    this.isOver = isFinal(code);
    this.hasEnded ||= code === ENDED;
    if (this.isOver || code >= 4400) this.told.over(code);
    else if (!this.hasEnded) this.told.away();
    if (this.isOver) return;
    this.retry = setTimeout(() => this.open(), this.wait * (0.75 + Math.random() / 2)); // not all pages at once
    this.wait = Math.min(this.wait * 2, LONGEST_WAIT);
  }

  /** A network that is cut says nothing. */
  private look(): void {
    if (!this.socket || performance.now() - this.heard < SILENT_AFTER) return;
    const { socket } = this;
    this.close(0);
    socket.close();
  }
}
