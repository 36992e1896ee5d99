"""Hints that every challenge gives, from what a run and its program have in common with many others."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise, takewhile

from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.run_record import RunRecord, Sample
from lrp_jupyter.language.checks.uses import uses_of
from lrp_jupyter.language.program import Block, Machine, Program, State
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.live.running.frame import is_active

_DRIVES = frozenset({"move", "drive_by", "turn_by", "drive_to"})
_MOVE = frozenset({"move"})
_ORDERS = _DRIVES | {"stop"}
_PACE = 1.5  # times longer than usual that a step of a task may take while a robot is on its way …
_PAUSE = 2.0  # … or so many seconds, such as for a turn


# -- what a text says ------------------------------------------------------------------------------------


def _commands(actions: Iterable[object], names: frozenset[str] = _DRIVES) -> bool:
    """Return whether one of some actions commands the robot to drive, or something else."""
    blocks = (action for action in actions if isinstance(action, Block))
    return any(
        use.role == "called" and not names.isdisjoint(use.names)
        for block in blocks
        for use in uses_of("robot", block.text)
    )


def _states(program: Program) -> Iterator[tuple[Machine, State]]:
    for _, machine in program.walk():
        for state in machine.states:
            yield machine, state


def _driving(program: Program) -> list[str]:
    """Return the names of the states that command the robot to drive, each once."""
    moving = (state for _, state in _states(program) if _commands((*state.onentry, *state.running)))
    return list(dict.fromkeys(str(state.name) for state in moving))


def _not_entered(names: Sequence[str]) -> str:
    verb, those = ("command", "any of them") if len(names) > 1 else ("commands", "that state")
    return (
        f"only {_listed(names, 'and')} {verb} it, and the run never entered {those}. Which transition leads"
        " there, and what does it wait for?"
    )


def _listed(names: Sequence[str], word: str) -> str:
    quoted = [f"`{name}`" for name in names]
    return f" {word} ".join(filter(None, [", ".join(quoted[:-1]), quoted[-1]]))


def compares_exactly(run: RunRecord) -> Iterator[str]:
    """Say that a measured value is compared with `==`, where it never had that value."""
    for place in resolve(run.programs[-1]).all_blocks:
        for use in uses_of("robot", place.block.text):
            other, written = use.other, ".".join(["robot", *use.names])
            if other is None or (other.sign, other.kind) != ("==", "number"):
                continue
            if written in _MEASURED and not _was(run, written, other.value):
                line, _ = run.programs[-1].place(place.block.at(use.span).start)
                yield (
                    f"Line {line}: `{written} == {other.value}` asks for exactly {other.value}, and a"
                    " measured value is hardly ever exact. Compare it with `<` or `>`."
                )
                return


_MEASURED = frozenset({"robot.light.data", "robot.distance.data", "robot.gyro.data"})


def _was(run: RunRecord, reading: str, value: object) -> bool:
    """Return whether a sensor has read a value, in any tick."""
    if reading == "robot.light.data":
        return any(value in sample.lights for sample in run.samples)
    return reading == "robot.distance.data" and any(value in sample.distances for sample in run.samples)


# -- what a run was --------------------------------------------------------------------------------------


def time_was_over(task: Challenge, run: RunRecord) -> Iterator[str]:
    """Say that the time was over while the robot was still on its way, and went on as fast as before."""
    steps = run.steps
    if not steps or run.seconds < task.seconds - 1e-6 or run.stood > 1:
        return
    gaps = [after - before for before, after in pairwise([0.0, *steps])]
    longest = _PACE * max(sorted(gaps)[(len(gaps) - 1) // 2], _PAUSE)
    lately = (sample for sample in run.samples if sample.time > run.seconds - longest)
    if max(*gaps, run.seconds - steps[-1]) > longest or not any(sample.command[0] for sample in lately):
        return
    missing = (each.missing(run) for each in task.criteria if each.when == "once")
    reason = next(filter(None, missing), None)
    if reason:
        yield (
            f"Time ran out after {task.seconds:g} s, and the robot was still on its way: {reason}."
            " Where does it lose time? Let it drive faster, or turn faster."
        )


def turned_for_ever(run: RunRecord) -> Iterator[str]:
    """Say that the robot was turning on the spot in a state that it did not leave any more."""
    last = run.samples[-1]
    turning = list(takewhile(lambda sample: _turns_alike(sample, last), reversed(run.samples)))
    if not turning or len(turning) == len(run.samples):
        return
    since = turning[-1].time
    if abs(last.command[1]) * (last.time - since) < 3 * math.pi:
        return  # it may look around
    for machine, state in _states(run.programs[-1]):
        if not is_active(state.name, last.active) or not _commands((*state.onentry, *state.running), _MOVE):
            continue
        if any(transition.leaves(state.name) for transition in machine.transitions):
            ask = f". What does the transition that leads out of `{state.name}` wait for?"
        else:
            ask = f": no transition leads out of `{state.name}`. Which state has to come next, and when?"
        yield f"The robot began to turn on the spot after {since:.1f} s and never stopped{ask}"
        return


def _turns_alike(sample: Sample, last: Sample) -> bool:
    return sample.active == last.active and not sample.command[0] and bool(sample.command[1])


def never_commanded(task: Challenge, run: RunRecord) -> Iterator[str]:
    """Say that the robot was told nothing, and where the program would have done it."""
    if run.commands or not any(criterion.needs_motion for criterion in task.criteria):
        return
    program = run.programs[-1]
    names = _driving(program)
    if any(run.entered(name) for name in names):
        name = next(name for name in names if run.entered(name))
        yield (
            f"The robot never received a command, although `{name}` was entered: its block did not come to"
            " the command. On which condition does that depend?"
        )
    elif names:
        yield f"The robot never received a command: {_not_entered(names)}"
    elif not _commands((place.block for place in resolve(program).all_blocks), _ORDERS):
        yield (
            "The robot never received a command. Put `robot.move(linear=0.2)` into the `running` of the state"
            " in which it has to drive."
        )


def moved_once(run: RunRecord) -> Iterator[str]:
    """Say that a command in `onentry` holds for half a second only, where that has stopped the robot."""
    if not any(notice.kind == "command watchdog" for notice in run.notices):
        return
    names = {
        state.name
        for _, state in _states(run.programs[-1])
        if _commands(state.onentry, _MOVE) and not _commands(state.running, _ORDERS)
    }
    for before, now in pairwise(run.samples):
        if any(now.command) or not any(before.command):
            continue
        state = next((path[-1] for path in now.active if path in before.active and path[-1] in names), None)
        if state is not None:
            yield (
                f"`{state}` moves the robot in `onentry`, which runs only once, and a command holds for half"
                f" a second: the robot stopped after {now.time:.1f} s. Put `move` into `running`, which runs"
                " in every tick."
            )
            return


def never_drove(run: RunRecord) -> Iterator[str]:
    """Say that the robot was commanded, but never to move."""
    if not run.commands or any(any(sample.command) for sample in run.samples):
        return
    told = "The robot was never told to drive"
    names = _driving(run.programs[-1])
    if not names:
        yield f"{told}. `robot.move(linear=0.2)` drives on at 0.2 m/s."
    elif not any(run.entered(name) for name in names):
        yield f"{told}: {_not_entered(names)}"
    elif not any(is_active(name, sample.active) for name in names for sample in run.samples[1:]):
        name = next(name for name in names if run.entered(name))
        yield (
            f"{told}: `{name}` was left before its first `running`. Which transition leads out of it at once,"
            " and is it right where the robot begins?"
        )
    else:
        yield f"{told}, although {_listed(names, 'or')} was active. At which speed does its block drive?"


def no_command_at_the_end(run: RunRecord) -> Iterator[str]:
    """Say in which state the robot got no more commands, if it stopped because of that."""
    if run.stood < 1 or not any(notice.kind == "command watchdog" for notice in run.notices):
        return
    names = [path[-1] for path in run.samples[-1].active]
    if names:
        yield (
            f"The robot got no more commands in {_listed(names, 'and')}, and a command holds for half a"
            f" second: it stopped after {run.still_since:.1f} s. If it has to drive there, put `robot.move`"
            " into `running`."
        )
