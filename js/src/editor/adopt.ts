/** Taking a text from elsewhere into the editor: only what differs is replaced, so the cursor stays. */

import { Annotation, type ChangeSpec, type Text } from "@codemirror/state";
import type { EditorView } from "@codemirror/view";

/** Marks a change that did not come from the person here, and must not be sent back. */
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
