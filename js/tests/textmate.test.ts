import { readdirSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { beforeAll, describe, expect, it } from "vitest";
import oniguruma from "vscode-oniguruma";
import textmate from "vscode-textmate";
import { parser } from "../src/language/parser";

const PROGRAMS = "../lrp_jupyter/programs";
const OTHERS = [
  "(machine m (state for (onexit [x = ']' # ]\n])) (on e for 20 for -> b) (exit m . s for [x] *-{a b} -> c))",
  "(on e for -> b)(on [a] for [b] a -> b)(on e form a -> b)(ontime for a -> b)(eps a->b (effect [x[1]][y]))",
  "; it's a comment\n(var é := [f\"{a['k']}\"]) # [ ( \"\n(event 中文 [True])(state\n  )(foo on state) 12 on",
];
const KINDS: [RegExp, string][] = [
  [/meta\.embedded/, "python"],
  [/^comment/, "comment"],
  [/^keyword\.control/, "keyword"],
  [/^keyword\.operator/, "sign"],
  [/^constant\.numeric/, "number"],
  [/^entity\.name/, "definition"],
  [/^variable/, "name"],
];
const NODES: Record<string, string> = {
  Python: "python",
  Comment: "comment",
  Keyword: "keyword",
  Arrow: "sign",
  Assign: "sign",
  Star: "sign",
  Minus: "sign",
  Number: "number",
  Name: "name",
};
const require = createRequire(import.meta.url);
let grammar: textmate.IGrammar;

beforeAll(async () => {
  const wasm = readFileSync(require.resolve("vscode-oniguruma/release/onig.wasm"));
  await oniguruma.loadWASM(wasm);
  const files: Record<string, string> = {
    "source.lrp": "../lrp_jupyter/editors/vscode/lrp.tmLanguage.json",
    "source.python": require.resolve("tm-grammars/grammars/python.json"),
  };
  const registry = new textmate.Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
      createOnigString: (text) => new oniguruma.OnigString(text),
    }),
    loadGrammar: async (name) =>
      files[name] ? textmate.parseRawGrammar(readFileSync(files[name], "utf8"), "grammar.json") : null,
  });
  grammar = (await registry.loadGrammar("source.lrp"))!;
});

/** What each character that is neither white space nor a bracket is, as the TextMate grammar has it. */
function coloured(text: string): string[] {
  const kinds: string[] = [];
  let state = textmate.INITIAL;
  for (const line of text.split("\n")) {
    const { tokens, ruleStack } = grammar.tokenizeLine(line, state);
    for (const { startIndex, endIndex, scopes } of tokens) {
      const found = KINDS.find(([pattern]) => scopes.some((scope) => pattern.test(scope)))?.[1] ?? "";
      for (let at = startIndex; at < Math.min(endIndex, line.length); at++) kinds.push(found);
    }
    kinds.push("");
    state = ruleStack;
  }
  return kinds.slice(0, text.length);
}

/** The same, as the editor of the lab has it. */
function parsed(text: string): string[] {
  const kinds = new Array<string>(text.length).fill("");
  parser.parse(text).iterate({
    enter: ({ name, from, to, node }) => {
      const isDefined = name === "Name" && node.parent?.name === "Definition";
      const kind = isDefined ? "definition" : NODES[name];
      if (kind) kinds.fill(kind, from, to);
    },
  });
  return kinds;
}

/** The words with what they are, for a failure that can be read. */
function words(text: string, kinds: string[]): string[] {
  return [...text.matchAll(/[^\s()[\]{}.]/g)].map(({ 0: char, index }) => `${index} ${char} ${kinds[index]}`);
}

describe("the TextMate grammar", () => {
  const programs = readdirSync(PROGRAMS).filter((name) => name.endsWith(".lrp"));
  const texts = [...programs.map((name) => readFileSync(`${PROGRAMS}/${name}`, "utf8")), ...OTHERS];
  it.each(texts)("colours a text as the lab does", (text) => {
    expect(words(text, coloured(text))).toEqual(words(text, parsed(text)));
  });
});
