// @vitest-environment happy-dom
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { AutoFit, LEGIBLE } from "../src/graph/autofit";
import { type Box, Camera } from "../src/graph/camera";
import { Dragging } from "../src/graph/drag";
import { draw, drawCones, drawMachines, type Layers, makeLayers } from "../src/graph/draw";
import { nearest } from "../src/graph/focus";
import { boxAround, nestAround, placesOf, shapeFor, statesOn, writtenIn } from "../src/graph/inside";
import { lastFired, marking } from "../src/graph/marks";
import { ScrollBars, scroll } from "../src/graph/scroll";
import { follow, followRun, showMachine } from "../src/graph/shown";
import type { Layout, SpawnedLine, StateShape, TransitionShape } from "../src/protocol";
import { initialState, type LabState } from "../src/session/state";
import { Store } from "../src/session/store";
import { AFTERGLOW } from "../src/ui/timers";
import fc from "./laws";
import recording from "./page/recording.json";

const follower = recording.snapshot.frame.layouts.follower as unknown as Layout;

const shape = (name: string, fields: Partial<StateShape> = {}): StateShape => ({
  id: `m/${name}`,
  name,
  kind: "state",
  x: 0,
  y: 0,
  width: 60,
  height: 36,
  label: name,
  nested: "",
  machines: [],
  inside: [],
  spawns: [],
  title: name,
  start: null,
  ...fields,
});
const line = (machine: string, fields: Partial<SpawnedLine> = {}): SpawnedLine => ({
  ...{ machine, name: machine, settings: "", title: machine, x: -25, y: 10, width: 50 },
  ...fields,
});
const arrow = (source: string, fields: Partial<TransitionShape> = {}): TransitionShape => ({
  id: "m:t",
  name: "t",
  kind: "on",
  style: "on",
  source,
  destination: "b",
  d: "M0 0L1 1",
  head: "",
  mark: "",
  label: { text: "e", x: 0, y: 0, width: 9, height: 9 },
  title: "t",
  broken: null,
  lands: false,
  watched: "",
  ...fields,
});
const layout = (states: StateShape[], transitions: TransitionShape[] = []): Layout => ({
  machine: "m",
  name: "m",
  view: [0, 0, 100, 100],
  frame: [0, 0, 100, 100],
  states,
  transitions,
  ports: [],
  places: {},
});

let layers: Layers;
let state: LabState;
const node = (path: string) => layers.root.querySelector(`[data-lrp-state="${path}"]`);
beforeEach(() => {
  layers = makeLayers();
  state = initialState();
  state.machine = "m";
});

