import { describe, expect, it } from "vitest";
import { testedEvents } from "../src/editor/tested";
import type { MachineItem, ProgramView } from "../src/protocol";

function machine(path: string, events: string[], transitions: [string, string, string][]): MachineItem {
  return {
    path,
    parent: null,
    states: [],
    variables: [],
    events: events.map((name) => `${path}/${name}`),
    transitions: transitions.map(([trigger, source, destination]) => ({
      id: "",
      kind: "on",
      trigger,
      source,
      destination,
    })),
  };
}

const program: ProgramView = {
  variables: [],
  events: ["far", "near"],
  main: "m",
  machines: [
    machine(
      "m",
      ["near", "hit"],
      [
        ["near", "a", "b"],
        ["hit", "*-{c}", "b"],
        ["far for 200", "{b c}", "a"],
      ],
    ),
    machine("m/b/n", [], [["near", "x", "y"]]),
  ],
};
const instance = (path: string, machine = path) => ({ path, machine, settings: "" });
const tested = (...active: string[]) => {
  const instances = ["m", "m/b/n"].slice(0, active.length).map((path) => instance(path));
  return [...testedEvents({ program, active, instances })].sort();
};

describe("an event is tested", () => {
  it("while a transition out of the active state waits for it", () => {
    expect(tested("m/a")).toEqual(["m/hit", "m/near"]);
    expect(tested()).toEqual([]);
  });
  it("not by a wildcard in its own destination, or in a state that it leaves out", () => {
    expect(tested("m/b")).toEqual(["far"]);
    expect(tested("m/c")).toEqual(["far"]);
  });
  it("by a nested machine as the name means there", () => {
    expect(tested("m/b", "m/b/n/x")).toEqual(["far", "m/near"]);
  });
  it("in the instance whose active state waits for it", () => {
    const instances = [
      ...[instance("k"), instance("k/one/m", "m"), instance("l"), instance("l/two/m", "m")],
      instance("l/two/m/b/n", "m/b/n"),
    ];
    const active = ["k/one/m/a", "l/two/m/b/n/x"];
    expect([...testedEvents({ program, active, instances })].sort()).toEqual([
      ...["far", "k/one/m/hit", "k/one/m/near", "l/two/m/near"],
    ]);
  });
});
