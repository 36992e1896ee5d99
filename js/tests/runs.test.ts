// @vitest-environment happy-dom

import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { reachedBy, reachWords } from "../src/parts/coverage";
import { proposing } from "../src/parts/expected";
import { reasonOf } from "../src/parts/runs";
import { stripWords, visitsOf } from "../src/parts/strip";
import type { CoverageView, GoalView, KeptRunView, ProgramView, RunsView, SearchView } from "../src/protocol";
import { initialState } from "../src/session/state";
import { Page } from "./opened";
import recording from "./page/recording.json";

const LATER = "`looking` is not entered; in the original run it is.";
const RUN: KeptRunView = {
  expected: "as recorded",
  seconds: 20,
  state: "passed",
  reason: "",
  differs: null,
  open_loop: "",
  lane: "follower",
  recorded: [
    [0, "follower/looking"],
    [12.3, "follower/moving"],
  ],
  now: [
    [0, "follower/looking"],
    [14, "follower/moving"],
    [18, ""],
  ],
  issues: 0,
};
const FAILED: Partial<KeptRunView> = {
  state: "failed",
  reason: `differs at 12.3 s: ${LATER}`,
  differs: [12.3, LATER],
};
const COVERAGE: CoverageView = {
  states: { "follower/moving": [0, 1] },
  transitions: { "follower/tmoving": [1] },
  conditions: { "follower/tend": "never true", "follower/tbump": "never tested" },
  words: "Reached: 1 of 9 states.",
};
const RUNS: RunsView = {
  folder: "follower.runs",
  attached: [],
  names: ["oval", "wall"],
  expected: "reaches follower/end",
  keeps: "",
  coverage: null,
  error: "",
};

let page: Page;
let frames = 100;
beforeEach(async () => {
  localStorage.clear();
  page = await new Page().begin();
});
afterEach(() => {
  page.close();
  page.host.remove();
});

async function show(kept_runs: Record<string, Partial<KeptRunView> | null>, runs: Partial<RunsView> = {}) {
  const full = Object.entries(kept_runs).map(([name, run]) => [name, run && { ...RUN, ...run }]);
  const fields = { runs: { ...RUNS, ...runs }, kept_runs: Object.fromEntries(full) };
  page.deliver({ type: "frame", frame: frames++, ...fields });
  await page.drawn();
}

const title = () => page.find('[data-lrp-tab="runs"]').textContent;
const rows = () => [...page.host.querySelectorAll<HTMLElement>("[data-lrp-run]")];
const order = () => rows().map(({ dataset }) => dataset.lrpRun);
const row = (name: string) => page.find(`[data-lrp-run="${name}"]`);
const press = (key: string, on: Element) =>
  on.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));

/** The next command is refused with a sentence, or carried out. */
async function reply(error: string | null = null): Promise<void> {
  const { id } = page.of("command").at(-1)!;
  page.deliver({ type: "reply", id, error });
  await page.drawn();
}