describe("a drawing", () => {
  it("has every state and transition of a real layout, by the names tests and themes use", () => {
    draw(layers, follower);
    const names = [...layers.root.querySelectorAll("[data-lrp-state]")].map((element) =>
      element.getAttribute("data-lrp-state"),
    );
    expect(names).toEqual(follower.states.filter(({ kind }) => kind !== "any").map(({ id }) => id));
    expect(layers.root.querySelectorAll("[data-lrp-transition='follower:tlooking']")).toHaveLength(1);
  });

  it("keeps the element of a state that stays, wherever it goes", () => {
    draw(layers, layout([shape("a"), shape("b")]));
    const before = node("m/b");
    draw(layers, layout([shape("b", { x: 70 }), shape("c")]));
    expect(node("m/b")).toBe(before);
    expect(before?.getAttribute("transform")).toBe("translate(70 0)");
    expect(node("m/a")).toBeNull();
  });

  it("keeps the element of a transition whose delay is edited", () => {
    const after = (delay: string) =>
      arrow("a", { id: "m:ontime:a->b", label: { text: delay, x: 0, y: 0, width: 9, height: 9 } });
    draw(layers, layout([shape("a"), shape("b")], [after("100 ms")]));
    const before = [layers.arrows.firstElementChild, layers.labels.firstElementChild];
    draw(layers, layout([shape("a"), shape("b")], [after("300 ms")]));
    expect([layers.arrows.firstElementChild, layers.labels.firstElementChild]).toEqual(before);
    expect(layers.arrows.firstElementChild).toBe(before[0]);
    expect(before[1]?.textContent).toBe("300 ms");
  });

  it("leaves a state alone while it is dragged", () => {
    draw(layers, layout([shape("a", { x: 5 })]));
    node("m/a")?.setAttribute("data-dragged", "");
    draw(layers, layout([shape("a", { x: 50 })]));
    expect(node("m/a")?.getAttribute("transform")).toBe("translate(5 0)");
  });

  it("draws one arrow for each source of a transition", () => {
    draw(layers, layout([shape("a"), shape("b"), shape("c")], [arrow("a"), arrow("c")]));
    expect(layers.arrows.children).toHaveLength(2);
    expect(layers.labels.children).toHaveLength(2);
  });

  it("shows why a transition is broken until it is repaired", () => {
    draw(layers, layout([shape("a")], [arrow("a", { broken: "There is no state `b`." })]));
    const drawn = layers.arrows.firstElementChild;
    expect(drawn?.getAttribute("data-broken")).toBe("There is no state `b`.");
    draw(layers, layout([shape("a")], [arrow("a")]));
    expect(drawn?.hasAttribute("data-broken")).toBe(false);
  });

  it("has a line in a state for each machine that it spawns from elsewhere, whole in its card", () => {
    const given = line("follow", { settings: "side −1, kee…25", title: "follow (side −1, keep 0.25)" });
    draw(layers, layout([shape("a", { spawns: [line("move"), given] })]));
    const lines = [...node("m/a")!.querySelectorAll("[data-lrp-spawns]")];
    expect(lines.map((each) => each.getAttribute("data-lrp-spawns"))).toEqual(["move", "follow"]);
    expect(lines[1]!.querySelector("title")!.textContent).toBe("follow (side −1, keep 0.25)");
    expect(lines[1]!.querySelector("text")!.textContent).toBe("followside −1, kee…25");
    expect(node("m/a")!.getAttribute("aria-label")).toBe("a move follow side −1, kee…25: state a");
  });

  it("writes a label of two lines around its middle", () => {
    const label = { text: "found\n(from send)", x: 10, y: 20, width: 60, height: 29 };
    draw(layers, layout([shape("a"), shape("b")], [arrow("a", { label, lands: true })]));
    const spans = [...layers.labels.querySelectorAll("tspan")];
    const lift = 11.5 * 0.35;
    expect(spans.map((span) => [span.getAttribute("x"), Number(span.getAttribute("y")) - lift])).toEqual([
      ["10", 20 - 6.75],
      ["10", 20 + 6.75],
    ]);
    expect(layers.labels.textContent).toBe("found (from send)");
    draw(layers, layout([shape("a"), shape("b")], [arrow("a")]));
    expect(layers.labels.innerHTML).not.toContain("tspan");
  });

  it("has no path for the placeholder state, which cannot be entered", () => {
    draw(layers, layout([shape("*", { kind: "any" })]));
    expect(layers.root.querySelector("[data-lrp-state]")).toBeNull();
  });
});

describe("a nested machine inside its state", () => {
  const inner = { ...layout([shape("x", { id: "m/a/i/x" })]), machine: "m/a/i" };
  const around = layout([shape("a", { inside: [{ machine: "m/a/i", x: 3, y: 4 }] })]);

  it("is drawn in it, keeps its elements, and goes with it", () => {
    draw(layers, around, { m: around, "m/a/i": inner });
    const before = node("m/a/i/x");
    expect(before?.closest('[data-lrp-state="m/a"]')).toBe(node("m/a"));
    draw(layers, layout([{ ...around.states[0]!, x: 90, width: 300 }]), { "m/a/i": inner });
    expect(node("m/a/i/x")).toBe(before);
    draw(layers, layout([shape("a")]));
    expect(node("m/a/i/x")).toBeNull();
  });

  it("has its own active state and its own last transition", () => {
    const t = arrow("x", { id: "m/a/i:t" });
    draw(layers, around, { m: around, "m/a/i": { ...inner, transitions: [t] } });
    state.lit = ["m/a", "m/a/i/x"];
    state.fired = { "m:u": [1, 9], "m/a/i:t": [1, 3] };
    marking(layers, state)();
    expect(node("m/a/i/x")?.hasAttribute("data-active")).toBe(true);
    expect(layers.root.querySelector("[data-fired]")?.getAttribute("data-of")).toBe("m/a/i:t");
  });
});

