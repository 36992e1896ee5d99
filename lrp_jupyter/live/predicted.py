"""The findings of the checks that predict issues of a run: one fault is told once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from lrp_jupyter.interpreter.issues import Issue, IssueKind
from lrp_jupyter.language.program import Finding

CODES: Mapping[IssueKind, frozenset[str]] = {
    "exception": frozenset(
        {"LRP312", "LRP503", "LRP518", *(f"LRP{number}" for number in range(520, 526))}
        | {"LRP532", "LRP533", "LRP534"}
    ),
    "not boolean": frozenset({"LRP505", "LRP508", "LRP522", "LRP524", "LRP527", "LRP533"}),
    "not a delay": frozenset({"LRP505", "LRP508"}),
    "unknown event": frozenset({"LRP301"}),
    "unknown state": frozenset({"LRP303", "LRP305", "LRP306", "LRP307", "LRP310"}),
    "unknown machine": frozenset({"LRP304", "LRP309"}),
    "unknown variable": frozenset({"LRP308", "LRP311", "LRP502", "LRP503", "LRP531"}),
    "already running": frozenset({"LRP407", "LRP408"}),
    "defined twice": frozenset({"LRP201"}),
}
"""The codes of the findings that say the same as issues of a kind."""


def finding_of(issue: Issue, findings: Iterable[Finding]) -> Finding | None:
    """Return the finding about the fault of an issue, the nearest one in its line; None if there is none."""
    codes = CODES.get(issue.kind, frozenset())
    same = (each for each in findings if each.code in codes and each.line == issue.line)
    return min(same, key=lambda each: abs(each.column - issue.column), default=None)
