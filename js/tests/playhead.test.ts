// @vitest-environment happy-dom

import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import type { Happening, LookingView, ReplyMessage, Timeline, WhatIf } from "../src/protocol";
import type { Act, Question } from "../src/session/connection";
import { type Lab, Store } from "../src/session/store";
import { Looking } from "../src/timeline/looking";
import { timelineView } from "../src/timeline/view";

const WIDTH = 700; // px
const LEFT = 110; // px of the names
const SECONDS = 30;
const END = 20; // s, the present
const xOf = (time: number) => LEFT + (time / SECONDS) * (WIDTH - LEFT - 14);

const entered = (time: number, state: string, by: string): Happening => ({
  tick: time * 10 + 1,
  time,
  kind: "entered",
  lane: "m",
  state,
  by,
  text: "",
});
const RUN = [entered(0, "m/a", ""), entered(8, "m/b", "m/go"), entered(12, "m/a", "m/back")];
const timeline = (fields: Partial<Timeline> = {}): Timeline => ({
  epoch: 1,
  first: 1,
  last: 10 * END + 1,
  begin: 0,
  end: END,
  kept: -1,
  happenings: RUN,
  plots: [],
  names: [],
  ...fields,
});
const moment = (time: number): LookingView => ({ tick: 10 * time + 1, time, ago: END - time, edited: false });

/** A timeline, and the kernel's end of its wire: a moment that is asked for is shown. */
class Page {
  readonly store = new Store();
  readonly root = document.createElement("div");
  readonly looks: Act[] = [];
  readonly asked: Question[] = [];
  answer = async (): Promise<Partial<ReplyMessage>> => ({ timeline: timeline() });
  readonly element: HTMLElement;

  constructor() {
    document.body.append(this.root);
    const act = async (command: Act) => {
      if (command.do !== "look") return null;
      this.looks.push(command);
      const time = command.time ?? (command.tick ? (command.tick - 1) / 10 : null);
      this.show(time);
      return null;
    };
    const ask = (question: Question) => {
      this.asked.push(question);
      return question.type === "timeline" ? this.answer() : Promise.resolve({ error: "not asked here" });
    };
    const closed = new AbortController().signal;
    const lab = { store: this.store, root: this.root, closed, act, ask } as unknown as Lab;
    this.element = timelineView(lab, new Looking(lab), () => {});
    this.root.append(this.element);
    Object.defineProperty(this.area, "clientWidth", { value: WIDTH });
    Object.assign(this.store.state, { tick: 10 * END + 1, time: END });
  }

  show(time: number | null): void {
    this.store.set("looking", time === null ? null : moment(time));
  }

  async open(): Promise<this> {
    this.find('[data-lrp-action="timeline"]').click();
    await this.drawn();
    return this;
  }

  drawn(): Promise<void> {
    return new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(() => resolve())));
  }

  find<E extends Element = HTMLElement>(selector: string): E {
    const found = this.root.querySelector<E>(selector);
    if (!found) throw new Error(`nothing is ${selector}`);
    return found;
  }

  get area(): HTMLElement {
    return this.element.querySelector<HTMLElement>(".lrp-timeline-area")!;
  }

  /** Where the playhead stands, in px. */
  get head(): number {
    return Number(/[\d.]+/.exec(this.find(".lrp-playhead").style.transform)![0]);
  }

  /** The numbers on the axis. */
  get axis(): string[] {
    return [...this.root.querySelectorAll(".lrp-timeline-time")].map((each) => each.textContent ?? "");
  }

  press(type: string, time: number, target: EventTarget = this.area, clientY = 5): void {
    const fields = { clientX: xOf(time), clientY, pointerId: 1, button: 0, buttons: 1, bubbles: true };
    target.dispatchEvent(new PointerEvent(type, fields));
  }

  async click(time: number, y = 5): Promise<void> {
    this.press("pointerdown", time, this.area, y);
    this.press("pointerup", time, window);
    await this.drawn();
  }

  async key(key: string): Promise<void> {
    this.find(".lrp-playhead").dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
    await this.drawn();
  }
}

let page: Page;
beforeEach(async () => {
  localStorage.clear();
  page = await new Page().open();
});
afterEach(() => {
  page.store.close();
  page.root.remove();
});

