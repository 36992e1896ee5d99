import { readdirSync, readFileSync } from "node:fs";
import { closeBrackets, insertBracket } from "@codemirror/autocomplete";
import { deleteCharBackward, indentSelection } from "@codemirror/commands";
import { ensureSyntaxTree, indentOnInput, syntaxTree } from "@codemirror/language";
import { EditorState, type Transaction } from "@codemirror/state";
import type { EditorView } from "@codemirror/view";
import { describe, expect, it } from "vitest";
import { newLine } from "../src/language/indent";
import { lrp } from "../src/language/lrp";

const PROGRAMS = "../lrp_jupyter/programs";

/** A text in which the cursor is `|`. */
function open(text: string): EditorState {
  const at = text.indexOf("|");
  return EditorState.create({
    doc: text.replace("|", ""),
    selection: { anchor: at },
    extensions: [lrp(), closeBrackets(), indentOnInput()],
  });
}

/** Type letter by letter, as in the editor. */
function type(state: EditorState, keys: string): EditorState {
  let now = state;
  for (const key of keys) {
    const command = key === "\n" ? newLine : key === "\b" ? deleteCharBackward : null;
    if (command) {
      const view = { state: now, dispatch: (transaction: Transaction) => (now = transaction.state) };
      command(view as unknown as EditorView);
      continue;
    }
    if (ensureSyntaxTree(now, now.doc.length, 10_000) !== syntaxTree(now)) now = now.update({}).state;
    const closed = insertBracket(now, key);
    now = (closed ?? now.update(now.replaceSelection(key), { userEvent: "input.type" })).state;
  }
  return now;
}

function shown(state: EditorState): string {
  const { head } = state.selection.main;
  return `${state.sliceDoc(0, head)}|${state.sliceDoc(head)}`;
}

const typed = (text: string, keys: string) => shown(type(open(text), keys));

describe("a typed program", () => {
  const names = readdirSync(PROGRAMS).filter((name) => name.endsWith(".lrp"));
  it.each(names)("looks like the printed %s", (name) => {
    const printed = readFileSync(`${PROGRAMS}/${name}`, "utf8").trimEnd();
    const keys = printed
      .replace(/\n +/g, "\n") // nothing is indented by hand,
      .replace("\nrobot.move(fill)", "\n\b\brobot.move(fill)"); // but the end of a `def`
    expect(shown(type(open("|"), keys))).toBe(`${printed}|`);
  });
});

describe("Enter", () => {
  it("keeps the brackets after the cursor there", () => {
    expect(typed("(machine m|)", "\n")).toBe("(machine m\n  |)");
    expect(typed("(machine m\n  (state a|))", "\n")).toBe("(machine m\n  (state a\n    |))");
    expect(typed("(machine m\n  (state a)|)", "\n\n")).toBe("(machine m\n  (state a)\n\n  |)");
  });
  it("leaves a bracket that stands on a line of its own where it is", () => {
    expect(typed("(machine m\n  (state a)\n|)", "\n")).toBe("(machine m\n  (state a)\n\n|)");
  });
  it("begins a block two columns further than its form, whatever stands before that", () => {
    expect(typed("(machine m\n  (state a\n    (running [|])))", "\n")).toBe(
      "(machine m\n  (state a\n    (running [\n      |])))",
    );
  });
  it("continues a block below its first statement", () => {
    expect(typed("  (onentry [n = 1|])", "\n")).toBe("  (onentry [n = 1\n            |])");
  });
  it("goes on below the parts of a form that are indented differently", () => {
    expect(typed("(machine m\n      (state a)|)", "\n")).toBe("(machine m\n      (state a)\n      |)");
  });
  it("puts an effect and a variable of a spawn below their form", () => {
    expect(typed("(machine m\n  (on m.s for 20 a -> b|))", "\n(effect [x\ny")).toBe(
      "(machine m\n  (on m.s for 20 a -> b\n    (effect [x\n             y|])))",
    );
    expect(typed("(state s\n  (onentry (spawn n a|)))", "\n(var v := [1")).toBe(
      "(state s\n  (onentry (spawn n a\n             (var v := [1|]))))",
    );
  });
  it("ends a form at the top level", () => {
    expect(typed("(machine m\n  (state a))|", "\n")).toBe("(machine m\n  (state a))\n|");
  });
  it("is Python's in a block", () => {
    expect(typed("(running [\n  if a:|])", "\n")).toBe("(running [\n  if a:\n      |])");
    expect(typed("(running [if a:|])", "\nb = 1\nelse:\nc = 2")).toBe(
      "(running [if a:\n              b = 1\n          else:\n              c = 2|])",
    );
    expect(typed("(running [\n  for x in y:|])", "\nif x:\nreturn x\nz = 2")).toBe(
      "(running [\n  for x in y:\n      if x:\n          return x\n      z = 2|])",
    );
    expect(typed("(running [x = f(|)])", "\n1,\n2")).toBe(
      "(running [x = f(\n              1,\n              2|)])",
    );
    expect(typed("(running [x = f(1,|)])", "\n2")).toBe("(running [x = f(1,\n                2|)])");
  });
  it("adds nothing inside a string", () => {
    expect(typed('(running [x = """a|"""])', "\nb")).toBe('(running [x = """a\nb|"""])');
  });
});

