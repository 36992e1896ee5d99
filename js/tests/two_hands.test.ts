// @vitest-environment happy-dom
/** Two editors, ahead of one kernel, over links that delay, overtake, repeat and lose messages. */

import { ChangeSet, Text } from "@codemirror/state";
import { afterEach, expect, it } from "vitest";
import { Editor } from "../src/editor/editor";
import type { AnswerMessage, FromKernel, FromPage, SnapshotMessage, UpdateView } from "../src/protocol";
import { type Clock, Connection } from "../src/session/connection";
import { type Packed, packed, unpacked } from "../src/session/plain";
import { type Lab, Store } from "../src/session/store";

const BEGIN = "(machine m\n  (state a))\n; 𝄞\n";
const LETTERS = { left: "ABCDEFGHIJKLM", right: "NOPQRSTUVWXYZ" };
type Name = keyof typeof LETTERS;

/** Whole numbers below a limit, the same ones each time. */
function numbers(seed: number): (limit: number) => number {
  let state = seed;
  return (limit) => {
    state = (Math.imul(state, 1103515245) + 12345) & 0x7fffffff;
    return (state >> 8) % limit;
  };
}

/** What the kernel's `Document` does, by CodeMirror's own change sets. */
class Kernel {
  text = Text.of(BEGIN.split("\n"));
  updates: { view: string; changes: ChangeSet }[] = [];
  private readonly seqs = new Map<string, number>();
  private number = 0;

  constructor(private readonly windows: Map<string, Window>) {}

  receive(message: FromPage): void {
    const known = this.seqs.get(message.view) ?? 0;
    if (message.type === "hello") {
      this.seqs.set(message.view, Math.max(known, message.seq ?? 0));
      this.welcome(message.view, message.document === "d" ? message.revision! : null);
    } else if (message.type === "text" && message.seq > known) {
      this.seqs.set(message.view, message.seq);
      let over = this.updates.slice(message.base).map(({ changes }) => changes);
      const before = this.updates.length;
      for (const each of message.updates) {
        let own = ChangeSet.fromJSON(each);
        over = over.map((other) => {
          const theirs = other.map(own, true);
          own = own.map(other);
          return theirs;
        });
        this.add(message.view, own);
      }
      this.answer(before, message.view, message.seq);
    }
  }

  /** A cell changes the text. */
  write(from: number, insert: string): void {
    const { length } = this.text;
    this.add("", ChangeSet.of({ from: Math.min(from, length), insert }, length));
    this.answer(this.updates.length - 1, "", 0);
  }

  private add(view: string, changes: ChangeSet): void {
    this.updates.push({ view, changes });
    this.text = changes.apply(this.text);
  }

  private since(revision: number): UpdateView[] {
    return this.updates.slice(revision).map(({ view, changes }) => ({ view, changes: changes.toJSON() }));
  }

  private answer(before: number, view: string, seq: number): void {
    this.number++;
    for (const [name, { coming }] of this.windows) {
      const fields = { number: this.number, seq: name === view ? seq : 0, revision: this.updates.length };
      const told = { applied: true, accepted: true, running: null, half_typed: false, findings: [] };
      const message = { type: "answer", view: name, ...fields, updates: this.since(before), ...told };
      coming.push(message as unknown as AnswerMessage);
    }
  }

  private welcome(view: string, revision: number | null): void {
    const text = this.text.toString();
    this.windows.get(view)!.coming.push({
      ...{ type: "snapshot", view, document: "d", number: this.number, seq: this.seqs.get(view)! },
      ...{ text, running: text, revision: this.updates.length, half_typed: false, findings: [] },
      updates: revision === null ? null : this.since(revision),
      frame: { type: "frame", view, frame: 1 },
    } as unknown as SnapshotMessage);
  }
}

/** An editor with its connection, and what is on its way. */
class Window {
  going: FromPage[] = [];
  coming: FromKernel[] = [];
  typed = "";
  readonly editor: Editor;
  readonly connection: Connection;
  private hear: (message: Packed) => void = () => {};

