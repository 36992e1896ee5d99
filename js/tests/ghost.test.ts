// @vitest-environment happy-dom

import { beforeEach, describe, expect, it } from "vitest";
import type { Point, ReplyMessage, Waypoint, WhatIf, WorldView } from "../src/protocol";
import type { Question } from "../src/session/connection";
import type { Stepped } from "../src/session/state";
import { type Lab, Store } from "../src/session/store";
import { complete } from "../src/world/complete";
import { coursesOf, isOther } from "../src/world/courses";
import { ahead, ghostAt, paintGhost, partingOf, spread } from "../src/world/ghost";
import type { Palette } from "../src/world/palette";
import { firstPoses } from "../src/world/poses";
import { Preview } from "../src/world/preview";

/** A robot that drives along x by 0.1 m a second, from `begin` on. */
function course(begin: number, y = 1): WhatIf["changed"] {
  const way = Array.from({ length: 4 }, (_, i): Waypoint => [begin + i, 0.1 * (begin + i), y, 0]);
  return { happenings: [], tick: 10 * begin, way, touch: null, others: {}, solids: [] };
}

function whatIf(begin = 0, fields: Partial<WhatIf> = {}): WhatIf {
  return {
    tick: 10 * begin,
    begin,
    end: begin + 3,
    recorded: course(begin),
    changed: course(begin),
    divergence: null,
    open_loop: false,
    ...fields,
  };
}

describe("a ghost", () => {
  const way = [
    [1, 0, 0, 3.1],
    [2, 1, 2, -3.1],
    [2.5, 1, 3, -3],
  ];

  it("is between two poses in proportion to the time, and turns the short way round", () => {
    const [x, y, theta] = ghostAt(way, 1.25)!;
    expect([x, y]).toEqual([0.25, 0.5]);
    expect(theta).toBeCloseTo(3.1 + (2 * Math.PI - 6.2) / 4);
    expect(ghostAt(way, 1)).toEqual([0, 0, 3.1]);
    expect(ghostAt(way, 2.5)!.slice(0, 2)).toEqual([1, 3]);
  });

  it("is nowhere before its way and after it", () => {
    expect([ghostAt(way, 0.9), ghostAt(way, 2.6), ghostAt([], 1)]).toEqual([null, null, null]);
  });

  it("has the rest of its way ahead", () => {
    expect(ahead(way, 2.25).map(([x, y]) => [x, y])).toEqual([
      [1, 2.5],
      [1, 3],
    ]);
    expect(ahead(way, 0)).toHaveLength(3);
    expect(ahead(way, 3)).toEqual([]);
  });

  it("parts from the recorded way where the first difference is", () => {
    const divergence = { tick: 20, time: 2, text: "`b` is entered, unlike before.", lane: "" };
    expect(partingOf(whatIf(0, { divergence }))).toEqual([0.2, 1]);
    expect(partingOf(whatIf(3, { divergence }))).toEqual([expect.closeTo(0.3), 1]); // before the first pose
    expect(partingOf(whatIf())).toBeNull();
  });
});

