// @vitest-environment happy-dom
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { CountBars, cardOf, countsOf } from "../src/graph/countdowns";
import type { Layout, TransitionShape } from "../src/protocol";
import { initialState, type LabState } from "../src/session/state";

const arrow = (id: string, source: string, fields: Partial<TransitionShape> = {}): TransitionShape => ({
  ...{ id, source, name: "t", kind: "on", style: "on", destination: "b", d: "", head: "", mark: "" },
  ...{ label: { text: "e", x: 50, y: 20, width: 64, height: 16 }, title: "(on e a -> b)" },
  ...{ broken: null, lands: false, watched: "" },
  ...fields,
});
const state = (id: string, fields: object = {}) => ({
  id,
  x: 0,
  y: 0,
  machines: [],
  spawns: [],
  inside: [],
  ...fields,
});
const layout = (machine: string, states: object[], transitions: TransitionShape[]) =>
  ({ machine, states, transitions }) as unknown as Layout;

/** What an animation was made of; null once it is over. */
const filled = new WeakMap<Element, string | null>();
let lab: LabState;
let bars: CountBars;
let now: number;
beforeEach(() => {
  now = 5000;
  vi.spyOn(performance, "now").mockImplementation(() => now);
  Element.prototype.animate = function (_, options) {
    const { duration, delay } = options as KeyframeAnimationOptions;
    filled.set(this, `${duration} from ${-delay!}`);
    return { cancel: () => filled.set(this, null) } as unknown as Animation;
  };
  lab = initialState();
  Object.assign(lab, { status: "running", link: "live", time: 10, lit: ["m/a"], active: ["m/a"] });
  lab.settings = { ...lab.settings, graph: "live" };
  bars = new CountBars(lab);
});
afterEach(() => {
  vi.restoreAllMocks();
});

const show = (layouts: Record<string, Layout>, machine = "m") => {
  lab.layouts = layouts;
  bars.draw([{ machine, x: 0, y: 0 }], layouts);
};
const PLAIN = () => ({
  m: layout("m", [state("m/a"), state("m/b")], [arrow("m:t", "a"), arrow("m:t", "b"), arrow("m:u", "b")]),
});
const shown = () => [...bars.element.querySelectorAll<HTMLElement>(".lrp-count")];
const fill = () => shown()[0]!.firstElementChild!;
const styleOf = (element: Element) => element.getAttribute("style");
const count = (since: number, delay: number, id = "m:t") => {
  lab.countdowns = { [id]: [since, delay] };
};

