// @vitest-environment happy-dom

import { describe, expect, it } from "vitest";
import type { Happening, Plot, Timeline } from "../src/protocol";
import { type Drawing, draw, heightOf, laneAt, roomFor } from "../src/timeline/draw";
import { Happened, lanesOf, segmentAt, valueAt } from "../src/timeline/happened";
import { ticksOf, xOf } from "../src/timeline/scale";
import { s } from "../src/ui/dom";

const happening = (fields: Partial<Happening>): Happening => ({
  tick: 1,
  time: 0,
  kind: "entered",
  lane: "m",
  state: "m/a",
  by: "",
  text: "",
  ...fields,
});

const answer = (fields: Partial<Timeline>): Timeline => ({
  epoch: 1,
  first: 1,
  last: 10,
  begin: 0,
  end: 0.9,
  kept: -1,
  happenings: [],
  plots: [],
  names: [],
  ...fields,
});

const RUN = [
  happening({}),
  happening({ tick: 3, time: 0.2, state: "m/b", by: "m/go", text: "`go` fired." }),
  happening({ tick: 3, time: 0.2, lane: "m/b/inner", state: "m/b/inner/x" }),
  happening({ tick: 5, time: 0.4, kind: "ended", lane: "m/b/inner", state: "" }),
  happening({ tick: 5, time: 0.4, state: "m/a", by: "m/back" }),
];

describe("what happened", () => {
  it("becomes a lane for each machine, with a segment for each visit", () => {
    const [outer, inner] = lanesOf(RUN);
    expect(outer!.segments.map(({ state, begin, end, by }) => [state, begin, end, by])).toEqual([
      ["m/a", 0, 0.2, ""],
      ["m/b", 0.2, 0.4, "m:go"],
      ["m/a", 0.4, Number.POSITIVE_INFINITY, "m:back"],
    ]);
    expect(inner).toMatchObject({ machine: "m/inner", depth: 1 });
    expect(inner!.segments[0]).toMatchObject({ begin: 0.2, end: 0.4 });
  });

  it("has nested machines below their outer one, in the order in which they began", () => {
    const lanes = lanesOf([
      happening({ lane: "b", state: "b/x" }),
      happening({ lane: "a", state: "a/x" }),
      happening({ lane: "b/x/inner", state: "b/x/inner/y" }),
      happening({ lane: "b/x/inner/y/deep", state: "b/x/inner/y/deep/z" }),
    ]);
    expect(lanes.map(({ machine, depth }) => [machine, depth])).toEqual([
      ["b", 0],
      ["b/inner", 1],
      ["b/inner/deep", 2],
      ["a", 0],
    ]);
  });

  it("ends all visits at a restart", () => {
    const [lane] = lanesOf([happening({}), happening({ kind: "restart", lane: "", time: 0.5 })]);
    expect(lane!.segments[0]!.end).toBe(0.5);
  });

  it("finds the visit at a time", () => {
    const [lane] = lanesOf(RUN);
    expect(segmentAt(lane!, 0.3)!.state).toBe("m/b");
    expect(segmentAt(lane!, 99)!.state).toBe("m/a");
    expect(segmentAt(lane!, -1)).toBeNull();
  });

  it("keeps what stays and replaces what came after it", () => {
    const happened = new Happened();
    happened.merge(answer({ happenings: RUN }));
    happened.merge(
      answer({ kept: 3, last: 12, happenings: [happening({ tick: 4, kind: "edit", lane: "" })] }),
    );
    expect(happened.happenings.map(({ tick, kind }) => [tick, kind])).toEqual([
      [1, "entered"],
      [3, "entered"],
      [3, "entered"],
      [4, "edit"],
    ]);
    expect(happened.marks()).toHaveLength(1);
    happened.merge(answer({ epoch: 2, happenings: [] }));
    expect(happened.lanes()).toEqual([]);
  });

  it("drops what is no longer recorded, but not what is active then", () => {
    const happened = new Happened();
    const states = Array.from({ length: 800 }, (_, i) =>
      happening({ tick: i + 1, time: i, state: `m/${i % 2}` }),
    );
    happened.merge(answer({ happenings: states, last: 800 }));
    happened.merge(answer({ kept: 800, first: 700, last: 801, begin: 699 }));
    expect(happened.happenings).toHaveLength(102);
    expect(segmentAt(happened.lanes()[0]!, 698.5)!.state).toBe("m/0");
  });
});