describe("the nest", () => {
  const at = (machine: string, states: StateShape[], width = 100): Layout => ({
    ...layout(states),
    ...{ machine, view: [0, 0, width, 80], frame: [0, 0, width, 80] },
  });
  const inner = { id: "m/a", machines: ["i", "j"], x: 50, y: 40 };
  const layouts = {
    m: at("m", [shape("b"), shape("a", inner)]),
    "m/a/i": at("m/a/i", [shape("x", { id: "m/a/i/x", machines: ["k"] })]),
    "m/a/j": at("m/a/j", []),
    "m/a/i/x/k": at("m/a/i/x/k", []),
  };

  it("has what is around a machine, and the first ones in it; none twice that is drawn inside its state", () => {
    const whole = ["m", "m/a/i", "m/a/i/x/k"];
    for (const machine of whole) expect(nestAround(machine, layouts)).toEqual(whole);
    expect(nestAround("m/a/j", layouts)).toEqual(["m", "m/a/j"]);
    const open = at("m", [shape("a", { ...inner, inside: [{ machine: "m/a/i", x: 0, y: 0 }] })]);
    expect(nestAround("m/a/i", { ...layouts, m: open })).toEqual(["m", "m/a/i/x/k"]);
  });

  it("is shown where there is room, side by side in a wide panel and one below the other in a high one", () => {
    expect([shapeFor(520, 300, "one"), shapeFor(900, 500, "one")]).toEqual(["one", "row"]);
    expect([shapeFor(400, 650, "one"), shapeFor(400, 420, "column")]).toEqual(["column", "column"]);
    const nest = ["m", "m/a/i"];
    const [row, column] = (["row", "column"] as const).map((form) => placesOf(nest, layouts, form, []));
    expect(row).toEqual([
      { machine: "m", x: 0, y: 0 },
      { machine: "m/a/i", x: 148, y: 0 },
    ]);
    expect(column?.[1]).toEqual({ machine: "m/a/i", x: 0, y: 128 });
    expect(boxAround(row!, layouts)).toEqual({ x: 0, y: 0, width: 248, height: 80 });
  });

  it("moves a machine only out of the way of one that grows", () => {
    const nest = ["m", "m/a/i"];
    const places = placesOf(nest, layouts, "row", []);
    const grown = (width: number) => ({ ...layouts, m: at("m", layouts.m.states, width) });
    const wide = placesOf(nest, grown(130), "row", places);
    expect(wide[1]!.x).toBe(178);
    expect(placesOf(nest, grown(90), "row", wide)).toEqual(wide);
  });

  const spawning = (user: string) => shape("s", { id: `${user}/s`, spawns: [line("move")], x: 50, y: 40 });
  const shared = {
    p: at("p", [spawning("p"), { ...spawning("p"), id: "p/t", y: 70 }]),
    q: at("q", [spawning("q")]),
    move: at("move", [shape("go", { id: "move/go" })]),
  };

  it("has the machine in which another one runs that is defined elsewhere: the likeliest of several", () => {
    for (const machine of ["p", "move"]) expect(nestAround(machine, shared)).toEqual(["p", "move"]);
    expect(nestAround("q", shared)).toEqual(["q", "move"]);
    expect(nestAround("move", shared, ["p/s", "q/s", "move/go"])).toEqual(["q", "move"]);
    const circle = { ...shared, move: at("move", [{ ...spawning("move"), spawns: [line("p")] }]) };
    expect(nestAround("p", circle)).toEqual(["move", "p"]);
  });

  it("knows the states on a path as spawned where they are defined", () => {
    expect(statesOn("q/s/move/go", shared)).toEqual(["q/s", "move/go"]);
    expect(statesOn("m/a/i/x", layouts)).toEqual(["m/a", "m/a/i/x"]);
    expect(statesOn("new/a/i/x", {})).toEqual(["new/a", "new/a/i/x"]);
  });

  it("is joined by a cone from each state that spawns a machine from elsewhere", () => {
    drawCones(layers.frame, placesOf(["p", "move"], shared, "row", []), shared, true);
    const ways = [...layers.frame.querySelectorAll(".lrp-cone")].map((cone) => cone.getAttribute("d"));
    expect(ways).toEqual(["M148 0L80 22V58L148 80", "M148 0L80 52V88L148 80"]);
  });

  it("is joined by a cone from the state that contains the machine", () => {
    const places = placesOf(["m", "m/a/i"], layouts, "row", []);
    drawMachines(layers.root, places, layouts);
    drawCones(layers.frame, places, layouts, true);
    expect(node("m/a/i/x")).not.toBeNull();
    expect(layers.frame.querySelector(".lrp-cone")?.getAttribute("d")).toBe("M148 0L80 22V58L148 80");
    drawMachines(layers.root, places.slice(0, 1), layouts);
    expect(node("m/a/i/x")).toBeNull();
  });
});

