// @vitest-environment happy-dom

import { describe, expect, it } from "vitest";
import { goalView, numbered, resultOf } from "../src/parts/goal";
import type { AttemptView, CheckView, GoalView, RunsView, SearchView } from "../src/protocol";
import { type Lab, Store } from "../src/session/store";

const world = { name: "line across", width: 3, height: 2, solids: "", line: "M1,1 2,1", zones: "" };
const attempt: AttemptView = {
  world: 0,
  seed: 0,
  passed: false,
  failed: "ends in `goal`",
  reason: "it is at x = 2.92 m",
  share: 0.5,
  shows: true,
  path: "M0.50,1.00 2.92,1.00",
};
const check: CheckView = {
  busy: false,
  stale: false,
  done: 2,
  total: 2,
  passed: false,
  points: 7.5,
  error: "",
};
const attempts = { 0: { ...attempt, world: 1, passed: true, failed: "", reason: "" }, 1: attempt };
const goal: GoalView = {
  name: "stop at the line",
  task: "Stop at the `line`.",
  points: 10,
  seconds: 20,
  over: false,
  world: 0,
  worlds: [world, { ...world, name: "far" }],
  note: "",
  hints: [],
  more_hints: 2,
  code: "",
  hidden: 0,
  check,
  begun: 0,
  trail: [],
  keeps: true,
};

function shown(fields: Partial<GoalView> = {}) {
  const store = new Store();
  const acts: unknown[] = [];
  const lab = { store, act: async (act: unknown) => void acts.push(act) } as unknown as Lab;
  let calls = 0;
  const element = goalView(lab, () => calls++);
  store.state.goal = { ...goal, ...fields };
  store.state.criteria = [
    { sentence: "ends in `goal`", state: "open", reason: "it is at x = 1.00 m" },
    { sentence: "runs without issues", state: "so far", reason: "no issue" },
  ];
  store.state.attempts = attempts;
  store.touch(new Set(["goal", "criteria", "attempts"] as const));
  return { element, acts, store, toRuns: () => calls };
}

const tick = () => new Promise((resolve) => setTimeout(resolve, 40));

describe("the goal", () => {
  it("shows the task, the criteria with their figures, and the runs of the check", async () => {
    const { element } = shown();
    await tick();
    expect(element.hasAttribute("data-absent")).toBe(false);
    expect(element.querySelector(".lrp-title")?.textContent).toBe("Goal: stop at the line");
    expect(element.querySelector(".lrp-task code")?.textContent).toBe("line");
    const criteria = [...element.querySelectorAll(".lrp-criterion")];
    expect(criteria.map((each) => each.getAttribute("data-state"))).toEqual(["open", "so far"]);
    expect(criteria[0]?.getAttribute("aria-label")).toBe("ends in `goal`, open: it is at x = 1.00 m");
    const runs = [...element.querySelectorAll(".lrp-attempt")];
    expect(runs.map((run) => run.querySelector(".lrp-attempt-name")?.textContent)).toEqual([
      "line across: not yet",
      "far: passed",
    ]);
    expect(runs[0]?.querySelector(".lrp-outline-end")?.getAttribute("cx")).toBe("2.92");
    expect(element.querySelector(".lrp-result")?.textContent).toBe(
      "Not yet: 7.5 of 10 points. 1 of 2 runs passed.",
    );
  });

  it("shows a code in an exam, and otherwise none", async () => {
    const { element, store } = shown({ code: "K7M2-QX9D" });
    await tick();
    const exam = element.querySelector<HTMLElement>(".lrp-exam")!;
    expect(exam.hidden).toBe(false);
    expect(exam.textContent).toBe("Hand-in code: K7M2-QX9D. Save your work, then write it down.");
    store.state.goal = goal;
    store.touch(new Set(["goal"] as const));
    await tick();
    expect(exam.hidden).toBe(true);
  });

  it("is not there while there is no challenge", () => {
    expect(goalView({ store: new Store() } as unknown as Lab).hasAttribute("data-absent")).toBe(true);
  });

  it("checks, shows a run, gives a hint and starts over", async () => {
    const { element, acts } = shown();
    await tick();
    for (const action of ["check", "show-attempt", "keep-attempt", "hint", "start-over"])
      element.querySelector<HTMLButtonElement>(`[data-lrp-action="${action}"]`)?.click();
    expect(acts).toEqual([
      { do: "check" },
      { do: "show_attempt", index: 1 },
      { do: "keep_attempt", index: 1 },
      { do: "hint" },
      { do: "start_over", world: -1 },
    ]);
  });

  it("has a button for hints as long as there are some, with their number", async () => {
    const { element, store } = shown();
    await tick();
    const hint = element.querySelector<HTMLButtonElement>('[data-lrp-action="hint"]');
    expect(hint?.textContent).toBe("Hint (2)");
    store.state.goal = { ...goal, hints: ["Turn by `pi`.", "Wait."], more_hints: 0 };
    store.touch(new Set(["goal"] as const));
    await tick();
    expect(hint?.hidden).toBe(true);
    expect([...element.querySelectorAll(".lrp-hint")].map((each) => each.textContent)).toEqual([
      "Turn by pi.",
      "Wait.",
    ]);
  });
});

