import { describe, expect, it } from "vitest";
import { parser } from "../src/language/parser";
import fc from "./laws";
import { write } from "./tree";

const tree = (text: string) => write(parser.parse(text));

/** The characters from one to another. */
function range(ends: string) {
  const [min, max] = [...ends].map((char) => char.codePointAt(0)!) as [number, number];
  return fc.integer({ min, max }).map((code) => String.fromCodePoint(code));
}

describe("the grammar", () => {
  it("names a definition", () => {
    expect(tree("(var x := [1])")).toBe("Variable(Keyword Definition(Name) Assign Block(Python))");
  });
  it("treats a word as a keyword only after a bracket, and only all of it", () => {
    expect(tree("(on state state -> on)")).toBe("Transition(Keyword Name Name Arrow Name)");
    const letter = fc.oneof(...["az", "AZ", "09", "__", "¡\ud7ff", "\u{10000}\u{10ffff}"].map(range));
    fc.assert(
      fc.property(fc.constantFrom("on", "state", "var", "eps", "exit"), letter, (word, letter) => {
        expect(tree(`(${word}${letter} x)`)).toBe("Unknown(Name Name)");
      }),
    );
  });
  it("begins with the magic of a cell, which is an error elsewhere", () => {
    const rest = "Comment Machine(Keyword Definition(Name))";
    for (const line of ["%%lrp", "%%lrp m --world 'it (is"])
      expect(tree(`${line}\n# it's\n(machine m)`)).toBe(`Magic ${rest}`);
    expect(tree("(machine m)\n%%lrp m")).toContain("⚠(Magic)");
  });
  it("lets a state be called by a keyword", () => {
    expect(tree("(state state)")).toBe("State(Keyword Definition(Name))");
  });
  it("reads wildcards with any white space", () => {
    const wanted = "Transition(Keyword Name Star Arrow Name)";
    for (const text of ["(on b *-> c)", "(on b * -> c)", "(on b*->c)"]) expect(tree(text)).toBe(wanted);
    expect(tree("(eps *-{a b}->c n)")).toBe(
      "Transition(Keyword Star Minus Group(Name Name) Arrow Name Name)",
    );
  });
  it("reads the state of a machine, however it is spaced, and half typed", () => {
    expect(tree("(on move . reached a -> b)")).toBe(
      "Transition(Keyword InState(Name Dot Name) Name Arrow Name)",
    );
    expect(tree("(exit move.)")).toBe("Transition(Keyword InState(Name Dot ⚠))");
  });
  it("takes `for` after what an `on` or `exit` waits for as a keyword, unless it is the source", () => {
    for (const trigger of ["e", "m.s", "[x]", "for"])
      expect(tree(`(on ${trigger} for 20 a -> b)`)).toMatch(
        /^Transition\(Keyword \S.* Keyword Number Name Arrow Name\)$/,
      );
    expect(tree("(exit e for [x] a -> b)")).toBe(
      "Transition(Keyword Name Keyword Block(Python) Name Arrow Name)",
    );
    expect(tree("(on e for for for -> for)")).toBe("Transition(Keyword Name Keyword Name Name Arrow Name)");
    for (const text of ["(on e for -> b)", "(on e for ; x ->\n # y\n->b)"])
      expect(tree(text).replace(/Comment /g, "")).toBe("Transition(Keyword Name Name Arrow Name)");
    expect(tree("(on e form -> b)")).toBe("Transition(Keyword Name Name Arrow Name)");
    expect(tree("(ontime for a -> b)")).toBe("Transition(Keyword Name Name Arrow Name)");
  });
  it("reads effects and settings as the forms they are", () => {
    expect(tree("(eps a -> b n (effect [x] [y]))")).toBe(
      "Transition(Keyword Name Arrow Name Name Action(Keyword Block(Python) Block(Python)))",
    );
    expect(tree("(spawn m s (var v := [1]))")).toBe(
      "Spawn(Keyword Name Name Variable(Keyword Definition(Name) Assign Block(Python)))",
    );
  });
  it("keeps brackets in strings and comments inside a block", () => {
    expect(tree("(running [x = ']' # ]\n y[0]])")).toBe("Action(Keyword Block(Python))");
  });
  it("ends an unclosed block with its line", () => {
    expect(tree("(running [x\n(state y)")).toBe(
      "Action(Keyword Block(Python) State(Keyword Definition(Name)) ⚠)",
    );
  });
  it("leaves an empty block empty", () => {
    expect(tree("(running [])")).toBe("Action(Keyword Block)");
    expect(tree("(running [")).not.toContain("Python");
  });
  it("knows comments by both signs", () => {
    expect(tree("; a (\n(state x) # b )")).toBe("Comment State(Keyword Definition(Name)) Comment");
  });
  it("reads a nested program whole", () => {
    const text =
      "(machine m (state s (onentry (spawn n a) [1]) (machine n (state a))) (exit [x] a -> s)) (spawn m s)";
    expect(tree(text)).not.toContain("⚠");
  });
  it("does not mark an unknown word as an error", () => {
    expect(tree("(stat x)")).toBe("Unknown(Name Name)");
  });
});
