// @vitest-environment happy-dom

import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import type { Point, WorldView } from "../src/protocol";
import type { Act } from "../src/session/connection";
import { type Lab, Store } from "../src/session/store";
import { Looking } from "../src/timeline/looking";
import { WorldEdits } from "../src/world/edits";
import { legend, trailStyles } from "../src/world/legend";
import { ofRobot, type Palette } from "../src/world/palette";
import { Stage } from "../src/world/stage";
import { type Tool, useTools } from "../src/world/tools";

const view: WorldView = {
  version: 1,
  name: "one",
  size: [3, 2],
  seed: 0,
  floor: {},
  solids: [{ box: [2, 1, 0.4, 0.4], angle: 0 }],
  robots: [{ pose: [0.5, 1, 0] }],
  zones: {},
};

let stage: Stage;
let edits: WorldEdits;
let acts: Act[];
let reply: () => Promise<string | null>;
let looking: Looking;
let captured: Set<number>;
beforeEach(() => {
  acts = [];
  const send = (act: Act) => void acts.push(act);
  const act = (act: Act) => {
    send(act);
    return reply();
  };
  reply = async () => null;
  stage = new Stage(() => ({}) as Palette, { on: false }, { on: true });
  document.body.replaceChildren(stage.canvas);
  captured = new Set();
  stage.canvas.setPointerCapture = (id) => void captured.add(id);
  stage.canvas.hasPointerCapture = (id) => captured.has(id);
  stage.canvas.releasePointerCapture = (id) => void captured.delete(id);
  const lab = { act, send, store: new Store(), root: document.body } as unknown as Lab;
  looking = new Looking(lab);
  edits = new WorldEdits(stage, lab, looking, () => {});
  const tool: Tool = "move";
  useTools(stage, edits, { tool, choose: () => {}, grid: () => {}, follow: () => {} });
  stage.show(view);
});

/** A pointer at a place of the world, in metres. */
function point(type: string, x: number, y: number, pointerId = 1): void {
  const [clientX, clientY] = stage.viewport.outside([x, y]);
  const event = new PointerEvent(type, { pointerId, clientX, clientY, button: 0, buttons: 1, bubbles: true });
  stage.canvas.dispatchEvent(event);
}

const press = (key: string) =>
  stage.canvas.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));

describe("a finger in the world", () => {
  const finger = (type: string, clientX: number, clientY: number) =>
    stage.canvas.dispatchEvent(
      new PointerEvent(type, { pointerType: "touch", clientX, clientY, buttons: 1, bubbles: true }),
    );

  it("scrolls from free floor, and grabs a thing that it hits about", () => {
    const { place } = stage.viewport;
    const [x, y] = stage.viewport.outside([1.2, 0.4]);
    finger("pointerdown", x, y);
    finger("pointermove", x + 40, y);
    expect([stage.viewport.place, stage.busy]).toEqual([place, false]);
    const [left, middle] = stage.viewport.outside([1.8, 1]);
    finger("pointerdown", left - 15, middle);
    finger("pointermove", left + 40, middle);
    expect(stage.draftOf({ kind: "solid", index: 0 })).not.toBeNull();
    finger("pointercancel", left, middle);
  });
});

