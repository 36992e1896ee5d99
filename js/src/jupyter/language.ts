/** LRP as a language of JupyterLab's editors: what the lab's own editor has, as far as the text alone is enough. */

import { acceptCompletion, startCompletion } from "@codemirror/autocomplete";
import { indentLess, indentMore } from "@codemirror/commands";
import { codeFolding, foldKeymap, indentUnit, LanguageSupport } from "@codemirror/language";
import { Prec } from "@codemirror/state";
import { type Command, EditorView, keymap, tooltips } from "@codemirror/view";
import { completion, type Known } from "../editor/complete";
import { contextAt } from "../editor/context";
import { newLine } from "../language/indent";
import { lrp } from "../language/lrp";
import { initialState } from "../session/state";
import members from "./members.json";

export const MIME = "text/x-lrp";

/** Whether a cell begins with the magic, and so is a program of this language. */
export const isLrp = (cell: string) => /^%%lrp\b/.test(cell);

/** Of a text without a lab: the robot is the simulated one. */
const { bridge, ...state } = initialState();
export const KNOWN: Known = {
  store: { state: { ...state, bridge: { ...bridge, members } } },
  ask: async () => ({ type: "reply", view: "", id: 0, error: null }),
};

/** Complete the word before the cursor, else indent; the options of the magic are completed by the kernel. */
const complete: Command = (view) => {
  const { head, empty } = view.state.selection.main;
  const line = view.state.doc.lineAt(head);
  if (empty && isLrp(line.text)) return false;
  const isWord = empty && /[\w.\u0080-\uffff]$/.test(line.text.slice(0, head - line.from));
  if (isWord && contextAt(view.state, head).wanted !== "nothing") return startCompletion(view);
  return indentMore(view);
};

/** Begin a line, unless Enter chooses one of the options that JupyterLab shows. */
const enter: Command = (view) => !view.dom.closest(".jp-mod-completer-active") && newLine(view);

export function support(): LanguageSupport {
  const { language, support } = lrp();
  return new LanguageSupport(language, [
    support,
    completion(KNOWN),
    tooltips({ parent: document.body }), // a cell would cut them off
    codeFolding(),
    Prec.high(indentUnit.of("  ")),
    EditorView.editorAttributes.of({ class: "lrp-text" }),
    Prec.high(
      keymap.of([
        { key: "Tab", run: acceptCompletion },
        { key: "Tab", run: complete, shift: indentLess },
        { key: "Enter", run: enter },
        ...foldKeymap,
      ]),
    ),
  ]);
}
