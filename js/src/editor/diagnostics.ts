/** Findings of the checks and issues of the run, underlined at their places: one truth, the kernel's. */

import { type Action, type Diagnostic, forEachDiagnostic, setDiagnostics } from "@codemirror/lint";
import type { EditorView } from "@codemirror/view";
import { codeButton } from "../parts/explain";
import { whereOf } from "../parts/issues";
import type { FindingView, IssueView, QuickFix, Severity, TextRange } from "../protocol";
import type { Lab } from "../session/store";
import { h, prose, unmarked } from "../ui/dom";
import { select } from "./cursor";
import { Tracked } from "./texts";

const SEVERITY: Record<Severity, Diagnostic["severity"]> = {
  error: "error",
  warning: "warning",
  hint: "info",
};

/**
 * Mark what is found in the text sent, and what else went wrong in the running one. Marks that would be the same
 * are left, with the card that is open at one of them.
 */
export class Underlines {
  /** The text sent that the marks were made for. */
  readonly text = new Tracked();

  show(view: EditorView, lab: Lab, sent: Tracked, running: Tracked): void {
    const { findings, issues } = lab.store.state;
    const known = new Set(findings.map(({ id }) => id));
    const others = Object.values(issues).filter(({ resolved, finding }) => !resolved && !known.has(finding));
    const wanted = [
      ...findings.map((finding) => ofFinding(view, lab, finding, sent, this.text)),
      ...others.map((issue) => ofIssue(view, lab, issue, running)),
    ].filter((mark) => mark !== null);
    wanted.sort((a, b) => a.from - b.from);
    const present: string[] = [];
    forEachDiagnostic(view.state, (mark, from, to) => present.push(identity(mark, from, to)));
    const next = wanted.map((mark) => identity(mark, mark.from, mark.to));
    const same = present.sort().join() === next.sort().join();
    if (!same || !next.length) this.text.become(sent);
    if (!same) view.dispatch(setDiagnostics(view.state, wanted));
  }
}

/** What tells a mark from another. */
function identity({ severity, message, actions = [] }: Diagnostic, from: number, to: number): string {
  return JSON.stringify([from, to, severity, message, actions.map(({ name }) => name)]);
}

function ofFinding(
  view: EditorView,
  lab: Lab,
  finding: FindingView,
  sent: Tracked,
  marked: Tracked,
): Diagnostic | null {
  const span = visible(view, finding.range, sent);
  if (!span) return null;
  const fixes = [finding.fix, finding.creates].filter((fix) => fix !== null);
  return {
    ...span,
    severity: SEVERITY[finding.severity],
    message: finding.message,
    renderMessage: () => {
      const issues = Object.values(lab.store.state.issues);
      const same = issues.find((issue) => issue.finding === finding.id);
      return message(lab, finding.code, finding.message, same && times(lab, same));
    },
    actions: fixes.map((fix) => action(fix, marked)),
  };
}

/** A fix as a button; the value that it leaves to be written is selected. */
function action({ title, edits }: QuickFix, marked: Tracked): Action {
  const apply = (view: EditorView) => {
    const changes = edits.flatMap(({ range, text }) => {
      const place = marked.span(range);
      return place ? [{ ...place, insert: text }] : [];
    });
    view.dispatch({ changes, userEvent: "input.fix" });
    const [only] = changes;
    const value = changes.length === 1 && only!.from === only!.to && /\[(.+)\]/.exec(only!.insert);
    if (value) {
      const from = only!.from + value.index + 1;
      select(view, from, from + value[1]!.length);
      view.focus();
    }
  };
  return { name: unmarked(title), apply };
}

function ofIssue(view: EditorView, lab: Lab, issue: IssueView, running: Tracked): Diagnostic | null {
  const span = issue.range && visible(view, issue.range, running);
  if (!span) return null;
  return {
    ...span,
    severity: SEVERITY[issue.severity],
    message: issue.message,
    renderMessage: () => {
      return message(lab, issue.code, issue.message, times(lab, lab.store.state.issues[issue.id] ?? issue));
    },
  };
}

function times(lab: Lab, issue: IssueView): string {
  return [`${issue.count}×`, whereOf(issue, lab.store.state)].filter(Boolean).join(" ");
}

function message(lab: Lab, code: string, sentence: string, note = ""): HTMLElement {
  const count = h("span", { class: "lrp-code" }, ` ${note}`);
  return h("div", {}, ...prose(sentence), " ", codeButton(lab, code), count);
}

/** A span that can be seen: an empty one is widened to a character, or to its line. */
function visible(view: EditorView, range: TextRange, text: Tracked): { from: number; to: number } | null {
  const span = text.span(range);
  if (!span || span.to > view.state.doc.length) return null;
  if (span.from < span.to) return span;
  const line = view.state.doc.lineAt(span.from);
  if (span.from < line.to) return { from: span.from, to: span.from + 1 };
  return { from: Math.max(line.from, span.from - 1), to: span.from };
}
