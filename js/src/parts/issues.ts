/** Findings of the checks and issues of the run in one list, each once, counted, with its place. Paper: §6.2. */

import type { FindingView, IssueView, Severity, TextRange } from "../protocol";
import { placeOf } from "../session/instances";
import type { LabState } from "../session/state";
import type { Lab } from "../session/store";
import { iconButton, linkButton, panel } from "../ui/button";
import { h, prose, reconcile, setAttribute, setText } from "../ui/dom";
import { codeButton } from "./explain";

interface Entry {
  key: string;
  code: string;
  severity: Severity;
  message: string;
  range: TextRange | null;
  /** Whether the range refers to the running text, which may differ from the one in the editor. */
  ofRunning: boolean;
  issue: IssueView | null;
}

export function issuesView(lab: Lab): HTMLElement {
  const { store } = lab;
  const clear = iconButton("clear", "Clear: remove the run-time issues", "clear", () => {
    void lab.act({ do: "clear_issues" });
  });
  const list = h("ul", { class: "lrp-issues" });
  const { element, heading } = panel("issues", "Issues", [clear], list, printed(lab));
  store.watch(["findings", "issues", "instances"], () => {
    const { findings, issues } = store.state;
    const entries = entriesOf(findings, Object.values(issues));
    reconcile(
      list,
      entries,
      ({ key }) => key,
      (entry) => make(lab, entry),
      (item, entry) => update(item, entry, store.state),
    );
    const open = entries.filter(({ issue }) => !issue?.resolved).length;
    setText(heading, open ? `Issues (${open})` : "Issues");
    setAttribute(list, "data-empty", entries.length ? null : "No issues.");
    clear.disabled = !Object.keys(issues).length;
  });
  return element;
}

export function errorsIn({ findings, issues }: Pick<LabState, "findings" | "issues">): number {
  const entries = entriesOf(findings, Object.values(issues));
  return entries.filter(({ severity, issue }) => severity === "error" && !issue?.resolved).length;
}

/** Findings and issues, the resolved ones last; an issue that names a finding is listed once, as that finding. */
export function entriesOf(findings: FindingView[], issues: IssueView[]): Entry[] {
  const isResolved = ({ issue }: Entry) => Number(issue?.resolved ?? false);
  const same = new Map(issues.map((issue) => [issue.finding, issue]));
  const known = new Set(findings.map(({ id }) => id));
  const all: Entry[] = [
    ...findings.map(({ id, code, severity, message, range }, index) => ({
      key: `${code} ${message} ${index}`,
      ...{ code, severity, message, range },
      ofRunning: false,
      issue: same.get(id) ?? null,
    })),
    ...issues
      .filter(({ finding }) => !known.has(finding))
      .map((issue) => {
        const { id, code, severity, message, range } = issue;
        return { key: `issue ${id}`, code, severity, message, range, ofRunning: true, issue };
      }),
  ];
  return all.sort((a, b) => isResolved(a) - isResolved(b));
}

function make(lab: Lab, entry: Entry): HTMLElement {
  const item = h("li", { class: "lrp-issue", "data-lrp-issue": entry.code });
  const go = h(
    "button",
    {
      type: "button",
      class: "lrp-issue-go",
      onclick: () => {
        const { range, issue, ofRunning } = current.get(item) ?? entry;
        if (range) lab.goToRange(range, ofRunning);
        else if (issue) lab.notify(issue.message);
      },
    },
    h("span", { class: "lrp-dot", "aria-hidden": "true" }),
    h("span", { class: "lrp-issue-text" }),
  );
  item.append(go, h("span", { class: "lrp-issue-note" }));
  if (entry.code) item.append(codeButton(lab, entry.code), debugButton(lab, item)); // else a notice of the robot
  if (entry.issue?.traceback)
    item.append(h("details", {}, h("summary", {}, "Traceback"), h("pre", { tabindex: "0" })));
  return item;
}

function debugButton(lab: Lab, item: Element): HTMLButtonElement {
  const { state } = lab.store;
  return linkButton("Debug", {
    class: "lrp-link lrp-debug",
    title: "Open a debugger at the last occurrence, in a cell below",
    "data-lrp-action": "debug",
    onclick: () => {
      const { line, column } = current.get(item)?.issue?.range ?? {};
      if (line) lab.runBelow(`${state.debugger} ${line}:${column} ${state.name}`);
    },
  });
}

/** The entry that each element of the list shows. */
const current = new WeakMap<Element, Entry>();

function update(item: Element, entry: Entry, state: LabState): void {
  const before = current.get(item);
  current.set(item, entry);
  const { issue, severity, range, message } = entry;
  setAttribute(item, "data-severity", severity);
  setAttribute(item, "data-resolved", issue?.resolved ?? false);
  const text = item.querySelector(".lrp-issue-text")!;
  if (before?.message !== message)
    text.replaceChildren(h("span", { class: "lrp-hidden" }, `${severity}: `), ...prose(message));
  setText(item.querySelector(".lrp-issue-note")!, note(issue, range, state));
  const debug = item.querySelector<HTMLElement>(".lrp-debug");
  if (debug) debug.hidden = !state.debugger || !issue?.range;
  const trace = item.querySelector("pre");
  if (trace && issue) setText(trace, issue.traceback);
}

function note(issue: IssueView | null, range: TextRange | null, state: LabState): string {
  const parts = [range ? `line ${range.line}` : ""];
  if (issue) {
    const { first_tick: first, last_tick: last, count } = issue;
    parts.push(
      whereOf(issue, state),
      count > 1 ? `${count}×, ticks ${first}–${last}` : `tick ${first}`,
      issue.resolved ? "resolved" : "",
    );
  }
  return parts.filter(Boolean).join(" · ");
}

/** In which instances an issue has occurred; empty if its machine can run in one place only. */
export function whereOf({ instances }: IssueView, state: LabState): string {
  const places = instances.map((path) => placeOf(state, path) || path).sort();
  return places.length ? `in ${places.join(", ")}` : "";
}

/** The output of blocks, shown in the lab and never in another cell. */
function printed(lab: Lab): HTMLElement {
  const lines = h("pre", { class: "lrp-output", tabindex: "0", "aria-label": "Printed by the program" });
  const details = h("details", { class: "lrp-details", open: true }, h("summary", {}, "Output"), lines);
  lab.store.watch(["printed", "snapshot"], () => {
    const { printed: all } = lab.store.state;
    const texts = Object.values(all); // in the order of their numbers
    details.hidden = texts.length === 0;
    const atEnd = lines.scrollTop + lines.clientHeight >= lines.scrollHeight - 4;
    setText(lines, texts.join("\n"));
    if (atEnd) lines.scrollTop = lines.scrollHeight;
  });
  return details;
}