describe("a search for a change", () => {
  it("is offered after a check that failed, where the teacher allows it, and leads to the runs", async () => {
    const { element, acts, store, toRuns } = shown();
    const find = element.querySelector<HTMLButtonElement>('[data-lrp-action="find-change"]')!;
    const search = {} as SearchView;
    const offered = async (fields: Partial<typeof store.state>) => {
      Object.assign(store.state, fields);
      store.touch(["goal", "search", "runs"]);
      await tick();
      return !find.hidden;
    };
    expect(await offered({ runs: {} as RunsView })).toBe(false);
    expect(await offered({ search })).toBe(true);
    for (const other of [{ passed: true }, { busy: true }])
      expect(await offered({ goal: { ...goal, check: { ...check, ...other } } })).toBe(false);
    expect(await offered({ goal: { ...goal, check: null } })).toBe(false);
    expect(await offered({ goal, settings: { ...store.state.settings, quiet: true } })).toBe(false);
    expect(await offered({ settings: { ...store.state.settings, quiet: false } })).toBe(true);
    find.click();
    expect([acts, toRuns()]).toEqual([[{ do: "find_change" }], 1]);
  });

  it("needs no run that is kept; one can be kept unless the program is to be edited meanwhile", async () => {
    const { element, store } = shown({ keeps: false });
    store.state.runs = {} as RunsView;
    await tick();
    expect(element.querySelector(".lrp-goal")!.hasAttribute("data-keeps")).toBe(false);
    store.state.goal = { ...goal };
    store.touch(["goal"]);
    await tick();
    expect(element.querySelector(".lrp-goal")!.hasAttribute("data-keeps")).toBe(true);
  });
});

describe("the result of a check", () => {
  it("says how far it is, what it has found, and whether that is still so", () => {
    expect(resultOf({ ...check, busy: true, done: 1 }, goal, attempts)).toBe("Run 2 of 2 …");
    const passed = { ...check, passed: true, points: 10 };
    const all = Object.fromEntries(
      Object.entries(attempts).map(([at, each]) => [at, { ...each, passed: true }]),
    );
    expect(resultOf(passed, goal, all)).toBe("Passed: 10 of 10 points. All 2 runs met all criteria.");
    expect(resultOf(passed, goal, attempts)).toBe(
      "Passed: 10 of 10 points. 1 of 2 runs passed, which is enough.",
    );
    expect(resultOf({ ...check, stale: true }, goal, attempts)).toContain("The program has changed since.");
    expect(resultOf({ ...check, error: "No." }, goal, attempts)).toBe("The check could not be made. No.");
    expect(resultOf({ ...check, total: 1, done: 1 }, goal, attempts)).toBe("Not yet: 7.5 of 10 points.");
  });

  it("promises no points where hidden worlds count", () => {
    const exam = { ...goal, hidden: 2 };
    expect(resultOf(check, exam, attempts)).toBe("Not yet: 1 of 2 runs passed.");
    expect(resultOf({ ...check, passed: true }, exam, attempts)).toBe(
      "Passed here. 1 of 2 runs passed, which is enough. Your points also depend on 2 worlds that you do not see.",
    );
  });
});

it("numbers worlds of the same name", () => {
  expect(numbered([{ name: "a" }, { name: "b" }, { name: "a" }])).toEqual(["a 1", "b", "a 2"]);
});