describe("following the run", () => {
  let lab: { store: Store; closed: AbortSignal };
  let end: AbortController;
  beforeEach(() => {
    vi.useFakeTimers();
    end = new AbortController();
    lab = { store: new Store(), closed: end.signal };
    Object.assign(lab.store.state, { machine: "m", follow: "active" });
    lab.store.state.settings = { ...lab.store.state.settings, graph: "live" };
  });
  afterEach(() => {
    end.abort();
    vi.useRealTimers();
  });
  const active = (...paths: string[]) => {
    lab.store.state.active = paths;
    lab.store.set("lit", paths);
    vi.advanceTimersByTime(300);
  };

  it("shows the machine of the innermost active state when it has been so for a second, not before", () => {
    followRun(lab);
    for (let turn = 0; turn < 20; turn++) active(turn % 2 ? "m/b" : "m/a/i/x");
    expect(lab.store.state.machine).toBe("m");
    for (const state of ["x", "y", "x", "y", "x"]) active(`m/a/i/${state}`);
    expect(lab.store.state.machine).toBe("m/a/i");
  });

  it("leaves what is seen, waits while one types or points, and does not act where it is not wanted", () => {
    let busy = true;
    const seen = ["m", "m/b/j"];
    followRun(
      lab,
      (machines) => machines.every((machine) => seen.includes(machine)),
      () => busy,
    );
    active("m/b/j/x");
    vi.advanceTimersByTime(5000);
    active("m/a/i/x");
    vi.advanceTimersByTime(5000);
    expect(lab.store.state.machine).toBe("m");
    busy = false;
    vi.advanceTimersByTime(1000);
    expect(lab.store.state.machine).toBe("m/a/i");
    showMachine(lab.store, "m/a/i"); // also of the one that is shown: it stays
    expect(lab.store.state.follow).toBe("nothing");
    showMachine(lab.store, "m");
    active("m/a");
    active("m/a/i/y");
    vi.advanceTimersByTime(5000);
    expect([lab.store.state.machine, lab.store.state.follow]).toEqual(["m", "nothing"]);
    follow(lab.store, "active");
    vi.advanceTimersByTime(50);
    expect(lab.store.state.machine).toBe("m/a/i"); // at once: it was asked for
    localStorage.clear();
  });
});

describe("following a machine that several others spawn", () => {
  it("shows the one in which it runs, too", () => {
    vi.useFakeTimers();
    const end = new AbortController();
    const store = new Store();
    const user = (machine: string) => ({
      ...layout([shape("s", { id: `${machine}/s`, spawns: [line("move")] })]),
      machine,
    });
    Object.assign(store.state, {
      machine: "move",
      follow: "active",
      layouts: { p: user("p"), q: user("q") },
    });
    store.state.settings = { ...store.state.settings, graph: "live" };
    const seen = ["p", "move"];
    const shown: string[] = [];
    followRun(
      { store, closed: end.signal },
      (machines) => machines.every((machine) => seen.includes(machine)),
      () => false,
      () => {},
      (machine) => shown.push(machine),
    );
    for (const active of ["p/s/move/go", "q/s/move/go"]) {
      store.state.active = [active];
      store.set("lit", []);
      vi.advanceTimersByTime(1100);
    }
    expect(shown).toEqual(["move"]);
    end.abort();
    vi.useRealTimers();
  });

  it("shows alone what is written in the outermost one, however deep, and none that others may use", () => {
    expect(writtenIn(["p", "p/s/i", "move", "move/go/j"])).toEqual(["p", "p/s/i"]);
    vi.useFakeTimers();
    const end = new AbortController();
    const store = new Store();
    const user = layout([shape("s", { id: "p/s", spawns: [line("move")] })]);
    Object.assign(store.state, {
      machine: "move",
      follow: "active",
      layouts: { p: { ...user, machine: "p" } },
    });
    store.state.settings = { ...store.state.settings, graph: "live" };
    store.state.active = ["p/s/move/go"];
    followRun({ store, closed: end.signal }, undefined, undefined, undefined, undefined, writtenIn);
    store.set("lit", []);
    vi.advanceTimersByTime(1100);
    expect(store.state.machine).toBe("p");
    end.abort();
    vi.useRealTimers();
  });
});

