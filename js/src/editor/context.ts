/** The syntactic context of an offset: its form, the word within the form, and the scope. */

import type { EditorState } from "@codemirror/state";
import type { SyntaxNode } from "@lezer/common";
import { outlineOf, treeOf } from "../language/lrp";
import { isIn, nameOf, parentOf } from "../language/paths";

/** The kinds of names that may appear at a place. */
type Wanted = "keyword" | "event" | "delay" | "state" | "machine" | "python" | "nothing";

interface Context {
  wanted: Wanted;
  /** Path of the innermost enclosing machine. */
  scope: string;
  /** The machine whose states can be named. */
  machine: string;
  /** The kind of the enclosing form: `State`, `Transition`, …; `Program` at the top level. */
  form: string;
}

const FORM = /^(Variable|Machine|State|Event|Spawn|Action|Transition|Unknown|Program)$/;
const WORD = /^(Name|Number|Block|Star|Minus|Group|Definition)$/;

export function contextAt(state: EditorState, offset: number): Context {
  const scope = outlineOf(state).around(offset, "machine")?.path ?? "";
  const context: Context = { wanted: "nothing", scope, machine: scope, form: "Program" };
  let node: SyntaxNode | null = treeOf(state).resolveInner(offset, -1);
  if (inside(node, "Block", offset)) return { ...context, wanted: "python", form: "Block" };
  if (/Comment|String/.test(node.name)) return context;
  while (node && !FORM.test(node.name)) node = node.parent;
  if (!node) return context;
  const word = /[\w\u0080-\uffff]*$/.exec(state.sliceDoc(Math.max(node.from, offset - 100), offset))![0];
  const begin = offset - word.length;
  const before = state.sliceDoc(Math.max(0, begin - 100), begin).trimEnd();
  if (before.endsWith("(")) {
    const parent = word || node.name === "Unknown" ? formAround(node) : node;
    return {
      ...context,
      wanted: "keyword",
      form: node.from === begin - 1 ? formAround(node).name : parent.name,
    };
  }
  context.form = node.name;
  if (node.name === "Transition") return { ...context, ...inTransition(node, begin, state, scope) };
  if (node.name === "Spawn") return { ...context, ...inSpawn(node, begin, state, scope) };
  return context;
}

function inside(node: SyntaxNode | null, name: string, offset: number): boolean {
  for (let at = node; at; at = at.parent) {
    if (at.name === name && at.from < offset) return !(at.lastChild?.name === "]" && offset >= at.to);
  }
  return false;
}

function formAround(node: SyntaxNode): SyntaxNode {
  let at = node.parent;
  while (at?.parent && !FORM.test(at.name)) at = at.parent;
  return at ?? node;
}

function wordsBefore(form: SyntaxNode, offset: number): SyntaxNode[] {
  const words: SyntaxNode[] = [];
  for (let child = form.firstChild; child && child.to < offset; child = child.nextSibling) {
    if (WORD.test(child.name) || child.name === "Arrow") words.push(child);
  }
  return words;
}

function inTransition(form: SyntaxNode, offset: number, state: EditorState, scope: string): Partial<Context> {
  const keyword = form.getChild("Keyword");
  const kind = keyword ? state.sliceDoc(keyword.from, keyword.to) : "";
  const words = wordsBefore(form, offset);
  const arrow = words.findIndex((word) => word.name === "Arrow");
  if (arrow >= 0) {
    const outer = parentOf(parentOf(scope));
    return words.length - arrow > 1 ? {} : { wanted: "state", machine: kind === "exit" ? outer : scope };
  }
  if (kind === "eps" || words.length) return { wanted: "state" };
  return { wanted: kind === "ontime" ? "delay" : "event" };
}

function inSpawn(form: SyntaxNode, offset: number, state: EditorState, scope: string): Partial<Context> {
  const [first, second] = wordsBefore(form, offset);
  if (!first) return { wanted: "machine" };
  if (second) return {};
  const name = state.sliceDoc(first.from, first.to);
  const machine = spawnable(state, form.from, scope).find((path) => nameOf(path) === name);
  return { wanted: "state", machine: machine ?? "" };
}

/** Paths of the machines that can be spawned at a place, inner before outer. */
export function spawnable(state: EditorState, offset: number, scope: string): string[] {
  const found = outlineOf(state);
  const here = found.around(offset, "state")?.path ?? "";
  return found.items
    .filter(({ kind, path }) => kind === "machine" && isIn(here, parentOf(path)) && !isIn(scope, path))
    .map(({ path }) => path)
    .sort((a, b) => b.length - a.length);
}

/** The dotted name at an offset: `robot.light.data`. */
export function chainAt(
  state: EditorState,
  offset: number,
): { text: string; from: number; to: number } | null {
  const line = state.doc.lineAt(offset);
  const at = offset - line.from;
  const left = /[\w.\u0080-\uffff]*$/.exec(line.text.slice(0, at))![0];
  const right = /^[\w\u0080-\uffff]*/.exec(line.text.slice(at))![0];
  const text = (left + right).replace(/^[\d.]+/, "");
  if (!text) return null;
  return { text, from: offset + right.length - text.length, to: offset + right.length };
}