describe("a preview", () => {
  let store: Store;
  let preview: Preview;
  let foretells: { on: boolean };
  let questions: { question: Question; resolve: (reply: Partial<ReplyMessage>) => void }[];
  const asked = ({ question }: { question: Question }) => question.type;
  const frames = () => new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve, 5)));
  const set = async (fields: Partial<Store["state"]>) => {
    Object.assign(store.state, fields);
    store.touch(Object.keys(fields) as (keyof Store["state"])[]);
    await frames();
  };
  const answer = async (fields: Partial<ReplyMessage>) => {
    questions.shift()!.resolve(fields);
    await frames();
  };

  beforeEach(async () => {
    store = new Store();
    questions = [];
    foretells = { on: true };
    const ask = (question: Question) => new Promise((resolve) => questions.push({ question, resolve }));
    preview = new Preview({ store, ask, closed: new AbortController().signal } as unknown as Lab, foretells, {
      calm: 0,
      rest: 0,
    });
    Object.assign(store.state, { status: "running", time: 5, revision: 1, world: {} });
    store.touch(["snapshot", "status", "time", "revision", "world"]);
    await frames();
    expect(questions).toEqual([]); // nothing was edited
    await set({ revision: 2 });
  });

  it("is asked for after an edit, shown, and removed at its end", async () => {
    expect(questions).toHaveLength(1);
    await answer({ what_if: whatIf(5) });
    expect(store.state.whatIf).toEqual(whatIf(5));
    await set({ time: 7.9 });
    expect(store.state.whatIf).not.toBeNull();
    await set({ time: 8 });
    expect(store.state.whatIf).toBeNull();
  });

  it("is asked for once at a time, and then about the newest edit", async () => {
    await set({ revision: 3 });
    await set({ revision: 4 });
    expect(questions).toHaveLength(1);
    await answer({ what_if: whatIf(5) });
    expect([store.state.whatIf, questions.length]).toEqual([null, 1]);
    await answer({ what_if: whatIf(5.5) });
    expect([store.state.whatIf?.begin, questions.length]).toEqual([5.5, 0]);
  });

  it("that comes late, or not at all, ends the one before; the first is said for a while", async () => {
    for (const [reply, said] of [
      [{ what_if: whatIf(5) }, "too long to compute"],
      [{ error: "There is no simulated robot." }, ""],
    ] as const) {
      await answer({ what_if: whatIf(store.state.time) });
      expect(store.state.whatIf).not.toBeNull();
      expect(store.state.unforetold).toBe("");
      await set({ revision: store.state.revision + 1, time: 7.1 });
      await answer(reply);
      expect(store.state.whatIf).toBeNull();
      expect(store.state.unforetold).toContain(said);
      await set({ time: 10.2 });
      expect(store.state.unforetold).toBe("");
      await set({ revision: store.state.revision + 1 });
    }
  });

  it("that comes while it still foretells something is shown", async () => {
    await set({ time: 6.9 });
    await answer({ what_if: whatIf(5) });
    expect([store.state.whatIf?.begin, store.state.unforetold]).toEqual([5, ""]);
  });

  it("ends where the robot goes another way, is set back, or an earlier moment is looked at", async () => {
    const shown = async () => {
      await answer({ what_if: whatIf(store.state.time) });
      expect(store.state.whatIf).not.toBeNull();
    };
    await shown();
    preview.check([0.55, 1, 0]);
    expect(store.state.whatIf).not.toBeNull();
    preview.check([0.9, 1, 0]);
    expect(store.state.whatIf).toBeNull();
    await set({ revision: 3 });
    await shown();
    await set({ time: 4.9 });
    expect(store.state.whatIf).toBeNull();
    await set({ revision: 4 });
    await shown();
    await set({ looking: { tick: 10, time: 1, ago: 4, edited: false } });
    expect(store.state.whatIf).toBeNull();
  });

  it("is not asked for when it is off, at a past moment, of a real robot, or before the start", async () => {
    await answer({ what_if: whatIf(5) });
    foretells.on = false;
    preview.check();
    expect(store.state.whatIf).toBeNull();
    await set({ revision: 3 });
    foretells.on = true;
    await set({ revision: 4, looking: { tick: 10, time: 1, ago: 4, edited: true } });
    await set({ revision: 5, looking: null, world: null });
    await set({ revision: 6, world: {} as WorldView, status: "ready" });
    expect(questions).toEqual([]);
  });

  describe("of a number that is stepped through", () => {
    const stepped = (now: string): Stepped => ({ values: ["1", now, `${now}1`], programs: ["p", now, "q"] });
    const courses = (...y: number[]) =>
      y.map((each) => whatIf(store.state.time, { recorded: course(5, y[0]), changed: course(5, each) }));
    const shown = () => store.state.whatIf?.tried?.values[1];

    beforeEach(async () => {
      await answer({});
      await set({ stepped: stepped("2") });
    });

    it("has all three courses, by one question, and its edits ask no other", async () => {
      await set({ revision: 3 });
      expect(questions.map(({ question }) => question)).toEqual([
        { type: "try_programs", programs: ["p", "2", "q"], seconds: 3 },
      ]);
      await answer({ what_ifs: courses(1, 2, 3) });
      expect(store.state.whatIf?.tried).toEqual({ values: ["1", "2", "21"], beyond: course(5, 3) });
      await set({ revision: 4 });
      expect(questions).toEqual([]);
      await set({ stepped: null, revision: 5 });
      expect(questions.map(asked)).toEqual(["what_if"]);
    });

    it("stays until that of the next step comes, which may be late", async () => {
      await set({ stepped: stepped("3") });
      await set({ stepped: stepped("4") });
      await answer({ what_ifs: courses(1, 2, 3) });
      expect([shown(), questions.length]).toEqual(["2", 1]);
      await answer({ what_ifs: courses(1, 2, 3) });
      expect([shown(), questions.length]).toEqual(["4", 0]);
    });

    it("is asked for again, once, before it is over", async () => {
      await answer({ what_ifs: courses(1, 2, 3) });
      await set({ time: 6.6 });
      await set({ time: 6.7 });
      expect([shown(), questions.length]).toEqual(["2", 1]);
      await answer({ what_ifs: courses(1, 2, 3) });
      expect([store.state.whatIf?.begin, questions.length]).toEqual([6.7, 0]);
    });

    it("is nothing where the number makes no difference, which is said, or the program is wrong", async () => {
      await answer({ what_ifs: courses(1, 2, 3) });
      await set({ stepped: stepped("1") });
      await answer({ what_ifs: courses(1, 1, 1) });
      expect(store.state.whatIf).toBeNull();
      expect(store.state.unforetold).toBe("The next 3 s are the same with 1, 11.");
      await set({ stepped: stepped("2") });
      await answer({ error: "A bracket is missing." });
      expect([store.state.whatIf, store.state.unforetold]).toEqual([null, ""]);
    });

    it("is withheld in a quiet lab, and while edits wait", async () => {
      await answer({});
      const { settings } = store.state;
      await set({ stepped: stepped("3"), settings: { ...settings, quiet: true } });
      await set({ stepped: stepped("4"), settings: { ...settings, edits: "hold" } });
      expect(questions).toEqual([]);
      await set({ revision: 3 }); // now they are applied
      expect(questions.map(asked)).toEqual(["what_if"]);
    });
  });

  it("leaves alone what was asked about the past", async () => {
    const past = whatIf(1, {
      divergence: { tick: 20, time: 2, text: "The robot takes another way.", lane: "" },
    });
    await answer({ what_if: whatIf(5) });
    await set({ looking: { tick: 10, time: 1, ago: 4, edited: true }, whatIf: past, time: 1 });
    preview.check([2, 2, 0]);
    await set({ revision: 3, time: 0.5 });
    expect(store.state.whatIf).toBe(past);
  });
});

