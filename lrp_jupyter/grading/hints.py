"""Hints for a failed run: those of its challenge, and those that every challenge gives.

They come in the order of their certainty. What failed is certain; what the checks find in the text, too; then
comes what was seen in the run, and last what often is the cause.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from lrp_jupyter.errors import Finding
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.general_hints import (
    compares_exactly,
    moved_once,
    never_commanded,
    never_drove,
    no_command_at_the_end,
    time_was_over,
    turned_for_ever,
)
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.live.predicted import finding_of

_NEVER = frozenset({"LRP401", "LRP402", "LRP404", "LRP405", "LRP406", "LRP409"})
"""The codes of the findings that name what a run never enters, spawns or follows."""


def hints_of(task: Challenge, run: RunRecord) -> Iterator[str]:
    """Yield the hints for the mistakes that are found in a run, the most certain first."""
    if task.exam:
        return
    errors = _findings(run, lambda finding: finding.severity == "error")
    if run.issues:
        yield _issue(run)
    yield from errors[:1]  # that no run has met, such as a misspelt name in another state
    is_sound = not run.issues and not errors
    if not any(sample.active for sample in run.samples):
        if is_sound:
            yield "Nothing was active. Write `(spawn machine state)` outside all machines to start one."
        return
    found = [*_findings(run, lambda finding: finding.code in _NEVER)[:1], *compares_exactly(run)]
    if is_sound:
        found += [*time_was_over(task, run), *turned_for_ever(run), *never_commanded(task, run)]
    found += moved_once(run)
    for hint in task.hints:
        text = hint(run)
        found += filter(None, [text] if isinstance(text, str) else text or ())
    if is_sound and not found:
        found = [*never_drove(run), *no_command_at_the_end(run)]
    yield from found
    others = _findings(run, lambda finding: finding.severity == "warning" and finding.code not in _NEVER)
    yield from others[:1]


def _issue(run: RunRecord) -> str:
    """Say what failed; of a misspelt name, the checks know what was meant."""
    issue = run.issues[0]
    return f"Line {issue.line}: {(finding_of(issue, run.findings) or issue).message}"


def _findings(run: RunRecord, are_meant: Callable[[Finding], bool]) -> list[str]:
    return [f"Line {each.line}: {each.message}" for each in run.findings if are_meant(each)]