  constructor(readonly name: Name) {
    const root = document.createElement("div");
    const lab = { store: new Store(), root, closed: new AbortController().signal } as unknown as Lab;
    const model = {
      send: (message: unknown) => void this.going.push(unpacked(message as Packed)),
      on: (event: string, callback: (...args: never[]) => void) => {
        if (event === "msg:custom") this.hear = callback as never;
      },
      off: () => {},
    };
    const clock: Clock = { now: () => 0, every: () => () => {} };
    let editor: Editor | null = null;
    const listener = {
      message: (message: FromKernel) => {
        if (message.type === "snapshot") expect(editor!.begin(message)).toBe(null);
        if (message.type === "answer") editor!.wasAnswered(message);
      },
      link: () => {},
      get typist() {
        return editor;
      },
    };
    this.connection = new Connection(model, "editor", listener, clock, name);
    this.editor = editor = new Editor(lab, this.connection);
  }

  get doc(): Text {
    return this.editor.view.state.doc;
  }

  /** Type the next letter, after the one before. */
  type(place: number): void {
    const letter = LETTERS[this.name][this.typed.length % 13]!;
    const last = this.typed ? this.doc.toString().lastIndexOf(this.typed.at(-1)!) + 1 : 0;
    const from = this.typed ? last : Math.min(place, BEGIN.length - 4);
    this.editor.view.dispatch({ changes: { from, insert: letter }, userEvent: "input.type" });
    this.typed += letter;
  }

  /** Delete a letter that is not among those counted. */
  erase(place: number): void {
    const text = this.doc.toString();
    const from = [...text.slice(0, place)].join("").length;
    if (/[a-z ]/.test(text[from] ?? "")) this.editor.view.dispatch({ changes: { from, to: from + 1 } });
  }

  arrives(index: number, again: boolean): void {
    if (!this.coming.length) return;
    const at = index % this.coming.length;
    const message = structuredClone(this.coming[at]!);
    if (!again) this.coming.splice(at, 1);
    this.hear(packed(message));
  }
}

let windows = new Map<string, Window>();
afterEach(() => {
  for (const { editor } of windows.values()) editor.close();
});

it.each(Array.from({ length: 16 }, (_, seed) => seed))("both have every letter, in order (%i)", (seed) => {
  const random = numbers(seed * 7919 + 1);
  windows = new Map();
  const kernel = new Kernel(windows);
  const names = Object.keys(LETTERS) as Name[];
  for (const name of names) windows.set(name, new Window(name));
  const goes = (window: Window, again = false) => {
    const message = again ? window.going[0] : window.going.shift();
    if (message) kernel.receive(structuredClone(message));
  };
  const settle = () => {
    for (let turn = 0; turn < 50; turn++) {
      for (const window of windows.values()) {
        while (window.going.length) goes(window);
        while (window.coming.length) window.arrives(0, false);
        if (turn % 5 === 4 && !window.connection.isAnswered) window.connection.hello();
      }
    }
  };
  settle();
  for (let step = 0; step < 120; step++) {
    const window = windows.get(names[random(2)]!)!;
    const what = random(20);
    if (what < 7) window.type(random(30));
    else if (what < 8) window.erase(random(30));
    else if (what < 12) goes(window, random(6) === 0);
    else if (what < 18) window.arrives(random(3), random(6) === 0);
    else if (what < 19) kernel.write(random(30) + 1, "; cell\n");
    else {
      window.going = [];
      window.coming = [];
      window.connection.hello();
    }
  }
  for (const { connection } of windows.values()) connection.hello(); // the last answer may be lost
  settle();
  const texts = [...windows.values()].map(({ doc }) => doc.toString());
  expect(texts).toEqual([kernel.text.toString(), kernel.text.toString()]);
  for (const { name, typed } of windows.values()) {
    expect([...texts[0]!].filter((letter) => LETTERS[name].includes(letter)).join("")).toBe(typed);
  }
});
