/**
 * The connection to the kernel: text (one in flight, the newest wins), commands and requests with their
 * replies, credit for frames, and whether the kernel answers. No DOM, no clock of its own.
 */

import type { AnswerMessage, Command, FromKernel, FromPage, PartName, ReplyMessage } from "../protocol";
import { viewOf, withNulls } from "./plain";
import type { Link } from "./state";

/** The part of anywidget's interface that is used here. */
export interface Model {
  send(content: unknown, callbacks?: unknown, buffers?: ArrayBuffer[]): void;
  on(event: string, callback: (...args: never[]) => void): void;
  off(event: string, callback: (...args: never[]) => void): void;
  get?(name: string): unknown;
  set?(name: string, value: unknown): void;
  save_changes?(): void;
}

export interface Clock {
  now(): number;
  every(milliseconds: number, callback: () => void): () => void;
}

export const realClock: Clock = {
  now: () => performance.now(),
  every(milliseconds, callback) {
    const timer = setInterval(callback, milliseconds);
    return () => clearInterval(timer);
  },
};

/** The kernel is busy without an answer for so long, and lost without any message for so long (ms). */
export const BUSY_AFTER = 300;
export const LOST_AFTER = 3000;
const GONE_AFTER = 1500;
/** Frames acknowledged at a time, fewer than may be in flight; a frame this late (ms) is acknowledged alone. */
const CREDIT_AFTER_FRAMES = 2;
const CREDIT_AFTER = 500;

const NO_KERNEL = "The kernel was restarted or shut down. Run the cell again.";

/** Each member of a union without the fields that this module fills in. */
type Without<T, K extends PropertyKey> = T extends unknown ? Omit<T, K> : never;
/** The commands of the page: the act and its own fields. */
export type Act = Without<Command, "type" | "view" | "id">;
/** The requests of the page: what has an id and is not a command. */
export type Question = Without<
  Exclude<Extract<FromPage, { id: number }>, { type: "command" }>,
  "view" | "id"
>;

/** A text, where it is being edited, and whether the word there is meant. */
interface Typed {
  text: string;
  cursor: [number, number] | null;
  meant: boolean;
}

export interface Listener {
  /** A message for this view; its buffers hold poses. */
  message(message: FromKernel, buffers: DataView[]): void;
  link(link: Link): void;
  /** The newest text is about to be sent. */
  sending?(): void;
  /** A text was typed while the kernel does not answer. */
  unanswered?(): void;
}

export class Connection {
  readonly view: string;
  /** Number of the text in flight, 0 if none. */
  inFlight = 0;
  private seq = 0;
  private nextId = 1;
  private base = 0;
  private waitingText: Typed | null = null;
  private sentText: Typed | null = null;
  private link: Link = "connecting";
  /** When the comm was reported to open or close: if no message follows, the kernel is gone. */
  private suspectedAt = Number.POSITIVE_INFINITY;
  private lastMessage: number;
  private lastHello: number;
  private readonly waiting = new Map<number, { since: number; resolve: (reply: ReplyMessage) => void }>();
  private textSince = 0;
  private uncredited = 0;
  private credited = Number.NEGATIVE_INFINITY;
  private readonly stop: () => void;

  constructor(
    private readonly model: Model,
    private readonly part: PartName,
    private readonly listener: Listener,
    private readonly clock: Clock = realClock,
    view: string = crypto.randomUUID?.() ?? String(Math.random()),
  ) {
    this.view = view;
    this.lastMessage = this.lastHello = clock.now();
    model.on("msg:custom", this.receive);
    model.on("comm_live_update", this.suspect);
    this.stop = clock.every(100, () => this.updateLink());
    this.hello();
  }

  /** Request a snapshot. */
  hello(): void {
    this.lastHello = this.clock.now();
    this.post({ type: "hello", view: this.view, part: this.part });
  }

  /** Whether the kernel has answered the newest text. */
  get isAnswered(): boolean {
    return this.inFlight === 0 && this.waitingText === null;
  }

  /**
   * Send the whole text, and where it is being edited: line and column, and whether the word there is meant.
   * Returns whether it was sent at once.
   */
  text(text: string, cursor: [number, number] | null = null, meant = true): boolean {
    if (this.link !== "live") this.listener.unanswered?.();
    const typed = { text, cursor, meant };
    if (this.inFlight) {
      this.waitingText = typed;
      return false;
    }
    this.inFlight = ++this.seq;
    this.sentText = typed;
    this.textSince = this.clock.now();
    this.listener.sending?.();
    this.post({ type: "text", view: this.view, seq: this.seq, base: this.base, ...typed });
    return true;
  }

