"""Six broken robots: each fails for another reason, which one has to ask for."""

from __future__ import annotations

from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import Criterion, Found, bumps, drives, enters, never_pushes
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.grading.variation import moves

__all__ = ["BROKEN_ROBOTS"]


def _enters_at(state: str, seconds: float, slack: float = 0.25) -> Criterion:
    """Require that a state is entered first at this time."""

    def judge(run: RunRecord) -> Found:
        found = run.entered(state)
        if found is None:
            return Found(run.seconds <= seconds + slack, "not entered yet")
        is_then = abs(found.time - seconds) <= slack
        return Found(is_then, f"entered after {found.time:.1f} s")

    return Criterion(f"enters `{state}` after {seconds:g} s", judge, "always", needs_motion=False)


def _never_enters(state: str) -> Criterion:
    def judge(run: RunRecord) -> Found:
        found = run.entered(state)
        return Found(found is None, f"entered after {found.time:.1f} s" if found else "never entered")

    return Criterion(f"never enters `{state}`", judge, "always", needs_motion=False)


def _ask(transition: str) -> str:
    return (
        f"Ask before you edit: right-click the arrow `{transition}` in the State graph, and choose **Why"
        " not?**. Then repair what the answer names."
    )


_ASK_THE_ROBOT = (
    "Ask before you edit: choose **Why does the robot do this?** in the menu of the World, when it stands."
)


def _robot(number: int, task: str, hint: str, *criteria: Criterion) -> Challenge:
    name = f"robot {number}"
    return Challenge(
        name,
        task,
        ("boxes",),
        criteria,
        10,
        (lambda _: hint,),
        seeds=3,
        vary=moves("box", x=0.25),
        starter=starter(name),
    )


BROKEN_ROBOTS = (
    _robot(
        1,
        "It bumps into a box. Then it should back off: ask `tback`.",
        _ask("tback"),
        enters("driving", "backing"),
        bumps(1),
        never_pushes(0.5),
    ),
    _robot(
        2,
        "It should sleep after a second: ask `tsleep`.",
        _ask("tsleep"),
        enters("awake", "asleep"),
        _enters_at("asleep", 1),
    ),
    _robot(
        3,
        "At level 2 it should sound the alarm: ask `talarm`.",
        _ask("talarm"),
        enters("sinking", "alarm"),
        _never_enters("saving"),
    ),
    _robot(
        4,
        "Its search should swing to the right: ask `tright`.",
        _ask("tright"),
        enters("moving", "left", "right"),
    ),
    _robot(
        5,
        "It should drive: ask the robot.",
        _ASK_THE_ROBOT,
        drives(0.3),
    ),
    _robot(
        6,
        "It should be done after three laps: ask `tdone`.",
        _ask("tdone"),
        enters("counting", "done"),
    ),
)
