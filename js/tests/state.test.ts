import { expect, it } from "vitest";
import type { Frame, FromKernel, IssueView, MachineItem, Snapshot } from "../src/protocol";
import { apply, initialState } from "../src/session/state";

const frame = (fields: Partial<Frame>): Frame => ({ type: "frame", view: "v", frame: 1, ...fields });
const machine = (path: string): MachineItem => ({
  path,
  parent: null,
  states: [],
  transitions: [],
  variables: [],
  events: [],
});
const snapshot = (machines: string[], fields: Partial<Frame> = {}): Snapshot => ({
  type: "snapshot",
  view: "v",
  name: "x",
  text: "",
  revision: 1,
  running: "",
  findings: [],
  program: { variables: [], events: [], machines: machines.map(machine) },
  layouts: {},
  pending: null,
  choices: { bridges: [], worlds: [], programs: [] },
  world: null,
  frame: frame(fields),
});

it("a frame changes what it names and nothing else", () => {
  const state = initialState();
  apply(state, frame({ variables: { x: { text: "1", number: 1 }, y: { text: "2", number: 2 } }, tick: 3 }));
  const changed = apply(state, frame({ variables: { x: null } }));
  expect([...changed]).toEqual(["variables"]);
  expect([...state.variables.keys()]).toEqual(["y"]);
  expect(state.tick).toBe(3);
});

it("a heartbeat changes nothing", () => {
  expect(apply(initialState(), frame({})).size).toBe(0);
});

it("issues come, change and go by their number", () => {
  const state = initialState();
  apply(
    state,
    frame({
      issues: [
        { id: 1, count: 1 },
        { id: 2, count: 1 },
      ] as IssueView[],
    }),
  );
  apply(state, frame({ issues: [{ id: 2, count: 5 }] as IssueView[], gone: [1] }));
  expect([...state.issues.values()]).toEqual([{ id: 2, count: 5 }]);
});

it("a snapshot forgets what was before, but not what the person looks at", () => {
  const state = initialState();
  apply(state, snapshot(["a", "b"], { members: { light: "1" } }));
  state.machine = "b";
  apply(state, snapshot(["a", "b"]));
  expect(state.machine).toBe("b");
  expect(state.members).toEqual({});
});

it("looks at the machine around when the one looked at goes", () => {
  const state = initialState();
  apply(state, snapshot(["a", "m", "m/s/n"]));
  state.machine = "m/s/n";
  const gone = { program: { variables: [], events: [], machines: [machine("a"), machine("m")] } };
  apply(state, { type: "answer", findings: [], layouts: null, ...gone } as unknown as FromKernel);
  expect(state.machine).toBe("m");
});

it("follows the innermost active state only when asked to", () => {
  const state = initialState();
  apply(state, snapshot(["m", "m/s/n"]));
  apply(state, frame({ lit: ["m/s", "m/s/n/x"] }));
  expect(state.machine).toBe("m");
  state.follow = true;
  apply(state, frame({ lit: ["m/s", "m/s/n/y"] }));
  expect(state.machine).toBe("m/s/n");
});
