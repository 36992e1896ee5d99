/** LRP as a language of the editor: highlighting, indentation, folding, brackets, Python in blocks. */

import { pythonLanguage } from "@codemirror/lang-python";
import {
  ensureSyntaxTree,
  foldNodeProp,
  LanguageSupport,
  LRLanguage,
  syntaxHighlighting,
  syntaxTree,
} from "@codemirror/language";
import type { EditorState } from "@codemirror/state";
import { parseMixed, type SyntaxNode, type Tree } from "@lezer/common";
import { classHighlighter, styleTags, tags } from "@lezer/highlight";
import { begunLines, indentation } from "./indent";
import { type Outline, outline } from "./outline";
import { parser } from "./parser";

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
      Magic: tags.meta,
      Number: tags.number,
      Arrow: tags.controlOperator,
      "Assign Minus Dot": tags.operator,
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
    foldNodeProp.add(
      Object.fromEntries(["Machine", "State", "Action", "Event", "Block"].map((n) => [n, folding])),
    ),
  ],
});

const lrpLanguage = LRLanguage.define({
  name: "lrp",
  parser: configured,
  languageData: {
    commentTokens: { line: "#" },
    closeBrackets: { brackets: ["(", "[", "{"], before: ")]}:;> \n\t" },
    indentOnInput: /^\s*[)\]]$/,
  },
});

export function lrp(): LanguageSupport {
  return new LanguageSupport(lrpLanguage, [syntaxHighlighting(classHighlighter), indentation, begunLines]);
}

const PATIENCE = 1000; // ms: a program of usual size takes less than one
const outlines = new WeakMap<object, Outline>();

/** The tree of the whole text: the editor's own ends early where the machine was held up. */
export function treeOf(state: EditorState): Tree {
  return ensureSyntaxTree(state, state.doc.length, PATIENCE) ?? syntaxTree(state);
}

/** The outline of the text; computed once per tree. */
export function outlineOf(state: EditorState): Outline {
  const tree = treeOf(state);
  let found = outlines.get(tree);
  if (!found) {
    found = outline(tree, (from, to) => state.sliceDoc(from, to));
    outlines.set(tree, found);
  }
  return found;
}
