"""``lrp check`` and ``lrp grade``: what is wrong with programs, and how they do in a challenge."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from typing import Any

from rich.text import Text

from lrp_jupyter.cli.excerpt import finding_text, plain_console, summary
from lrp_jupyter.cli.source import UnreadableError, read_source
from lrp_jupyter.language.checks import check
from lrp_jupyter.language.program import Finding

__all__ = ["check_files", "grade_file"]


def check_files(files: Sequence[str], as_json: bool) -> int:
    """Report the findings of files; return the exit code: 1 with errors, 2 if one is unreadable."""
    console, complaints = plain_console(), plain_console(stderr=True)
    found: list[Finding] = []
    lines: list[dict[str, Any]] = []
    unreadable = False
    for file in files:
        try:
            source = read_source(file)
        except UnreadableError as error:
            complaints.print(f"lrp: {error}")
            unreadable = True
            continue
        findings = check(source.text)
        found += findings
        for finding in findings:
            lines.append(_as_dict(source.name, finding))
            if not as_json:
                console.print(finding_text(source.name, source.text, finding))
        if not (findings or as_json):
            console.print(f"{source.name}: no findings")
    if as_json:
        json.dump(lines, sys.stdout, ensure_ascii=False, indent=2)
        sys.stdout.write("\n")
    elif found:
        console.print(summary(found))
    return 2 if unreadable else int(any(finding.severity == "error" for finding in found))


def _as_dict(name: str, finding: Finding) -> dict[str, Any]:
    fix = finding.fix
    return {
        "file": name,
        "code": finding.code,
        "severity": finding.severity,
        "message": finding.message,
        "line": finding.line,
        "column": finding.column,
        "end_line": finding.end_line,
        "end_column": finding.end_column,
        "fix": fix and {"title": fix.title, "edits": [edit._asdict() for edit in fix.edits]},
    }


def grade_file(file: str, name: str, seeds: int) -> int:
    """Run a file in every world of a challenge with so many seeds; return 1 if it does not pass."""
    from lrp_jupyter.grading.challenges import challenge
    from lrp_jupyter.grading.grade import grade

    task, source = challenge(name), read_source(file)
    result = grade(source.text, task, seeds)
    report = Text(f"{source.name}, {result}")
    report.highlight_regex(r"✓", "green")
    report.highlight_regex(r"✗", "bold red")
    report.highlight_regex(r"(?m)^Hint:", "bold yellow")
    plain_console().print(report)
    return int(not result.passed)