describe("plots", () => {
  const plot = (fields: Partial<Plot>): Plot => ({
    name: "x",
    kind: "number",
    times: [],
    values: [],
    thresholds: [],
    ...fields,
  });

  it("are continued, and thresholds that come later have no values before", () => {
    const happened = new Happened();
    happened.merge(answer({ last: 2, plots: [plot({ times: [0, 0.1], values: [1, 2] })] }));
    const thresholds = [{ text: "limit", values: [5] }];
    happened.merge(answer({ kept: 1, last: 3, plots: [plot({ times: [0.2], values: [null], thresholds })] }));
    const known = happened.plots.get("x")!;
    expect(known).toMatchObject({ tick: 3, times: [0, 0.1, 0.2], values: [1, 2, null] });
    expect(known.thresholds.get("limit")).toEqual([null, null, 5]);
    happened.merge(answer({ kept: 2, last: 4, plots: [plot({ times: [0.3], values: [4] })] }));
    expect(known.thresholds.get("limit")).toEqual([null, null, 5, null]);
    happened.merge(answer({ epoch: 2 }));
    expect(happened.plots.size).toBe(0);
  });

  it("tell the value at a time", () => {
    const plotted = {
      kind: "number" as const,
      tick: 3,
      times: [0, 0.1, 0.2],
      values: [1, null, 3],
      thresholds: new Map(),
    };
    expect([-1, 0, 0.05, 0.1, 5].map((time) => valueAt(plotted, time))).toEqual([null, 1, 1, null, 3]);
  });
});