describe("marks", () => {
  it("name the state in which a machine runs that is defined elsewhere, and at each of several", () => {
    const [user, helper] = [
      { ...layout([shape("s", { id: "p/s", spawns: [line("m")] })]), machine: "p" },
      layout([shape("a"), shape("b")]),
    ];
    state.layouts = { p: user, m: helper };
    const places = [{ machine: "m", x: 0, y: 0 }];
    drawMachines(layers.root, places, state.layouts);
    const update = marking(layers, state);
    const within = () => layers.root.querySelector(".lrp-within")?.textContent ?? null;
    Object.assign(state, { active: ["p/s/m/a"], lit: ["p/s", "m/a"] });
    update();
    expect(within()).toBe("in p/s");
    expect(layers.root.querySelector(".lrp-user")).toBeNull();
    state.users = { "m/a": "p/s", "m/b": "q/s, top level" };
    update();
    update();
    const tags = [...layers.root.querySelectorAll(".lrp-user")].map((tag) => [
      tag.parentElement?.getAttribute("data-lrp-state"),
      tag.textContent,
    ]);
    expect(tags).toEqual([
      ["m/a", "p/s"],
      ["m/b", "q/s, top level"],
    ]);
    expect(node("m/b")?.getAttribute("aria-description")).toBe("in q/s, top level");
    Object.assign(state, { active: [], lit: [], users: {} });
    update();
    expect([within(), layers.root.querySelector(".lrp-user")]).toEqual([null, null]);
  });

  it("show the active state and the transition that fired last", () => {
    draw(layers, layout([shape("a"), shape("b")], [arrow("a"), arrow("b", { id: "m:u" })]));
    state.lit = ["m/b"];
    state.fired = {
      "m:t": [4, 9],
      "m:u": [1, 3],
      "n:t": [1, 20],
    };
    marking(layers, state)();
    expect(node("m/b")?.hasAttribute("data-active")).toBe(true);
    expect(node("m/a")?.hasAttribute("data-active")).toBe(false);
    expect(layers.root.querySelector("[data-fired]")?.getAttribute("data-lrp-transition")).toBe("m:t");
  });

  it("tell the last of four transitions that fire in turn from those before it, fainter by age", () => {
    vi.useFakeTimers();
    const names = ["a", "b", "c", "d"];
    const arrows = names.map((name) => arrow(name, { id: `m:${name}` }));
    draw(
      layers,
      layout(
        names.map((name) => shape(name)),
        arrows,
      ),
    );
    const update = marking(layers, state);
    update();
    const marked = (mark: string) =>
      [...layers.root.querySelectorAll(mark)].map((part) => part.getAttribute("data-of"));
    for (let tick = 1; tick < 40; tick++) {
      const id = `m:${names[tick % 4]}`;
      state.tick = tick;
      state.fired = { ...state.fired, [id]: [Math.ceil(tick / 4), tick] };
      update();
      expect(marked("[data-fired]")).toEqual([id, id, id]); // the arrow, the plate of its label, and the label
      expect(marked("[aria-description]")).toEqual([id]);
      vi.advanceTimersByTime(100);
      if (tick < 4) continue;
      for (const part of layers.arrows.children) {
        const before = (tick - (state.fired[part.getAttribute("data-of") ?? ""]?.[1] ?? 0)) % 4;
        expect(part.hasAttribute("data-glow")).toBe(true);
        expect(part.getAttribute("style")).toBe(`--lrp-age: ${before}`);
      }
    }
    vi.advanceTimersByTime(AFTERGLOW); // paused
    expect(marked("[data-fired]")).toEqual(["m:d", "m:d", "m:d"]);
    expect(marked("[data-glow]")).toEqual([]);
    vi.useRealTimers();
  });

  it("let a visit that was too short to see glow for a while", () => {
    vi.useFakeTimers();
    const update = marking(layers, state);
    draw(layers, layout([shape("a")]));
    update();
    state.entered = { "m/a": [1, 1] };
    update();
    vi.advanceTimersByTime(150);
    expect(node("m/a")?.hasAttribute("data-glow")).toBe(true);
    vi.advanceTimersByTime(AFTERGLOW);
    expect(node("m/a")?.hasAttribute("data-glow")).toBe(false);
    vi.useRealTimers();
  });

  it("do not glow when what happened long ago gets another name", () => {
    vi.useFakeTimers();
    const update = marking(layers, state);
    state.tick = 9;
    state.entered = { "m/a": [1, 1] };
    draw(layers, layout([shape("a"), shape("b")]));
    update();
    vi.advanceTimersByTime(AFTERGLOW);
    state.entered = { "m/z": [1, 1], "m/b": [1, 10] };
    draw(layers, layout([shape("z"), shape("b")]));
    update();
    expect(node("m/z")?.hasAttribute("data-glow")).toBe(false);
    expect(node("m/b")?.hasAttribute("data-glow")).toBe(true);
    vi.useRealTimers();
  });

  it("know no last transition before the first", () => {
    expect(lastFired({ "m:t": [0, 0] })).toEqual([]);
  });
});

