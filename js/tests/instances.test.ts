// @vitest-environment happy-dom

import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { menuOf } from "../src/graph/elements";
import { differences } from "../src/language/paths";
import { breakpointItems } from "../src/parts/breakpoints";
import { rowsOf } from "../src/parts/tree";
import { groupsInScope } from "../src/parts/variables";
import { askWhy } from "../src/parts/why";
import type { Happening, ViewState } from "../src/protocol";
import { addressed, meant, placeOf, spawned, stateOf, valuesOf } from "../src/session/instances";
import { apply, initialState } from "../src/session/state";
import { type Lab, Store } from "../src/session/store";
import { draw } from "../src/timeline/draw";
import { Happened, lanesOf, placesIn, placesOfInstances } from "../src/timeline/happened";
import { labelsOf } from "../src/timeline/plots";
import { s } from "../src/ui/dom";
import { Page } from "./opened";

const TEXT = `(var n := [0])
(machine follow (var side := [1])
  (event near [n > 6 + side]) (state search) (state found)
  (on near search -> found)
  (on [n > 5 + side] search -> found hit))
(machine m (state left (onentry (spawn follow search (var side := [2])))))
(machine k (state one (onentry (spawn follow search))))
(spawn m left) (spawn k one)
`;
const machine = (path: string, states: string[], variables: string[] = [], events: string[] = []) => ({
  ...{ path, parent: null, transitions: [], events, variables },
  states: states.map((name) => ({ path: `${path}/${name}`, machines: [] })),
});
const instance = (path: string, machine = path, settings = "") => ({ path, machine, settings });
const RUN = {
  program: {
    variables: ["n"],
    events: [],
    main: "follow",
    machines: [
      machine("follow", ["search", "found"], ["follow/side"], ["follow/near"]),
      machine("m", ["left"]),
      machine("k", ["one"]),
      machine("clock", ["t"]),
    ],
  },
  active: ["m/left/follow/search", "k/one/follow/found", "clock/t"],
  lit: ["m/left", "follow/search", "k/one", "follow/found", "clock/t"],
  instances: [
    instance("m"),
    instance("m/left/follow", "follow", "side 2"),
    instance("k"),
    instance("k/one/follow", "follow"),
    instance("clock"),
  ],
  variables: { n: ["8", 8], "m/left/follow/side": ["2", 2], "k/one/follow/side": ["1", 1] },
  events: { "m/left/follow/near": false, "k/one/follow/near": true },
} satisfies Partial<ViewState>;
/** Only one of the two runs. */
const ONCE = {
  active: ["m/left", "k/one/follow/found", "clock/t"],
  lit: ["m/left", "k/one", "follow/found", "clock/t"],
  instances: RUN.instances.filter(({ path }) => path !== "m/left/follow"),
  variables: { ...RUN.variables, "m/left/follow/side": null },
  events: { "k/one/follow/near": true, "m/left/follow/near": null },
};
const stateOfLab = (fields = {}) => ({ ...initialState(), ...RUN, ...fields });

