/** The gutter of the coverage: in how many of the kept runs each state is entered and each transition fires. */

import { type EditorState, type Extension, RangeSet } from "@codemirror/state";
import { GutterMarker, gutter } from "@codemirror/view";
import type { Item, Outline } from "../language/outline";
import { onlyWay, reachWords, timesReached } from "../parts/coverage";
import type { LabState, Reached } from "../session/state";
import { h } from "../ui/dom";
import { wholeOutline, wholeOutlineOf } from "./whole";

class Figure extends GutterMarker {
  constructor(
    private readonly times: number,
    private readonly isOneWay: boolean,
    private readonly words: string,
  ) {
    super();
  }

  override eq(other: Figure): boolean {
    return other.times === this.times && other.isOneWay === this.isOneWay && other.words === this.words;
  }

  override toDOM(): HTMLElement {
    const attributes = { "data-reached": this.times, "data-one-way": this.isOneWay, title: this.words };
    return h("span", { class: "lrp-reached", ...attributes }, String(this.times));
  }
}

/** The gutter; of several elements on a line the one that the fewest runs reach counts. */
export function coverageGutter(state: LabState): Extension {
  let made: { outline: Outline; reached: Reached; figures: RangeSet<GutterMarker> } | null = null;
  const figures = (editor: EditorState) => {
    const outline = wholeOutlineOf(editor);
    const { reached } = state;
    if (!reached) return RangeSet.empty;
    if (made?.outline !== outline || made.reached !== reached)
      made = { outline, reached, figures: figuresOf(editor, outline, state) };
    return made.figures;
  };
  return [
    wholeOutline,
    gutter({
      class: "lrp-coverage-gutter",
      markers: (view) => figures(view.state),
      initialSpacer: () => new Figure(state.reached?.runs ?? 0, false, ""),
    }),
  ];
}

function figuresOf(editor: EditorState, outline: Outline, state: LabState): RangeSet<GutterMarker> {
  const { reached } = state;
  const lines = new Map<number, Item[]>();
  for (const item of outline.items) {
    if (timesReached(reached, item.kind, item.path) === null) continue;
    const { from } = editor.doc.lineAt(item.nameFrom);
    lines.set(from, [...(lines.get(from) ?? []), item]);
  }
  const marks = [...lines].map(([from, items]) => {
    const times = items.map(({ kind, path }) => timesReached(reached, kind, path) ?? 0);
    const isOneWay = items.some(({ kind, path }) => onlyWay(reached, kind, path));
    const words = items.map(({ kind, path, name }) => `${name}: ${reachWords(state, kind, path)}`);
    return new Figure(Math.min(...times), isOneWay, words.join("\n")).range(from);
  });
  return RangeSet.of(marks, true);
}