describe("the camera", () => {
  it("shows the whole in the middle, not larger than it should be", () => {
    const camera = new Camera();
    camera.fit({ x: 10, y: 10, width: 100, height: 50 }, 400, 400, 2);
    expect(camera.scale).toBe(2);
    expect(camera.inside(200, 200)).toEqual([60, 35]);
    expect(camera.moved).toBe(false);
  });

  it("keeps the point under the pointer while zooming", () => {
    const camera = new Camera();
    camera.fit({ x: 0, y: 0, width: 100, height: 100 }, 200, 200);
    const before = camera.inside(30, 40);
    camera.zoom(1.7, 30, 40);
    const after = camera.inside(30, 40);
    expect(after[0]).toBeCloseTo(before[0]);
    expect(after[1]).toBeCloseTo(before[1]);
    expect(camera.moved).toBe(true);
  });

  it("limits zooming in and out", () => {
    const camera = new Camera();
    for (let i = 0; i < 50; i++) camera.zoom(2, 0, 0);
    expect(camera.scale).toBe(4);
    for (let i = 0; i < 50; i++) camera.zoom(0.5, 0, 0);
    expect(camera.scale).toBe(0.2);
  });
});

describe("scrolling", () => {
  it("moves a drawing that is larger than its panel, not beyond its ends, and its bars show what is in view", () => {
    const length = fc.integer({ min: 50, max: 1000 });
    const two = fc.tuple(length, length);
    const by = fc.integer({ min: -300, max: 300 });
    fc.assert(
      fc.property(two, two, fc.array(fc.tuple(by, by), { maxLength: 5 }), (long, room, ways) => {
        const content = { x: -20, y: -30, width: long[0], height: long[1] };
        const size = { width: room[0], height: room[1] };
        const [camera, bars] = [new Camera(), new ScrollBars()];
        camera.set({ x: 20, y: 30, scale: 1 });
        const cut = long.map((all, axis) => (all > room[axis]! + 1 ? all - room[axis]! : 0)); // px
        let gone = [0, 0];
        for (const way of ways) {
          const next = gone.map((px, axis) => Math.min(cut[axis]!, Math.max(0, px + way[axis]!)));
          expect(scroll(camera, content, size, ...way)).toBe(`${next}` !== `${gone}`);
          gone = next;
          expect([camera.x, camera.y]).toEqual([20 - gone[0]!, 30 - gone[1]!]);
        }
        bars.update(camera, content, size);
        expect(bars.elements.map(({ hidden }) => hidden)).toEqual(cut.map((px) => !px));
        bars.elements.forEach(({ style }, axis) => {
          if (!cut[axis]) return;
          const px = (share: number) => (share / long[axis]!) * (room[axis]! - 4);
          const [begin, extent] = axis ? [style.top, style.height] : [style.left, style.width];
          expect(Number.parseFloat(begin)).toBeCloseTo(2 + px(gone[axis]!));
          expect(Number.parseFloat(extent)).toBeCloseTo(px(room[axis]!));
        });
      }),
    );
  });
});

