"""Hints for a failed run: those of its challenge, and those that every challenge gives."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.language.checks.uses import uses_of
from lrp_jupyter.language.program import Block, Program
from lrp_jupyter.live.predicted import finding_of


def hints_of(task: Challenge, run: RunRecord) -> Iterator[str]:
    """Yield the hints for the mistakes that are found in a run, the most important first."""
    if task.exam:
        return
    if not any(sample.active for sample in run.samples):
        yield "Nothing was active. Write `(spawn machine state)` outside all machines to start one."
    if run.issues:
        yield _issue(run)
    yield from _findings(run, "error")[:1]  # that no run has met, such as a misspelt name in another state
    if not run.commands and any(criterion.needs_motion for criterion in task.criteria):
        yield (
            "The robot never received a command. Put `robot.move(linear=0.2)` into the `running` of a state."
        )
    watchdog = [notice.text for notice in run.notices if notice.kind == "command watchdog"]
    if watchdog:
        yield from _moved_once(run)
    for hint in task.hints:
        found = hint(run)
        yield from filter(None, [found] if isinstance(found, str) else found or ())
    if run.commands and not any(any(sample.command) for sample in run.samples):
        yield "The robot was never told to drive. `robot.move(linear=0.2)` drives on at 0.2 m/s."
    yield from watchdog[:1]
    yield from _findings(run, "warning")[:1]


def _issue(run: RunRecord) -> str:
    """Say what failed; of a misspelt name, the checks know what was meant."""
    issue = run.issues[0]
    return f"Line {issue.line}: {(finding_of(issue, run.findings) or issue).message}"


def _findings(run: RunRecord, severity: str) -> list[str]:
    return [f"Line {each.line}: {each.message}" for each in run.findings if each.severity == severity]


def _moved_once(run: RunRecord) -> Iterator[str]:
    """Say that a command in `onentry` holds for half a second only, where that has stopped the robot."""
    names = set(_states_that_move_once(run.programs[-1]))
    for before, now in pairwise(run.samples):
        if any(now.command) or not any(before.command):
            continue
        state = next((path[-1] for path in now.active if path in before.active and path[-1] in names), None)
        if state is not None:
            yield (
                f"`{state}` moves the robot in `onentry`, which is done once, and a command holds for half a"
                f" second: the robot stopped after {now.time:.1f} s. Put `move` into `running`, which is done"
                " in every tick."
            )
            return


def _states_that_move_once(program: Program) -> Iterator[str]:
    for _, machine in program.walk():
        for state in machine.states:
            if _moves(state.onentry) and not _moves(state.running):
                yield state.name


def _moves(actions: tuple[object, ...]) -> bool:
    blocks = (action for action in actions if isinstance(action, Block))
    return any("move" in use.names for block in blocks for use in uses_of("robot", block.text))
