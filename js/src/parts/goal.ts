/** The challenge: its criteria, live, and the check with its runs, hints and points. */

import type { AttemptView, CheckView, CriterionView, GoalView, OutlineView } from "../protocol";
import type { Lab } from "../session/store";
import { button, disabledDuring, panel } from "../ui/button";
import { h, reconcile, s, setAttribute, setChoices, setHidden, setProse, setText } from "../ui/dom";
import { ABSENT } from "../ui/layout";
import { findButton, isCheckFailed } from "./search";
import { withheld } from "./study";

type Attempts = Readonly<Record<string, AttemptView>>;

const STATES: Record<CriterionView["state"], string> = {
  open: "open",
  "so far": "met so far",
  met: "met",
  failed: "failed",
};

/** `toRuns` brings the runs to the front; null where there are none in this view. */
export function goalView(lab: Lab, toRuns: (() => void) | null = null): HTMLElement {
  const { store } = lab;
  const world = h("select", {
    class: "lrp-select",
    "aria-label": "World of the challenge",
    title: "The world in which the robot drives here; a check runs the program in all of them",
    "data-lrp-action": "challenge-world",
    onchange: () => void lab.act({ do: "start_over", world: world.selectedIndex }),
  });
  const again = button({
    icon: "reset",
    label: "Start over",
    title: "Put the robot back to its start, and start the program again",
    action: "start-over",
    onclick: () => void lab.act({ do: "start_over", world: -1 }),
  });
  const check = button({
    label: "Check",
    title: "Run the program in every world of the challenge",
    class: "lrp-button lrp-primary",
    action: "check",
    onclick: () => void lab.act({ do: "check" }),
  });
  const task = h("p", { class: "lrp-task" });
  const note = h("p", { class: "lrp-goal-note", role: "status" });
  const watched = h("p", { class: "lrp-faint" }, "The run in the world, as far as it has come:");
  const criteria = h("ul", { class: "lrp-criteria", "aria-label": "Criteria of the run in the world" });
  const find = findButton(() => {
    toRuns?.(); // where the answer stands
    void lab.act({ do: "find_change" });
  });
  const keep = async (index: number) => {
    if (!(await lab.act({ do: "keep_attempt", index }))) toRuns?.();
  };
  const checked = checkView(lab, keep);
  const group = { class: "lrp-goal", tabindex: "0", role: "group", "aria-label": "Goal" };
  const code = h("strong", { class: "lrp-code" });
  const exam = h("p", { class: "lrp-exam" }, "Hand-in code: ", code, ". Save your work, then write it down.");
  const body = h("div", group, checked.element, task, exam, note, watched, criteria);
  const { element, heading } = panel("goal", "Goal", [world, again, check, checked.hint, find], body);
  element.setAttribute(ABSENT, "");
  store.watch(["goal", "attempts", "search", "runs", "settings"], () => {
    const { goal, attempts, search, runs, settings } = store.state;
    const hasRuns = !!toRuns && !!runs && !withheld(settings).includes("runs");
    setHidden(find, !(hasRuns && search && isCheckFailed(goal)));
    setAttribute(body, "data-keeps", hasRuns && goal?.keeps);
    setAttribute(element, ABSENT, goal === null);
    if (!goal) return;
    setText(heading, `Goal: ${goal.name}`);
    setAttribute(heading, "title", goal.name); // which may be cut off
    setProse(task, goal.task);
    setText(code, goal.code);
    exam.hidden = !goal.code;
    setProse(note, goal.note);
    note.hidden = !goal.note;
    watched.hidden = !goal.check;
    const names = numbered(goal.worlds);
    const offered = names.map((name, at) => [String(at), name] as const);
    setChoices(world, offered, String(goal.world));
    world.hidden = names.length < 2;
    checked.update(goal, attempts);
  });
  store.watch(["criteria", "goal"], () =>
    reconcile(
      criteria,
      store.state.criteria,
      ({ sentence }) => sentence,
      () => h("li", { class: "lrp-criterion" }, h("span", {}), h("span", { class: "lrp-faint" })),
      updateCriterion,
    ),
  );
  return element;
}

function updateCriterion(item: Element, { sentence, state, reason }: CriterionView): void {
  setAttribute(item, "data-state", state);
  setAttribute(item, "aria-label", `${sentence}, ${STATES[state]}: ${reason}`);
  const [what, why] = [...item.children] as [Element, Element];
  setProse(what, sentence);
  setProse(why, reason);
}

/** The names of the worlds; several of the same name get a number. */
export function numbered(worlds: readonly { name: string }[]): string[] {
  return worlds.map(({ name }, at) => {
    const same = worlds.filter((world) => world.name === name);
    return same.length < 2
      ? name
      : `${name} ${worlds.slice(0, at + 1).filter((each) => each.name === name).length}`;
  });
}