describe("the camera's own movements", () => {
  let svg: SVGSVGElement;
  let camera: Camera;
  let autofit: AutoFit;
  const resize = (width: number, height: number) => {
    Object.defineProperty(svg, "clientWidth", { value: width, configurable: true });
    Object.defineProperty(svg, "clientHeight", { value: height, configurable: true });
  };
  const box = (x: number, y: number, width: number, height: number) => ({ x, y, width, height });
  const at = () => [camera.x, camera.y, camera.scale];
  beforeEach(() => {
    vi.useFakeTimers({
      toFake: ["setTimeout", "clearTimeout", "requestAnimationFrame", "cancelAnimationFrame", "performance"],
    });
    vi.stubGlobal("matchMedia", () => ({ matches: false }));
    svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    resize(400, 300);
    camera = new Camera();
    autofit = new AutoFit(svg, camera, () => {});
    autofit.show(camera, box(0, 0, 400, 300), null);
    vi.advanceTimersByTime(5000);
  });
  afterEach(() => {
    vi.unstubAllGlobals();
    vi.useRealTimers();
  });

  it("do not happen while everything is in view", () => {
    autofit.update(box(50, 50, 200, 200), () => box(60, 60, 10, 10));
    vi.advanceTimersByTime(5000);
    expect(at()).toEqual([0, 0, 1]);
  });

  it("wait for a second after the last key", () => {
    autofit.acted();
    autofit.update(box(0, 0, 440, 300), null);
    vi.advanceTimersByTime(600);
    autofit.acted();
    vi.advanceTimersByTime(990);
    expect(at()).toEqual([0, 0, 1]);
    vi.advanceTimersByTime(500);
    expect(camera.scale).toBeCloseTo(400 / 440);
  });

  it("stop at a key, and go on when the user pauses", () => {
    autofit.update(box(0, 0, 400, 3000), () => box(100, 2000, 60, 36));
    vi.advanceTimersByTime(60);
    autofit.acted();
    const stopped = at();
    expect(stopped).not.toEqual([0, 0, 1]);
    vi.advanceTimersByTime(990);
    expect(at()).toEqual(stopped);
    vi.advanceTimersByTime(500);
    expect(camera.inside(200, 150)[1]).toBeCloseTo(2018);
  });

  it("bring what is new into view, also when a state becomes active before the user pauses", () => {
    autofit.acted();
    autofit.update(box(0, 0, 400, 3000), () => box(100, 2000, 60, 36));
    autofit.suggest(() => box(100, 0, 60, 36));
    vi.advanceTimersByTime(2000);
    expect(camera.inside(200, 150)[1]).toBeCloseTo(2018);
  });

  it("do not happen because the panel changes its size while one types", () => {
    autofit.acted();
    resize(400, 320);
    autofit.resized(null);
    vi.advanceTimersByTime(990);
    expect(at()).toEqual([0, 0, 1]);
    vi.advanceTimersByTime(500);
    expect(at()).toEqual([0, 10, 1]);
  });

  it("wait while a button is down, whatever it does, and for a pause after it", () => {
    autofit.acted(true);
    autofit.update(box(0, 0, 440, 300), null);
    vi.advanceTimersByTime(5000);
    expect(at()).toEqual([0, 0, 1]);
    autofit.acted();
    vi.advanceTimersByTime(990);
    expect(at()).toEqual([0, 0, 1]);
    vi.advanceTimersByTime(500);
    expect(camera.scale).toBeCloseTo(400 / 440);
  });

  it("do not happen before what was dragged is drawn where it was dropped", () => {
    autofit.hold();
    autofit.update(box(0, 0, 440, 300), null);
    vi.advanceTimersByTime(5000);
    expect(at()).toEqual([0, 0, 1]);
    autofit.release();
    vi.advanceTimersByTime(500);
    expect(at()).toEqual([0, 0, 1]);
    autofit.update(box(0, 0, 440, 300), null);
    vi.advanceTimersByTime(500);
    expect(camera.scale).toBeCloseTo(400 / 440);
  });

  it("never make names too small: what is new is scrolled into view instead", () => {
    autofit.update(box(0, 0, 400, 3000), () => box(100, 2000, 60, 36));
    vi.advanceTimersByTime(500);
    expect(camera.scale).toBe(LEGIBLE);
    const [, y] = camera.inside(200, 150);
    expect(y).toBeCloseTo(2018);
  });

  it("bring what is new into view where it is then, not where it was drawn first", () => {
    let fresh: Box | null = box(560, 100, 60, 36);
    autofit.acted();
    autofit.update(box(0, 0, 400, 300), () => fresh);
    fresh = box(200, 100, 60, 36); // it was put where the user had clicked
    autofit.update(box(0, 0, 400, 300), null);
    vi.advanceTimersByTime(5000);
    expect(at()).toEqual([0, 0, 1]);
    autofit.update(box(0, 0, 400, 300), () => fresh);
    fresh = null; // and removed again
    vi.advanceTimersByTime(5000);
    expect(at()).toEqual([0, 0, 1]);
  });

  it("leave a camera alone that the user has moved, except for what is new", () => {
    camera.pan(30, 0);
    autofit.update(box(0, 0, 600, 300), null);
    vi.advanceTimersByTime(500);
    expect(at()).toEqual([30, 0, 1]);
    autofit.update(box(0, 0, 600, 300), () => box(500, 100, 60, 36));
    vi.advanceTimersByTime(500);
    expect(camera.x).toBe(400 - 14 - 560);
  });

  it("begin where a drawing does that is too long, or as near to that as shows the active state", () => {
    const top = new Camera();
    autofit.show(top, box(0, 0, 400, 3000), box(100, 200, 60, 36));
    expect(top.y).toBeCloseTo(0);
    const below = new Camera();
    autofit.show(below, box(0, 0, 400, 3000), box(100, 2000, 60, 36));
    expect(below.y + 2036 * LEGIBLE).toBeCloseTo(300 - 14);
  });

  it("keep the middle of the panel when its size changes", () => {
    resize(500, 400);
    autofit.resized(null);
    expect(at()).toEqual([50, 50, 1]);
  });

  it("fit a drawing that was last shown in a smaller panel", () => {
    const drawing = box(0, 0, 440, 330);
    const other = new Camera();
    autofit.show(other, drawing, null);
    autofit.show(camera, box(0, 0, 400, 300), null);
    resize(440, 330);
    autofit.resized(null);
    autofit.show(other, drawing, null);
    expect([other.x, other.y, other.scale]).toEqual([0, 0, 1]);
  });

  it("leave a drawing alone that the user has shown whole since the panel changed its size", () => {
    autofit.acted();
    resize(300, 200);
    autofit.resized(null);
    autofit.whole(box(0, 0, 400, 300));
    const whole = at();
    vi.advanceTimersByTime(5000);
    expect(at()).toEqual(whole);
  });

  it("are for the panel as it was last seen, while it is in a tab that is not shown", () => {
    resize(0, 0);
    autofit.resized(null);
    autofit.rearranged(box(0, 0, 300, 100), null);
    vi.advanceTimersByTime(500);
    resize(400, 300);
    autofit.resized(null);
    expect(camera.inside(200, 150)).toEqual([150, 50]);
    resize(0, 0);
    autofit.resized(null);
    resize(500, 300);
    autofit.resized(null);
    expect(camera.inside(250, 150)).toEqual([150, 50]);
  });
});

