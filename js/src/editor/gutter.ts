/**
 * The gutter of breakpoints: a dot on the line in which an element with a breakpoint is defined, and a question mark
 * that asks why on the line of the cursor, or under the pointer. A click or a key acts on the innermost element.
 */

import {
  type EditorState,
  type Extension,
  type RangeSet,
  RangeSetBuilder,
  StateEffect,
  StateField,
} from "@codemirror/state";
import { type BlockInfo, EditorView, GutterMarker, gutter, keymap } from "@codemirror/view";
import type { Item, Outline } from "../language/outline";
import { breakpointsOf, type Dot, dotsOf, keyOf, toggleBreakpoint, USUAL } from "../parts/breakpoints";
import { askWhy } from "../parts/why";
import type { ElementKind } from "../protocol";
import type { Lab } from "../session/store";
import { h } from "../ui/dom";
import { atCursor } from "./cursor";
import { wholeOutline, wholeOutlineOf } from "./whole";

const ASKED: ElementKind[] = ["state", "transition"];

/** The innermost element of some kinds that is defined on the line from `from` to `to`; of several, the first. */
function definedOn(outline: Outline, from: number, to: number, kinds: ElementKind[]): Item | undefined {
  const depth = ({ path }: Item) => path.split(/[/:]/).length;
  return outline.items
    .filter(({ kind, nameFrom }) => kinds.includes(kind) && from <= nameFrom && nameFrom <= to)
    .reduce<Item | undefined>((best, item) => (best && depth(best) >= depth(item) ? best : item), undefined);
}

class Mark extends GutterMarker {
  constructor(
    private readonly dot: Dot | null,
    private readonly asks: boolean,
  ) {
    super();
  }

  override eq(other: Mark): boolean {
    return other.dot === this.dot && other.asks === this.asks;
  }

  override toDOM(): HTMLElement {
    return h(
      "span",
      { class: "lrp-gutter-marks" },
      h("span", { class: "lrp-breakpoint-dot", "data-dot": this.dot ?? "none" }),
      h("span", { class: "lrp-gutter-why", "data-asks": this.asks }, this.asks ? "?" : ""),
    );
  }
}

/** The start of the line under the pointer, or -1. */
const hovered = StateEffect.define<number>();
const hoveredLine = StateField.define<number>({
  create: () => -1,
  update(value, transaction) {
    for (const effect of transaction.effects) if (effect.is(hovered)) return effect.value;
    return transaction.docChanged ? -1 : value;
  },
});

function marks(editor: EditorState, lab: Lab): RangeSet<GutterMarker> {
  const outline = wholeOutlineOf(editor);
  const dots = new Map<number, Dot>();
  const all = dotsOf(lab.store.state);
  for (const { kind, path, nameFrom } of all.size ? outline.items : []) {
    const dot = all.get(keyOf(kind, path));
    if (!dot) continue;
    const { from } = editor.doc.lineAt(nameFrom);
    if (dots.get(from) !== "on") dots.set(from, dot);
  }
  const asking = new Set<number>();
  for (const offset of [editor.selection.main.head, editor.field(hoveredLine)]) {
    if (offset < 0 || offset > editor.doc.length) continue;
    const { from, to } = editor.doc.lineAt(offset);
    if (definedOn(outline, from, to, ASKED)) asking.add(from);
  }
  const built = new RangeSetBuilder<GutterMarker>();
  for (const from of [...new Set([...dots.keys(), ...asking])].sort((a, b) => a - b))
    built.add(from, from, new Mark(dots.get(from) ?? null, asking.has(from)));
  return built.finish();
}

/** Remove the breakpoints that the dot of a line stands for; where there is none, set one. */
function toggleAt(view: EditorView, lab: Lab, offset: number): void {
  const { from, to } = view.state.doc.lineAt(offset);
  const outline = wholeOutlineOf(view.state);
  const item = definedOn(outline, from, to, Object.keys(USUAL) as ElementKind[]);
  const kind = item && USUAL[item.kind];
  const known = outline.items
    .filter(({ nameFrom }) => from <= nameFrom && nameFrom <= to)
    .flatMap(({ kind, path }) => breakpointsOf(lab.store.state, kind, path));
  if (known.length) for (const [number] of known) void lab.act({ do: "remove_breakpoint", number });
  else if (item && kind) void toggleBreakpoint(lab, kind, item.path);
  else lab.notify("This line defines no state, transition or event. A breakpoint belongs to one of these.");
}

function askAt(view: EditorView, lab: Lab, offset: number): void {
  const { from, to } = view.state.doc.lineAt(offset);
  const item = definedOn(wholeOutlineOf(view.state), from, to, ASKED);
  const at = view.coordsAtPos(from);
  if (item && at) askWhy(lab, item.kind, item.path, { x: at.left, y: at.bottom });
  else lab.notify("This line defines no state and no transition to ask about.");
}

export function breakpointGutter(lab: Lab): Extension {
  const hover = (view: EditorView, offset: number) => {
    if (view.state.field(hoveredLine) !== offset) view.dispatch({ effects: hovered.of(offset) });
    return false;
  };
  const mousedown = (view: EditorView, { from }: BlockInfo, event: Event) => {
    const { button, target } = event as MouseEvent;
    if (button !== 0) return false;
    event.preventDefault();
    const act = (target as Element).closest("[data-asks]") ? askAt : toggleAt;
    act(view, lab, from);
    return true;
  };
  return [
    wholeOutline,
    hoveredLine,
    gutter({
      class: "lrp-breakpoint-gutter",
      markers: (view) => marks(view.state, lab),
      initialSpacer: () => new Mark(null, false),
      domEventHandlers: {
        mousedown,
        mousemove: (view, { from }) => hover(view, from),
        mouseleave: (view) => hover(view, -1),
      },
    }),
    EditorView.domEventHandlers({
      mousemove: (event, view) => hover(view, view.lineBlockAtHeight(event.clientY - view.documentTop).from),
      mouseleave: (_, view) => hover(view, -1),
    }),
    keymap.of([
      { key: "Mod-F8", run: atCursor(lab, toggleAt), preventDefault: true },
      { key: "Alt-F8", run: atCursor(lab, askAt), preventDefault: true },
    ]),
  ];
}
