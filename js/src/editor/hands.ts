/**
 * The cursors and selections of other views, each in a colour of its view. They are drawn over the text, so that
 * nothing moves for them, and move with the text until the kernel says where they are.
 */

import {
  type ChangeDesc,
  EditorSelection,
  type EditorState,
  type Extension,
  StateEffect,
  StateField,
  type Transaction,
} from "@codemirror/state";
import { type EditorView, type LayerMarker, layer, RectangleMarker } from "@codemirror/view";
import type { HandView } from "../protocol";

const COLOURS = 4;

/** A selection in another view's editor. */
interface Hand {
  view: string;
  anchor: number;
  head: number;
}

const placed = StateEffect.define<readonly Hand[]>();

/** Goes with changes that another view has made: its cursor is after what it typed. */
export const typedBy = StateEffect.define<string>();

const hands = StateField.define<readonly Hand[]>({
  create: () => [],
  update(value, { changes, docChanged, effects }) {
    if (docChanged && value.length) {
      const authors = effects.flatMap((effect) => (effect.is(typedBy) ? [effect.value] : []));
      value = value.map(({ view, ...place }) => moved(view, place, changes, authors.includes(view) ? 1 : -1));
    }
    for (const effect of effects) if (effect.is(placed)) value = effect.value;
    return value;
  },
});

export function handsIn(state: EditorState): readonly Hand[] {
  return state.field(hands);
}

function moved(view: string, { anchor, head }: Omit<Hand, "view">, changes: ChangeDesc, side: number): Hand {
  return { view, anchor: changes.mapPos(anchor, side), head: changes.mapPos(head, side) };
}

/** Show where the kernel says that other hands are; `ahead` are the changes here that it does not know. */
export function placeHands(
  view: EditorView,
  others: readonly [string, HandView][],
  ahead: ChangeDesc | null,
): void {
  const { length } = ahead ?? view.state.doc;
  const found = others.flatMap(([name, { selection }]): Hand[] => {
    if (!selection) return [];
    const [anchor, head] = selection.map((place) => Math.min(place, length)) as [number, number];
    return [ahead ? moved(name, { anchor, head }, ahead, -1) : { view: name, anchor, head }];
  });
  if (found.length || handsIn(view.state).length) view.dispatch({ effects: placed.of(found) });
}

/** A cursor. It is drawn again wherever it comes, so that its flag is seen there for a while. */
class Caret extends RectangleMarker {
  override update(): boolean {
    return false;
  }
}

function classes(kind: string, view: string): string {
  let sum = 0;
  for (const char of view) sum = (sum * 31 + char.codePointAt(0)!) % 9973;
  return `lrp-hand-${kind} lrp-hand-${(sum % COLOURS) + 1}`;
}

function drawn(above: boolean, markers: (view: EditorView, hand: Hand) => readonly LayerMarker[]): Extension {
  return layer({
    above,
    class: "lrp-hands",
    update: ({ docChanged, transactions }) => docChanged || transactions.some(isPlaced),
    markers: (view) => handsIn(view.state).flatMap((hand) => markers(view, hand)),
  });
}

function isPlaced({ effects }: Transaction): boolean {
  return effects.some((effect) => effect.is(placed));
}

export const otherHands: Extension = [
  hands,
  drawn(false, (view, { view: name, anchor, head }) =>
    anchor === head
      ? []
      : RectangleMarker.forRange(view, classes("selection", name), EditorSelection.range(anchor, head)),
  ),
  drawn(true, (view, { view: name, head }) =>
    RectangleMarker.forRange(view, "", EditorSelection.cursor(head)).map(
      ({ left, top, height }) => new Caret(classes("caret", name), left, top, null, height),
    ),
  ),
];