describe("the courses of a number that is stepped through", () => {
  const palette = {} as Palette;
  const tried = (before: string, now: string, beyond: string) =>
    coursesOf({ ...whatIf(), tried: { values: [before, now, beyond], beyond: course(0, 2) } }, palette);

  it("are told apart, this one on top, and each value has one", () => {
    const names = (values: [string, string, string]) => tried(...values).map(({ name }) => name);
    expect(names(["1", "2", "3"])).toEqual(["next 3", "before 1", "now 2"]);
    expect(names(["1", "1", "0"])).toEqual(["next 0", "now 1"]);
    expect(names(["1", "2", "1"])).toEqual(["before 1", "now 2"]);
    const drawn = tried("1", "2", "3").map(({ dash, color }) => `${dash} ${color}`);
    expect(new Set(drawn).size).toBe(3);
  });

  it("differ where a robot or a solid goes another way", () => {
    const one = course(0);
    expect(isOther(one, course(0, 1.001))).toBe(false);
    expect(isOther(one, course(0, 1.1))).toBe(true);
    expect(isOther({ ...one, others: { b: one.way } }, { ...one, others: { b: course(0, 2).way } })).toBe(
      true,
    );
    expect(isOther({ ...one, solids: [[0, [1, 1, 0]]] }, { ...one, solids: [[0, [1, 1.1, 0]]] })).toBe(true);
  });

  it("have labels that do not lie on each other", () => {
    expect(spread([5, 1], 2)).toEqual([5, 1]);
    expect(spread([1, 1, 1], 2)).toEqual([3, 1, -1]);
  });
});

describe("what is foretold of a world", () => {
  it("is painted for every robot, and for solids that will be elsewhere", () => {
    const world = complete({
      ...{ version: 1, size: [3, 2], seed: 0, floor: {}, zones: {} },
      robots: [{ pose: [0, 0, 0] }, { pose: [0, 1, 0] }],
      solids: [
        { box: [1, 1, 0.1, 0.1], patrol: [[1, 1] as Point, [2, 1] as Point] },
        { box: [2, 2, 0.1, 0.1], push: 0.3 },
      ],
    });
    const now = { ...firstPoses(world), time: 0 };
    const way = (y: number) => [0, 1, 2].map((time) => [time, 0.1 * time, y, 0]);
    const changed = {
      ...{ happenings: [], way: way(0), others: { other: way(1) } },
      solids: [
        [0, [1.5, 1, 0]],
        [1, [2, 2, 0]],
      ],
    };
    const whatIf = { changed, recorded: changed, divergence: null } as unknown as WhatIf;
    const palette = { others: [{ robot: "orange" }], robot: "blue" } as unknown as Palette;
    const moves: number[][] = [];
    const fills = new Set<unknown>();
    const c = new Proxy({} as Record<string, unknown>, {
      get: (_, name) => (name === "translate" ? (...at: number[]) => moves.push(at) : () => {}),
      set: (_, name, value) => name !== "fillStyle" || Boolean(fills.add(value)),
    });
    paintGhost({ c: c as unknown as CanvasRenderingContext2D, palette, pixels: 100 }, world, whatIf, now);
    expect(moves).toEqual([
      [1.5, 1],
      [0.2, 0],
      [0.2, 1],
    ]);
    expect([...fills]).toContain("orange");
    expect([...fills]).toContain("blue");
  });
});
