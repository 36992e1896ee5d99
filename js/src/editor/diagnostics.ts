/** Findings of the checks and issues of the run, underlined at their places: one truth, the kernel's. */

import { type Diagnostic, diagnosticCount, setDiagnostics } from "@codemirror/lint";
import type { EditorView } from "@codemirror/view";
import type { FindingView, IssueView, Severity, TextRange } from "../protocol";
import type { LabState } from "../session/state";
import { h, prose } from "../ui/dom";
import type { Tracked } from "./texts";

const SEVERITY: Record<Severity, Diagnostic["severity"]> = {
  error: "error",
  warning: "warning",
  hint: "info",
};

export function showDiagnostics(view: EditorView, lab: LabState, sent: Tracked, running: Tracked): void {
  if (!lab.findings.length && !Object.keys(lab.issues).length && !diagnosticCount(view.state)) return;
  const diagnostics: Diagnostic[] = [];
  for (const finding of lab.findings) {
    const found = ofFinding(view, finding, sent);
    if (found) diagnostics.push(found);
  }
  for (const issue of Object.values(lab.issues)) {
    const found = issue.resolved ? null : ofIssue(view, issue, running);
    if (found) diagnostics.push(found);
  }
  diagnostics.sort((a, b) => a.from - b.from);
  view.dispatch(setDiagnostics(view.state, diagnostics));
}

function ofFinding(view: EditorView, finding: FindingView, sent: Tracked): Diagnostic | null {
  const span = visible(view, finding.range, sent);
  if (!span) return null;
  const { fix } = finding;
  const apply = (editor: EditorView) => {
    const changes = fix!.edits.flatMap(({ range, text }) => {
      const place = sent.span(range);
      return place ? [{ ...place, insert: text }] : [];
    });
    editor.dispatch({ changes, userEvent: "input.fix" });
  };
  return {
    ...span,
    severity: SEVERITY[finding.severity],
    message: finding.message,
    renderMessage: () => message(finding.code, finding.message),
    actions: fix ? [{ name: fix.title.replaceAll("`", ""), apply }] : [],
  };
}

function ofIssue(view: EditorView, issue: IssueView, running: Tracked): Diagnostic | null {
  const span = issue.range && visible(view, issue.range, running);
  if (!span) return null;
  return {
    ...span,
    severity: SEVERITY[issue.severity],
    message: issue.message,
    renderMessage: () => message(issue.code, issue.message, `${issue.count}×`),
  };
}

function message(code: string, sentence: string, note = ""): HTMLElement {
  return h("div", {}, ...prose(sentence), h("span", { class: "lrp-code" }, ` ${code} ${note}`));
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