describe("an instance", () => {
  it("is told apart from the others by what differs in their paths", () => {
    expect(differences(["m/left/follow", "k/one/follow"])).toEqual(["m/left", "k/one"]);
    expect(differences(["team/one/car/drive/eye", "team/two/car/drive/eye"])).toEqual(["one", "two"]);
    expect(differences(["a/b/a/b", "a/b"])).toEqual(["a/b", ""]);
    const top = stateOfLab({ instances: [instance("follow"), instance("k/one/follow", "follow")] });
    expect([placeOf(top, "follow"), placeOf(top, "k/one/follow")]).toEqual(["follow", "k/one"]);
    expect(placeOf(stateOfLab(), "m")).toBe("");
  });

  it("is meant where it is selected, or nearest to the one that is", () => {
    const paths = (selected: string, machine: string) =>
      meant({ instances, instance: selected }, machine).map(({ path }) => path);
    const instances = [
      ...["team/one/car", "team/two/car"].map((path) => instance(path, "car")),
      ...["team/one/car/drive/eye", "team/two/car/drive/eye"].map((path) => instance(path, "eye")),
    ];
    expect(paths("", "car")).toEqual(["team/one/car", "team/two/car"]);
    expect(paths("team/two/car", "car")).toEqual(["team/two/car"]);
    expect(paths("team/two/car", "eye")).toEqual(["team/two/car/drive/eye"]);
    expect(paths("team/two/car/drive/eye", "car")).toEqual(["team/two/car"]);
    expect(paths("team/three/car", "car")).toEqual(["team/one/car", "team/two/car"]);
    expect(paths("", "boat")).toEqual([]);
  });

  it("has values and an active state of its own, and the kernel is told which it is if there are several", () => {
    const state = stateOfLab({ instance: "k/one/follow" });
    expect(spawned(state, "follow/side")).toBe("k/one/follow/side");
    expect(addressed(state, "follow:hit")).toBe("k/one/follow:hit");
    expect(valuesOf(state, "variable", "follow/side").map(({ text }) => text)).toEqual(["1"]);
    expect(valuesOf(state, "variable", "follow/side", true).map(({ place }) => place)).toEqual([
      ...["m/left", "k/one"],
    ]);
    expect(valuesOf(state, "event", "follow/near").map(({ text }) => text)).toEqual(["True"]);
    expect(valuesOf(state, "event", "follow/near", true).map(({ text }) => text)).toEqual(["False", "True"]);
    expect(state.instances.map((each) => stateOf(state, each))).toEqual([
      ...["m/left", "follow/search", "k/one", "follow/found", "clock/t"],
    ]);
    const once = stateOfLab(ONCE);
    expect(spawned(once, "follow/side")).toBe("k/one/follow/side");
    expect(addressed(once, "follow:hit")).toBe("follow:hit");
    expect(addressed(state, "n")).toBe("n");
  });

  it("keeps being selected and inspected when a state around it is renamed", () => {
    const state = stateOfLab({
      instance: "m/left/follow",
      inspected: { kind: "variable", path: "m/left/follow/side" },
    });
    const moved = {
      1: [
        { kind: "state" as const, old: "m/left", new: "m/west" },
        { kind: "variable" as const, old: "follow/side", new: "follow/way" },
      ],
    };
    apply(state, { type: "frame", view: "v", frame: 1, moved } as never);
    expect(state.instance).toBe("m/west/follow");
    expect(state.inspected!.path).toBe("m/west/follow/way");
  });
});

