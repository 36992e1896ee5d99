/**
 * Numbers that are changed by hand while the program runs: Alt and a drag, or Alt and the arrow keys, on a
 * number. Each step is an edit that runs at once; all steps of one gesture are one step of undo.
 */

import { Annotation, type EditorState, type Extension, Prec, StateField } from "@codemirror/state";
import { EditorView, hoverTooltip, keymap } from "@codemirror/view";
import type { Stepped } from "../session/state";
import type { Lab } from "../session/store";
import { h } from "../ui/dom";
import { trackDrag } from "../ui/drag";
import { pointOf } from "../ui/point";

type Values = Stepped["values"];

/** Marks a change that scrubbing made, which is meant at once; null where it ends what was begun. */
export const scrubbed = Annotation.define<Values | null>();

const STEP = 4; // px of a drag for one step
const NUMBER = /(?<![\w.])-?(?:\d+\.\d*|\.\d+|\d+)(?![\w.])/g;
/** After one of these a `-` is not the sign of the number: `a - 1`, `f(x)-1`. */
const OPERAND = /[\w)\]]\s*$/;

interface Literal {
  from: number;
  to: number;
  text: string;
}

/** The number that an offset touches. */
export function numberAt(state: EditorState, offset: number): Literal | null {
  const line = state.doc.lineAt(offset);
  for (const match of line.text.matchAll(NUMBER)) {
    const binary = match[0].startsWith("-") && OPERAND.test(line.text.slice(0, match.index));
    const text = binary ? match[0].slice(1) : match[0];
    const to = line.from + match.index + match[0].length;
    if (to - text.length <= offset && offset <= to) return { from: to - text.length, to, text };
  }
  return null;
}

/** A number after some steps: of its second digit, or of the last one that is written, whichever is finer. */
export function stepped(text: string, steps: number): string {
  const value = Number(text);
  const written = text.includes(".") ? text.length - text.indexOf(".") - 1 : 0;
  const second = value ? 1 - Math.floor(Math.log10(Math.abs(value))) : 1;
  const places = text.includes(".") ? Math.max(written, second, 1) : 0;
  const size = text.includes(".") ? 10 ** -places : 10 ** Math.max(0, -second);
  return (value + steps * size).toFixed(Math.min(places, 15)).replace(/^-(0(?:\.0*)?)$/, "$1");
}

function put(
  view: EditorView,
  { from, to }: Literal,
  text: string,
  isFirst: boolean,
  values: Values | null,
): Literal {
  view.dispatch({
    changes: { from, to, insert: text },
    selection: { anchor: from, head: from + text.length },
    // this event joins the last one of the history, however long ago that was
    userEvent: isFirst ? "input.scrub" : "input.type.compose",
    annotations: scrubbed.of(values),
  });
  return { from, to: from + text.length, text };
}

/** The number, if the last thing done was a step: the next one at the same number belongs to it. */
const stepping = StateField.define<Values | null>({
  create: () => null,
  update: (was, transaction) =>
    transaction.annotation(scrubbed) ?? (transaction.docChanged || transaction.selection ? null : was),
});

/** Tells the lab which number is stepped through. */
const telling = ({ store }: Lab) =>
  EditorView.updateListener.of(({ state, startState }) => {
    const values = state.field(stepping);
    if (values === startState.field(stepping, false)) return;
    const { from, to } = state.selection.main; // a step selects its number
    const [before, after] = [state.sliceDoc(0, from), state.sliceDoc(to)];
    const programs = values?.map((value) => before + value + after);
    store.set("stepped", values && programs ? { values, programs } : null);
  });

/** Changes the number at the cursor; false if there is none. */
function byKey(steps: number) {
  return (view: EditorView): boolean => {
    const { from, to, head } = view.state.selection.main;
    const literal = numberAt(view.state, head);
    if (!literal || from < literal.from || to > literal.to) return false;
    const now = stepped(literal.text, steps);
    const begun = view.state.field(stepping);
    put(view, literal, now, !begun, [begun?.[0] ?? literal.text, now, stepped(now, steps)]);
    return true;
  };
}

function byDrag(event: PointerEvent, view: EditorView): boolean {
  if (!event.altKey || event.button !== 0) return false;
  const offset = view.posAtCoords(pointOf(event));
  const begun = offset === null ? null : numberAt(view.state, offset);
  if (!begun) return false;
  view.focus();
  drag(event, view, view.contentDOM, begun);
  return true;
}

/** Change a number by a drag that begins on a surface; `tapped` are the steps of a press that is none. */
function drag(event: PointerEvent, view: EditorView, surface: Element, begun: Literal, tapped = 0): void {
  let literal = begun;
  let isFirst = true;
  let steps = 0;
  const become = (text: string, beyond: string | null) => {
    const isHere = view.state.sliceDoc(literal.from, literal.to) === literal.text; // not changed elsewhere
    if (!isHere || text === literal.text) return;
    literal = put(view, literal, text, isFirst, beyond === null ? null : [begun.text, text, beyond]);
    isFirst = false;
  };
  trackDrag(surface, event, {
    move: ({ clientX, shiftKey }) => {
      const [size, before] = [shiftKey ? 10 : 1, steps];
      steps = Math.trunc((clientX - event.clientX) / STEP) * size;
      const next = steps + Math.sign(steps - before) * size;
      become(stepped(begun.text, steps), stepped(begun.text, next));
    },
    end(last, moved) {
      if (!last) become(begun.text, null);
      else if (!moved && tapped) become(stepped(begun.text, tapped), stepped(begun.text, 2 * tapped));
    },
  });
}

/** What fingers have in the place of Alt: a strip, dragged on, or tapped at its ends. */
function strip(view: EditorView, offset: number): HTMLElement {
  const element = h(
    "div",
    {
      class: "lrp-scrub",
      onpointerdown: (event: PointerEvent) => {
        event.preventDefault(); // the focus stays where it is
        const { left, width } = element.getBoundingClientRect();
        const literal = numberAt(view.state, offset);
        if (literal) drag(event, view, element, literal, event.clientX < left + width / 2 ? -1 : 1);
      },
    },
    h("span", {}, "−"),
    h("span", {}, "drag"),
    h("span", {}, "+"),
  );
  return element;
}

const card = hoverTooltip(
  (view, offset) => {
    const literal = numberAt(view.state, offset);
    if (!literal || view.state.field(stepping)) return null; // who steps a number knows how
    return {
      pos: literal.from,
      end: literal.to,
      above: true,
      create: () => ({
        dom: h(
          "div",
          { class: "lrp-card" },
          h("span", {}, "Drag with Alt, or press Alt+↑ or Alt+↓, to change it while the program runs."),
          strip(view, literal.from),
        ),
      }),
    };
  },
  { hoverTime: 600 },
);

export const scrubbing = (lab: Lab): Extension => [
  stepping,
  telling(lab),
  card,
  EditorView.domEventHandlers({ pointerdown: byDrag }),
  Prec.high(
    keymap.of([
      { key: "Alt-ArrowUp", run: byKey(1), shift: byKey(10) },
      { key: "Alt-ArrowDown", run: byKey(-1), shift: byKey(-10) },
    ]),
  ),
];