describe("a drag in the world", () => {
  it("takes what is shown in its place, also before the kernel has answered the last one", () => {
    reply = () => new Promise(() => {});
    for (const [from, to] of [
      [0.5, 1.5],
      [0.5, 1],
    ] as const) {
      point("pointerdown", from, 1);
      point("pointermove", to, 1);
      point("pointerup", to, 1);
    }
    expect(acts.at(-1)).toMatchObject({ do: "set_start", index: 0, pose: [1, 1, 0] });
    expect(stage.shape({ kind: "robot", index: 0 })?.x).toBe(1.5);
  });

  it("ends with Escape: the thing is where it was, and the pointer is free", () => {
    point("pointerdown", 2, 1);
    point("pointermove", 2.5, 1);
    expect(captured).toEqual(new Set([1]));
    press("Escape");
    expect([...captured, stage.busy, stage.draftOf({ kind: "solid", index: 0 })]).toEqual([false, null]);
    point("pointerup", 2.5, 1);
    expect(acts.filter((act) => act.do === "put_solid")).toEqual([]);
  });

  it("adds another thing, also before the kernel has answered the last one", () => {
    reply = () => new Promise(() => {});
    const wall = { x: 1, y: 1, angle: 0, box: [0.6, 0.04] as Point };
    const box = { x: 2, y: 1.5, angle: 0, box: [0.2, 0.2] as Point };
    edits.add("wall", wall);
    edits.add("box", box);
    expect(stage.selected && stage.shape(stage.selected)).toEqual(box);
    expect(stage.shape({ kind: "solid", index: 1 })).toEqual(wall);
  });

  it("that ends with Escape leaves an edit that the kernel has not answered as it is shown", () => {
    reply = () => new Promise(() => {});
    edits.put({ kind: "solid", index: 0 }, { x: 2.2, y: 1, angle: 0, box: [0.4, 0.4] });
    point("pointerdown", 2.2, 1);
    point("pointermove", 2.5, 1);
    press("Escape");
    expect(stage.shape({ kind: "solid", index: 0 })?.x).toBe(2.2);
  });

  it("that ends with Escape before the pointer has moved leaves the robot alone, which may drive", () => {
    point("pointerdown", 0.5, 1);
    press("Escape");
    expect(acts).toEqual([]);
  });

  it("that moves the view ends with Escape where it began, and the robot is followed as before", () => {
    for (const follows of [true, false]) {
      stage.follows = follows;
      const before = stage.viewport.inside(0, 0);
      point("pointerdown", 1.2, 1.8);
      point("pointermove", 1.6, 1.2);
      expect([stage.follows, stage.viewport.inside(0, 0)]).not.toEqual([follows, before]);
      press("Escape");
      expect(stage.follows).toBe(follows);
      expect(stage.viewport.inside(0, 0)).toEqual(before.map((place) => expect.closeTo(place)));
    }
    expect([acts, stage.selected]).toEqual([[], null]);
  });

  it("is not disturbed by a second finger, nor by keys", () => {
    point("pointerdown", 2, 1);
    point("pointermove", 2.5, 1);
    point("pointermove", 0.2, 0.2, 2);
    point("pointerup", 0.2, 0.2, 2);
    press("ArrowLeft");
    press("Delete");
    point("pointerup", 2.5, 1);
    const put = acts.filter((act) => act.do === "put_solid");
    expect(put).toMatchObject([{ box: [2.5, 1, 0.4, 0.4] }]);
    expect(acts.map((act) => act.do)).not.toContain("remove_solid");
  });
});

it("a zone, which has no angle, is not edited by the keys that turn", () => {
  stage.show({ ...view, zones: { goal: { box: [1, 1, 0.5, 0.5] } } });
  edits.select({ kind: "zone", name: "goal" });
  press("]");
  edits.flush();
  expect([acts, edits.nudge("]", false)]).toEqual([[], false]);
  press("ArrowLeft");
  edits.flush();
  expect(acts.map((act) => act.do)).toEqual(["put_zone"]);
});

