/** The search for the smallest change that makes the program pass all runs, and what it has found. */

import type { FoundChangeView, GoalView, SearchView } from "../protocol";
import type { Lab } from "../session/store";
import { button, linkButton } from "../ui/button";
import { h, reconcile, setAttribute, setHidden, setProse, setText } from "../ui/dom";

/** The button that begins a search. */
export function findButton(onclick: () => void): HTMLButtonElement {
  return button({
    ...{ icon: "search", label: "Find a change", action: "find-change", onclick },
    title: "Search for the smallest change that makes the program pass all runs",
  });
}

/** Whether the last check of the challenge has come to its end, and has not passed. */
export function isCheckFailed(goal: Pick<GoalView, "check"> | null): boolean {
  const check = goal?.check;
  return !!check && !check.busy && !check.passed;
}

/** The button, the progress and the answer; `update` says whether something has failed. */
export function searchView(lab: Lab): { element: HTMLElement; update: (failed: boolean) => void } {
  const { state } = lab.store;
  let isFailed = false;
  let refusal: string | null = null;
  const act = async (...[asked]: Parameters<Lab["act"]>) => {
    refusal = await lab.act(asked, true);
    show();
  };
  const find = findButton(() => void act({ do: "find_change" }));
  const stop = button({
    ...{ label: "Stop", title: "End the search, and show what it has found so far", action: "stop-search" },
    onclick: () => void act({ do: "stop_search" }),
  });
  const progress = h("span", { role: "status" });
  const error = h("p", { class: "lrp-error", role: "status" });
  const changes = h("ul", { class: "lrp-changes", "aria-label": "Changes that help" });
  const answer = h("p", { role: "status" });
  const stale = h("p", {}, "The program has changed since.");
  const found = h("div", { class: "lrp-found" }, changes, answer, stale);
  const head = h("div", { class: "lrp-search-head" }, find, progress, stop);
  const element = h("div", { class: "lrp-search" }, head, error, found);

  function item({ sentence, line }: FoundChangeView, index: number): HTMLElement {
    const words = h("span", {});
    setProse(words, sentence);
    const take = linkButton("Take it", {
      title: "Write this change into the program; it can be undone",
      "data-lrp-action": "take-change",
      onclick: () => void act({ do: "take_change", index }),
    });
    const place = { line, column: 1, end_line: line, end_column: 1 };
    const go = linkButton(`Line ${line}`, {
      title: `Show line ${line} of the program`,
      "data-lrp-action": "line-of-change",
      onclick: () => lab.goToRange(place, false),
    });
    return h("li", {}, words, take, line > 0 && go);
  }

  function show(): void {
    const { search } = state;
    const isBusy = search?.busy ?? false;
    const isStale = search?.stale ?? false;
    const isAnswered = !!search && !isBusy && !!(search.answer || search.changes.length);
    setHidden(stop, !isBusy); // before the other one, which gets its place
    setHidden(find, isBusy || !search || !isFailed);
    setText(progress, search && isBusy ? progressOf(search) : "");
    setProse(error, refusal || search?.error || "");
    setHidden(found, !isAnswered);
    setAttribute(found, "data-stale", isStale);
    setHidden(stale, !isStale);
    setProse(answer, search?.answer ?? "");
    reconcile(
      changes,
      (search?.changes ?? []).map((change, index) => ({ change, index })),
      ({ change, index }) => `${index} ${change.sentence}`,
      ({ change, index }) => item(change, index),
      (each) => {
        for (const button of each.querySelectorAll("button")) setHidden(button, isStale);
      },
    );
    setHidden(element, find.hidden && !isBusy && !isAnswered && !error.textContent);
  }

  lab.store.watch(["search"], () => {
    if (state.search?.busy) refusal = null;
    show();
  });
  return {
    element,
    update(failed) {
      isFailed = failed;
      show();
    },
  };
}

function progressOf({ made, planned }: SearchView): string {
  return planned ? `Run ${Math.min(made + 1, planned)} of ${planned} …` : "Searching …";
}