describe("a timeline with many machines", () => {
  it("is drawn where it is scrolled to", async () => {
    const many = Array.from({ length: 200 }, (_, i) => ({ ...entered(0, `m${i}/a`, ""), lane: `m${i}` }));
    page.answer = async () => ({ timeline: timeline({ happenings: many }) });
    page.store.set("revision", 2);
    const lanes = () =>
      [...page.root.querySelectorAll<SVGElement>("[data-lrp-visit]")].map((each) => each.dataset.lane);
    await vi.waitFor(() => expect(lanes()).toContain("m0"));
    expect(lanes()).not.toContain("m150");
    const body = page.find(".lrp-timeline-body");
    body.scrollTop = 150 * 18;
    body.dispatchEvent(new Event("scroll"));
    expect(lanes()).toContain("m150");
    expect(lanes()).not.toContain("m0");
  });
});

describe("an edit", () => {
  it("is applied and drawn before the timeline asks what happened", async () => {
    const { answer } = page;
    const calm: number[] = []; // ms from the last edit to a question
    let edited = 0;
    page.answer = () => {
      calm.push(performance.now() - edited);
      return answer();
    };
    await new Promise((over) => setTimeout(over, 300)); // it may ask again at once
    for (let revision = 2; revision < 7; revision++) {
      edited = performance.now();
      page.store.set("revision", revision);
      page.store.set("tick", page.store.state.tick + 1);
      await page.drawn();
    }
    await vi.waitUntil(() => calm.length, { timeout: 5000 });
    expect(Math.min(...calm)).toBeGreaterThan(200);
  });
});

describe("a pointer on the timeline", () => {
  it("goes to the moment where it is pressed, and the window stays", async () => {
    const { axis } = page;
    await page.click(10);
    expect(page.looks).toEqual([{ do: "look", time: expect.closeTo(10, 5) }]);
    expect(page.head).toBeCloseTo(xOf(10), 0);
    expect(page.axis).toEqual(axis);
  });

  it("does nothing behind the present, but to lead back there from the past", async () => {
    await page.click(25);
    expect(page.looks).toEqual([]);
    await page.click(10);
    await page.click(25);
    expect(page.looks.at(-1)).toEqual({ do: "look" });
  });

  it("goes to a moment after the last one that was asked about", async () => {
    page.store.state.time = END + 4;
    await page.click(END + 2);
    expect(page.looks).toEqual([{ do: "look", time: expect.closeTo(END + 2, 5) }]);
  });

  it("asks why the transition fired at the border of two visits, and goes to the moment beside it", async () => {
    const asked = () => page.asked.filter(({ type }) => type === "why");
    await page.click(8.5, 40);
    expect(asked()).toEqual([]);
    await page.click(8.1, 40);
    expect(page.looks.at(-1)).toEqual({ do: "look", tick: 81 });
    expect(asked()).toMatchObject([{ kind: "transition", path: "m:go" }]);
  });

  it("drags the playhead to the first moment if it moves over the names", async () => {
    page.press("pointerdown", 10);
    page.press("pointermove", 5, window);
    page.press("pointermove", -3, window);
    await page.drawn();
    expect(page.looks.at(-1)).toEqual({ do: "look", time: 0 });
    page.press("pointerup", -3, window);
  });

  it("leads back to the present at the end of a drag to it", async () => {
    page.press("pointerdown", 10);
    page.press("pointermove", 5, window);
    await page.drawn();
    page.press("pointermove", 22, window);
    page.press("pointerup", 22, window);
    await page.drawn();
    expect(page.looks.at(-1)).toEqual({ do: "look" });
  });

  it("puts the playhead back where it was if the drag is given up", async () => {
    page.show(15);
    await page.drawn();
    page.press("pointerdown", 10);
    page.press("pointermove", 5, window);
    await page.drawn();
    window.dispatchEvent(new KeyboardEvent("keydown", { key: "Escape" }));
    await page.drawn();
    expect(page.looks.at(-1)).toEqual({ do: "look", tick: 151 });
  });

  it("zooms about the time where it is", async () => {
    const wheel = new WheelEvent("wheel", { deltaY: -500 * Math.LN2 });
    Object.defineProperties(wheel, { ctrlKey: { value: true }, clientX: { value: xOf(6) } });
    page.area.dispatchEvent(wheel);
    await page.click(6);
    expect(page.looks).toEqual([{ do: "look", time: expect.closeTo(6, 5) }]);
    expect(page.axis[0]).not.toBe("0 s");
  });
});

