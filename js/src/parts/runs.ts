/** The runs that are kept beside the program, and run again after every edit: whether what is expected of them holds. */

import { nameOf } from "../language/paths";
import type { KeptRunView, RunVerdict } from "../protocol";
import type { Lab } from "../session/store";
import { button, disabledDuring, linkButton, panel, setSwitch, toggle } from "../ui/button";
import { h, reconcile, s, setAttribute, setHidden, setProse, setText } from "../ui/dom";
import { editing } from "../ui/editing";
import type { KeptSwitch } from "../ui/kept";
import { ABSENT } from "../ui/layout";
import { item, menuButton } from "../ui/menu";
import { TRAIL_COLORS, trailStyles } from "../world/legend";
import type { Style } from "../world/palette";
import { counted } from "./coverage";
import { proposing } from "./expected";
import { keepButton } from "./keep";
import { isCheckFailed, searchView } from "./search";
import { drawStrip, STRIP, stripWords } from "./strip";

const EMPTY =
  "A run that you keep here is an example: after every edit it runs again, and you see whether it still does what you expect. Let the robot drive, then choose Keep this run.";
const COVERAGE =
  "Show in the text and in the graph how many runs enter each state and fire each transition; what no run reaches is hatched or faint";
const MARKS: Record<RunVerdict, string> = { passed: "✓", failed: "✗", problem: "!", waiting: "…" };
const VERDICTS: Record<RunVerdict, string> = {
  passed: "as expected",
  failed: "not as expected",
  problem: "could not be run again",
  waiting: "not run again yet",
};

/** What is shown of a run: the last result while it is run again. */
interface Shown extends KeptRunView {
  waits: boolean;
}

/** `keep` and `attach` open forms. */
export function runsView(lab: Lab, coverage: KeptSwitch, keep: () => void, attach: () => void): HTMLElement {
  const { store } = lab;
  const shown = new Map<string, Shown>();
  let first = new Set<string>();
  let styleOf = trailStyles(store.state.program, TRAIL_COLORS);
  const begin = () => void lab.act({ do: "new_run" });
  const cover = () => {
    coverage.flip();
    setSwitch(covers, coverage.on);
  };
  const covers = toggle("Coverage", COVERAGE, "coverage", cover);
  setSwitch(covers, coverage.on);
  const tools = [
    keepButton(lab, keep),
    button({
      ...{ icon: "reset", label: "New run", action: "new-run", onclick: begin },
      title: "Put the world back to its start, and start the program again: what follows can be kept",
    }),
    button({
      ...{ icon: "folder", label: "Attach runs…", action: "attach-runs", onclick: attach },
      title: "Also show and run the recordings in another folder",
    }),
    covers,
    // in the place of the last three where there is little room
    menuButton(lab.root, { title: "More for the runs", action: "runs-menu" }, "Runs", () => [
      item("New run", "menu-new-run", begin),
      item("Attach runs…", "menu-attach-runs", attach),
      item("Coverage", "menu-coverage", cover, { checked: coverage.on }),
    ]),
  ];
  const error = h("p", { class: "lrp-error", role: "status" });
  const list = h("ul", { class: "lrp-runs", "aria-label": "Kept runs" });
  const reached = h("p", { class: "lrp-runs-reached" });
  const result = h("p", { role: "status" });
  const where = h("p", { class: "lrp-faint" });
  const search = searchView(lab);
  const body = h("div", { class: "lrp-runs-body" }, search.element, error, list, result, reached, where);
  let focused = ""; // the run that gets the keyboard's focus, from one that goes
  const leave = (name: string) => {
    focused = name;
  };
  const { element, heading } = panel("runs", "Runs", tools, body);
  element.setAttribute(ABSENT, "");

  store.watch(["program"], () => {
    styleOf = trailStyles(store.state.program, TRAIL_COLORS);
  });
  store.watch(["runs", "kept_runs", "program", "goal", "snapshot"], (changed) => {
    const { runs, kept_runs: kept, goal } = store.state;
    setAttribute(element, ABSENT, !runs);
    if (changed.has("snapshot")) shown.clear();
    const names = [...new Set(runs?.names)].filter((name) => kept[name]);
    for (const name of shown.keys()) if (!names.includes(name)) shown.delete(name);
    for (const name of names) shown.set(name, lastResult(kept[name]!, shown.get(name)));
    const failed = names.filter((name) => isFailed(shown.get(name)!));
    const isSettled = !names.some((name) => isOutdated(shown.get(name)!));
    if (isSettled) first = new Set(failed); // nothing changes its place before all is known
    const sorted = [...names].sort((a, b) => Number(first.has(b)) - Number(first.has(a)));
    reconcile(
      list,
      sorted,
      (name) => name,
      (name) => new RunRow(lab, name, leave).element,
      (row, name) => rows.get(row)!.update(shown.get(name)!, styleOf),
    );
    search.update(failed.length > 0 || isCheckFailed(goal));
    setText(heading, failed.length ? `Runs (${failed.length})` : "Runs");
    setAttribute(list, "data-empty", names.length ? null : EMPTY);
    setProse(error, runs?.error ?? "");
    if (names.every((name) => !shown.get(name)!.waits))
      setText(result, resultOf(names.length, failed.length));
    setProse(where, runs ? placesOf([runs.folder, ...runs.attached]) : "");
    const row = [...list.children].find((each) => each.getAttribute("data-key") === focused);
    if (!row) return;
    rows.get(row)!.focus();
    focused = "";
  });
  store.watch(["reached"], () => {
    const found = store.state.reached;
    setHidden(reached, !found);
    if (found) setProse(reached, found.words);
  });
  return element;
}

