/** The syntactic context of an offset: its form, the word within the form, and the scope. */

import type { EditorState } from "@codemirror/state";
import type { SyntaxNode } from "@lezer/common";
import { outlineOf, treeOf } from "../language/lrp";
import type { Item } from "../language/outline";
import { isIn, nameOf, parentOf } from "../language/paths";

/** The kinds of names that may appear at a place; `held` is a state, or the `for` before it. */
type Wanted =
  | "keyword"
  | "event"
  | "delay"
  | "held"
  | "state"
  | "machine"
  | "setting"
  | "effect"
  | "python"
  | "nothing";

interface Context {
  wanted: Wanted;
  /** Path of the innermost enclosing machine. */
  scope: string;
  /** The machine whose states or variables can be named. */
  machine: string;
  /** The kind of the enclosing form: `State`, `Transition`, …; `Program` at the top level. */
  form: string;
}

const FORM = /^(Variable|Machine|State|Event|Spawn|Action|Transition|Unknown|Program)$/;
const WORD = /^(Name|InState|Keyword|Number|Block|Star|Minus|Group|Definition)$/;

export function contextAt(state: EditorState, offset: number): Context {
  const scope = outlineOf(state).around(offset, "machine")?.path ?? "";
  const context: Context = { wanted: "nothing", scope, machine: scope, form: "Program" };
  let node: SyntaxNode | null = treeOf(state).resolveInner(offset, -1);
  if (inside(node, "Block", offset)) return { ...context, wanted: "python", form: "Block" };
  if (/Comment|Magic|String/.test(node.name)) return context;
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
  if (node.name === "Variable" && node.parent?.name === "Spawn")
    return { ...context, ...inSetting(node, begin, state, scope) };
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

/** The words of a form before an offset, its keyword left out. */
function wordsBefore(form: SyntaxNode, offset: number): SyntaxNode[] {
  const words: SyntaxNode[] = [];
  const first = form.getChild("Keyword")?.nextSibling ?? null;
  for (let child = first; child && child.to < offset; child = child.nextSibling) {
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
    if (words.length - arrow > 1) return { wanted: "effect" };
    return { wanted: "state", machine: kind === "exit" ? outer : scope };
  }
  const machine = form.getChild("InState");
  if (machine && machine.from < offset && /\.\s*$/.test(state.sliceDoc(machine.from, offset)))
    return { wanted: "state", machine: machineCalled(state, scope, firstOf(machine, state)) ?? "" };
  const isHeld = kind === "on" || kind === "exit";
  if (isHeld && words.length === 1) return { wanted: "held" };
  if (isHeld && words.length === 2 && words[1]!.name === "Keyword") return { wanted: "delay" };
  if (kind === "eps" || words.length) return { wanted: "state" };
  return { wanted: kind === "ontime" ? "delay" : "event" };
}

function inSpawn(form: SyntaxNode, offset: number, state: EditorState, scope: string): Partial<Context> {
  const [first, second] = wordsBefore(form, offset);
  if (!first) return { wanted: "machine" };
  return second ? {} : { wanted: "state", machine: machineSpawned(form, state, scope) };
}

function inSetting(form: SyntaxNode, offset: number, state: EditorState, scope: string): Partial<Context> {
  if (wordsBefore(form, offset).length) return {};
  return { wanted: "setting", machine: machineSpawned(form.parent!, state, scope) };
}

/** The path of the machine that a `spawn` starts; empty if there is none. */
export function machineSpawned(form: SyntaxNode, state: EditorState, scope: string): string {
  const name = firstOf(form, state);
  return spawnable(state, form.from, scope).find((path) => nameOf(path) === name) ?? "";
}

function firstOf(node: SyntaxNode, state: EditorState): string {
  const name = node.getChild("Name");
  return name ? state.sliceDoc(name.from, name.to) : "";
}

/** Paths of the machines that can be spawned at a place, inner before outer. */
export function spawnable(state: EditorState, offset: number, scope: string): string[] {
  const here = outlineOf(state).around(offset, "state")?.path ?? "";
  return machines(state, (around) => isIn(here, around), scope);
}

/** Paths of the machines that the states of a machine can spawn, which its transitions and blocks can name. */
export function visibleMachines(state: EditorState, scope: string): string[] {
  return machines(state, (around) => parentOf(around) === scope || isIn(scope, around), scope);
}

function machines(state: EditorState, isSeen: (around: string) => boolean, scope: string): string[] {
  return outlineOf(state)
    .items.filter(({ kind, path }) => kind === "machine" && isSeen(parentOf(path)) && !isIn(scope, path))
    .map(({ path }) => path)
    .sort((a, b) => b.length - a.length);
}

export function machineCalled(state: EditorState, scope: string, name: string): string | undefined {
  return visibleMachines(state, scope).find((path) => nameOf(path) === name);
}

/** What a dotted name means in a machine: the state `move.reached` in a transition, the variable `move.tries` in a block. */
export function partOf(
  state: EditorState,
  scope: string,
  kind: "state" | "variable",
  chain: string,
): Item | undefined {
  const [name, part] = chain.split(".");
  const machine = part && machineCalled(state, scope, name!);
  return machine ? outlineOf(state).find(kind, `${machine}/${part}`) : undefined;
}

/** The element that a name means where it stands in the program; in blocks, the kernel knows. */
export function namedAt(state: EditorState, offset: number, chain: string): Item | undefined {
  const found = outlineOf(state);
  const scope = found.around(offset, "machine")?.path ?? "";
  const { parent } = treeOf(state).resolveInner(offset, 1);
  const machine = (path: string | undefined) => found.find("machine", path ?? "");
  if (parent?.name === "InState")
    return chain.includes(".")
      ? partOf(state, scope, "state", chain)
      : machine(machineCalled(state, scope, chain));
  if (parent?.name === "Spawn") {
    const path = machineSpawned(parent, state, scope);
    return parent.getChild("Name")!.from === offset ? machine(path) : found.find("state", `${path}/${chain}`);
  }
  const spawn = parent?.parent?.parent;
  if (spawn?.name === "Spawn")
    return found.find("variable", `${machineSpawned(spawn, state, scope)}/${chain}`);
  return (
    found.items.find(({ nameFrom, name }) => nameFrom === offset && name === chain) ??
    found.statesOf(scope).find(({ name }) => name === chain) ??
    found.inScope("event", scope).find(({ name }) => name === chain) ??
    found.inScope("variable", scope).find(({ name }) => name === chain)
  );
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
