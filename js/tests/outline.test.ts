import { readFileSync } from "node:fs";
import { expect, it } from "vitest";
import { outline } from "../src/language/outline";
import { parser } from "../src/language/parser";

function read(text: string) {
  return outline(parser.parse(text), (from, to) => text.slice(from, to));
}

const PROGRAM = `(var lim := [1])
(machine m (var n := [2])
  (state a (machine inner (var n := [3]) (state b) (event deep [n])))
  (state c)
  (event go [n > lim])
  (on go a -> c tgo) (on go a -> c) (on go a->c) (eps *-{a  c}-> c) (ontime 100 {a} -> c) (on [n == 1] * -> a))
`;

it("assigns a path to every element", () => {
  const paths = read(PROGRAM).items.map((item) => `${item.kind} ${item.path}`);
  expect(paths.slice(0, 9)).toEqual([
    "variable lim",
    "machine m",
    "variable m/n",
    "state m/a",
    "machine m/a/inner",
    "variable m/a/inner/n",
    "state m/a/inner/b",
    "event m/a/inner/deep",
    "state m/c",
  ]);
});

it("labels transitions as the kernel does, a second one with its number", () => {
  const labels = read(PROGRAM).items.flatMap((item) => (item.kind === "transition" ? [item.name] : []));
  const paths = read(PROGRAM).items.flatMap((item) => (item.kind === "transition" ? [item.path] : []));
  expect(paths.map((path) => path.slice(path.indexOf(":") + 1))).toEqual([
    "tgo",
    "on:a->c",
    "on:a->c#2",
    "eps:*-{a c}->c",
    "ontime:a->c",
    "on:*->a",
  ]);
  expect(labels).toEqual(["tgo", "go:a->c", "go:a->c#2", "eps:*-{a c}->c", "100:a->c", "[n == 1]:*->a"]);
});

it("labels what a transition waits for, and for how long, as the kernel does", () => {
  const text =
    "(machine m (on n . a for  200 a -> b) (exit e for [x] a -> b) (on e for -> b) (on [y] for t *-{a} -> b (effect [z]))" +
    " (onentry (spawn n s (var v := [1]))))";
  const found = read(text).items.filter(({ kind }) => kind !== "machine");
  expect(found.map(({ kind }) => kind)).toEqual(Array(4).fill("transition"));
  expect(found.map(({ name }) => name)).toEqual([
    "n.a for 200:a->b",
    "e for [x]:a->b",
    "e:for->b",
    "[y] for t:*-{a}->b",
  ]);
});

it("sees inner variables before outer ones of the same name", () => {
  const scope = read(PROGRAM).inScope("variable", "m/a/inner");
  expect(scope.map((item) => item.path)).toEqual(["m/a/inner/n", "m/n", "lim"]);
  expect(
    read(PROGRAM)
      .inScope("variable", "m")
      .map((item) => item.path),
  ).toEqual(["m/n", "lim"]);
});

it("finds the innermost element around an offset", () => {
  const found = read(PROGRAM);
  expect(found.around(PROGRAM.indexOf("(state b") + 3, "machine")?.path).toBe("m/a/inner");
  expect(found.around(PROGRAM.indexOf("(state c") + 3, "state", "machine")?.path).toBe("m/c");
});

it("survives a text that is being typed", () => {
  expect(read("(machine m (state ) (on x a -> ").items.map((item) => item.path)).toEqual(["m"]);
});

interface Recorded {
  text: string;
  elements: string[];
}

const RECORDED = new URL("../../tests/language/outlines.json", import.meta.url);

it("finds in every program what the kernel's parser finds", () => {
  for (const { text, elements } of JSON.parse(readFileSync(RECORDED, "utf8")) as Recorded[]) {
    const found = read(text).items.map(({ kind, path, name }) =>
      kind === "transition" ? `${kind} ${path} ${name}` : `${kind} ${path}`,
    );
    expect([...new Set(found)].sort(), text).toEqual([...elements].sort());
  }
});
