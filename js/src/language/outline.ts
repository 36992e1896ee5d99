/**
 * What a text defines and where, read from the editor's own tree: it is right while a word is being
 * typed, and needs no kernel. Paths and labels are those of the kernel (`Machine.ids`, `Machine.labels`).
 */

import type { SyntaxNode, Tree } from "@lezer/common";
import type { ElementKind } from "../protocol";
import { isIn, parentOf } from "./paths";

export interface Item {
  kind: ElementKind;
  path: string;
  name: string;
  from: number;
  to: number;
  /** Where its name stands; for a transition without one, the whole form. */
  nameFrom: number;
  nameTo: number;
}

type Read = (from: number, to: number) => string;

const KINDS: Record<string, ElementKind> = {
  Machine: "machine",
  State: "state",
  Event: "event",
  Variable: "variable",
};

export class Outline {
  private readonly byKey = new Map<string, Item>();

  constructor(readonly items: readonly Item[]) {
    for (const item of items) {
      const key = `${item.kind} ${item.path}`;
      if (!this.byKey.has(key)) this.byKey.set(key, item); // the first of equal names counts
    }
  }

  find(kind: ElementKind, path: string): Item | undefined {
    return this.byKey.get(`${kind} ${path}`);
  }

  /** The innermost item of one of these kinds around an offset. */
  around(offset: number, ...kinds: ElementKind[]): Item | undefined {
    let found: Item | undefined;
    for (const item of this.items) {
      if (item.from <= offset && offset <= item.to && kinds.includes(item.kind)) found = item;
    }
    return found;
  }

  /** Elements of a kind that the scope of a machine path sees, inner before outer. */
  inScope(kind: "variable" | "event", scope: string): Item[] {
    const seen = this.items.filter((item) => item.kind === kind && isIn(scope, parentOf(item.path)));
    return seen.sort((a, b) => b.path.split("/").length - a.path.split("/").length);
  }

  statesOf(machine: string): Item[] {
    return this.items.filter((item) => item.kind === "state" && item.path === `${machine}/${item.name}`);
  }
}

export function outline(tree: Tree, read: Read): Outline {
  const items: Item[] = [];
  collect(tree.topNode, "", read, items);
  return new Outline(items);
}

function collect(parent: SyntaxNode, prefix: string, read: Read, items: Item[]): void {
  const seen: Seen = { ids: new Map(), labels: new Map() };
  for (let node = parent.firstChild; node; node = node.nextSibling) {
    if (node.name === "Transition") {
      const item = transition(node, prefix, seen, read);
      if (item) items.push(item);
      continue;
    }
    const kind = KINDS[node.name];
    const definition = node.getChild("Definition");
    if (kind && definition) {
      const name = read(definition.from, definition.to);
      const path = prefix + name;
      const [nameFrom, nameTo] = [definition.from, definition.to];
      items.push({ kind, path, name, from: node.from, to: node.to, nameFrom, nameTo });
      if (kind === "machine" || kind === "state") collect(node, `${path}/`, read, items);
    }
  }
}

/** How often each id and each label of a machine's transitions has occurred. */
interface Seen {
  ids: Map<string, number>;
  labels: Map<string, number>;
}

/** A second `t` is `t#2`. */
function distinct(counts: Map<string, number>, plain: string): string {
  const count = (counts.get(plain) ?? 0) + 1;
  counts.set(plain, count);
  return count === 1 ? plain : `${plain}#${count}`;
}

function transition(node: SyntaxNode, prefix: string, seen: Seen, read: Read): Item | null {
  const arrow = node.getChild("Arrow");
  const keyword = node.getChild("Keyword");
  if (!arrow || !keyword) return null;
  const text = (part: SyntaxNode) => read(part.from, part.to);
  const before: SyntaxNode[] = [];
  const after: SyntaxNode[] = [];
  for (let part = keyword.nextSibling; part; part = part.nextSibling) {
    if (PART.test(part.name)) (part.from < arrow.from ? before : after).push(part);
  }
  const destination = after[0];
  if (!destination) return null;
  let trigger = text(keyword) === "eps" ? "eps" : triggerOf(before.shift(), text);
  if (before[0]?.name === "Keyword") {
    const delay = before.splice(0, 2)[1];
    trigger += ` for ${delay ? text(delay) : ""}`;
  }
  const own = after[1]?.name === "Name" ? after[1] : null;
  const way = `${sources(before, text)}->${text(destination)}`;
  const called = own && text(own);
  const id = distinct(seen.ids, called ?? `${text(keyword)}:${way}`);
  const name = distinct(seen.labels, called ?? `${trigger}:${way}`);
  const place = own ?? node;
  return {
    kind: "transition",
    path: `${prefix.slice(0, -1)}:${id}`,
    name,
    from: node.from,
    to: node.to,
    nameFrom: place.from,
    nameTo: place.to,
  };
}

const PART = /^(Name|InState|Keyword|Number|Block|Star|Minus|Group)$/;

/** What it waits for, as the kernel writes it. */
function triggerOf(part: SyntaxNode | undefined, text: (part: SyntaxNode) => string): string {
  if (part?.name === "InState") return part.getChildren("Name").map(text).join(".");
  return part ? text(part) : "";
}

/** Sources as the kernel writes them: `a`, `*`, `*-{a b}`, `{a b}`. */
function sources(parts: SyntaxNode[], text: (part: SyntaxNode) => string): string {
  const group = parts.find((part) => part.name === "Group");
  const names = group?.getChildren("Name").map(text) ?? [];
  if (parts.some((part) => part.name === "Star")) return names.length ? `*-{${names.join(" ")}}` : "*";
  if (group) return names.length === 1 ? names[0]! : `{${names.join(" ")}}`;
  return parts[0] ? text(parts[0]) : "";
}
