/**
 * Texts that are not the editor's own: those of the past, which places refer to (each remembers how the
 * editor's text has changed since, so that a place in it is found in the text as it is now), and those
 * from elsewhere, of which only what differs is replaced, so that the cursor stays.
 */

import { type ChangeDesc, ChangeSet, type ChangeSpec, type Text, Text as Texts } from "@codemirror/state";
import type { TextRange } from "../protocol";
import { type Span, spanOf } from "./places";

export class Tracked {
  private changes: ChangeDesc | null = null;

  constructor(private doc: Text = Texts.empty) {}

  /** Refer to a text that has changed since. */
  begin(doc: Text, changes: ChangeDesc | null = null): void {
    this.doc = doc;
    this.changes = changes;
  }

  become(other: Tracked): void {
    this.begin(other.doc, other.changes);
  }

  /** Refer to a text that differs from the present one. */
  differs(doc: Text, now: Text): void {
    this.begin(doc);
    const change = difference(doc, now);
    if (change) this.add(ChangeSet.of(change, doc.length).desc);
  }

  /** The editor's text changed. */
  add(changes: ChangeDesc): void {
    this.changes = this.changes ? this.changes.composeDesc(changes) : changes;
  }

  /** The present place of a range; null if its text was deleted. */
  span(range: TextRange): Span | null {
    const span = spanOf(this.doc, range);
    return this.changes ? movedSpan(span, this.changes) : span;
  }
}

/** The place of a span after changes, without what was typed at its ends; null if its text was deleted. */
export function movedSpan({ from, to }: Span, changes: ChangeDesc): Span | null {
  const now = { from: changes.mapPos(from, 1), to: changes.mapPos(to, -1) };
  if (now.from > now.to) return from === to ? { from: now.to, to: now.to } : null;
  return now.from === now.to && from !== to ? null : now;
}

/** One replacement that makes `next` of `doc`; null if they are equal. */
export function difference(doc: Text, next: Text): ChangeSpec | null {
  if (doc.eq(next)) return null;
  const old = doc.toString();
  const now = next.toString();
  const most = Math.min(old.length, now.length);
  let start = 0;
  while (start < most && old.charCodeAt(start) === now.charCodeAt(start)) start++;
  if (start && old.codePointAt(start - 1)! > 0xffff) start--; // half a character
  let end = 0;
  while (end < most - start && old.charCodeAt(old.length - 1 - end) === now.charCodeAt(now.length - 1 - end))
    end++;
  if (end && old.length - end && old.codePointAt(old.length - end - 1)! > 0xffff) end--;
  return { from: start, to: old.length - end, insert: next.slice(start, now.length - end) };
}