describe("the parts of a lab", () => {
  it("list several instances under their machine, and one as the machine itself", () => {
    const rows = rowsOf(RUN.program, RUN).map((row) => [row.machine.path, row.place]);
    expect(rows).toEqual([
      ...[
        ["follow", ""],
        ["follow", "m/left"],
        ["follow", "k/one"],
      ],
      ...[
        ["m", ""],
        ["k", ""],
        ["clock", ""],
      ],
    ]);
    expect(rowsOf(RUN.program, ONCE)).toHaveLength(4);
  });

  it("show the variables of the selected instance, or of each", () => {
    const groups = (fields: object) =>
      groupsInScope(stateOfLab({ machine: "follow", ...fields })).map((each) => [each.instance, each.place]);
    expect(groups({})).toEqual([
      ["m/left/follow", "m/left"],
      ["k/one/follow", "k/one"],
      ["", ""],
    ]);
    expect(groups({ instance: "k/one/follow" })).toEqual([
      ["k/one/follow", "k/one"],
      ["", ""],
    ]);
    expect(groups(ONCE)).toEqual([
      ["k/one/follow", ""],
      ["", ""],
    ]);
  });

  it("offer a breakpoint in any instance, and in the one that is meant", () => {
    const acts: object[] = [];
    const state = stateOfLab({ instance: "k/one/follow" });
    const lab = { store: { state }, act: async (act: object) => acts.push(act) } as unknown as Lab;
    const items = breakpointItems(lab, "transition", "follow:hit");
    expect(items.map(({ label }) => label)).toEqual(["Pause when it fires", "Pause when it fires in k/one"]);
    for (const { run } of items) run();
    expect(acts).toEqual([
      { do: "add_breakpoint", kind: "fired", path: "follow:hit" },
      { do: "add_breakpoint", kind: "fired", path: "follow:hit", instance: "k/one/follow" },
    ]);
    Object.assign(state, ONCE);
    expect(breakpointItems(lab, "transition", "follow:hit")).toHaveLength(1);
  });

  it("ask why in the instance that is meant, say which it is, and stay with it", async () => {
    const store = new Store();
    Object.assign(store.state, RUN, { instance: "k/one/follow" });
    const asked: object[] = [];
    const why = { code: "fired", name: "hit", time: 0.7, sentence: "It fired.", lines: [], present: true };
    const root = document.createElement("div");
    const lab = {
      ...{ store, root, closed: new AbortController().signal, tell: () => {} },
      ask: async (question: object) => asked.push(question) && { why },
    } as unknown as Lab;
    const title = async (path: string, instance?: string) => {
      askWhy(lab, "transition", path, { x: 0, y: 0 }, instance);
      for (let i = 0; i < 5; i++) await Promise.resolve();
      const cards = root.querySelectorAll(".lrp-why .lrp-title > span:first-child");
      return [...cards].at(-1)!.textContent;
    };
    expect(await title("follow:hit")).toBe("Why hit in k/one?");
    expect(await title("follow:hit", "m/left/follow")).toBe("Why hit in m/left?");
    Object.assign(store.state, ONCE);
    expect(await title("follow:hit")).toBe("Why hit?");
    expect(asked).toEqual(
      ["k/one/follow:hit", "m/left/follow:hit", "follow:hit"].map((path) => {
        return { type: "why", kind: "transition", path };
      }),
    );
  });

  it("force a state, or fire a transition, in the instance that is meant", () => {
    const acts: object[] = [];
    const state = stateOfLab({ instance: "k/one/follow" });
    const lab = { store: { state }, act: async (act: object) => acts.push(act) } as unknown as Lab;
    const offered = (kind: "state" | "transition", path: string) =>
      menuOf(lab, { kind, path }, { x: 0, y: 0 }, [], () => {}).filter((each) => each !== null);
    const [here, teleport, why] = offered("state", "follow/search");
    expect([here!.label, why!.label]).toEqual(["Transition here in k/one", "Why in k/one?"]);
    here!.run();
    teleport!.run();
    offered("transition", "follow:hit")[0]!.run();
    offered("state", "m/left")[0]!.run();
    expect(acts).toEqual([
      { do: "transition", path: "k/one/follow/search" },
      { do: "teleport", path: "k/one/follow/search" },
      { do: "fire", path: "k/one/follow:hit" },
      { do: "transition", path: "m/left" },
    ]);
    Object.assign(state, ONCE);
    expect(offered("state", "follow/search").map(({ label }) => label)).toEqual([
      ...["Transition here", "Teleport here", "Why?", "Pause when entered", "Pause when left"],
      ...["Inspect", "Go to source", "Rename…"],
    ]);
  });

  it("name the lanes and plots of instances so that they can be told apart, and no others", () => {
    const entered = (lane: string, state: string, by = ""): Happening => ({
      ...{ tick: 1, time: 0, kind: "entered", lane, state, by, text: "", call: "" },
    });
    const lanes = lanesOf([
      entered("m", "m/left"),
      entered("m/left/follow", "follow/search"),
      entered("k/one/follow", "follow/search"),
      entered("a/x/inner", "a/x/inner/y"),
      entered("b/x/inner", "b/x/inner/y"),
    ]);
    const names = (other = lanes) =>
      [...placesIn(other)].filter(([, place]) => place).map(([lane, place]) => `${lane}: ${place}`);
    expect(names()).toEqual(["m/follow: m", "k/follow: k"]);
    const svg = s("svg");
    const scale = { span: { from: 0, to: 1 }, left: 100, width: 100, now: 1, sight: { top: 0, bottom: 99 } };
    const styleOf = () => ({ color: "red", dash: [] });
    draw(svg, {
      ...scale,
      machines: 4,
      lanes,
      marks: [],
      plots: [],
      labels: new Map(),
      other: null,
      styleOf,
    });
    const shown = [...svg.querySelectorAll(".lrp-timeline-name")].map((each) => each.textContent);
    expect(shown).toEqual(["m", "follow m", "follow k", "inner"]);
    const plots = ["m/left/follow/side", "n", "robot.light.data"];
    expect([...labelsOf(plots).values()]).toEqual(["side", "n", "light.data"]);
    expect([...labelsOf(plots, ["k/one/follow/side", "m/n"]).values()]).toEqual([
      ...["side m/left", "n", "light.data"],
    ]);
  });

  it("share a lane where states of one machine spawn them in turn, and are asked about one by one", () => {
    const happened = new Happened();
    const entered = (lane: string, state: string, tick: number, by = ""): Happening => ({
      ...{ tick, time: tick, kind: "entered", lane, state, by, text: "", call: "" },
    });
    happened.happenings = [
      entered("m", "m/there", 1),
      entered("m/there/follow", "follow/search", 1),
      entered("m/there/follow", "follow/found", 2, "follow/hit"),
      { ...entered("m/there/follow", "", 3), kind: "ended" },
      entered("m", "m/back", 3, "m/go"),
      entered("m/back/follow", "follow/search", 3),
      entered("m/back/follow/search/follow", "follow/search", 3),
    ];
    const lanes = happened.lanes();
    expect(lanes.map(({ machine, depth, segments }) => [machine, depth, segments.length])).toEqual([
      ["m", 0, 2],
      ["m/follow", 1, 3],
      ["m/follow/follow", 2, 1],
    ]);
    const [, found, again] = lanes[1]!.segments;
    expect([found!.end, again!.lane]).toEqual([3, "m/back/follow"]);
    expect(happened.after(found!)).toBeNull();
    expect(placesOfInstances(lanes).get("m/back/follow")).toBe("back");
  });

  it("know which instance a transition belongs to that began a visit, also an `exit`", () => {
    const happened = new Happened();
    const entered = (state: string, by: string, tick: number): Happening => ({
      ...{ tick, time: tick, kind: "entered", lane: "m", state, by, text: "", call: "" },
    });
    happened.happenings = [
      entered("m/left", "", 1),
      entered("m/right", "follow/out", 2),
      entered("m/left", "m/go", 3),
    ];
    const [, out, go] = happened.lanes()[0]!.segments;
    expect([happened.leader(out!), happened.leader(go!)]).toEqual(["m/left/follow", "m"]);
  });
});

