"""Exercises of lesson 8: programs that do not do what they should, and which the lab can be asked about."""

from __future__ import annotations

from lrp_jupyter.grading.bundled.common_hints import kept_pushing
from lrp_jupyter.grading.bundled.exercises.exercise import exercise, says
from lrp_jupyter.grading.bundled.exercises.exercise_criteria import rests_in
from lrp_jupyter.grading.bundled.exercises.exercise_worlds import HALLS, across, lane
from lrp_jupyter.grading.criteria import ends_in, ends_still, never_pushes, touches
from lrp_jupyter.grading.criteria.line import sees_line
from lrp_jupyter.grading.variation import moves

__all__ = ["EXERCISES"]

_LANES = tuple(lane(f"line at {x:g} m", across((x, 0.05), grey=40), x, 0.2) for x in (1.0, 1.5, 2.2))
_THIN = tuple(lane(f"thin line at {x:g} m", across((x, 0.02)), x, 0.24) for x in (1.0, 1.5, 2.2))
_STARTS = moves("robot", x=0.15, y=0.3)

EXERCISES = (
    exercise(
        "8.1",
        "Stop at the line. The robot does not: ask `tstop`.",
        _LANES,
        ends_in("stop"),
        ends_still(2),
        seconds=20,
        noise={"motor": 0.02, "light": 8},
        vary=_STARTS,
        hints=(
            says(
                "Put a breakpoint on the event, or go back to the moment at which the sensor is over the"
                " line, and ask `tstop`: what is the value of `robot.light.data` there?",
                lambda run: run.first(sees_line),
            ),
        ),
    ),
    exercise(
        "8.2",
        "Stop at the line for two seconds, and then drive on to the wall. The robot stays at the line: ask"
        " `tleave`.",
        _LANES,
        rests_in("stop", 1.8),
        touches("wall"),
        seconds=40,
        vary=_STARTS,
        hints=(
            says(
                "The robot is still at the line. Ask `tleave` there: how many of its 2000 ms have passed,"
                " and which transition makes the timer begin again?",
                lambda run: run.stood > 5,
            ),
        ),
    ),
    exercise(
        "8.3",
        "At the bump, back off, turn round, and drive to the wall behind. Two conditions are never true: ask,"
        " repair one, and ask again.",
        HALLS,
        touches("wall ahead", "wall behind"),
        never_pushes(1),
        seconds=60,
        vary=_STARTS,
        hints=(
            kept_pushing,
            says(
                "The robot turns and turns. Ask `tdrive`: which part of its condition is false when the"
                " robot faces the wall behind?",
                lambda run: run.turned.total > 400,
            ),
        ),
    ),
    exercise(
        "8.5",
        "Stop at the line. The robot does so in some runs, and drives on in others: find out what is"
        " different in those.",
        _THIN,
        ends_in("stop"),
        ends_still(2),
        seconds=20,
        seeds=6,
        vary=_STARTS,
        hints=(
            says(
                "No condition failed: there was no tick in which the sensor was over the line. Step through"
                " the moments before and after the line: how far does the robot move from tick to tick, and"
                " how wide is the line?",
                lambda run: not run.first(sees_line),
            ),
        ),
    ),
)
