/**
 * Indentation: where a line begins, so that a typed program looks like the printed ones.
 *
 * There, closing brackets stand at the end of the last line; those after the cursor are therefore no reason
 * to indent less. A block is indented as Python is, from the column of its first statement.
 */

import {
  ensureSyntaxTree,
  IndentContext,
  indentService,
  indentString,
  syntaxTree,
} from "@codemirror/language";
import {
  type ChangeSpec,
  EditorSelection,
  EditorState,
  type Line,
  type StateCommand,
  Text,
} from "@codemirror/state";
import type { SyntaxNode } from "@lezer/common";

const STEP = 2;
const BODY = 4; // in Python
const PATIENCE = 50; // ms: to parse up to the cursor
const OPENED = /^(Variable|Machine|State|Event|Spawn|Action|Transition|Unknown|Block)$/;
const STRINGS = /^(String|FormatString|ContinuedString)$/;
const BRACKETED =
  /^(ArgList|ParamList|Array\w*|Dictionary\w*|Set\w*|Tuple\w*|Parenthesized\w*|Generator\w*|MemberExpression)$/;
const LEAVES = /^(Return|Pass|Break|Continue|Raise)Statement$/;
const STATEMENT = /^(StatementGroup|\w+(Statement|Definition))$/;
const CONTINUED = /^(If|For|While|Try)Statement$/;
const CONTINUES = /^(elif|else|except|finally)\b/;
const CLOSES = /^[)\]}]/;
const CLOSERS = /^[\s)\]}]*$/;
const COMPOSED = "input.type.compose"; // a change beside what an input method composes would double that
const BEGINS = ["input.type", "input.complete", "input.paste", "input.drop"];

/** Lines that are indented again: by a command, or when a closing bracket or an `else:` is typed. */
export const indentation = indentService.of((context, offset) => {
  const line = context.state.doc.lineAt(offset);
  const rest = line.text.trimStart();
  return columnAt(context, line.from, rest, CLOSES.test(rest));
});

export const newLine: StateCommand = ({ state, dispatch }) => {
  if (state.readOnly) return false;
  const changes = state.changeByRange((range) => {
    const context = new IndentContext(brokenAt(state, range.from));
    const line = state.doc.lineAt(range.from);
    const before = line.text.slice(0, range.from - line.from);
    const after = state.sliceDoc(range.to, state.doc.lineAt(range.to).to);
    const rest = after.trimStart();
    const blank = !before.trim();
    const column = columnAt(context, range.from, rest, blank && isBelow(context, range.from, rest));
    const indent = column === null ? /^\s*/.exec(before)![0] : indentString(state, column);
    const from = blank ? line.from : range.from;
    return {
      changes: { from, to: range.to + after.length - rest.length, insert: Text.of(["", indent]) },
      range: EditorSelection.cursor(from + 1 + indent.length),
    };
  });
  dispatch(state.update(changes, { scrollIntoView: true, userEvent: "input" }));
  return true;
};

/** The text with a line break at an offset, if that is in a comment: what is after it is no part of that then. */
function brokenAt(state: EditorState, offset: number): EditorState {
  const inComment = nodeAt(state, offset).name === "Comment";
  return inComment ? state.update({ changes: { from: offset, insert: state.lineBreak } }).state : state;
}

/** What is typed, completed or pasted on an empty line begins where that line does. */
export const begunLines = EditorState.transactionFilter.of((transaction) => {
  const begins = BEGINS.some((event) => transaction.isUserEvent(event));
  if (!begins || transaction.isUserEvent(COMPOSED)) return transaction;
  const { doc } = transaction.startState;
  const isTyped = transaction.isUserEvent("input.type");
  const begun: [from: number, to: number, before: number][] = [];
  transaction.changes.iterChanges((from, to, fromNow, toNow, inserted) => {
    const before = doc.sliceString(doc.lineAt(from).from, from);
    const isLines = inserted.lines > 1 && !inserted.line(inserted.lines).text.trim();
    const isAlone = isLines || CLOSERS.test(doc.sliceString(to, doc.lineAt(to).to));
    if (isAlone && !(isTyped ? before : before.trim()) && inserted.line(1).text.trim())
      begun.push([fromNow, toNow, before.length]);
  });
  if (!begun.length) return transaction;
  const context = new IndentContext(transaction.state);
  const changes = begun.flatMap((each) => indented(context, ...each));
  return [transaction, { changes, sequential: true }];
});

/**
 * Move lines to where the first of them is to begin; `before` columns of it were there. In a block, where columns
 * have a meaning, they stay if they are indented. The first line of a form that was copied from its bracket on is
 * not indented as the others are.
 */
