"""Hints for a failed run: those of its challenge, and those that every challenge gives."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import partial

from lrp_jupyter.grading.challenge import Challenge, Hint
from lrp_jupyter.grading.record import RunRecord
from lrp_jupyter.language.checks.uses import robot_uses
from lrp_jupyter.language.program import Block, Finding, Program

_NAME = re.compile(r"`[^`]+`")


def hints_of(task: Challenge, run: RunRecord) -> Iterator[str]:
    """Yield the hints for the mistakes that are found in a run, the most important first."""
    finders: tuple[Hint, ...] = (
        _nothing_active,
        _has_issues,
        _has_errors,
        partial(_no_command, task),
        _moves_once,
        *task.hints,
        _never_told_to_drive,
        _watchdog,
        _has_warnings,
    )
    for find in finders:
        if text := find(run):
            yield text


def _nothing_active(run: RunRecord) -> str | None:
    if any(sample.active for sample in run.samples):
        return None
    return "Nothing was active. Write `(spawn machine state)` outside all machines to start one."


def _has_issues(run: RunRecord) -> str | None:
    """Say what failed; of a misspelt name, the checks know what was meant."""
    if not run.issues:
        return None
    line, message = run.issues[0].line, run.issues[0].message
    names = set(_NAME.findall(message))
    same = (each for each in run.findings if each.line == line and names & set(_NAME.findall(each.message)))
    return f"Line {line}: {next((each.message for each in same), message)}"


def _has_errors(run: RunRecord) -> str | None:
    """Say which error the checks find that no run has met, such as a misspelt name in another state."""
    return _finding(run, "error")


def _has_warnings(run: RunRecord) -> str | None:
    return _finding(run, "warning")


def _finding(run: RunRecord, severity: str) -> str | None:
    found: Finding | None = next((each for each in run.findings if each.severity == severity), None)
    return f"Line {found.line}: {found.message}" if found else None


def _no_command(task: Challenge, run: RunRecord) -> str | None:
    if run.commands or not any(criterion.needs_motion for criterion in task.criteria):
        return None
    return "The robot never received a command. Put `robot.move(linear=0.2)` into the `running` of a state."


def _never_told_to_drive(run: RunRecord) -> str | None:
    if not run.commands or any(any(sample.command) for sample in run.samples):
        return None
    return "The robot was never told to drive. `robot.move(linear=0.2)` drives on at 0.2 m/s."


def _moves_once(run: RunRecord) -> str | None:
    """Say that a command in `onentry` holds for half a second only, where that has stopped the robot."""
    notice = next((each for each in run.notices if each.kind == "command watchdog"), None)
    if notice is None:
        return None
    names = set(_states_that_move_once(run.programs[-1]))
    for before, now in zip(run.samples, run.samples[1:], strict=False):
        if any(now.command) or not any(before.command):
            continue
        state = next((path[-1] for path in now.active if path in before.active and path[-1] in names), None)
        if state is not None:
            return (
                f"`{state}` moves the robot in `onentry`, which is done once, and a command holds for half a"
                f" second: the robot stopped after {now.time:.1f} s. Put `move` into `running`, which is done"
                " in every tick."
            )
    return None


def _states_that_move_once(program: Program) -> Iterator[str]:
    for _, machine in program.walk():
        for state in machine.states:
            if _moves(state.onentry) and not _moves(state.running):
                yield state.name


def _moves(actions: tuple[object, ...]) -> bool:
    blocks = (action for action in actions if isinstance(action, Block))
    return any("move" in use.names for block in blocks for use in robot_uses(block.text))


def _watchdog(run: RunRecord) -> str | None:
    return next((notice.text for notice in run.notices if notice.kind == "command watchdog"), None)
