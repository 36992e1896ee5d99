/**
 * Texts of the past that places refer to: the one last sent, the one that runs. Each remembers how the
 * editor's text has changed since, so that a place in it is found in the text as it is now.
 */

import { type ChangeDesc, type Text, Text as Texts } from "@codemirror/state";
import type { TextRange } from "../protocol";
import { type Span, spanOf } from "../text/places";

export class Tracked {
  private changes: ChangeDesc | null = null;

  constructor(private doc: Text = Texts.empty) {}

  /** The text as it is now is the one to refer to. */
  begin(doc: Text): void {
    this.doc = doc;
    this.changes = null;
  }

  /** Refer to what another one refers to. */
  take(other: Tracked): void {
    this.doc = other.doc;
    this.changes = other.changes;
  }

  /** The editor's text changed. */
  add(changes: ChangeDesc): void {
    this.changes = this.changes ? this.changes.composeDesc(changes) : changes;
  }

  /** Where a range stands now; null if what it covered was deleted. */
  span(range: TextRange): Span | null {
    const { from, to } = spanOf(this.doc, range);
    if (!this.changes) return { from, to };
    const now = { from: this.changes.mapPos(from, 1), to: this.changes.mapPos(to, -1) };
    if (now.from > now.to) return from === to ? { from: now.to, to: now.to } : null;
    return now.from === now.to && from !== to ? null : now;
  }
}