function indented(context: IndentContext, from: number, to: number, before: number): ChangeSpec[] {
  const { doc } = context.state;
  const first = doc.lineAt(from);
  const has = beginOf(context.state, first.from) - first.from;
  const isPython = formAt(context.state, first.from)?.name === "Block";
  const moved = (columnOf(context, first) ?? has) - has;
  if (isPython ? has || !moved : !before && !moved) return [];
  const changes: ChangeSpec[] = [];
  let by = isPython || has > before ? moved + before : null;
  for (let { number } = first; number <= doc.lines && doc.line(number).from < to; number++) {
    const line = doc.line(number);
    const wanted = columnOf(context, line);
    if (wanted === null) continue;
    const begin = beginOf(context.state, line.from);
    const column = begin - line.from;
    if (number > first.number) by ??= wanted + moved - column;
    const now = Math.max(0, column + (number > first.number ? (by ?? 0) : moved));
    if (now !== column) changes.push({ from: line.from, to: begin, insert: " ".repeat(now) });
  }
  return changes;
}

/** The column at which a line is to begin; null if it is empty, or the text of a string. */
function columnOf(context: IndentContext, { from, text }: Line): number | null {
  const rest = text.trimStart();
  return rest ? columnAt(context, from, rest, CLOSES.test(rest)) : null;
}

/** Whether a closing bracket stands on a line of its own, below the beginning of what it closes. */
function isBelow(context: IndentContext, offset: number, rest: string): boolean {
  return CLOSES.test(rest) && columnAt(context, offset, rest, true) === context.column(offset);
}

/**
 * The column of a line that begins at an offset with `rest`; null inside a string, whose lines are its text.
 * A bracket that is `closing` stands below the beginning of what it closes.
 */
function columnAt(context: IndentContext, offset: number, rest: string, closing: boolean): number | null {
  const node = formAt(context.state, offset);
  if (!node) return 0;
  if (node.name === "Block") return inBlock(context, node, offset, rest, closing);
  return closing ? context.column(node.from) : inForm(context, node, offset);
}

/** The innermost form or block that an offset is inside. */
function formAt(state: EditorState, offset: number): SyntaxNode | null {
  let node: SyntaxNode | null = nodeAt(state, offset);
  while (node && !(OPENED.test(node.name) && isOpen(node, offset))) node = node.parent;
  return node;
}

/** Whether an offset is inside a form or block: not before its first bracket, and not after its last. */
function isOpen({ from, to, lastChild }: SyntaxNode, offset: number): boolean {
  return from < offset && !(offset >= to && /^[)\]]$/.test(lastChild?.name ?? ""));
}

/** In a form: below the last part that begins a line of its own, else two columns further than the form. */
function inForm(context: IndentContext, form: SyntaxNode, offset: number): number {
  for (let part = form.childBefore(offset); part && part.from > form.from; part = part.prevSibling) {
    if (part.name !== "Comment" && beginOf(context.state, part.from) === part.from)
      return context.column(part.from);
  }
  return context.column(form.from) + STEP;
}

function inBlock(
  context: IndentContext,
  block: SyntaxNode,
  offset: number,
  rest: string,
  closing: boolean,
): number | null {
  const { state } = context;
  const first = block.from + 1;
  const begun = codeBetween(state, first, offset);
  const base = context.column(beginOf(state, block.from));
  if (closing && rest.startsWith("]")) return base;
  if (!begun) return base + STEP;
  const end = first + begun.length;
  let statement: SyntaxNode | null = null;
  for (let node = nodeAt(state, end); node.from >= first; node = node.parent!) {
    if (STRINGS.test(node.name) && offset < node.to) return null;
    if (BRACKETED.test(node.name) && offset < node.to)
      return inBrackets(context, node, first, offset, closing);
    if (STATEMENT.test(node.name)) {
      statement ??= node;
      if (CONTINUES.test(rest) && CONTINUED.test(node.name)) return context.column(node.from);
    }
  }
  const column = context.column(statement?.from ?? Math.max(first, beginOf(state, end)));
  if (begun.endsWith(":")) return column + BODY;
  const outer = statement?.parent?.parent;
  return statement && outer && LEAVES.test(statement.name) && outer.from >= first
    ? context.column(outer.from)
    : column;
}

/** The code of a block up to an offset, without a comment behind its last line. */
function codeBetween(state: EditorState, first: number, offset: number): string {
  const begun = state.sliceDoc(first, offset).trimEnd();
  const { name, from } = nodeAt(state, first + begun.length);
  const follows = name === "Comment" && beginOf(state, from) < from;
  return follows ? state.sliceDoc(first, from).trimEnd() : begun;
}

/** In brackets of Python: below what stands after the opening one, else further than its line. */
function inBrackets(
  context: IndentContext,
  node: SyntaxNode,
  first: number,
  offset: number,
  closing: boolean,
): number {
  const end = Math.min(offset, context.state.doc.lineAt(node.from).to);
  const inside = /\S/.exec(context.state.sliceDoc(node.from + 1, end));
  if (inside) return context.column(node.from + 1 + inside.index);
  const base = context.column(Math.max(first, beginOf(context.state, node.from)));
  return closing ? base : base + BODY;
}

/** The offset at which the text of a line begins. */
function beginOf(state: EditorState, offset: number): number {
  const line = state.doc.lineAt(offset);
  return line.from + line.text.search(/\S|$/);
}

/** The innermost node that an offset is in, or ends. */
function nodeAt(state: EditorState, offset: number): SyntaxNode {
  return (ensureSyntaxTree(state, offset, PATIENCE) ?? syntaxTree(state)).resolveInner(offset, -1);
}
