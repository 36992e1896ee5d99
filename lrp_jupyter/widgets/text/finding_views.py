"""The findings of the checks and the changes of an edit, in the form that pages show."""

from __future__ import annotations

from lrp_jupyter.errors import Fix
from lrp_jupyter.language.diff import diff
from lrp_jupyter.language.program import Finding, Program
from lrp_jupyter.widgets.wire.page_places import edits_view
from lrp_jupyter.widgets.wire.protocol import Difference, FindingView, QuickFix


def finding_id(finding: Finding) -> str:
    """Return the identity of a finding among those of its text."""
    return f"{finding.code} {finding.line}:{finding.column} {finding.message}"


def finding_view(finding: Finding, text: str) -> FindingView:
    """Return a finding about a text, as pages show it."""
    return {
        "id": finding_id(finding),
        "code": finding.code,
        "severity": finding.severity,
        "message": finding.message,
        "range": {
            "line": finding.line,
            "column": finding.column,
            "end_line": finding.end_line,
            "end_column": finding.end_column,
        },
        "fix": _fix_view(finding.fix, text),
        "creates": _fix_view(finding.creates, text),
    }


def _fix_view(fix: Fix | None, text: str) -> QuickFix | None:
    return None if fix is None else {"title": fix.title, "edits": edits_view(text, fix.edits)}


def difference_view(old: Program, new: Program) -> Difference:
    """Return the changes that an edit would make."""
    changes = diff(old, new)
    return {
        "added": [str(element) for element in changes.added],
        "removed": [str(element) for element in changes.removed],
        "changed": [str(element) for element in changes.changed],
        "moved": [str(element) for element in changes.moved],
    }
