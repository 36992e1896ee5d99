import { expect, it } from "vitest";
import { Camera } from "../src/graph/camera";
import type { ElementKind, FrameMessage, IssueView, MachineItem, SnapshotMessage } from "../src/protocol";
import { apply, initialState } from "../src/session/state";

const frame = (fields: Partial<FrameMessage>): FrameMessage => ({
  type: "frame",
  view: "v",
  frame: 1,
  ...fields,
});
const machine = (path: string): MachineItem => ({
  path,
  parent: null,
  states: [],
  transitions: [],
  variables: [],
  events: [],
});
const program = (machines: string[]) => ({
  variables: [],
  events: [],
  machines: machines.map(machine),
  main: machines.find((path) => path === "main") ?? machines[0] ?? "",
});
const snapshot = (machines: string[], fields: Partial<FrameMessage> = {}): SnapshotMessage => ({
  type: "snapshot",
  view: "v",
  name: "x",
  home: "/x",
  tab_only: false,
  debugger: "",
  by_hand: "",
  document: "d",
  number: 0,
  seq: 0,
  text: "",
  revision: 1,
  updates: null,
  running: "",
  findings: [],
  accepted: true,
  half_typed: false,
  pending: null,
  choices: { bridges: [], worlds: [], programs: [] },
  world: null,
  frame: frame({ program: program(machines), ...fields }),
});

it("a frame changes what it names and nothing else", () => {
  const state = initialState();
  apply(
    state,
    frame({
      variables: {
        x: ["1", 1],
        y: ["2", 2],
      },
      tick: 3,
    }),
  );
  const changed = apply(state, frame({ variables: { x: null } }));
  expect([...changed]).toEqual(["variables"]);
  expect(Object.keys(state.variables)).toEqual(["y"]);
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
      issues: { 1: { id: 1, count: 1 }, 2: { id: 2, count: 1 } } as unknown as Record<string, IssueView>,
    }),
  );
  apply(state, frame({ issues: { 1: null, 2: { id: 2, count: 5 } as IssueView } }));
  expect(Object.values(state.issues)).toEqual([{ id: 2, count: 5 }]);
});

it("a snapshot replaces the state, but not what the user has selected and opened", () => {
  const state = initialState();
  apply(state, snapshot(["a", "b"], { members: { light: "1" } }));
  state.machine = "b";
  apply(state, snapshot(["a", "b"]));
  expect(state.machine).toBe("b");
  expect(state.members).toEqual({});
});

const moved = (kind: ElementKind, old: string, now: string) => ({ kind, old, new: now });

it("keeps the machine shown, the selection and the inspected element when their paths change", () => {
  const state = initialState();
  apply(state, snapshot(["m", "m/a/inner"]));
  state.machine = "m/a/inner";
  state.chosen = "m:on:a->b";
  state.inspected = { kind: "state", path: "m/a" };
  const camera = new Camera();
  state.cameras = { "m/a/inner": camera };
  const renamed = [
    moved("machine", "m/a/inner", "m/z/inner"),
    moved("transition", "m:on:a->b", "m:on:z->b"),
    moved("state", "m/a", "m/z"),
  ];
  const changed = apply(state, frame({ program: program(["m", "m/z/inner"]), moved: { 4: renamed } }));
  expect(state.machine).toBe("m/z/inner");
  expect(state.cameras["m/z/inner"]).toBe(camera);
  expect(state.chosen).toBe("m:on:z->b");
  expect(state.inspected).toEqual({ kind: "state", path: "m/z" });
  expect([...changed]).toEqual(expect.arrayContaining(["machine", "chosen", "inspected"]));
});

it("applies several renames in their order, and each once", () => {
  const state = initialState();
  apply(state, snapshot(["m"]));
  state.chosen = "m/a";
  const first = { 2: [moved("state", "m/a", "m/b")] };
  const both = { ...first, 10: [moved("state", "m/b", "m/a")] };
  apply(state, frame({ moved: first }));
  expect(state.chosen).toBe("m/b");
  apply(state, frame({ moved: { 10: both[10] } }));
  expect(state.chosen).toBe("m/a");
  apply(state, snapshot(["m"], { moved: both })); // the connection was lost for a while
  expect(state.chosen).toBe("m/a");
  state.moved = {};
  apply(state, snapshot(["m"], { moved: both })); // it was lost before both
  expect(state.chosen).toBe("m/a");
});

it("does not confuse a variable with the machine of the same path", () => {
  const state = initialState();
  apply(state, snapshot(["m", "other"]));
  apply(state, frame({ moved: { 1: [moved("variable", "m", "other")] } }));
  expect(state.machine).toBe("m");
});

it("shows the machine that the program spawns first, wherever it stands", () => {
  const state = initialState();
  apply(state, snapshot(["helper", "main"]));
  expect(state.machine).toBe("main");
});

it("shows the enclosing machine when the one shown is removed", () => {
  const state = initialState();
  apply(state, snapshot(["a", "m", "m/s/n"]));
  state.machine = "m/s/n";
  apply(state, frame({ program: program(["a", "m"]) }));
  expect(state.machine).toBe("m");
});