describe("a thing that was just placed", () => {
  const wall = (x: number) => ({ ...view, solids: [...view.solids!, { box: [x, 1, 0.4, 0.1], angle: 0 }] });
  const where = () => stage.shape({ kind: "solid", index: 1 })?.x;

  it("is moved by every key, however late the kernel describes it", async () => {
    vi.useFakeTimers();
    const replies: (() => void)[] = [];
    reply = () => new Promise((resolve) => replies.push(() => resolve(null)));
    edits.add("wall", { x: 1, y: 1, angle: 0, box: [0.4, 0.1] });
    press("ArrowRight");
    vi.advanceTimersByTime(2000); // longer than between two moves of which one edit is made
    press("ArrowRight");
    stage.show(wall(1)); // as it was placed
    replies[0]!();
    await vi.advanceTimersByTimeAsync(2000);
    press("ArrowRight");
    expect(where()).toBeCloseTo(1.06);
    vi.useRealTimers();
  });

  it("keeps what was done to it when another one is placed and both are moved, however slow the link is", async () => {
    const replies: (() => void)[] = [];
    reply = () => new Promise((resolve) => replies.push(() => resolve(null)));
    edits.add("box", { x: 1, y: 1, angle: 0, box: [0.2, 0.2] });
    const other = { ...view, solids: [...view.solids!, { box: [1, 1, 0.2, 0.2], angle: 0, push: 0.3 }] };
    stage.show(other as WorldView);
    edits.nudge("ArrowRight", false);
    edits.nudge("ArrowUp", true);
    edits.add("zone", { x: 2, y: 1, angle: 0, radius: 0.2 });
    edits.nudge("ArrowRight", false);
    edits.select({ kind: "solid", index: 1 });
    edits.nudge("ArrowUp", false);
    edits.flush();
    const put = acts.filter((act) => act.do === "put_solid");
    expect(put.at(-1)).toMatchObject({ index: 1, box: [1.02, 1.02, 0.2, 0.22] });
    for (const answer of replies) answer();
    await vi.waitFor(() => expect(where()).toBe(1)); // as the kernel has described it last
  });

  it("is where the kernel describes it as soon as it has replied", async () => {
    edits.add("wall", { x: 1, y: 1, angle: 0, box: [0.4, 0.1] });
    stage.show(wall(1.2)); // another hand has moved it
    await vi.waitFor(() => expect(stage.draftOf({ kind: "solid", index: 1 })).toBe(null));
    expect(where()).toBe(1.2);
  });

  it("that does not move by itself is where the newest description says", () => {
    stage.show(wall(1));
    stage.show(wall(1.3));
    expect(where()).toBe(1.3);
  });
});

it("the robot is moved by every key, also by those that come before a frame shows where it is", async () => {
  const replies: (() => void)[] = [];
  reply = () => new Promise((resolve) => replies.push(() => resolve(null)));
  for (let i = 0; i < 3; i++) press("ArrowRight");
  stage.move({ ...stage.latest!, time: 1 }, 1, ""); // of a moment before the kernel knew of it
  for (const answer of replies) answer();
  await vi.waitFor(() => expect(stage.isHeld).toBe(false));
  press("ArrowRight");
  expect(acts.at(-1)).toMatchObject({ do: "drag_robot", pose: [expect.closeTo(0.58), 1, 0] });
  replies.at(-1)!();
  await vi.waitFor(() => expect(stage.isHeld).toBe(false));
  stage.move({ ...stage.latest!, time: 2 }, 2, "");
  expect(stage.draftOf({ kind: "robot", index: 0 })).toBe(null); // it may drive from there
});

it("the robot's start is where it was just put, also before a frame shows it there", () => {
  press("ArrowRight");
  edits.startHere();
  expect(acts.at(-1)).toEqual({ do: "set_start", index: 0, pose: [expect.closeTo(0.52), 1, 0] });
});

