/**
 * Texts that are not the editor's own: those of the past, which places refer to (each remembers how the
 * editor's text has changed since, so that a place in it is found in the text as it is now), and those
 * from elsewhere, of which only what differs is replaced, so that the cursor stays.
 */

import {
  Annotation,
  type ChangeDesc,
  ChangeSet,
  type ChangeSpec,
  type Text,
  Text as Texts,
} from "@codemirror/state";
import type { EditorView } from "@codemirror/view";
import type { TextRange } from "../protocol";
import { type Span, spanOf } from "./places";

export class Tracked {
  private changes: ChangeDesc | null = null;

  constructor(private doc: Text = Texts.empty) {}

  /** Refer to the text as it is now. */
  begin(doc: Text): void {
    this.doc = doc;
    this.changes = null;
  }

  /** Refer to a text that differs from the present one. */
  differs(doc: Text, now: Text): void {
    this.begin(doc);
    const change = difference(doc, now);
    if (change) this.add(ChangeSet.of(change, doc.length).desc);
  }

  /** Refer to what another one refers to. */
  copy(other: Tracked): void {
    this.doc = other.doc;
    this.changes = other.changes;
  }

  /** The editor's text changed. */
  add(changes: ChangeDesc): void {
    this.changes = this.changes ? this.changes.composeDesc(changes) : changes;
  }

  /** The present place of a range; null if its text was deleted. */
  span(range: TextRange): Span | null {
    const { from, to } = spanOf(this.doc, range);
    if (!this.changes) return { from, to };
    const now = { from: this.changes.mapPos(from, 1), to: this.changes.mapPos(to, -1) };
    if (now.from > now.to) return from === to ? { from: now.to, to: now.to } : null;
    return now.from === now.to && from !== to ? null : now;
  }
}

/** Marks a change that the user did not type here, and that must not be sent back. */
export const adopted = Annotation.define<boolean>();

export function adopt(view: EditorView, text: string): void {
  const changes = difference(view.state.doc, view.state.toText(text));
  if (changes) view.dispatch({ changes, annotations: adopted.of(true) });
}

/** One replacement that makes `next` of `doc`; null if they are equal. */
export function difference(doc: Text, next: Text): ChangeSpec | null {
  if (doc.eq(next)) return null;
  const old = doc.toString();
  const now = next.toString();
  const most = Math.min(old.length, now.length);
  let start = 0;
  while (start < most && old.charCodeAt(start) === now.charCodeAt(start)) start++;
  let end = 0;
  while (end < most - start && old.charCodeAt(old.length - 1 - end) === now.charCodeAt(now.length - 1 - end))
    end++;
  return { from: start, to: old.length - end, insert: next.slice(start, now.length - end) };
}
