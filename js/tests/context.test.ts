import { EditorState } from "@codemirror/state";
import { describe, expect, it } from "vitest";
import { filledBy } from "../src/editor/complete";
import { chainAt, contextAt, namedAt, partOf, spawnable, visibleMachines } from "../src/editor/context";
import { lrp } from "../src/language/lrp";

/** A state of the text, and the offset of the `|` in it, which is taken out. */
function at(text: string): [EditorState, number] {
  const offset = text.indexOf("|");
  const doc = text.slice(0, offset) + text.slice(offset + 1);
  return [EditorState.create({ doc, extensions: lrp() }), offset];
}
const wanted = (text: string) => contextAt(...at(text)).wanted;

describe("what may be named", () => {
  it.each([
    ["(|)", "keyword", "Program"],
    ["(machine m (|))", "keyword", "Machine"],
    ["(machine m (st|))", "keyword", "Machine"],
    ["(machine m (state s (run|)))", "keyword", "State"],
    ["(machine m (state s (onentry (sp|))))", "keyword", "Action"],
  ])("in %s is a word of the language, inside %s %s", (text, want, form) => {
    expect(contextAt(...at(text))).toMatchObject({ wanted: want, form });
  });

  it("goes through a transition in the order of its words", () => {
    expect(wanted("(machine m (on |))")).toBe("event");
    expect(wanted("(machine m (on go |))")).toBe("held");
    expect(wanted("(machine m (on [go] f|))")).toBe("held");
    expect(wanted("(machine m (on go for |))")).toBe("delay");
    expect(wanted("(machine m (exit n.s for 200 |))")).toBe("state");
    expect(wanted("(machine m (ontime 200 |))")).toBe("state");
    expect(wanted("(machine m (on go for a -> |))")).toBe("state");
    expect(wanted("(machine m (on go a -> |))")).toBe("state");
    expect(wanted("(machine m (on go a -> b |))")).toBe("effect");
    expect(wanted("(machine m (on go a -> b (|)))")).toBe("keyword");
    expect(wanted("(machine m (ontime |))")).toBe("delay");
    expect(wanted("(machine m (eps |))")).toBe("state");
  });

  it("is a state of the outer machine after the arrow of an exit", () => {
    const [state, offset] = at("(machine m (state s (machine n (state a) (exit go a -> |))))");
    expect(contextAt(state, offset)).toMatchObject({ scope: "m/s/n", machine: "m" });
  });

  it("is a machine, then one of its states, in a spawn", () => {
    const text = "(machine m (state s (onentry (spawn n |)) (machine n (state a))))";
    expect(contextAt(...at(text))).toMatchObject({ wanted: "state", machine: "m/s/n" });
    expect(wanted("(spawn |)")).toBe("machine");
  });

  const PARTS =
    "(machine o (state x)) (machine m (state s (onentry (spawn n a (var |))) (machine n (var v := [1]) (state a))) (state t (machine p)) (on |))";
  it("is a state of a machine that the states spawn after its name and a dot", () => {
    for (const [typed, machine] of [
      ["o.", "o"],
      ["n.|a s -> t", "m/s/n"],
      ["n . a|", "m/s/n"],
      ["m.", ""],
    ] as const) {
      const text = PARTS.replace("|", "").replace("|", typed.includes("|") ? typed : `${typed}|`);
      expect(contextAt(...at(text))).toMatchObject({ wanted: "state", machine });
    }
  });
  it("is a variable of the machine in a spawn", () => {
    expect(contextAt(...at(PARTS))).toMatchObject({ wanted: "setting", machine: "m/s/n" });
    expect(wanted("(spawn n a (v|))")).toBe("keyword");
    expect(wanted("(spawn n a (var v |))")).toBe("nothing");
  });
  it("is each machine that a state of the machine can spawn, nothing around it", () => {
    const [state] = at(PARTS);
    expect(visibleMachines(state, "m").sort()).toEqual(["m/s/n", "m/t/p", "o"]);
    expect(visibleMachines(state, "m/s/n")).toEqual(["o"]);
    expect(visibleMachines(state, "").sort()).toEqual(["m", "o"]);
  });

  it("is Python inside a block, even an empty one, but not after it", () => {
    expect(wanted("(running [x|])")).toBe("python");
    expect(wanted("(running [|])")).toBe("python");
    expect(wanted("(running [x] |)")).not.toBe("python");
  });
});

it("a machine can be spawned from inside the states around it, never itself", () => {
  const [state, offset] = at("(machine o (state x)) (machine m (state s (machine n (state a (onentry |)))))");
  expect(spawnable(state, offset, "m/s/n")).toEqual(["o"]);
});

describe("a name means", () => {
  const text =
    "(event go [1]) (machine n (var v := [1]) (state a)) (machine m (state s (onentry (spawn n a (var v := [2]))))" +
    " (on n.a s -> s) (on go s -> s))";
  const [state] = at(`${text}|`);
  const named = (place: string, name: string, chain = name) => {
    const item = namedAt(state, text.indexOf(place) + place.indexOf(name), chain);
    return item && `${item.kind} ${item.path}`;
  };
  it("what it names where it stands", () => {
    expect(named("n a (var", "n")).toBe("machine n");
    expect(named("n a (var", "a")).toBe("state n/a");
    expect(named("v := [2]", "v")).toBe("variable n/v");
    expect(named("n.a s", "n")).toBe("machine n");
    expect(named("n.a s", "n", "n.a")).toBe("state n/a");
    expect(named("go s", "go")).toBe("event go");
    expect(named("s -> s)", "s")).toBe("state m/s");
  });
  it("a variable of a machine after its dot in a block", () => {
    expect(partOf(state, "m", "variable", "n.v")?.path).toBe("n/v");
    expect(partOf(state, "n", "variable", "n.v")).toBeUndefined();
  });
});

it("a dotted name is read up to the end of the word", () => {
  const [state, offset] = at("(running [x = robot.li|ght.data])");
  expect(chainAt(state, offset)?.text).toBe("robot.light");
});

describe("the message that a command fills", () => {
  it.each([
    ["by a lambda", "robot.move(lambda msg: ", ""],
    ["in a with", "with robot.move as msg:\n  msg.angular.z = 1\n  ", ""],
    ["by a def", "def fill(msg):\n  ", "\nrobot.move(fill)"],
  ])("is known %s", (_, before, after) => {
    expect(filledBy("msg.linear.", before, after)).toBe("robot.move().linear.");
  });

  it("is not known where nothing is filled", () => {
    expect(filledBy("msg.linear.", "def fill(msg):\n  ", "\nfill(1)")).toBeNull();
    expect(filledBy("other.", "robot.move(lambda msg: ", "")).toBeNull();
    expect(filledBy("robot.light.", "robot.move(lambda robot: ", "")).toBeNull();
    expect(filledBy(".", "robot.move(lambda : f()", "")).toBeNull();
  });
});