describe("the panel of runs", () => {
  it("has a tab only where there can be runs, and says how to begin", async () => {
    const panels = () => {
      page.find('[data-lrp-action="menu"]').click();
      return [...page.host.querySelectorAll('[data-lrp-action="panel-runs"]')].length;
    };
    const tab = page.find('[data-lrp-tab="runs"]');
    const keep = page.find('.lrp-timeline [data-lrp-action="keep-run"]') as HTMLButtonElement;
    expect([tab.hidden, keep.hidden, panels()]).toEqual([true, true, 0]);
    await show({}, { names: [], keeps: "It began before the `world` was changed." });
    await page.drawn();
    expect([tab.hidden, keep.hidden, panels()]).toEqual([false, false, 1]);
    expect([keep.disabled, keep.title]).toEqual([true, "It began before the world was changed."]);
    expect(page.find(".lrp-runs").dataset.empty).toContain("choose Keep this run");
  });

  it("lists those that failed first, counts them, and says why", async () => {
    await show({ oval: {}, wall: FAILED });
    expect([title(), order()]).toEqual(["Runs (1)", ["wall", "oval"]]);
    expect(row("wall").querySelector(".lrp-run-reason")!.textContent).toBe(
      "Differs at 12.3 s: looking is not entered; in the original run it is.",
    );
    expect(row("oval").querySelector<HTMLElement>('[data-lrp-action="accept-run"]')!.hidden).toBe(true);
  });

  it("keeps the last result and the order in sight until all runs have been run again", async () => {
    await show({ oval: {}, wall: FAILED });
    const strip = row("wall").querySelector(".lrp-strip")!.innerHTML;
    const waiting: Partial<KeptRunView> = { state: "waiting", seconds: 0, recorded: [], now: [] };
    await show({ oval: waiting, wall: { ...waiting, expected: "never touches" } });
    expect([title(), order()]).toEqual(["Runs (1)", ["wall", "oval"]]);
    const outdated = () => row("wall").hasAttribute("data-outdated");
    expect([row("wall").dataset.state, outdated()]).toEqual(["failed", true]);
    expect(row("wall").querySelector(".lrp-strip")!.innerHTML).toBe(strip);
    expect(row("wall").querySelector(".lrp-run-expected")!.textContent).toBe("never touches");
    await show({
      oval: { state: "problem", reason: "It needs more memory than it may use." },
      wall: waiting,
    });
    expect([title(), order()]).toEqual(["Runs (2)", ["wall", "oval"]]);
    await show({ wall: {} });
    expect([title(), order()]).toEqual(["Runs (1)", ["oval", "wall"]]);
    expect(outdated()).toBe(false);
  });

  it("shows a run at a press on it, but not at one on what is changed in it", async () => {
    await show({ oval: FAILED });
    row("oval").querySelector<HTMLElement>(".lrp-run-expected")!.click();
    row("oval").querySelector<HTMLElement>("input")!.click();
    expect(page.commands("show_run")).toEqual([]);
    row("oval").querySelector<HTMLElement>(".lrp-run-reason")!.click();
    expect(page.commands("show_run")).toMatchObject([{ name: "oval" }]);
  });

  it("keeps what was typed where the kernel refuses it, and its sentence beside it", async () => {
    await show({ oval: {} });
    page.find(".lrp-run-expected").click();
    const input = page.find(".lrp-run-asked input") as HTMLInputElement;
    input.value = "reach end";
    press("Enter", input);
    expect(page.commands("expect")).toMatchObject([{ name: "oval", expected: "reach end" }]);
    await reply("`reach end` is not something that can be expected of a run.");
    await show({ oval: FAILED });
    expect(page.focused).toBe(input);
    expect([input.value, page.find(".lrp-run-asked .lrp-error").textContent]).toEqual([
      "reach end",
      "reach end is not something that can be expected of a run.",
    ]);
    input.value = "reaches end";
    press("Enter", input);
    await reply();
    expect(page.host.querySelector(".lrp-run-asked input")).toBe(null);
    expect(page.focused).toBe(page.find(".lrp-run-expected"));
  });

  it("moves the keyboard's focus to the run with another name, and to the next one where it is removed", async () => {
    await show({ oval: {}, wall: {} });
    const menu = (name: string, act: string) => {
      row(name).querySelector<HTMLElement>('[data-lrp-action="run-menu"]')!.click();
      page.find(`.lrp-menu [data-lrp-action="${act}"]`).click();
    };
    menu("oval", "rename-run");
    const input = page.find(".lrp-run-asked input") as HTMLInputElement;
    input.value = "bend";
    press("Enter", input);
    await reply();
    await show({ oval: null, bend: {} }, { names: ["bend", "wall"] });
    expect(page.focused).toBe(row("bend").querySelector("button"));
    menu("bend", "forget-run");
    expect(page.commands("forget_run")).toEqual([]);
    page.find('[data-lrp-action="forget-run-now"]').click();
    await reply();
    await show({ bend: null }, { names: ["wall"] });
    expect(page.focused).toBe(row("wall").querySelector("button"));
  });

  it("keeps the present run with what is proposed for it, also from the timeline", async () => {
    await show({});
    page.find('.lrp-timeline [data-lrp-action="keep-run"]').click();
    const form = page.find('[aria-label="Keep this run"]');
    const [name, expected] = [...form.querySelectorAll("input")] as [HTMLInputElement, HTMLInputElement];
    const proposed = [...form.querySelectorAll("option")].map(({ value }) => value);
    expect(proposed).toContain("never enters follower/looking/lookalgo/lookleft");
    expect(expected.value).toBe("reaches follower/end");
    name.value = "oval";
    page.find('[data-lrp-action="keep-run-now"]').click();
    expect(page.commands("keep_run")).toMatchObject([{ name: "oval", expected: "reaches follower/end" }]);
    await reply("There is a run `oval` already.");
    expect([form.hidden, name.value]).toEqual([false, "oval"]);
    expect(form.querySelector(".lrp-error")!.textContent).toBe("There is a run oval already.");
  });

  it("is withheld in a quiet lab, whose text and graph show no coverage either", async () => {
    page.find('[data-lrp-action="coverage"]').click();
    await show({ oval: {}, wall: {} }, { coverage: COVERAGE });
    expect(page.host.querySelectorAll(".lrp-reached").length).toBeGreaterThan(0);
    const { settings } = recording.snapshot.frame;
    page.deliver({ type: "frame", frame: frames++, settings: { ...settings, quiet: true } });
    await page.drawn();
    await page.drawn();
    expect(page.find('[data-lrp="runs"]').hasAttribute("data-withheld")).toBe(true);
    expect(page.host.querySelectorAll(".lrp-reached")).toHaveLength(0);
  });
});

