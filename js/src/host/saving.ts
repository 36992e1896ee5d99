/**
 * What is typed is in the notebook when it is saved: the text in the `%%lrp` cell that holds the program, and beside
 * the picture in the output of the lab. Jupyter writes what the model contains when it reports that saving
 * "started"; the picture is asked for before, as often as the program changes, at most once a second.
 */

import type { Editor } from "../editor/editor";
import type { Lab } from "../session/store";
import { plain } from "../ui/difference";
import { calledAfter } from "../ui/timers";
import type { Holder } from "./holder";
import { type CellPlace, type Notebook, PICTURE, saveOutput, textOf } from "./notebook";

const REST = 1000; // ms between two pictures, at least

export function saveWith(
  notebook: Notebook,
  lab: Lab,
  editor: Editor,
  holder: Holder,
  place: () => CellPlace | null,
): void {
  const { store, root, closed } = lab;
  const { model } = notebook;
  let picture: { svg: string; revision: number } | null = null;
  let begun = -1; // the revision whose picture the notebook has from its kernel
  let waiting: Promise<void> | null = null;
  let isTyped = false; // into this page

  const isStale = () => store.state.revision !== (picture?.revision ?? begun);
  /** Of two pages with a shared notebook only one writes: both would insert the same. */
  const isWriter = () => !model.collaborative || editor.isLast;
  const draw = async () => {
    const { revision } = store.state;
    const { svg, error } = await lab.ask({ type: "picture" });
    if (!error && svg) picture = { svg, revision };
  };
  /** Put text and picture where they are saved; returns whether something is to be saved. */
  const put = (): boolean => {
    if (!isWriter()) return false;
    const held = holder.held;
    const isNews = held !== null && held.program !== plain(editor.text);
    if (held) isNews ? holder.write(held) : holder.told();
    const here = place();
    const index = here ? indexOf(root) : -1;
    const svg = picture && { [PICTURE]: picture.svg };
    const isOther = here !== null && saveOutput(here.cell, index, { "text/plain": editor.text, ...svg });
    return isNews || isOther;
  };
  /** The server of a shared notebook saves what changes, and reports nothing. */
  const share = () => void (model.collaborative && put());
  /** Save what was not there yet when the notebook was saved. */
  const supplement = () => {
    if (model.dirty || !put()) return; // else it is saved with what has changed since
    model.dirty = true;
    void notebook.save();
  };
  const rest = calledAfter(REST, async () => {
    if (closed.aborted) return;
    share();
    if (!isStale()) return;
    await draw();
    if (model.collaborative) put();
    else supplement();
  });
  editor.onChange = () => {
    if (!editor.isLast) return; // the page of the other one is to be saved
    if (!model.collaborative) model.dirty = true;
    isTyped = true;
    rest();
  };
  /** What was typed last may begin to run only after the last rest. */
  store.watch(["revision"], () => isTyped && rest());
  const saving = (_: unknown, state: string) => {
    if (state === "started") {
      put();
      waiting = isStale() ? draw() : null;
    } else if (state === "completed" && waiting) {
      void waiting.then(supplement);
      waiting = null;
    }
  };
  store.watch(["snapshot"], () => {
    const output = place()?.cell.outputs?.get(indexOf(root));
    const shown = textOf(output?.data["text/plain"]);
    picture = null;
    begun = typeof shown === "string" && plain(shown) === plain(editor.text) ? store.state.revision : -1;
  });
  notebook.saveState.connect(saving);
  closed.addEventListener("abort", () => {
    share();
    notebook.saveState.disconnect(saving);
  });
}

/** Which output of its cell an element is in. */
function indexOf(inside: HTMLElement): number {
  const output = inside.closest(".jp-OutputArea-child");
  const all = output?.parentElement?.children ?? [];
  return [...all].filter(({ className }) => className.includes("jp-OutputArea-child")).indexOf(output!);
}