  /** Send a command and wait for the reply; its `error` is a sentence or null. */
  command(act: Act): Promise<ReplyMessage> {
    return this.wait((id) => ({ type: "command", view: this.view, id, ...act }));
  }

  /** Send a command without a reply, because only the newest counts: a drag, a slider. */
  send(act: Act): void {
    this.post({ type: "command", view: this.view, id: 0, ...act });
  }

  ask(question: Question): Promise<ReplyMessage> {
    return this.wait((id) => ({ ...question, view: this.view, id }));
  }

  close(): void {
    this.stop();
    this.post({ type: "bye", view: this.view });
    this.model.off("msg:custom", this.receive);
    this.model.off("comm_live_update", this.suspect);
    this.refuse();
  }

  private wait(make: (id: number) => FromPage): Promise<ReplyMessage> {
    const id = this.nextId++;
    return new Promise((resolve) => {
      this.waiting.set(id, { since: this.clock.now(), resolve });
      this.post(make(id));
      if (this.link === "dead") this.refuse();
    });
  }

  /** Reply to everything that waits: the kernel will not. */
  private refuse(): void {
    for (const [id] of this.waiting) this.resolve({ type: "reply", view: this.view, id, error: NO_KERNEL });
  }

  private post(message: FromPage): void {
    try {
      this.model.send(message);
    } catch {
      this.become("dead"); // the comm is closed: the kernel was restarted or shut down
    }
  }

  private readonly receive = (
    received: FromKernel,
    buffers: (ArrayBuffer | ArrayBufferView)[] = [],
  ): void => {
    if (!received || received.view !== this.view) return;
    const message = withNulls(received);
    this.lastMessage = this.clock.now();
    this.suspectedAt = Number.POSITIVE_INFINITY;
    if (message.type === "frame") this.credit(message.frame);
    if (message.type === "reply") this.resolve(message);
    if (message.type === "answer") this.answered(message);
    if (message.type === "snapshot") {
      this.base = message.revision;
      this.credit(message.frame.frame);
    }
    this.updateLink();
    try {
      this.listener.message(message, buffers.map(viewOf));
    } finally {
      if (message.type === "answer" && message.seq) this.next(); // whatever failed, what was typed is sent
      if (message.type === "snapshot") this.restart(message.text);
    }
  };

  /** Every message makes the kernel report "busy" and "idle", which its host draws: acknowledge two at once. */
  private credit(frame: number): void {
    this.uncredited += 1;
    if (this.uncredited < CREDIT_AFTER_FRAMES && this.lastMessage - this.credited < CREDIT_AFTER) return;
    this.uncredited = 0;
    this.credited = this.lastMessage;
    this.post({ type: "credit", view: this.view, frame });
  }

  private readonly suspect = (): void => {
    this.suspectedAt = this.clock.now();
  };

  private resolve(reply: ReplyMessage): void {
    this.waiting.get(reply.id)?.resolve(reply);
    this.waiting.delete(reply.id);
  }

  private answered(answer: AnswerMessage): void {
    this.base = answer.revision;
    if (answer.seq === this.inFlight) this.inFlight = 0;
  }

  private next(): void {
    const next = this.waitingText;
    this.waitingText = null;
    const last = this.sentText;
    if (next && (next.text !== last?.text || next.meant || !last.meant)) this.again(next);
  }

  /** Handle a snapshot: texts sent before it are no longer answered, so the newest is sent again. */
  private restart(text: string): void {
    const mine = this.waitingText ?? (this.inFlight ? this.sentText : null);
    this.inFlight = 0;
    this.waitingText = null;
    if (mine !== null && mine.text !== text) this.again(mine);
  }

  private again({ text, cursor, meant }: Typed): void {
    this.text(text, cursor, meant);
  }

  private updateLink(): void {
    if (this.link === "dead") return;
    const now = this.clock.now();
    if (now - Math.max(this.suspectedAt, this.lastMessage) >= GONE_AFTER) {
      this.become("dead");
      return;
    }
    if (now - this.lastMessage >= LOST_AFTER) {
      if (this.link !== "connecting") this.become("lost");
      if (now - this.lastHello >= LOST_AFTER) this.hello();
      return;
    }
    if (this.link === "connecting" && this.lastMessage <= this.lastHello) return;
    let since = this.inFlight ? this.textSince : now;
    for (const { since: asked } of this.waiting.values()) since = Math.min(since, asked);
    this.become(now - since >= BUSY_AFTER ? "busy" : "live");
  }

  private become(link: Link): void {
    if (link === this.link) return;
    this.link = link;
    this.listener.link(link);
    if (link === "dead") this.refuse();
  }
}