it("a challenge with a comma in its name is proposed as it is to be written", () => {
  const runs = { ...RUNS, expected: "meets `a, b`" };
  const state = { ...initialState(), goal: { name: "a, b" } as GoalView, runs };
  const lines = proposing(document.createElement("input"), state).querySelectorAll("option");
  expect([...lines].map(({ value }) => value)).toEqual(["as recorded", "never touches", "meets `a, b`"]);
});

it("a reason has the first difference once, and the issues", () => {
  expect(reasonOf({ ...RUN, ...FAILED, issues: 1 })).toBe(
    `Differs at 12.3 s: ${LATER} It ends with 1 issue.`,
  );
  expect(reasonOf({ ...RUN, ...FAILED, reason: "`end` is not entered in 20 s." })).toBe(
    `\`end\` is not entered in 20 s. Differs at 12.3 s: ${LATER}`,
  );
});

it("a strip says which state was active at each place, until its machine ended", () => {
  const states = visitsOf(RUN.now, 20).map(({ from, to }) => [from, to]);
  expect(states).toEqual([
    [0, 14],
    [14, 18],
  ]);
  expect(stripWords(RUN, 0.65, 0.2)).toBe("recorded: moving, 12.3 to 20.0 s");
  expect(stripWords(RUN, 0.65, 0.8)).toBe("now: looking, 0.0 to 14.0 s");
  expect(stripWords(RUN, 0.95, 0.8)).toBe("now: no state at 19.0 s");
});

describe("the search for a change", () => {
  const IDLE = { busy: false, made: 0, planned: 0, changes: [], answer: "", stale: false, error: "" };
  const FOUND: SearchView = {
    ...IDLE,
    changes: [
      {
        sentence: "`turn` 10 instead of 15 (line 2) passes in 2 of 2 runs (now 0).",
        line: 2,
      },
      {
        sentence: "`pace` 3 instead of 1 (line 1) passes in 1 of 2 runs (now 0).",
        line: 1,
      },
    ],
    answer: "Changing `lag` does not help.",
  };
  const search = async (fields: Partial<SearchView> | null) => {
    page.deliver({ type: "frame", frame: frames++, search: fields && { ...IDLE, ...fields } });
    await page.drawn();
  };
  const part = () => page.find(".lrp-search");
  const action = (name: string) => part().querySelector<HTMLElement>(`[data-lrp-action="${name}"]`)!;

  it("is offered where it is allowed and a run has failed, also while that is run again", async () => {
    const offered = () => !part().hidden && !action("find-change").hidden;
    await show({ oval: {}, wall: FAILED });
    expect(offered()).toBe(false);
    await search({});
    expect([offered(), part().querySelector<HTMLElement>(".lrp-found")!.hidden]).toEqual([true, true]);
    await show({ wall: { state: "waiting" } });
    expect(offered()).toBe(true);
    await show({ wall: {} });
    expect([offered(), part().hidden]).toEqual([false, true]);
  });

  it("says how far it is, can be stopped, and shows what was found with what can be done with it", async () => {
    await show({ wall: FAILED });
    await search({});
    action("find-change").click();
    expect(page.commands("find_change")).toHaveLength(1);
    await search({ busy: true, made: 36, planned: 120 });
    expect(part().querySelector("[role=status]")!.textContent).toBe("Run 37 of 120 …");
    expect([action("find-change").hidden, action("stop-search").hidden]).toEqual([true, false]);
    action("stop-search").click();
    expect(page.commands("stop_search")).toHaveLength(1);
    await search(FOUND);
    const items = [...part().querySelectorAll("li")];
    expect(items.map((each) => each.querySelector("span")!.textContent)).toEqual([
      "turn 10 instead of 15 (line 2) passes in 2 of 2 runs (now 0).",
      "pace 3 instead of 1 (line 1) passes in 1 of 2 runs (now 0).",
    ]);
    expect(part().querySelector(".lrp-found > p")!.textContent).toBe("Changing lag does not help.");
    items[0]!.querySelector<HTMLElement>('[data-lrp-action="line-of-change"]')!.click();
    const { state } = page.editor;
    expect(state.doc.lineAt(state.selection.main.head).number).toBe(2);
    items[1]!.querySelector<HTMLElement>('[data-lrp-action="take-change"]')!.click();
    expect(page.commands("take_change")).toMatchObject([{ index: 1 }]);
    await reply("The program has changed since this search. Search again.");
    expect(part().querySelector(".lrp-error")!.textContent).toContain("Search again.");
  });

  it("offers nothing of an answer about an earlier program, and shows what went wrong", async () => {
    await show({ wall: {} });
    await search({ ...FOUND, stale: true });
    expect(part().querySelector(".lrp-found")!.hasAttribute("data-stale")).toBe(true);
    expect(part().textContent).toContain("The program has changed since.");
    expect([...part().querySelectorAll<HTMLElement>("li button")].every(({ hidden }) => hidden)).toBe(true);
    await search({ error: "A run `wall` cannot be repeated." });
    expect(part().querySelector(".lrp-error")!.textContent).toBe("A run wall cannot be repeated.");
    expect(part().querySelector<HTMLElement>(".lrp-found")!.hidden).toBe(true);
  });
});

