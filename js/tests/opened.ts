import { ChangeSet, Text } from "@codemirror/state";
import { EditorView } from "@codemirror/view";
import { difference } from "../src/editor/texts";
import type { WidgetManager } from "../src/host/notebook";
import { openLab } from "../src/lab";
import type {
  AnswerMessage,
  Command,
  FromPage,
  PartName,
  Sections,
  SnapshotMessage,
  UpdateView,
} from "../src/protocol";
import { type Packed, packed, unpacked } from "../src/session/plain";
import recording from "./page/recording.json";

/** Whether these tests run as in Colab and marimo (see `vitest.config.ts`), else as in Jupyter. */
export const ELSEWHERE = process.env.LRP_HOST === "elsewhere";

/** A whole lab in a page without a browser, and the kernel's end of its wire. */
export class Page {
  readonly around = document.createElement("div");
  readonly host = document.createElement("div");
  sent: FromPage[] = [];
  private ended = false;
  /** The kernel's text, of which revision, how many answers there were, and which texts are in it. */
  kernel = { text: Text.empty, revision: 0, number: 0, seq: 0 };
  private hear: (message: unknown, buffers: ArrayBufferView[]) => void = () => {};
  readonly close: () => void;
  /** The traits of its widget, and how often the page has saved them. */
  readonly traits: Record<string, unknown> = {};
  saved = 0;

  constructor(part: PartName = "lab", attach = true, manager?: WidgetManager) {
    if (manager) {
      this.around.className = "jp-Cell"; // the first one
      this.around.dataset.windowedListIndex = "0";
      this.host.className = "jp-OutputArea-child";
    }
    document.body.append(this.around);
    if (attach) this.attach();
    const model = {
      send: (message: unknown) => {
        if (this.ended) throw new Error("The comm is closed");
        this.sent.push(unpacked(message as Packed));
      },
      on: (event: string, callback: (...args: never[]) => void) => {
        if (event === "msg:custom") this.hear = callback as never;
      },
      off: () => {},
      get: (name: string) => this.traits[name],
      set: (name: string, value: unknown) => {
        this.traits[name] = value;
      },
      save_changes: () => {
        this.saved += 1;
      },
      ...(manager && { widget_manager: manager }),
    };
    this.close = openLab(model, part, this.host);
  }

  attach(): void {
    (ELSEWHERE ? this.around.attachShadow({ mode: "open" }) : this.around).append(this.host);
  }

  /** The element that has the keyboard's focus. */
  get focused(): Element | null {
    return (this.host.getRootNode() as Document).activeElement;
  }

  /** The kernel ends; the page notices at its next message. */
  end(): void {
    this.ended = true;
    this.find('[data-lrp-action="stop"]').click();
  }

  get view(): string {
    return this.sent[0]!.view;
  }

  deliver(message: object, bytes: Uint8Array[] = []): void {
    const views = bytes.map(({ buffer, byteOffset, length }) => new DataView(buffer, byteOffset, length));
    this.hear(packed({ view: this.view, ...message }), ELSEWHERE ? bytes : views);
  }

  /** Deliver a snapshot of a text. */
  open(fields: Partial<SnapshotMessage> = {}): void {
    const snapshot = { ...structuredClone(recording.snapshot), ...fields };
    const { revision, number, seq } = snapshot;
    this.kernel = { text: lines(snapshot.text), revision, number, seq };
    this.deliver(snapshot);
  }

  /** The changes of the texts that the kernel has not handled, which it then has. */
  merge(): UpdateView[] {
    return this.of("text")
      .filter(({ seq }) => seq > this.kernel.seq)
      .flatMap(({ seq, updates }) => updates.map((changes) => this.update(changes, this.view, seq)));
  }

  /** Make the next revision. */
  update(changes: Sections, view = "", seq = this.kernel.seq): UpdateView {
    const { kernel } = this;
    kernel.text = ChangeSet.fromJSON(changes).apply(kernel.text);
    kernel.revision++;
    kernel.seq = seq;
    return { view, changes };
  }

  /** The next answer, with these updates. */
  answer(updates: UpdateView[], fields: Partial<AnswerMessage> = {}): Partial<AnswerMessage> {
    const { revision, seq } = this.kernel;
    const number = ++this.kernel.number;
    return { ...ANSWER, number, seq: fields.seq ?? seq, revision, updates, ...fields };
  }

  /** The kernel answers what was typed. */
  confirm(fields: Partial<AnswerMessage> = {}): void {
    this.deliver(this.answer(this.merge(), fields));
  }

  /** Another view, or a cell, has changed the text. */
  elsewhere(text: string, view = ""): UpdateView[] {
    const change = difference(this.kernel.text, lines(text));
    return change ? [this.update(ChangeSet.of(change, this.kernel.text.length).toJSON(), view)] : [];
  }

  /** The fields of a snapshot after an interruption: what others changed, and the last text that counts. */
  snapshot(updates: UpdateView[], seq: number): Partial<SnapshotMessage> {
    const { text, revision, number } = this.kernel;
    return { text: text.toString(), revision, number, seq, updates };
  }

  hears(text: string, fields: Partial<AnswerMessage> = {}): void {
    this.deliver(this.answer(this.elsewhere(text), { seq: 0, ...fields }));
  }

  async begin(): Promise<this> {
    this.open();
    await this.drawn();
    return this;
  }

  drawn(): Promise<void> {
    return new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(() => resolve())));
  }

  find(selector: string): HTMLElement {
    const found = this.host.querySelector<HTMLElement>(selector);
    if (!found) throw new Error(`nothing is ${selector}`);
    return found;
  }

  get editor(): EditorView {
    return EditorView.findFromDOM(this.find(".cm-editor"))!;
  }

  type(text: string, at = 0): void {
    this.editor.dispatch({ changes: { from: at, insert: text }, userEvent: "input.type" });
  }

  of<K extends FromPage["type"]>(type: K): Extract<FromPage, { type: K }>[] {
    return this.sent.filter((message) => message.type === type) as Extract<FromPage, { type: K }>[];
  }

  commands(act: Command["do"]): Command[] {
    return this.of("command").filter((command) => command.do === act);
  }
}

export const lines = (text: string) => Text.of(text.split("\n"));

export const ANSWER: Partial<AnswerMessage> = {
  type: "answer",
  findings: [],
  accepted: true,
  applied: true,
  reason: "",
  half_typed: false,
  running: null,
  pending: null,
};