describe("a state that is dragged", () => {
  it("is in its place when it is drawn there; meanwhile another one can be dragged", () => {
    const ended = vi.fn();
    const dragging = new Dragging(() => {}, ended);
    draw(layers, layout([shape("a"), shape("b")]));
    dragging.begin(node("m/a")!);
    dragging.move(5, 0, 0);
    dragging.drop();
    dragging.begin(node("m/b")!);
    dragging.move(0, 9, 0);
    expect([node("m/a"), node("m/b")].map((each) => each?.hasAttribute("data-dragged"))).toEqual([
      false,
      true,
    ]);
    expect(ended).not.toHaveBeenCalled(); // nothing may move under the pointer
    dragging.drop();
    dragging.drawn([layout([shape("a", { x: 5 }), shape("b", { y: 9 })])]);
    expect(ended).toHaveBeenCalledTimes(1);
  });

  it("goes home where its drop is refused, also if it is never drawn where it was dropped", () => {
    const [pinned, ended] = [vi.fn(), vi.fn()];
    const dragging = new Dragging(pinned, ended);
    draw(layers, layout([shape("a"), shape("b", { y: 60 })]));
    dragging.begin(node("m/b")!);
    dragging.move(0, -60, 0);
    dragging.drop();
    dragging.put("m/b", 0, 60);
    expect(node("m/b")!.getAttribute("transform")).toBe("translate(0 60)");
    expect(pinned).toHaveBeenLastCalledWith("m/b", 0, 60);
    dragging.drawn([layout([shape("a"), shape("b", { y: 60 })])]);
    expect(ended).toHaveBeenCalledOnce();
  });
});

it("a state that is put home while it is dragged is not pinned where it is dropped", () => {
  const pinned = vi.fn();
  const dragging = new Dragging(pinned, () => {});
  draw(layers, layout([shape("a")]));
  dragging.begin(node("m/a")!);
  dragging.move(500, 0, 0);
  pinned.mockClear();
  dragging.put("m/a", 0, 0);
  dragging.drop();
  expect(pinned.mock.calls).toEqual([
    ["m/a", 0, 0],
    ["m/a", 0, 0],
  ]);
});

describe("arrow keys", () => {
  const points = [
    { x: 100, y: 5 },
    { x: 60, y: 80 },
    { x: -50, y: 0 },
  ];

  it("move to the nearest in that direction; one to the side counts as farther", () => {
    expect(nearest({ x: 0, y: 0 }, points, "ArrowRight")).toBe(0);
    expect(nearest({ x: 0, y: 10 }, points, "ArrowDown")).toBe(1);
    expect(nearest({ x: 0, y: 0 }, points, "ArrowLeft")).toBe(2);
  });

  it("do not move when there is nothing in that direction", () => {
    expect(nearest({ x: 0, y: 0 }, [{ x: 0, y: 5 }], "ArrowUp")).toBe(-1);
  });
});