describe("the coverage", () => {
  const program = recording.snapshot.frame.program as ProgramView;
  const reached = reachedBy(COVERAGE, RUNS.names, program);

  it("names the runs, and what none of them reaches", () => {
    const words = (kind: "state" | "transition", path: string) => reachWords({ reached }, kind, path);
    expect(words("state", "follower/moving")).toBe("entered in 2 of 2 runs: oval, wall");
    expect(words("state", "follower/end")).toBe("not entered in any run");
    expect(words("state", "follower/new")).toBe(""); // the runs have not been run again with it
    expect(words("transition", "follower:tend")).toBe("not fired in any run; its condition was never true");
  });

  it("is shown in the text and in the graph while that is wanted, also until runs have been run again", async () => {
    const state = (name: string) => page.find(`[data-lrp-state="follower/${name}"]`);
    const hatched = () => [...page.host.querySelectorAll(".lrp-hatching")].length;
    const gutter = () => {
      const [, ...figures] = page.host.querySelectorAll(".lrp-coverage-gutter .lrp-reached"); // after its spacer
      return figures.map(({ textContent }) => textContent);
    };
    page.hears("(machine follower\n(state moving)\n(on ending * -> end tend) (state end))");
    await show({ oval: {}, wall: {} }, { coverage: COVERAGE });
    expect([state("moving").dataset.reached, hatched(), gutter()]).toEqual([undefined, 0, []]);
    page.find('[data-lrp-action="coverage"]').click();
    await page.drawn();
    for (const coverage of [COVERAGE, null]) {
      await show({}, { coverage });
      expect([state("moving").dataset.reached, state("end").dataset.reached]).toEqual(["2", "0"]);
      expect(state("end").querySelector(".lrp-hatching")).not.toBe(null);
      expect(state("end").getAttribute("aria-label")).toBe("end 0: state end");
      expect(state("end").getAttribute("aria-description")).toContain("not entered in any run");
      for (const kind of ["label", "halo"]) // which lies below it
        expect(page.find(`.lrp-${kind}[data-of="follower:tend"] .lrp-reached`).textContent).toBe("0 ◐");
      expect(page.find(".lrp-runs-reached").textContent).toBe(COVERAGE.words);
      expect(gutter()).toEqual(["2", "0"]);
    }
    page.find('[data-lrp-action="coverage"]').click();
    await page.drawn();
    expect([state("moving").dataset.reached, hatched(), gutter()]).toEqual([undefined, 0, []]);
    expect(state("end").getAttribute("aria-label")).toBe("end: state end");
    expect(page.host.querySelectorAll(".lrp-reached")).toHaveLength(0);
  });
});
