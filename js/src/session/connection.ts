/**
 * The connection to the kernel: what was typed (one text in flight; answers in their order, each once), commands
 * and requests with their replies, credit for frames, and whether the kernel answers. No DOM, no clock of its
 * own.
 */

import type {
  AnswerMessage,
  Command,
  CursorMessage,
  FrameMessage,
  FromKernel,
  FromPage,
  LookedMessage,
  PartName,
  ReplyMessage,
  SnapshotMessage,
  TextMessage,
} from "../protocol";
import { type Packed, packed, unpacked, viewOf } from "./plain";
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

const realClock: Clock = {
  now: () => performance.now(),
  every(milliseconds, callback) {
    const timer = setInterval(callback, milliseconds);
    return () => clearInterval(timer);
  },
};

/** The kernel is busy if it says other things so long after a question, and lost without any message for so long (ms). */
export const BUSY_AFTER = 300;
export const LOST_AFTER = 3000;
const GONE_AFTER = 1500;

/** What runs the text waits until all that was typed before it is on its way. Nothing else waits: stop means stop. */
const RUNS_THE_TEXT: ReadonlySet<Act["do"]> = new Set(["run", "step", "reset", "apply", "check"]);

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

/** What the kernel has to know of an editor: changes, or where the cursor is. */
export type Typed = Without<TextMessage | CursorMessage, "view" | "seq">;

export interface Typist {
  /** The revision that it knows. */
  readonly revision: number;
  /** Whether it has changes that the kernel has not confirmed. */
  readonly isAhead: boolean;
  /** What it has to send next; null if there is nothing. */
  next(): Typed | null;
}

interface Listener {
  /** A message for this view; its buffers hold poses. */
  message(message: FromKernel, buffers: DataView[]): void;
  link(link: Link): void;
  /** The editor of this view, if it has one. */
  readonly typist?: Typist | null;
  /** A text was typed while the kernel does not answer. */
  unanswered?(): void;
}

