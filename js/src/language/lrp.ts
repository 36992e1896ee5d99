/** LRP as a language of the editor: highlighting, indentation, folding, brackets, Python in blocks. */

import { pythonLanguage } from "@codemirror/lang-python";
import {
  foldNodeProp,
  indentNodeProp,
  LanguageSupport,
  LRLanguage,
  syntaxHighlighting,
  syntaxTree,
  type TreeIndentContext,
} from "@codemirror/language";
import type { EditorState } from "@codemirror/state";
import { parseMixed, type SyntaxNode } from "@lezer/common";
import { classHighlighter, styleTags, tags } from "@lezer/highlight";
import { type Outline, outline } from "./outline";
import { parser } from "./parser";

const FORMS = ["Variable", "Machine", "State", "Event", "Spawn", "Action", "Transition", "Unknown"];

/** Inside a block: under its first statement, or two steps in where that stands on a line of its own. */
function blockIndent(context: TreeIndentContext): number {
  const { node, state } = context;
  const line = state.doc.lineAt(node.from);
  const first = /\S/.exec(line.text.slice(node.from + 1 - line.from));
  if (context.textAfter.startsWith("]") || !first) {
    const base = context.lineIndent(node.from);
    return context.textAfter.startsWith("]") ? base : base + context.unit;
  }
  return context.column(node.from) + 1 + first.index;
}

function formIndent(context: TreeIndentContext): number {
  const base = context.column(context.node.from);
  return context.textAfter.startsWith(")") ? base : base + context.unit;
}

function folding(node: SyntaxNode, state: EditorState): { from: number; to: number } | null {
  const end = state.doc.lineAt(node.from).to;
  return end < node.to - 1 ? { from: end, to: node.to - 1 } : null;
}

const configured = parser.configure({
  wrap: parseMixed((node) => (node.name === "Python" ? { parser: pythonLanguage.parser } : null)),
  props: [
    styleTags({
      Keyword: tags.keyword,
      Comment: tags.lineComment,
      Number: tags.number,
      Arrow: tags.controlOperator,
      "Assign Minus": tags.operator,
      Star: tags.special(tags.operator),
      "Machine/Definition/Name": tags.definition(tags.namespace),
      "State/Definition/Name": tags.definition(tags.className),
      "Event/Definition/Name": tags.definition(tags.propertyName),
      "Variable/Definition/Name": tags.definition(tags.variableName),
      Name: tags.labelName,
      "( )": tags.paren,
      "[ ]": tags.squareBracket,
      "{ }": tags.brace,
    }),
    indentNodeProp.add({
      Program: () => 0,
      Block: blockIndent,
      ...Object.fromEntries(FORMS.map((name) => [name, formIndent])),
    }),
    foldNodeProp.add(
      Object.fromEntries(["Machine", "State", "Action", "Event", "Block"].map((n) => [n, folding])),
    ),
  ],
});

export const lrpLanguage = LRLanguage.define({
  name: "lrp",
  parser: configured,
  languageData: {
    commentTokens: { line: "#" },
    closeBrackets: { brackets: ["(", "[", "{"], before: ")]}:;> \n\t" },
    indentOnInput: /^\s*[)\]]$/,
  },
});

export function lrp(): LanguageSupport {
  return new LanguageSupport(lrpLanguage, syntaxHighlighting(classHighlighter));
}

const outlines = new WeakMap<object, Outline>();

/** The outline of the text as far as it is parsed; computed once per tree. */
export function outlineOf(state: EditorState): Outline {
  const tree = syntaxTree(state);
  let found = outlines.get(tree);
  if (!found) {
    found = outline(tree, (from, to) => state.sliceDoc(from, to));
    outlines.set(tree, found);
  }
  return found;
}
