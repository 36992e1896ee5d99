/** Format the text: the kernel says where white space changes, and the cursor stays at its word. */

import type { EditorView } from "@codemirror/view";
import type { Lab } from "../session/store";
import { changesOf } from "./places";

export async function format(view: EditorView, lab: Lab): Promise<void> {
  const { doc } = view.state;
  const reply = await lab.ask({ type: "format", text: view.state.sliceDoc() });
  if (reply.error) lab.notify(reply.error);
  else if (view.state.doc !== doc) lab.notify("The text has changed in the meantime. Format it again.");
  else {
    const changes = changesOf(doc, reply.edits);
    if (changes.length) view.dispatch({ changes, userEvent: "input.format", scrollIntoView: true });
    else lab.notify("The text is already formatted.");
  }
}