export class Connection {
  readonly view: string;
  /** Number of the text in flight, 0 if none. */
  inFlight = 0;
  private seq = 0;
  private nextId = 1;
  /** The document of the kernel, the number of the last answer, and those that came before their turn. */
  private document = "";
  private answers = 0;
  private readonly early = new Map<number, AnswerMessage>();
  private earlySince = 0;
  private link: Link = "connecting";
  /** When the comm was reported to open or close: if no message follows, the kernel is gone. */
  private suspectedAt = Number.POSITIVE_INFINITY;
  private lastMessage: number;
  private lastHello: number;
  private readonly waiting = new Map<number, { since: number; resolve: (reply: ReplyMessage) => void }>();
  private textSince = 0;
  /** Commands that follow what was typed; see `RUNS_THE_TEXT`. */
  private following: FromPage[] = [];
  /** The newest frame, until a message has acknowledged it; then 0. */
  private arrived = 0;
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
    const { document, seq } = this;
    const revision = this.listener.typist?.revision ?? 0;
    this.post({ type: "hello", view: this.view, part: this.part, document, revision, seq });
  }

  /** Whether the kernel has answered the newest text. */
  get isAnswered(): boolean {
    return this.inFlight === 0 && !this.listener.typist?.isAhead;
  }

  /** Send what was typed: now, or when the text in flight is answered. */
  text(): void {
    const { typist } = this.listener;
    if (this.link !== "live" && typist?.isAhead) this.listener.unanswered?.();
    if (this.inFlight) return;
    const typed = typist?.next();
    if (typed?.type === "text") {
      this.inFlight = ++this.seq;
      this.textSince = this.clock.now();
    }
    if (typed) this.post({ view: this.view, seq: this.seq, ...typed });
    for (const command of this.following.splice(0)) this.post(command);
  }

  /** Send a command and wait for the reply; its `error` is a sentence or null. */
  command(act: Act): Promise<ReplyMessage> {
    const follows = this.inFlight > 0 && RUNS_THE_TEXT.has(act.do);
    const post = follows ? (command: FromPage) => void this.following.push(command) : this.post;
    return this.wait((id) => ({ type: "command", view: this.view, id, ...act }), post);
  }

  /** Send a command without a reply, because only the newest counts: a drag, a slider. */
  send(act: Act): void {
    this.post({ type: "command", view: this.view, id: 0, ...act });
  }

  /** Say what the kernel does not answer. */
  tell(looked: Without<LookedMessage, "view">): void {
    this.post({ view: this.view, ...looked });
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

  private wait(make: (id: number) => FromPage, post = this.post): Promise<ReplyMessage> {
    const id = this.nextId++;
    return new Promise((resolve) => {
      this.waiting.set(id, { since: this.clock.now(), resolve });
      post(make(id));
      if (this.link === "dead") this.refuse();
    });
  }

  /** Reply to everything that waits: the kernel will not. */
  private refuse(): void {
    this.following = [];
    for (const [id] of this.waiting) this.resolve({ type: "reply", view: this.view, id, error: NO_KERNEL });
  }

  private readonly post = (message: FromPage): void => {
    const frame = this.arrived;
    this.arrived = 0;
    try {
      this.model.send(packed(frame ? { ...message, frame } : message));
    } catch {
      this.become("dead"); // the comm is closed: the kernel was restarted or shut down
    }
  };

  private readonly receive = (received: Packed, buffers: (ArrayBuffer | ArrayBufferView)[] = []): void => {
    const message = unpacked<FromKernel>(received);
    if (message.view === this.view) this.handle(message, buffers.map(viewOf));
  };

  private handle(message: FromKernel, buffers: DataView[]): void {
    this.lastMessage = this.clock.now();
    this.suspectedAt = Number.POSITIVE_INFINITY;
    if (message.type === "answer" && !this.isNext(message)) return;
    if (message.type === "frame") this.acknowledge(message);
    if (message.type === "reply") this.resolve(message);
    if (message.type === "snapshot") {
      this.begin(message);
      this.acknowledge(message.frame);
    }
    this.updateLink();
    try {
      this.listener.message(message, buffers);
    } finally {
      if (message.type === "answer" || message.type === "snapshot") {
        this.text(); // whatever failed, what was typed is sent
        const next = this.early.get(this.answers + 1);
        if (next) this.handle(next, []);
      }
    }
  }

  /** Every message makes the kernel report "busy" and "idle" to the page: one alone for that only if it asks. */
  private acknowledge({ frame, asks }: FrameMessage): void {
    this.arrived = frame;
    if (asks) this.post({ type: "credit", view: this.view });
  }

  private readonly suspect = (): void => {
    this.suspectedAt = this.clock.now();
  };

  private resolve(reply: ReplyMessage): void {
    this.waiting.get(reply.id)?.resolve(reply);
    this.waiting.delete(reply.id);
  }

  /** Whether an answer is the next one, which is then counted. One that came early waits for its turn. */
  private isNext(answer: AnswerMessage): boolean {
    if (answer.number > this.answers + 1) {
      if (!this.early.size) this.earlySince = this.clock.now();
      this.early.set(answer.number, answer);
    }
    if (answer.number !== this.answers + 1) return false;
    this.count(answer.number);
    if (answer.seq === this.inFlight) this.inFlight = 0;
    return true;
  }

  /** Answers up to this number are known. */
  private count(number: number): void {
    this.answers = number;
    for (const each of this.early.keys()) if (each <= number) this.early.delete(each);
    this.earlySince = this.clock.now();
  }

  /** Handle a snapshot: it contains the texts that it says, or they have not arrived and never count. */
  private begin({ document, number, seq }: SnapshotMessage): void {
    this.count(document === this.document ? Math.max(number, this.answers) : number);
    this.document = document;
    if (this.inFlight <= seq) this.inFlight = 0;
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
    const missing = this.early.size ? this.earlySince : this.inFlight ? this.textSince : now;
    if (now - Math.max(missing, this.lastHello) >= LOST_AFTER) this.hello(); // a message was lost
    let since = this.inFlight ? this.textSince : now;
    for (const { since: asked } of this.waiting.values()) since = Math.min(since, asked);
    this.become(this.lastMessage - since >= BUSY_AFTER ? "busy" : "live"); // in silence nothing is known
  }

  private become(link: Link): void {
    if (link === this.link) return;
    this.link = link;
    this.listener.link(link);
    if (link === "dead") this.refuse();
  }
}