describe("a lab whose program runs a machine in two places", () => {
  let page: Page;
  beforeEach(async () => {
    page = new Page();
    page.open({ text: TEXT, running: TEXT, findings: [], frame: { ...recorded(), ...RUN } as never });
    await page.drawn();
  });
  afterEach(() => page.close());
  const recorded = () => ({ type: "frame", view: "", frame: 1, tick: 8, time: 0.7, status: "paused" });
  const rows = () =>
    [...page.host.querySelectorAll<HTMLElement>('[data-lrp="tree"] .lrp-tree-item')].map((each) => [
      each.querySelector(".lrp-tree-name")!.textContent,
      each.querySelector(".lrp-tree-settings")!.textContent,
      each.querySelector(".lrp-tree-state")!.textContent,
    ]);
  const select = async (path: string) => {
    page.find(`[data-lrp="tree"] [data-lrp-instance="${path}"]`).click();
    await page.drawn();
  };
  const values = () =>
    [...page.host.querySelectorAll(".lrp-variable")].map(
      (each) => `${each.getAttribute("data-lrp-variable")} ${each.querySelector(".lrp-value")?.textContent}`,
    );
  const inline = () => [...page.host.querySelectorAll(".lrp-inline-value")].map((each) => each.textContent);

  it("lists and selects them", async () => {
    expect(rows()).toEqual([
      ["follow", "", ""],
      ["m/left", "side 2", "search"],
      ["k/one", "", "found"],
      ["m", "", "left"],
      ["k", "", "one"],
      ["clock", "", "t"],
    ]);
    expect(values()).toEqual(["m/left/follow/side 2", "k/one/follow/side 1", "n 8"]);
    expect(inline()).toEqual([
      ...["8", "side m/left = 2side k/one = 1", "near m/left = Falsenear k/one = True"],
    ]);
    await select("k/one/follow");
    expect(page.find('[data-lrp="tree"] [aria-selected="true"]').dataset.lrpInstance).toBe("k/one/follow");
    expect(values()).toEqual(["k/one/follow/side 1", "n 8"]);
    expect(inline()).toEqual(["8", "1", "True"]);
    page.find('[data-lrp="tree"] [data-lrp-machine="follow"]').click();
    await page.drawn();
    expect(values()).toHaveLength(3);
  });

  it("inspects and sets variables in the selected one", async () => {
    await select("k/one/follow");
    page.find('[data-lrp-variable="k/one/follow/side"] [data-lrp-action="inspect"]').click();
    await page.drawn();
    expect(page.of("inspect").at(-1)).toMatchObject({ kind: "variable", path: "k/one/follow/side" });
    const row = page.find('[data-lrp-variable="k/one/follow/side"]');
    row.querySelector<HTMLElement>(".lrp-value")!.click();
    const field = row.querySelector("input")!;
    field.value = "7";
    field.dispatchEvent(new KeyboardEvent("keydown", { key: "Enter", bubbles: true }));
    const path = "k/one/follow/side";
    expect(page.commands("set_variable")).toMatchObject([{ path, expression: "7" }]);
  });

  it("keeps the field of a value, with what is typed, until Enter or Escape", async () => {
    await select("k/one/follow");
    const row = page.find('[data-lrp-variable="k/one/follow/side"]');
    const open = () => {
      row.querySelector<HTMLElement>(".lrp-value")!.click();
      return row.querySelector("input")!;
    };
    open().blur();
    expect(row.querySelector("input")).toBeNull(); // nothing was typed
    const field = open();
    field.value = "7 +";
    field.blur();
    page.deliver({ type: "frame", frame: 2, variables: { n: ["9", 9], "k/one/follow/side": ["3", 3] } });
    await select("m/left/follow");
    expect([field.isConnected, field.value, values().at(-1)]).toEqual([true, "7 +", "n 9"]);
    field.dispatchEvent(new KeyboardEvent("keydown", { key: "Escape", bubbles: true }));
    expect(values()).toEqual(["m/left/follow/side 2", "n 9"]);
  });

  it("have a panel however few machines there are, and keep it", async () => {
    const folded = () => page.find('[data-lrp="tree"]').hasAttribute("data-folded");
    const few = { ...RUN.program, machines: RUN.program.machines.slice(0, 3) };
    page.close();
    page = new Page();
    page.open({ frame: { ...recorded(), ...RUN, ...ONCE, program: few } as never });
    await page.drawn();
    expect(folded()).toBe(true);
    for (const run of [RUN, ONCE]) {
      page.deliver({ type: "frame", frame: 2, instances: run.instances });
      await page.drawn();
      expect(folded()).toBe(false);
    }
  });

  it("says of an issue in which it occurred", async () => {
    const issue = {
      ...{ id: 1, code: "LRP601", severity: "error" as const, kind: "exception", element: "", traceback: "" },
      ...{ message: "No.", range: null, finding: "", first_tick: 1, last_tick: 3, count: 3, resolved: false },
    };
    const told = async (...instances: string[]) => {
      page.deliver({ type: "frame", frame: 2, issues: { 1: { ...issue, instances } } });
      await page.drawn();
      return page.find('[data-lrp-issue="LRP601"] .lrp-issue-note').textContent;
    };
    expect(await told("m/left/follow")).toBe("in m/left · 3×, ticks 1–3");
    expect(await told("m/left/follow", "k/one/follow")).toBe("in k/one, m/left · 3×, ticks 1–3");
    expect(await told("gone/follow")).toBe("in gone/follow · 3×, ticks 1–3");
    expect(await told()).toBe("3×, ticks 1–3");
  });

  it("selects one in all views of the session", async () => {
    const beside = new Page("variables");
    beside.open({ frame: { ...recorded(), ...RUN } as never });
    await select("k/one/follow");
    await page.drawn();
    expect([...beside.host.querySelectorAll(".lrp-group-title")].map((each) => each.textContent)).toEqual([
      ...["follow k/one", "global"],
    ]);
    beside.close();
  });

  it("looks as ever where only one of them runs", async () => {
    page.deliver({ type: "frame", frame: 2, ...ONCE });
    await page.drawn();
    await page.drawn();
    expect(rows()).toEqual([
      ["follow", "", "found"],
      ["m", "", "left"],
      ["k", "", "one"],
      ["clock", "", "t"],
    ]);
    expect(values()).toEqual(["follow/side 1", "n 8"]);
    expect(page.find(".lrp-group-title").textContent).toBe("follow");
    expect(inline()).toEqual(["8", "1", "True"]);
  });
});