function lastResult(run: KeptRunView, before: Shown | undefined): Shown {
  const waits = run.state === "waiting";
  if (waits && before) return { ...before, expected: run.expected, waits };
  return { ...run, waits };
}

/** Whether what is shown is the result with an earlier program. */
const isOutdated = ({ waits, state }: Pick<Shown, "waits" | "state">) => waits && state !== "waiting";

const isFailed = ({ state }: Pick<Shown, "state">) => state === "failed" || state === "problem";

function resultOf(all: number, failed: number): string {
  const some = failed < all ? `${failed} of them ` : "";
  return all ? `${counted(all)}, ${failed ? `${some}not ` : ""}as expected.` : "";
}

function placesOf(folders: readonly string[]): string {
  const [own, ...others] = folders.map((folder) => `\`${folder}\``);
  return `Kept in ${own}${others.length ? `; also shown: ${others.join(", ")}` : ""}.`;
}

/** Why a run failed, and where it differs from the recording. */
export function reasonOf({
  reason,
  differs,
  issues,
}: Pick<KeptRunView, "reason" | "differs" | "issues">): string {
  const other =
    differs && !reason.includes(differs[1]) ? `differs at ${differs[0].toFixed(1)} s: ${differs[1]}` : "";
  const found = issues ? `It ends with ${issues === 1 ? "1 issue" : `${issues} issues`}.` : "";
  return [reason, other, found].filter(Boolean).map(sentence).join(" ");
}

function sentence(words: string): string {
  const begun = words.charAt(0).toUpperCase() + words.slice(1);
  return /[.!?…]$/.test(begun) ? begun : `${begun}.`;
}

const rows = new WeakMap<Element, RunRow>();

class RunRow {
  readonly element: HTMLElement;
  private shown: Shown | null = null;
  private styleOf: unknown = null;
  private readonly mark = h("span", { class: "lrp-run-mark", "aria-hidden": "true" });
  private readonly verdict = h("span", { class: "lrp-hidden" });
  private readonly go: HTMLButtonElement;
  private readonly length = h("span", { class: "lrp-run-length lrp-faint" });
  private readonly strip = s("svg", {
    class: "lrp-strip",
    preserveAspectRatio: "none",
    height: STRIP,
    role: "img",
  });
  private readonly tip = s("title");
  private readonly expected: HTMLButtonElement;
  private readonly reason = h("span", { class: "lrp-run-reason" });
  private readonly accept: HTMLButtonElement;
  private readonly openLoop = h("p", { class: "lrp-faint" });
  private readonly words: HTMLElement;
  /** What is asked in place: another name, what is expected, whether the run is to be removed. */
  private readonly asked = h("div", { class: "lrp-run-asked", hidden: true });

  constructor(
    private readonly lab: Lab,
    private readonly name: string,
    /** Names the run that gets the focus when this one goes. */
    private readonly leave: (other: string) => void,
  ) {
    this.go = linkButton("", {
      class: "lrp-link lrp-run-name",
      title: `${name}: run it again in the lab, and look at its first difference, or where it fails`,
      "data-lrp-action": "show-run",
    });
    this.go.append(this.verdict, h("span", {}, name));
    this.expected = linkButton("", {
      class: "lrp-link lrp-run-expected",
      title: "Change what is expected",
      "data-lrp-action": "expect",
      onclick: () => this.expect(),
    });
    this.accept = linkButton("Take as expected", {
      title: "Replace the recording by this run with the present program",
      "data-lrp-action": "accept-run",
      onclick: () => void disabledDuring(this.accept, lab.act({ do: "accept_run", name })),
    });
    const menu = menuButton(
      lab.root,
      { title: `More for ${name}`, action: "run-menu" },
      `Run ${name}`,
      () => [
        item("Change what is expected…", "expect", () => this.expect()),
        item("Rename…", "rename-run", () => this.rename()),
        item("Remove…", "forget-run", () => this.remove()),
      ],
    );
    this.strip.addEventListener("pointermove", (event) => this.point(event));
    this.words = h("p", { class: "lrp-run-words" }, this.expected, this.reason, this.accept);
    this.element = h(
      "li",
      {
        class: "lrp-run",
        "data-lrp-run": name,
        onclick: ({ target }: Event) => {
          const pressed = (target as Element).closest("button, input, .lrp-run-asked");
          if (!pressed || pressed === this.go) void this.show();
        },
      },
      ...[this.mark, this.go, this.strip, this.length, menu, this.words, this.openLoop, this.asked],
    );
    rows.set(this.element, this);
  }