/** The last check: progress, result, one card for each run, hints. */
function checkView(lab: Lab, keep: (index: number) => Promise<void>) {
  const bar = h("progress", { class: "lrp-progress", "aria-label": "Runs made" });
  const result = h("p", { class: "lrp-result", role: "status" });
  const runs = h("ul", { class: "lrp-attempts", "aria-label": "Runs of the check" });
  const hint = button({
    label: "Hint",
    title: "Show a hint about what went wrong",
    action: "hint",
    onclick: () => void lab.act({ do: "hint" }),
  });
  const hints = h("ol", { class: "lrp-hints", "aria-label": "Hints", "aria-live": "polite" });
  const element = h("div", { class: "lrp-check" }, bar, result, hints, runs);
  const label = hint.querySelector(".lrp-button-label")!;
  let given = 0; // hints: a new one is brought into view
  let ended = true;
  return {
    element,
    hint,
    update(goal: GoalView, attempts: Attempts) {
      const { check } = goal;
      element.hidden = check === null;
      hint.hidden = !(check && goal.more_hints);
      if (!check) return;
      if (check.busy && ended && element.parentElement) element.parentElement.scrollTop = 0;
      ended = !check.busy;
      bar.hidden = !check.busy;
      bar.max = check.total;
      bar.value = check.done;
      setProse(result, resultOf(check, goal, attempts));
      setAttribute(result, "data-state", check.busy ? null : check.passed ? "met" : "failed");
      reconcile(
        runs,
        failedFirst(attempts),
        ([index]) => index,
        ([index]) => makeRun(lab, Number(index), keep),
        (card, [, attempt]) => updateRun(card, attempt, goal, attempts),
      );
      setText(label, goal.more_hints ? `Hint (${goal.more_hints})` : "Hint");
      reconcile(
        hints,
        goal.hints,
        (text) => text,
        () => h("li", { class: "lrp-hint" }),
        setProse,
      );
      if (goal.hints.length > given) bringIntoView(hints.lastElementChild, element.parentElement);
      given = goal.hints.length;
    },
  };
}

/** Scroll a box so far that the end of an element in it can be seen; the page around it stays. */
function bringIntoView(element: Element | null, box: Element | null): void {
  if (!element || !box) return;
  const hidden = element.getBoundingClientRect().bottom - box.getBoundingClientRect().bottom;
  if (hidden > 0) box.scrollTop += hidden;
}

/** What a check has found, in a sentence or two. */
export function resultOf(
  check: CheckView,
  { points, hidden }: Pick<GoalView, "points" | "hidden">,
  attempts: Attempts,
): string {
  if (check.busy) return `Run ${Math.min(check.done + 1, check.total)} of ${check.total} …`;
  if (check.error) return `The check could not be made. ${check.error}`;
  const passed = Object.values(attempts).filter((attempt) => attempt.passed).length;
  const all = check.total === 1 ? "The run" : `All ${check.total} runs`;
  const some = `${passed} of ${check.total} runs passed`;
  const unseen = hidden === 1 ? "a world that you do not see" : `${hidden} worlds that you do not see`;
  const far = hidden ? "" : ` ${check.points} of ${points} points.`;
  let sentence = `Not yet:${far}${hidden || check.total > 1 ? ` ${some}.` : ""}`;
  if (check.passed) {
    const runs = passed < check.total ? `${some}, which is enough.` : `${all} met all criteria.`;
    sentence = hidden
      ? `Passed here. ${runs} Your points also depend on ${unseen}.`
      : `Passed: ${points} of ${points} points. ${runs}`;
  }
  return check.stale ? `${sentence} The program has changed since.` : sentence;
}

/** The runs by their numbers, those that have failed before those that have passed. */
function failedFirst(attempts: Attempts): [string, AttemptView][] {
  return Object.entries(attempts).sort(
    ([one, a], [other, b]) => Number(a.passed) - Number(b.passed) || Number(one) - Number(other),
  );
}

function makeRun(lab: Lab, index: number, keep: (index: number) => Promise<void>): HTMLElement {
  const show = button({
    label: "Show",
    title: "Repeat this run in the lab, and look at the moment at which it failed",
    action: "show-attempt",
    onclick: () => void disabledDuring(show, lab.act({ do: "show_attempt", index })), // it may take some seconds
  });
  const keeping = button({
    label: "Keep",
    title: "Keep this run as an example that runs again after every edit",
    action: "keep-attempt",
    onclick: () => void disabledDuring(keeping, keep(index)),
  });
  const picture = s("svg", { class: "lrp-outline", "aria-hidden": "true" });
  const words = h("div", {}, h("div", { class: "lrp-attempt-name" }), h("div", { class: "lrp-faint" }));
  return h(
    "li",
    { class: "lrp-attempt" },
    picture,
    words,
    h("div", { class: "lrp-attempt-acts" }, show, keeping),
  );
}

function updateRun(card: Element, attempt: AttemptView, goal: GoalView, attempts: Attempts): void {
  setAttribute(card, "data-state", attempt.passed ? "met" : "failed");
  const [picture, text, acts] = [...card.children] as [Element, Element, HTMLElement];
  const [show, keeping] = [...acts.children] as [Element, Element];
  const seeds = Object.values(attempts).filter(({ world }) => world === attempt.world).length > 1;
  const name = `${numbered(goal.worlds)[attempt.world]}${seeds ? `, seed ${attempt.seed}` : ""}`;
  const [title, why] = [...text.children] as [Element, Element];
  setText(title, `${name}: ${attempt.passed ? "passed" : "not yet"}`);
  setProse(why, attempt.passed ? "" : `${attempt.failed}: ${attempt.reason}`);
  acts.hidden = !attempt.shows;
  setAttribute(show, "aria-label", `Show the run: ${name}`);
  setAttribute(keeping, "aria-label", `Keep the run: ${name}`);
  drawRun(picture, goal.worlds[attempt.world]!, attempt.path);
}

function drawRun(picture: Element, { width, height, solids, line, zones }: OutlineView, path: string): void {
  if (picture.getAttribute("data-path") === path) return;
  setAttribute(picture, "data-path", path);
  setAttribute(picture, "viewBox", `0 0 ${width} ${height}`);
  const end = /([\d.]+),([\d.]+)$/.exec(path);
  picture.replaceChildren(
    s("path", { class: "lrp-outline-zones", d: zones }),
    s("path", { class: "lrp-outline-line", d: line }),
    s("path", { class: "lrp-outline-solids", d: solids }),
    s("path", { class: "lrp-outline-path", d: path }),
    ...(end ? [s("circle", { class: "lrp-outline-end", cx: end[1], cy: end[2], r: width / 40 })] : []),
  );
}