describe("the drawing", () => {
  const drawing = (fields: Partial<Drawing> = {}): Drawing => ({
    span: { from: 0, to: 10 },
    sight: { top: 0, bottom: 500 },
    now: 8,
    left: 100,
    width: 500,
    machines: 2,
    lanes: lanesOf(RUN),
    marks: [],
    plots: [],
    labels: new Map(),
    other: null,
    styleOf: () => ({ color: "red", dash: [] }),
    ...fields,
  });
  const drawn = (fields: Partial<Drawing> = {}) => {
    const svg = s("svg");
    draw(svg, drawing(fields));
    return svg;
  };

  it("has round numbers on its axis, not too close", () => {
    expect(ticksOf({ from: 0, to: 30 }, 960)).toEqual([
      0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30,
    ]);
    expect(ticksOf({ from: 12.3, to: 14 }, 300)).toEqual([12.5, 13, 13.5, 14]);
    expect(ticksOf({ from: 0, to: 7200 }, 300).length).toBeLessThan(8);
  });

  it("ends what lasts at the present", () => {
    const last = [...drawn().querySelectorAll("[data-lrp-visit]")].filter(
      (visit) => visit.getAttribute("data-tick") === "5",
    );
    const { x, width } = {
      x: Number(last[0]!.getAttribute("x")),
      width: Number(last[0]!.getAttribute("width")),
    };
    expect(x + width).toBeCloseTo(xOf(drawing(), 8), 0);
  });

  it("draws only what is in the window, and visits too short to see together", () => {
    const many = Array.from({ length: 5000 }, (_, i) =>
      happening({ tick: i, time: i / 100, state: `m/${i % 2}` }),
    );
    const shown = drawn({ span: { from: 0, to: 60 }, lanes: lanesOf(many), now: 60 });
    expect(shown.querySelectorAll("*").length).toBeLessThan(100);
    const drawnTogether = shown.querySelector("g > path")?.getAttribute("d") ?? "";
    expect(drawnTogether.split("M").length).toBeGreaterThan(200);
    expect(drawn({ span: { from: 20, to: 30 }, now: 30 }).querySelectorAll("[data-lrp-visit]")).toHaveLength(
      1,
    );
  });

  it("draws only the lanes and plots in sight, and is as high as all of them", () => {
    const lanes = lanesOf(
      Array.from({ length: 200 }, (_, i) => happening({ lane: `m${i}`, state: `m${i}/x` })),
    );
    const plotted = { kind: "number" as const, tick: 1, times: [0], values: [1], thresholds: new Map() };
    const plots: Drawing["plots"] = [["x", plotted]];
    const svg = drawn({ lanes, plots, sight: { top: 932, bottom: 1002 } });
    const shown = [...svg.querySelectorAll("[data-lrp-visit]")];
    expect(shown.map((each) => each.getAttribute("data-lane"))).toEqual(["m50", "m51", "m52", "m53"]);
    expect(svg.querySelector("[data-lrp-plot]")).toBeNull();
    expect(svg.getAttribute("height")).toBe(String(heightOf({ machines: 2, lanes, plots, other: null })));
    const end = drawn({ lanes, plots, sight: { top: 3602, bottom: 3702 } });
    expect(end.querySelector("[data-lrp-plot]")).not.toBeNull();
  });

  it("has as much room with one machine as with many, and with another course of them", () => {
    const many = lanesOf(["a", "b", "c", "d"].map((lane) => happening({ lane, state: `${lane}/x` })));
    const other = { lanes: many, end: 9, divergence: null };
    const rooms = [0, 1, 2, 4].flatMap((count) => {
      const lanes = many.slice(0, count);
      return [null, { ...other, lanes }].map((other) => {
        const held = { machines: 2, lanes, plots: [], other };
        return [roomFor(held), heightOf(held)];
      });
    });
    expect(rooms.map(([room]) => room)).toEqual(Array(8).fill(71));
    expect(rooms.map(([, height]) => height)).toEqual([53, 71, 53, 71, 71, 71, 107, 107]);
  });

  it("has room for the machines of the program, up to four", () => {
    expect([1, 2, 3, 4, 9].map((machines) => roomFor({ plots: [], machines }))).toEqual([
      71, 71, 89, 107, 107,
    ]);
    const lanes = lanesOf(["a", "b", "c"].map((lane) => happening({ lane, state: `${lane}/x` })));
    expect(heightOf({ plots: [], other: null, lanes, machines: 3 })).toBe(89);
  });

  it("keeps its axis and its marks above the lanes, to stay in sight where these are scrolled", () => {
    const marks = [{ kind: "edit" as const, tick: 1, time: 1, text: "Edited." }];
    const top = drawn({ marks }).lastElementChild!;
    expect(top.querySelectorAll(".lrp-timeline-time, [data-lrp-mark]").length).toBeGreaterThan(2);
    expect(top.getAttribute("class")).toBe("lrp-timeline-top");
  });

  it("has the other course of a machine below the recorded one, in the same row", () => {
    const nested = happening({ lane: "m/b/more", state: "m/b/more/x", time: 3, tick: 31 });
    const after = [...RUN, happening({ tick: 20, time: 2, state: "m/b" }), nested];
    const other = { lanes: lanesOf(after), end: 9, divergence: { time: 2, text: "`b` is entered." } };
    const svg = drawn({ other });
    const shown = (selector: string) =>
      [...svg.querySelectorAll(`[data-lrp-visit]${selector}`)].map((each) => {
        const [y, height] = ["y", "height"].map((name) => Number(each.getAttribute(name)));
        return [each.getAttribute("data-lane"), y, y! + height!] as const;
      });
    const recorded = new Map(shown(":not([data-other])").map(([lane, , bottom]) => [lane, bottom]));
    const changed = new Map(shown("[data-other]").map(([lane, top]) => [lane, top]));
    expect(changed.get("m")).toBeGreaterThan(recorded.get("m")!);
    expect(changed.get("m/b/more")).toBeGreaterThan(changed.get("m")!);
    expect(changed.get("m/b/inner")).toBeGreaterThan(changed.get("m/b/more")!);
    expect(svg.querySelectorAll(".lrp-timeline-name")).toHaveLength(3);
    expect(svg.querySelector(".lrp-timeline-divergence")).not.toBeNull();
    expect(svg.querySelector("[data-other] title")!.textContent).toMatch(/^With the edit: /);
    expect(laneAt(drawing({ other }), recorded.get("m")! - 1)!.machine).toBe("m");
    expect(laneAt(drawing({ other }), changed.get("m")! + 1)).toBeNull();
  });

  it("stripes a visit as the trail of its state is dashed", () => {
    const styleOf = (state: string) => ({ color: "red", dash: state === "m/b" ? [3, 3] : [] });
    const stripes = (state: string) =>
      drawn({ styleOf })
        .querySelector(`[data-lrp-visit="${state}"] > path`)!
        .getAttribute("stroke-dasharray");
    expect([stripes("m/a"), stripes("m/b")]).toEqual([null, "3 3"]);
    expect(drawn({ styleOf }).querySelectorAll(".lrp-timeline-visit > .lrp-timeline-hit")).toHaveLength(4);
  });

  it("leaves gaps in curves where there is no value, and draws truth as steps", () => {
    const base = { tick: 4, times: [0, 1, 2, 3], thresholds: new Map([["9", [9, 9, 9, 9]]]) };
    const number = { ...base, kind: "number" as const, values: [1, null, 3, 4] };
    const truth = { ...base, kind: "truth" as const, values: [1, 1, 0, 1], thresholds: new Map() };
    const svg = drawn({
      plots: [
        ["x", number],
        ["robot.bumper.data", truth],
      ],
    });
    expect(svg.querySelector(".lrp-timeline-curve")!.getAttribute("d")!.match(/M/g)).toHaveLength(2);
    expect(svg.querySelector(".lrp-timeline-limit")!.textContent).toBe("9");
    const [bands, curves] = [".lrp-timeline-truth", ".lrp-timeline-curve"].map((name) => [
      ...svg.querySelectorAll(name),
    ]);
    const top = Number(svg.querySelector("[data-lrp-plot^=robot]")!.getAttribute("y"));
    expect(bands).toHaveLength(1);
    const [on, off] = [top + 10, top + 34].map((y) => y.toFixed(1));
    expect(curves![1]!.getAttribute("d")).toBe(
      `M100.0 ${on}L150.0 ${on}L150.0 ${on}L200.0 ${on}L200.0 ${off}L250.0 ${off}L250.0 ${on}`,
    );
    const never = { ...truth, values: [0, 0, 0, 0] };
    const flat = drawn({ plots: [["button", never]] }).querySelector(".lrp-timeline-curve");
    expect(flat!.getAttribute("d")).toMatch(/^M100.0 (\d+.0)L.* \1L250.0 \1$/);
  });

  it("names thresholds where there is room, and no name lies over another or outside of its plot", () => {
    const values = [0, 100];
    const limits = ["2", "3", "4", "50", "99"].map((text) => [text, [Number(text), Number(text)]] as const);
    const plotted = { kind: "number" as const, tick: 2, times: [0, 1], values, thresholds: new Map() };
    for (const [text, samples] of limits) plotted.thresholds.set(text, samples);
    const svg = drawn({ plots: [["x", plotted]] });
    const plot = svg.querySelector("[data-lrp-plot]")!;
    const top = Number(plot.getAttribute("y"));
    const places = [...svg.querySelectorAll(".lrp-timeline-limit")].map((each) =>
      Number(each.getAttribute("y")),
    );
    expect(places).toHaveLength(4); // there is no room for a fifth
    expect(Math.min(...places)).toBeGreaterThan(top);
    expect(Math.max(...places)).toBeLessThan(top + Number(plot.getAttribute("height")));
    const apart = places.sort((a, b) => a - b).map((each, index) => each - (places[index - 1] ?? 0));
    expect(Math.min(...apart)).toBeGreaterThanOrEqual(10);
    const titles = [...svg.querySelectorAll(".lrp-timeline-threshold > title")].map(
      (each) => each.textContent,
    );
    expect(titles).toEqual(limits.map(([text]) => text));
  });

  it("draws marks where they can be told apart, and one for several says them all", () => {
    const mark = { kind: "edit" as const, tick: 1, time: 1, text: "The program was edited." };
    const marks = [
      mark,
      { ...mark, time: 1.01, text: "Again." },
      ...[5, 5.2, 5.4, 5.6].map((time) => ({ ...mark, time, text: "Typed." })),
      { ...mark, time: 50 },
    ];
    const shown = drawn({ marks }).querySelectorAll("[data-lrp-mark] > title");
    expect([...shown].map((title) => title.textContent)).toEqual([
      "1.0 s: The program was edited.\n1.0 s: Again.",
      "5.0 s: Typed.\n5.2 s: Typed.\n5.4 s: Typed.\n5.6 s: Typed.",
    ]);
  });

  it("has different numbers on its axis, however short the window is", () => {
    const axis = (from: number, to: number) =>
      [...drawn({ span: { from, to } }).querySelectorAll(".lrp-timeline-time")].map(
        (text) => text.textContent,
      );
    expect(axis(99.8, 100.35)).toEqual(["1:39.8", "1:39.9", "1:40.0", "1:40.1", "1:40.2", "1:40.3"]);
    expect(axis(50, 70)).toContain("1:05");
    expect(axis(0, 2)).toContain("0.5 s");
  });

  it("draws a long plot with a few points for each px, and misses no peak", () => {
    const times = Array.from({ length: 60000 }, (_, i) => i / 6000);
    const values = times.map((_, i) => (i === 31234 ? 9 : i % 2));
    const plotted = { kind: "number" as const, tick: 1, times, values, thresholds: new Map() };
    const svg = drawn({ plots: [["x", plotted]] });
    const points = svg.querySelector(".lrp-timeline-curve")!.getAttribute("d")!.split(/[ML]/).slice(1);
    expect(points.length).toBeLessThan(4 * 502);
    const y = Number(svg.querySelector(".lrp-timeline-plot")!.getAttribute("y"));
    expect(points.filter((point) => Number(point.split(" ")[1]) === y + 4)).toHaveLength(1); // at its upper edge
  });

  it("says the range of a plot", () => {
    const base = { kind: "number" as const, tick: 3, times: [0, 1, 2], thresholds: new Map() };
    const ranges = (values: number[]) =>
      drawn({ plots: [["x", { ...base, values }]] }).querySelector(".lrp-timeline-range")!.textContent;
    expect(ranges([0.123456, 7, 255])).toBe("0.1235 to 255");
    expect(ranges([3, 3, 3])).toBe("3");
  });
});

describe("changes", () => {
  it("are found before and after a tick, but for commands", () => {
    const happened = new Happened();
    const command = happening({ tick: 7, kind: "command", lane: "" });
    happened.merge(answer({ first: 2, happenings: [...RUN, command] }));
    expect([0, 3, 4, 5].map((tick) => happened.changeFrom(tick, true))).toEqual([3, 5, 5, null]);
    expect([9, 5, 3].map((tick) => happened.changeFrom(tick, false))).toEqual([5, 3, null]);
  });

  it("are the end of a visit and the beginning of the next, unless its machine ended", () => {
    const happened = new Happened();
    happened.merge(answer({ happenings: RUN }));
    const [outer, inner] = happened.lanes();
    expect(happened.after(outer!.segments[1]!)).toMatchObject({ by: "m:back" });
    expect(happened.after(outer!.segments[2]!)).toBeNull();
    expect(happened.after(inner!.segments[0]!)).toBeNull();
  });
});