describe("keys on the playhead", () => {
  it("go from change to change, and after the last one back to the present", async () => {
    await page.key("PageDown");
    await page.key("PageDown");
    await page.key("PageUp");
    await page.key("PageUp");
    expect(page.looks).toEqual([
      { do: "look", tick: 121 },
      { do: "look", tick: 81 },
      { do: "look", tick: 121 },
      { do: "look" },
    ]);
  });

  it("say where it stands, and how long ago that was", async () => {
    const head = page.find(".lrp-playhead");
    expect(head.getAttribute("aria-valuetext")).toBe("now");
    await page.key("Home");
    expect(head.getAttribute("aria-valuetext")).toBe("0.0 s, 20.0 s ago");
  });
});

it("stands with its words over no number of the axis while one looks back", async () => {
  const hidden = () =>
    [...page.root.querySelectorAll('.lrp-timeline-time[visibility="hidden"]')].map(
      (each) => each.textContent,
    );
  expect(hidden()).toEqual([]);
  await page.click(10);
  expect(hidden()).toEqual(["10 s"]);
  await page.key("End");
  expect(hidden()).toEqual([]);
});

describe("the menu of a visit", () => {
  it("asks why it began and why it ended", async () => {
    const open = (time: number) =>
      page.area.dispatchEvent(
        new MouseEvent("contextmenu", { cancelable: true, clientX: xOf(time), clientY: 40 }),
      );
    const menuOf = async (time: number) => {
      open(time);
      const disabled = (action: string) =>
        page.find<HTMLButtonElement>(`[data-lrp-action="${action}"]`).disabled;
      const both = [disabled("why-begin"), disabled("why-end")];
      page.find('[role="menu"]').dispatchEvent(new KeyboardEvent("keydown", { key: "Escape" }));
      return both;
    };
    expect(await menuOf(1)).toEqual([true, false]);
    expect(await menuOf(9)).toEqual([false, false]);
    expect(await menuOf(15)).toEqual([false, true]);
    open(9);
    page.find('[data-lrp-action="why-end"]').click();
    await page.drawn();
    expect(page.looks.at(-1)).toEqual({ do: "look", tick: 121 });
    expect(page.asked.at(-1)).toMatchObject({ type: "why", kind: "transition", path: "m:back" });
  });
});

describe("the window", () => {
  it("shows the end of what would happen after an edit of the past", async () => {
    page.show(18);
    await page.drawn();
    const happenings = [entered(18, "m/a", "")];
    const course = { happenings, tick: 181, way: [], touch: null, others: {}, solids: [] };
    const courses = { recorded: course, changed: course, divergence: null };
    const whatIf: WhatIf = { tick: 181, begin: 18, end: 40, ...courses, open_loop: true };
    page.store.set("whatIf", whatIf);
    await page.drawn();
    expect(page.axis).toContain("40 s");
    expect(page.find(".lrp-playhead").dataset.label).toMatch(
      /^18.0 s · with the edit \(open loop: .*no difference up to 40.0/,
    );
    expect(page.find(".lrp-playhead").getAttribute("aria-valuetext")).toContain("with the edit");
  });
});

describe("a drawing under a pointer that is aiming", () => {
  it("stays for a moment, and is up to date after it", async () => {
    page.area.dispatchEvent(new PointerEvent("pointermove"));
    const more = [...RUN, entered(15, "m/b", "m/go")];
    page.answer = async () => ({ timeline: timeline({ happenings: more }) });
    page.store.touch(["revision"]);
    const visits = () => page.root.querySelectorAll(".lrp-timeline-visit").length;
    await vi.waitUntil(() => page.asked.length > 1, { timeout: 1000 });
    await page.drawn();
    expect(visits()).toBe(3);
    await vi.waitUntil(() => visits() === 4, { timeout: 3000 });
  });
});

describe("what a session told before another snapshot", () => {
  it("is not mixed with what it tells after it", async () => {
    page.root.remove();
    page = new Page();
    let reply: (reply: Partial<ReplyMessage>) => void = () => {};
    page.answer = () => new Promise((resolve) => (reply = resolve));
    await page.open();
    page.store.touch(["snapshot"]);
    await page.drawn();
    page.answer = async () => ({ timeline: timeline({ happenings: [] }) });
    reply({ timeline: timeline() });
    await page.drawn();
    expect(page.root.querySelectorAll(".lrp-timeline-visit")).toHaveLength(0);
  });
});