describe("what begins an empty line", () => {
  it("begins where that line does, whatever it is", () => {
    for (const key of ["x", ";", "1", "[", '"', "(on e a -> b)"])
      expect(typed("(machine m\n  (state a)\n|\n)", key).replace("|", "")).toContain(`\n  ${key}`);
    expect(typed("(machine m\n  (state a)\n|)", "(state b)")).toBe("(machine m\n  (state a)\n  (state b)|)");
    expect(typed("(running [\n  if a:\n|])", "b")).toBe("(running [\n  if a:\n      b|])");
    expect(typed("(machine m)\n|\n", ";")).toBe("(machine m)\n;|\n");
  });
  it("stays where it was put by hand, in a string, beside something, and while it is composed", () => {
    for (const [text, shown] of [
      ["(machine m\n      |\n)", "(machine m\n      x|\n)"],
      ['(running [x = """\n|\n"""])', '(running [x = """\nx|\n"""])'],
      ["(machine m\n|(state a))", "(machine m\nx|(state a))"],
    ] as const)
      expect(typed(text, "x")).toBe(shown);
    const state = open("(machine m\n|\n)");
    const composed = state.update(state.replaceSelection("に"), { userEvent: "input.type.compose" });
    expect(composed.state.sliceDoc()).toBe("(machine m\nに\n)");
  });

  const pasted = (text: string, piece: string) => {
    const state = open(text);
    return state.update(state.replaceSelection(piece), { userEvent: "input.paste" }).state.sliceDoc();
  };
  it("is moved with all its lines where it is pasted", () => {
    const printed = "(machine m\n  (state b\n    (running [\n      if a:\n          b]))\n)";
    for (const piece of [
      "(state b\n  (running [\n    if a:\n        b]))", // as printed alone
      "(state b\n    (running [\n      if a:\n          b]))", // from the bracket on
      "      (state b\n        (running [\n          if a:\n              b]))", // whole lines from deeper inside
    ])
      for (const place of ["|", "  |", "      |"])
        expect(pasted(`(machine m\n${place}\n)`, piece)).toBe(printed);
    expect(pasted("(machine m\n|  (state c))", "(state b)\n")).toBe("(machine m\n  (state b)\n  (state c))");
    expect(pasted("|", "(machine m\n    (state a))\n")).toBe("(machine m\n    (state a))\n");
  });
  it("keeps the columns of Python that was copied with them, and the lines of strings", () => {
    expect(pasted("(running [\n  if a:\n      b\n|])", "  c\n  d")).toBe(
      "(running [\n  if a:\n      b\n  c\n  d])",
    );
    expect(pasted("(machine m\n|\n)", '(state b\n  (running [x = """\ny\n"""]))')).toBe(
      '(machine m\n  (state b\n    (running [x = """\ny\n"""]))\n)',
    );
  });
});

it("lines are indented again as they would have been typed, and a lone bracket below its form", () => {
  let state = EditorState.create({
    doc: "(machine m\n(state a\n(running [\nx = 1\n  ]))\n )",
    selection: { anchor: 0, head: 45 },
    extensions: [lrp()],
  });
  indentSelection({ state, dispatch: (transaction) => (state = transaction.state) });
  expect(state.sliceDoc()).toBe("(machine m\n  (state a\n    (running [\n      x = 1\n    ]))\n)");
});
