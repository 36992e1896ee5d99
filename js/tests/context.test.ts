import { EditorState } from "@codemirror/state";
import { describe, expect, it } from "vitest";
import { filledBy } from "../src/editor/complete";
import { chainAt, contextAt, spawnable } from "../src/editor/context";
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
    expect(wanted("(machine m (on go |))")).toBe("state");
    expect(wanted("(machine m (on go a -> |))")).toBe("state");
    expect(wanted("(machine m (on go a -> b |))")).toBe("nothing");
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
  });
});
