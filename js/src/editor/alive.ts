/**
 * CodeMirror ends a plugin that throws, for good, and with it what the plugin draws. Here all plugins begin again a
 * moment later, in the same text and at the same place; the fault is one of the page like any other.
 */

import type { Extension } from "@codemirror/state";
import { EditorView } from "@codemirror/view";
import { calledAfter } from "../ui/timers";

export const AGAIN_AFTER = 1000; // ms: what throws at every change must not draw the whole text at every change

export function alive(view: () => EditorView): Extension {
  const begin = calledAfter(AGAIN_AFTER, () => {
    const place = view().scrollSnapshot();
    view().setState(view().state);
    view().dispatch({ effects: place });
  });
  return EditorView.exceptionSink.of((error) => {
    reportError(error);
    begin();
  });
}
