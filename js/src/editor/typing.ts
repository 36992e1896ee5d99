/**
 * When what is typed is meant: once the cursor has left the word, or nothing was typed for a while. Until then
 * it is sent as half typed, and the kernel delays what it would break.
 */

import type { EditorState } from "@codemirror/state";
import type { ViewUpdate } from "@codemirror/view";
import { scrubbed } from "./scrub";

export const WORD_AFTER = 700; // ms
export const NUMBER_AFTER = 400;

const WORD = /[\p{L}\p{N}_.]*$/u;
const REST = /^[\p{L}\p{N}_]*/u;

/** Sends what was typed, with the place of the cursor if that is in the text. */
type Send = (hasCursor: boolean, meant: boolean) => void;

export class Typing {
  private from = 0;
  private to = 0;
  private timer = 0;
  /** Whether something of the last text waits for the word to be meant, or for the cursor to leave. */
  waits = false;

  constructor(
    private readonly send: Send,
    /** Whether others see the cursor, wherever it is. */
    private readonly isSeen: () => boolean = () => false,
  ) {}

  /** Handle a change of the text that was made here. */
  changed({ state, transactions }: ViewUpdate): void {
    const isTyped = transactions.some(
      (one) =>
        (one.isUserEvent("input.type") || one.isUserEvent("delete")) &&
        one.annotation(scrubbed) === undefined,
    );
    this.stop();
    if (isTyped) {
      const word = wordAt(state, state.selection.main.head);
      [this.from, this.to] = [word.from, word.to];
      this.timer = window.setTimeout(() => this.over(true), word.isNumber ? NUMBER_AFTER : WORD_AFTER);
    }
    this.waits = true; // until the kernel answers
    this.send(true, !isTyped);
  }

  moved({ state }: ViewUpdate): void {
    const { head } = state.selection.main;
    if (!this.timer || head < this.from || head > this.to) this.over(true);
  }

  /** Handle the loss of the focus: there is no cursor. */
  left(): void {
    this.over(false);
  }

  answered(halfTyped: boolean): void {
    this.waits = halfTyped;
  }

  stop(): void {
    clearTimeout(this.timer);
    this.timer = 0;
  }

  private over(hasCursor: boolean): void {
    this.stop();
    if (this.waits || this.isSeen()) this.send(hasCursor, true);
  }
}

function wordAt(state: EditorState, offset: number): { from: number; to: number; isNumber: boolean } {
  const line = state.doc.lineAt(offset);
  const before = WORD.exec(line.text.slice(0, offset - line.from))![0];
  const after = REST.exec(line.text.slice(offset - line.from))![0];
  const word = /^[\d.]/.test(before) ? before : before.slice(before.lastIndexOf(".") + 1);
  return { from: offset - word.length, to: offset + after.length, isNumber: /^\d/.test(word || after) };
}