describe("the bar of an arrow that waits for a time", () => {
  it("is below the label of the arrow from the active state, and fills from what has passed", () => {
    count(9.5, 2000);
    show(PLAIN());
    expect(shown().map(styleOf)).toEqual(["left: 20px; top: 26.5px; width: 60px"]);
    expect(filled.get(fill())).toBe("2000 from 500");
  });

  it("is left alone while it fills as it was told, and begins again where the run is late, or starts to count again", () => {
    count(9.5, 2000);
    show(PLAIN());
    const after = (seconds: number, of: number) => {
      now += 1000 * seconds;
      lab.time += of;
      bars.update();
      return filled.get(fill());
    };
    expect(after(0.1, 0.1)).toBe("2000 from 500");
    expect(after(0.3, 0.25)).toBe("2000 from 500");
    expect(after(0.4, 0.15)).toBe("2000 from 1000");
    count(10.25, 2000);
    expect(after(0.25, 0.25)).toBe("2000 from 500");
    lab.countdowns = {};
    bars.update();
    expect(shown()).toEqual([]);
  });

  it("fills as fast as the run is", () => {
    count(9.5, 2000);
    lab.achieved_speed = 4;
    show(PLAIN());
    expect(filled.get(fill())).toBe("500 from 125");
    lab.achieved_speed = 10;
    bars.update();
    expect(shown()).toEqual([]); // over before one sees it
  });

  it.each([{ status: "paused" }, { looking: { tick: 3, time: 10, now: 12 } }, { link: "dead" }])(
    "stands still with %o, at what had passed then",
    (fields) => {
      count(9.5, 2000);
      show(PLAIN());
      Object.assign(lab, fields);
      bars.update();
      expect([styleOf(fill()), filled.get(fill())]).toEqual(["transform: scaleX(0.25)", null]);
      const before = fill();
      now += 900;
      bars.update();
      expect(fill()).toBe(before);
      lab.time = 11;
      bars.update();
      expect(styleOf(fill())).toBe("transform: scaleX(0.75)");
    },
  );

  it("grows in few steps where motion is not wanted", () => {
    vi.spyOn(window, "matchMedia").mockReturnValue({ matches: true } as MediaQueryList);
    count(9.5, 2000);
    show(PLAIN());
    expect(styleOf(fill())).toBe("transform: scaleX(0.2)");
    lab.time += 0.05;
    bars.update();
    expect(styleOf(fill())).toBe("transform: scaleX(0.2)");
    lab.time += 0.2;
    bars.update();
    expect(styleOf(fill())).toBe("transform: scaleX(0.3)");
  });

  it("is not there in a graph that shows nothing of the run", () => {
    count(9.5, 2000);
    lab.settings = { ...lab.settings, graph: "static" };
    show(PLAIN());
    expect(shown()).toEqual([]);
  });

  it("is at the arrow of a wildcard, and inside of the state in which a machine is drawn", () => {
    const m = layout("m", [state("m/a", { x: 100, y: 50, inside: [{ machine: "m/a/i", x: 10, y: 5 }] })], []);
    const inner = layout("m/a/i", [state("m/a/i/x")], [arrow("m/a/i:t", "*", { style: "wildcard" })]);
    lab.lit = ["m/a", "m/a/i/x"];
    count(9.5, 2000, "m/a/i:t");
    show({ m, "m/a/i": inner });
    expect(shown().map(styleOf)).toEqual(["left: 130px; top: 81.5px; width: 60px"]);
    expect(shown()[0]!.className).toBe("lrp-count lrp-wildcard");
  });
});

describe("a machine that runs in two states", () => {
  const layouts = () => ({
    m: layout(
      "m",
      ["m/a", "m/b"].map((id) => state(id, { spawns: [{ machine: "car" }] })),
      [arrow("m:w", "a", { watched: "car", title: "(on car.go a -> b)" })],
    ),
    car: layout("car", [state("car/go")], [arrow("car:t", "go", { kind: "ontime" })]),
  });

  it("has the bar of the one that is further on", () => {
    lab.countdowns = { "m/a/car:t": [8.5, 2000], "m/b/car:t": [9.5, 2000], "m:w": [9, 4000] };
    lab.layouts = layouts();
    expect(Object.fromEntries(countsOf(lab))).toEqual({
      "car:t": { since: 8.5, passed: 1.5, whole: 2 },
      "m:w": { since: 9, passed: 1, whole: 4 },
    });
  });

  it("has the bar of the selected one, if one is", () => {
    lab.countdowns = { "m/a/car:t": [8.5, 2000], "m/b/car:t": [9.5, 2000] };
    lab.instances = ["m", "m/a/car", "m/b/car"].map((path) => {
      return { path, machine: path.split("/").at(-1)!, settings: "" };
    });
    lab.instance = "m/b/car";
    lab.layouts = layouts();
    expect(Object.fromEntries(countsOf(lab))).toEqual({ "car:t": { since: 9.5, passed: 0.5, whole: 2 } });
  });

  it("is in the card of what waits for it, with what has passed", () => {
    Object.assign(lab, { lit: ["m/a", "car/go"], active: ["m/a/car/go", "m/b/car/stop"] });
    lab.layouts = layouts();
    count(9.25, 2000, "m:w");
    const card = (id: "m" | "car") => cardOf(lab, lab.layouts[id]!.transitions[0]!, id);
    expect(card("m")).toBe("(on car.go a -> b)\nhas held for 0.8 s of 2 s\ncar is in go");
    lab.active = ["m/a"];
    lab.countdowns = {};
    expect(card("m")).toBe("(on car.go a -> b)\ncar does not run");
    lab.lit = ["m/b"];
    expect(card("m")).toBe("(on car.go a -> b)");
    Object.assign(lab, { lit: ["m/a", "car/go"], countdowns: { "m/a/car:t": [9, 1500] } });
    expect(card("car")).toBe("(on e a -> b)\n1.0 s of 1.5 s have passed");
  });
});
