"""The findings of a text as an editor marks them, and their fixes as it offers them."""

from __future__ import annotations

from collections.abc import Iterator

from lsprotocol import types as lsp

from lrp_jupyter.codes import DOCUMENTATION, address_of
from lrp_jupyter.editors.certain_fixes import apply_fixes
from lrp_jupyter.editors.program_text import ProgramText
from lrp_jupyter.errors import Edit, Finding, Fix
from lrp_jupyter.language.edits.text_difference import text_difference
from lrp_jupyter.programs import heading, line_of

QUICK, ALL = lsp.CodeActionKind.QuickFix, lsp.CodeActionKind.SourceFixAll
"""The kinds of fixes: one, and all together."""
_SEVERITIES = {
    "error": lsp.DiagnosticSeverity.Error,
    "warning": lsp.DiagnosticSeverity.Warning,
    "hint": lsp.DiagnosticSeverity.Information,  # some editors list no hints
}


def marks(text: ProgramText) -> list[lsp.Diagnostic]:
    """Return the marks of a text."""
    found = [_mark(text, finding) for finding in text.findings]
    problem = text.robot.read(text.text).problem
    if problem:  # it begins with the number of the line
        line = line_of(text.text, str(heading(text.text).world)) - 1
        start = text.at.offset(lsp.Position(line, 0))
        place = lsp.Range(lsp.Position(line, 0), text.at.line_end(start))
        found.append(lsp.Diagnostic(place, problem, lsp.DiagnosticSeverity.Error, source="lrp"))
    return found


def _mark(text: ProgramText, finding: Finding) -> lsp.Diagnostic:
    return lsp.Diagnostic(
        text.at.range_of_finding(finding),
        finding.message,
        _SEVERITIES[finding.severity],
        finding.code,
        lsp.CodeDescription(address_of(finding.code)) if DOCUMENTATION else None,
        "lrp",
    )


def fixes(uri: str, text: ProgramText, start: int, end: int) -> Iterator[lsp.CodeAction]:
    """Yield the fixes of what is found in a range, and all certain ones of the text together."""
    for finding in text.findings:
        first, last = text.at.span(text.at.range_of_finding(finding))
        if first <= end and start <= last:
            mark = [_mark(text, finding)]
            for fix in filter(None, (finding.fix, finding.creates)):
                edit = _edit(uri, text, fix)
                certain = fix is finding.fix
                yield lsp.CodeAction(fix.title, QUICK, diagnostics=mark, is_preferred=certain, edit=edit)
    count = sum(finding.fix is not None for finding in text.findings)
    if count:
        yield lsp.CodeAction("Apply all certain fixes", ALL, data={"uri": uri})  # made when it is chosen


def fix_all(uri: str, text: ProgramText) -> lsp.WorkspaceEdit:
    """Return all certain fixes of a text, one after the other, as `lrp check --fix` applies them."""
    fixed = text.text
    for after, _ in apply_fixes(text.text, text.check):
        fixed = after
    edits, at = [], 0
    for length, new in text_difference(text.text, fixed):
        if new is not None:
            edits.append(Edit(at, at + length, new))
        at += length
    return _edit(uri, text, Fix("", tuple(edits)))


def _edit(uri: str, text: ProgramText, fix: Fix) -> lsp.WorkspaceEdit:
    return lsp.WorkspaceEdit({uri: [text.at.edit(edit) for edit in fix.edits]})
