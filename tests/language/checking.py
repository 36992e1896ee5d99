"""Shared by the tests of the checks: findings as the text that they mark, and applied fixes."""

from __future__ import annotations

from collections.abc import Collection

from lrp_jupyter.language.checks import check
from lrp_jupyter.language.program import Finding, line_starts


def found(text: str, names: Collection[str] = ()) -> list[tuple[str, str]]:
    """Return the code of every finding, with the piece of text that it marks."""
    return [
        (finding.code, text[start_of(text, finding) : end_of(text, finding)])
        for finding in check(text, names)
    ]


def start_of(text: str, finding: Finding) -> int:
    return line_starts(text)[finding.line - 1] + finding.column - 1


def end_of(text: str, finding: Finding) -> int:
    return line_starts(text)[finding.end_line - 1] + finding.end_column - 1


def message(text: str, names: Collection[str] = ()) -> str:
    """Return the message of the only finding of a text."""
    (finding,) = check(text, names)
    return finding.message


def fixed(text: str, names: Collection[str] = ()) -> str:
    """Apply the fix of the one finding of a text."""
    (finding,) = check(text, names)
    assert finding.fix
    for start, end, replacement in sorted(finding.fix.edits, reverse=True):
        text = text[:start] + replacement + text[end:]
    return text
