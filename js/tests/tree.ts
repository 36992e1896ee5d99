/** Writes a syntax tree as text, for tests: `State(Keyword Definition(Name))`. Brackets are left out. */

import type { SyntaxNode, Tree } from "@lezer/common";

export function write(tree: Tree): string {
  return children(tree.topNode);
}

function children(node: SyntaxNode): string {
  const parts: string[] = [];
  for (let child = node.firstChild; child; child = child.nextSibling) {
    if (!/^[\w⚠]/.test(child.name)) continue;
    const inner = children(child);
    parts.push(inner ? `${child.name}(${inner})` : child.name);
  }
  return parts.join(" ");
}