  update(shown: Shown, styleOf: (state: string) => Style): void {
    const before = this.shown;
    this.shown = shown;
    const { state, seconds, expected, differs, open_loop: openLoop, lane } = shown;
    setAttribute(this.element, "data-state", state);
    setAttribute(this.element, "data-outdated", isOutdated(shown));
    setText(this.mark, MARKS[state]);
    setText(this.verdict, `${VERDICTS[state]}: `);
    setText(this.length, seconds ? `${seconds.toFixed(1)} s` : "");
    setText(this.expected, expected);
    setAttribute(this.expected, "aria-label", `${expected}: what is expected of ${this.name}`);
    setProse(this.reason, reasonOf(shown));
    setHidden(this.accept, !differs);
    setProse(this.openLoop, openLoop);
    setHidden(this.openLoop, !openLoop);
    const difference = differs ? `, different from ${differs[0].toFixed(1)} s on` : "";
    setAttribute(this.strip, "aria-label", `States of ${nameOf(lane)}, recorded and now${difference}`);
    if (styleOf === this.styleOf && before && isSameCourse(before, shown)) return;
    this.styleOf = styleOf;
    drawStrip(this.strip, shown, styleOf);
  }

  focus(): void {
    this.go.focus({ preventScroll: true });
  }

  private point({ clientX, clientY }: PointerEvent): void {
    const { left, top, width, height } = this.strip.getBoundingClientRect();
    const words = this.shown && stripWords(this.shown, (clientX - left) / width, (clientY - top) / height);
    if (!this.tip.isConnected) this.strip.append(this.tip);
    setText(this.tip, words ?? "");
  }

  private async show(): Promise<void> {
    if (this.element.hasAttribute("aria-busy")) return;
    setAttribute(this.element, "aria-busy", "true"); // it may take some seconds
    await this.lab.act({ do: "show_run", name: this.name });
    setAttribute(this.element, "aria-busy", null);
  }

  private expect(): void {
    const { name, lab } = this;
    const { input, error } = editing(
      this.shown?.expected ?? "",
      `What is expected of ${name}`,
      (expected) => lab.act({ do: "expect", name, expected }, true),
      () => this.answered(this.expected),
    );
    this.ask(input, input, proposing(input, lab.store.state), error);
    this.expected.hidden = true;
    input.select();
  }

  private rename(): void {
    const { name, lab } = this;
    const { input, error } = editing(
      name,
      `Another name for ${name}`,
      async (other) => {
        const refusal = await lab.act({ do: "rename_run", name, new_name: other.trim() }, true);
        if (!refusal) this.leave(other.trim());
        return refusal;
      },
      () => this.answered(this.go),
    );
    this.ask(input, input, error);
    input.select();
  }

  private remove(): void {
    const { name, lab } = this;
    const cancel = () => this.answered(this.go);
    const remove = linkButton("Remove", {
      class: "lrp-button",
      "data-lrp-action": "forget-run-now",
      onclick: async () => {
        const { nextElementSibling: after, previousElementSibling: before } = this.element;
        if (await lab.act({ do: "forget_run", name })) return;
        this.leave((after ?? before)?.getAttribute("data-key") ?? "");
        cancel();
      },
    });
    const leave = linkButton("Cancel", { class: "lrp-button", onclick: cancel });
    this.ask(remove, h("span", {}, `Remove ${name}?`), remove, leave);
  }

  /** Ask something in place; Escape leaves it. */
  private ask(first: HTMLElement, ...content: HTMLElement[]): void {
    this.expected.hidden = false;
    this.asked.replaceChildren(...content);
    this.asked.onkeydown = (event) => {
      if (event.key === "Escape") this.answered(this.go);
    };
    setHidden(this.asked, false);
    first.focus();
  }

  private answered(focused: HTMLElement): void {
    if (this.asked.hidden) return;
    this.expected.hidden = false;
    focused.focus({ preventScroll: true });
    setHidden(this.asked, true);
    this.asked.replaceChildren();
  }
}

function isSameCourse(a: Shown, b: Shown): boolean {
  return a.recorded === b.recorded && a.now === b.now && a.seconds === b.seconds && a.differs === b.differs;
}
