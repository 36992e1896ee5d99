// @vitest-environment happy-dom

import { EditorState } from "@codemirror/state";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { subjectAt } from "../src/editor/history";
import { lrp } from "../src/language/lrp";
import { glances } from "../src/parts/glance";
import { history, openHistory } from "../src/parts/history";
import type { Plot } from "../src/protocol";
import { type Lab, Store } from "../src/session/store";
import { ofEvent, ofVariable } from "../src/timeline/spark";
import { h } from "../src/ui/dom";

const LIGHT: Plot = {
  name: "robot.light.data",
  kind: "number",
  times: [8, 9, 10],
  values: [90, 120, 200],
  thresholds: [{ text: "lightlim + 10", values: [138, 138, 138] }],
};

describe("the value of a name", () => {
  const TEXT = `(var limit := [5])
(machine m
  (var n := [0])
  (event over [n > limit + 1 and robot.light.data > 3])
  (state a (running [n += robot.light.data]))
  (on over a -> a))`;
  const store = new Store();
  store.state.bridge = {
    ...store.state.bridge,
    members: ["variable", "method"].map((kind) => ({
      ...{ kind, name: kind === "method" ? "stop" : "light.data" },
      ...{ type: "", unit: "", doc: "", insert: "" },
    })),
  };
  const state = EditorState.create({ doc: TEXT, extensions: [lrp()] });
  const at = (part: string, inside: number) =>
    subjectAt({ store } as unknown as Lab, state, TEXT.indexOf(part) + inside);

  it("is that of what it means there, with the condition in which it stands", () => {
    expect(at("limit + 1", 1)).toEqual({ names: ["limit"], event: "m/over" });
    expect(at("n > ", 0)).toEqual({ names: ["m/n"], event: "m/over" });
    expect(at("light.data > 3", 2)).toEqual({ names: ["robot.light.data"], event: "m/over" });
    expect(at("light.data]", 2)).toEqual({ names: ["robot.light.data"], event: "" });
    expect(at("var n", 4)).toEqual(ofVariable("m/n"));
    expect(at("event over", 7)).toEqual(ofEvent("m/over"));
    expect(at("on over", 4)).toEqual(ofEvent("m/over"));
    expect(at("state a", 1)).toBeNull();
  });
});

describe("a value", () => {
  let lab: Lab;
  let asked: Record<string, unknown>[];
  let value: HTMLElement;
  const closing = new AbortController();
  const card = () => lab.root.querySelector(".lrp-history-card");
  const point = (type: string, target: Element = value, pointerType = "mouse") =>
    target.dispatchEvent(new PointerEvent(type, { pointerType, bubbles: true }));
  const later = (ms: number) => vi.advanceTimersByTimeAsync(ms);

  beforeEach(() => {
    vi.useFakeTimers();
    const store = new Store();
    store.state.time = 10;
    asked = [];
    const ask = async (question: Record<string, unknown>) => {
      asked.push(question);
      return { plots: [LIGHT] };
    };
    const root = h("div", { class: "lrp-lab" });
    document.body.append(root);
    lab = { store, ask, root, closed: closing.signal, tell: () => {} } as unknown as Lab;
    value = h("span", history(ofEvent("m/over")), "False");
    root.append(value, h("p", {}, "text"));
    glances(lab);
  });

  afterEach(() => {
    lab.store.close();
    lab.root.remove();
    vi.useRealTimers();
  });

  it("shows its last half minute with its threshold, and follows it, while the pointer rests on it", async () => {
    point("pointermove");
    await later(200);
    expect(card()).toBeNull();
    await later(100);
    expect(asked).toEqual([{ type: "plots", names: [], event: "m/over", seconds: 30 }]);
    expect(card()?.querySelectorAll(".lrp-timeline-curve, .lrp-timeline-threshold")).toHaveLength(2);
    expect(card()?.textContent).toContain("lightlim + 10");
    const words = "robot.light.data: 90 to 200, now 200; lightlim + 10: 138";
    expect(card()?.querySelector("[role=img]")?.getAttribute("aria-label")).toBe(words);
    lab.store.set("tick", 5);
    await later(400);
    expect(asked).toHaveLength(2);
    point("pointerover", lab.root.lastElementChild!);
    await later(200);
    lab.store.set("tick", 6);
    await later(1000);
    expect([card(), asked.length]).toEqual([null, 2]);
  });

  it("asks for the half minute before the moment that is looked at", async () => {
    lab.store.set("looking", { tick: 80, time: 8, ago: 2, edited: false });
    point("pointermove");
    await later(300);
    expect(asked[0]).toMatchObject({ seconds: 32 });
  });

  it("is left alone while one types, and in a quiet lab", async () => {
    point("pointermove");
    await later(300);
    lab.root.dispatchEvent(new KeyboardEvent("keydown", { key: "a" }));
    point("pointerover"); // the text has moved, not the pointer
    await later(1000);
    expect(card()).toBeNull();
    lab.store.state.settings = { ...lab.store.state.settings, quiet: true };
    point("pointermove");
    await later(1000);
    value.click();
    await later(100);
    expect([card(), lab.store.state.plots]).toEqual([null, []]);
  });

  it("is pinned by a click, and removed by another; the pointer need not have rested on it", async () => {
    value.click();
    await later(0);
    expect(lab.store.state.plots).toEqual(["robot.light.data"]);
    point("pointermove");
    await later(300);
    expect(card()?.textContent).toContain("In the timeline");
    value.click();
    expect(lab.store.state.plots).toEqual([]);
  });

  it("opens a card that stays, where a finger or a key asks for it", async () => {
    point("pointerdown", value, "touch");
    value.click();
    await later(0);
    const button = lab.root.querySelector<HTMLButtonElement>('[role="dialog"] [data-lrp-action="pin"]')!;
    button.click();
    await later(20);
    expect(lab.store.state.plots).toEqual(["robot.light.data"]);
    expect(button.getAttribute("aria-pressed")).toBe("true");
    openHistory(lab, ofVariable("m/n"), { x: 0, y: 0 });
    await later(0);
    expect(lab.root.querySelectorAll('[role="dialog"] .lrp-timeline-curve')).toHaveLength(1);
    expect(lab.root.querySelector('[data-lrp-action="pin"]')?.getAttribute("aria-pressed")).toBe("true");
  });

  it("that is not a number shows nothing, and says so where it was asked for", async () => {
    lab.ask = async () => ({ plots: [{ ...LIGHT, values: [null, null, null] }] }) as never;
    point("pointermove");
    await later(300);
    expect(card()?.hasAttribute("hidden")).toBe(true);
    value.click();
    await later(0);
    expect(lab.store.state.plots).toEqual([]);
    openHistory(lab, ofVariable("m/n"), { x: 0, y: 0 });
    await later(0);
    expect(lab.root.querySelector('[role="dialog"]')?.textContent).toContain("No number was recorded.");
  });

  it("that is on a button leaves the button what it does", async () => {
    const changes = vi.fn();
    const other = h("button", { ...history(ofVariable("m/n")), onclick: changes }, "5");
    lab.root.append(other);
    other.click();
    await later(0);
    expect([changes.mock.calls.length, lab.store.state.plots]).toEqual([1, []]);
  });
});