describe("the trail", () => {
  beforeEach(() => {
    const robots = (x: number) => [
      { ...stage.latest!.robots[0]!, pose: [x, 1.5, 0] as [number, number, number] },
    ];
    for (let i = 0; i <= 10; i++)
      stage.move({ ...stage.latest!, time: i, robots: robots(0.5 + i / 10) }, i, "m/a");
  });

  it("leads to the moment at which the robot was where it is clicked, and the playhead goes there", () => {
    point("pointerdown", 0.85, 1.5);
    point("pointerup", 0.85, 1.5);
    expect(acts).toEqual([{ do: "look", time: expect.closeTo(3.5) }]);
    expect(looking.wanted).toEqual({ time: expect.closeTo(3.5) });
  });

  it("does not lead anywhere with a drag, nor when it is hidden", () => {
    point("pointerdown", 0.85, 1.5);
    point("pointermove", 1.25, 1.8);
    point("pointerup", 1.25, 1.8);
    stage.showsTrail.on = false;
    point("pointerdown", 0.85, 1.5);
    point("pointerup", 0.85, 1.5);
    expect(acts).toEqual([]);
  });

  it("stays as it is while an earlier moment is looked at, and is shortened by a rewind", () => {
    const { points } = stage.trail;
    stage.isPast = true;
    stage.move({ ...stage.latest!, time: 3 }, 20, "m/a");
    expect(stage.trail.points).toEqual(points);
    expect(stage.trail.points).toHaveLength(11);
    stage.isPast = false;
    stage.move({ ...stage.latest!, time: 3.5 }, 21, "m/a");
    expect(stage.trail.points.map(({ time }) => time)).toEqual([0, 1, 2, 3, 3.5]);
  });
});

describe("while an earlier moment is looked at", () => {
  beforeEach(() => {
    stage.isPast = true;
  });

  it("a drag leads to the present and moves nothing", () => {
    for (const x of [0.5, 2]) {
      point("pointerdown", x, 1);
      point("pointermove", x + 0.1, 1);
      stage.isPast = false; // the present has come
      point("pointermove", x + 0.4, 1);
      point("pointerup", x + 0.4, 1);
      expect(acts).toEqual([{ do: "look" }]);
      acts = [];
      stage.isPast = true;
    }
  });

  it("so does an edit by keyboard, or from a menu", async () => {
    press("ArrowLeft");
    edits.undo();
    edits.startHere();
    edits.add("wall", { x: 1, y: 1, angle: 0, box: [1, 0.1] });
    expect(new Set(acts.map((act) => act.do))).toEqual(new Set(["look"]));
    expect([stage.busy, stage.selected]).toEqual([false, null]);
    expect(stage.draftOf({ kind: "solid", index: 1 })).toBe(null);
  });

  it("a click selects, and the view can be moved", () => {
    point("pointerdown", 2, 1);
    point("pointerup", 2, 1);
    point("pointerdown", 1.2, 1.8);
    point("pointermove", 1.6, 1.2);
    point("pointerup", 1.6, 1.2);
    expect([acts, stage.selected]).toEqual([[], { kind: "solid", index: 0 }]);
  });
});

describe("a stage", () => {
  beforeEach(() => {
    Object.defineProperty(stage.canvas, "clientWidth", { value: 200 });
    Object.defineProperty(stage.canvas, "clientHeight", { value: 100 });
    stage.resize();
  });
  afterEach(() => vi.unstubAllGlobals());

  it("does not follow the robot again because its size changes", () => {
    expect(stage.follows).toBe(true); // it would be too small to be seen
    stage.follows = false;
    stage.resize();
    expect(stage.follows).toBe(false);
  });

  it("is as sharp as the screen to which its window has been moved", async () => {
    expect(stage.canvas.width).toBe(200);
    vi.stubGlobal("devicePixelRatio", 2);
    stage.wake();
    await vi.waitFor(() => expect(stage.canvas.width).toBe(400));
  });
});

it("a selection is not that of another world, whose things have the same numbers", () => {
  edits.select({ kind: "solid", index: 0 });
  stage.show({ ...view, solids: [...view.solids!] });
  expect(stage.selected).toEqual({ kind: "solid", index: 0 });
  stage.show({ ...view, name: "other" });
  expect(stage.selected).toBe(null);
});

describe("two robots", () => {
  const two: WorldView = {
    ...view,
    name: "two",
    robots: [
      { pose: [0.5, 1, 0], name: "leader" },
      { pose: [1.5, 0.5, 0], name: "follower" },
    ],
  };

  it("are each given the start where it is, the first one if none is selected", () => {
    stage.show(two);
    edits.select({ kind: "robot", index: 1 });
    edits.startHere();
    edits.select(null);
    edits.startHere();
    expect(acts).toEqual([
      { do: "set_start", index: 1, pose: [1.5, 0.5, 0] },
      { do: "set_start", index: 0, pose: [0.5, 1, 0] },
    ]);
  });

  it("have colours of their own, which come again", () => {
    const first = { robot: "blue", robotEdge: "navy", mark: "azure" };
    const second = { robot: "orange", robotEdge: "brown", mark: "ochre" };
    const palette = { ...first, others: [second] } as unknown as Palette;
    expect([0, 1, 2, 3].map((index) => ofRobot(palette, index).robot)).toEqual([
      "blue",
      "orange",
      "blue",
      "orange",
    ]);
  });
});

it("the legend has the order of the program, whichever state the robot was in first", () => {
  const states = ["a", "b"].map((name) => ({ path: `m/${name}`, machines: [] }));
  const machine = { path: "m", parent: null, states, transitions: [], variables: [], events: [] };
  const program = { variables: [], events: [], machines: [machine], main: "m" };
  stage.styleOf = trailStyles(program, ["red", "blue"]);
  const { element, refresh } = legend(stage, () => program);
  for (const [time, state] of ["", "m/gone", "m/b", "m/a"].entries())
    stage.trail.add(time, [time / 10, 0, 0], state);
  stage.latest = { ...stage.latest!, time: 3 };
  refresh();
  expect([...element.children].map(({ textContent }) => textContent)).toEqual(["a", "b", "gone"]);
});

it("the name of a zone at the side of the world is all within it", async () => {
  const done: [string | symbol, unknown][] = [];
  const c = new Proxy(
    {},
    { get: (_, name) => (value: unknown) => done.push([name, value]), set: () => true },
  );
  const [width] = view.size;
  stage.show({ ...view, zones: { "before the wall": { circle: [width, 1, 0.2] } } });
  stage.palette = { others: [] } as unknown as Palette;
  stage.canvas.getContext = (() => c) as never;
  stage.canvas.width = 300;
  stage.wake();
  const written = () => done.findIndex(([name, text]) => name === "fillText" && text === "before the wall");
  await vi.waitFor(() => expect(written()).toBeGreaterThan(0));
  const [, middle] = done.slice(0, written()).findLast(([name]) => name === "translate")!;
  expect(middle).toBeLessThan(width - 0.06 * 4); // letters of 6 cm, half as wide, on both sides of it
});

it("no trail hides the name of a zone, and no wall the scale bar", async () => {
  const done: string[] = [];
  const note = (name: string | symbol, value: unknown) => void done.push(`${String(name)} ${value}`);
  const c = new Proxy(
    {},
    {
      get: (_, name) => (value: unknown) => note(name, value),
      set: (_, name, value) => {
        note(name, value);
        return true;
      },
    },
  );
  stage.show({ ...view, zones: { goal: { circle: [1, 1, 0.2] } } });
  stage.palette = { others: [] } as unknown as Palette;
  stage.styleOf = () => ({ color: "orange", dash: [] });
  for (const time of [1, 2]) stage.trail.add(time, [time / 10, 1, 0], "m/a");
  stage.latest = { ...stage.latest!, time: 2 };
  stage.canvas.getContext = (() => c) as never;
  stage.canvas.width = 300;
  stage.wake();
  await vi.waitFor(() => expect(done).toContain("fillText goal"));
  expect(done).toContain("strokeStyle orange");
  expect(done.indexOf("fillText goal")).toBeGreaterThan(done.lastIndexOf("strokeStyle orange"));
  const bar = done.findIndex((each) => /^fillText \d+ (c?m)$/.test(each));
  expect(bar).toBeGreaterThan(done.indexOf("rect -0.2"));
});
