"""Exercises of lesson 10: numbers that work in nine of ten runs."""

from __future__ import annotations

from dataclasses import replace

from lrp_jupyter.grading.bundled.exercises.exercise import exercise, says
from lrp_jupyter.grading.bundled.exercises.exercise_worlds import RADIUS, across, hall, lane
from lrp_jupyter.grading.bundled.rooms import THICK
from lrp_jupyter.grading.criteria import ends_in, ends_still, near_line, touches_nothing, visits, within
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.grading.variation import moves
from lrp_jupyter.sim.world import BoxZone

__all__ = ["EXERCISES"]

_LANE = lane("line", across((1.6, 0.06)), 1.6, 0.2)
_WIDE = lane("wide line", across((1.6, 0.15)), 1.6, 0.3)
_HALL = replace(hall(1.8), zones={"before the wall": BoxZone((2.58 - THICK - RADIUS - 0.21, 0.8, 0.42, 1.6))})
_ELSEWHERE = moves("floor", "stop", x=0.4)
_NEAR = near_line(0.15)


def _stopped(run: RunRecord) -> bool:
    return run.stood > 1


_FALSE_ALARM = says(
    "The robot stopped before the line: noise alone was below the threshold. A lower one is more certain; how"
    " low may it be so that the line itself is not missed? Let a sweep try.",
    _stopped,
)
_MISSED = says(
    "The robot drove over the line: on black, noise kept the reading above the threshold.",
    lambda run: not _stopped(run),
)

EXERCISES = (
    exercise(
        "10.1",
        "Stop at the line in nine out of ten runs, although the light sensor is poor.",
        _LANE,
        ends_in("stop"),
        ends_still(2),
        seconds=40,
        seeds=20,
        needed=0.9,
        noise={"motor": 0.02, "light": 50},
        vary=_ELSEWHERE,
        hints=(_FALSE_ALARM, _MISSED),
    ),
    exercise(
        "10.2",
        "Stop before the wall, no further than 40 cm away, in nine out of ten runs. Now and then the distance"
        " sensor sees something that is not there.",
        _HALL,
        touches_nothing(),
        ends_in("before the wall"),
        ends_still(2),
        seconds=60,
        seeds=20,
        needed=0.9,
        noise={"motor": 0.02, "distance": 0.12},
        vary=moves("robot", x=0.3, y=0.2),
        hints=(
            says(
                "The robot stopped too early: a single reading was below the threshold. You can require a"
                " condition to hold `for` a while, such as 300 ms.",
                _stopped,
            ),
        ),
    ),
    exercise(
        "10.3",
        "Follow the line to the right end, to the left end, and to the right end again within 70 seconds, in"
        " nine out of ten runs, although the sensor and the motors are poor.",
        "oval",
        within(70, visits("right", "left", "right")),
        _NEAR,
        seconds=70,
        seeds=20,
        needed=0.9,
        noise={"motor": 0.2, "light": 40},
        vary=moves("robot", x=0.1),
        hints=(
            says(
                "The robot lost the line. A slower robot, or a tighter bend, comes back to it sooner: sweep"
                " one number, and then the other.",
                lambda run: _NEAR.missing(run),
            ),
            says(
                "Time ran out. The robot has to be faster, but not too fast: let a sweep try.",
            ),
        ),
    ),
    exercise(
        "10.5",
        "Stop at the wide line in nine out of ten runs. The light sensor is so poor that a single reading"
        " tells you nothing.",
        _WIDE,
        ends_in("stop"),
        ends_still(2),
        seconds=60,
        seeds=20,
        needed=0.9,
        noise={"motor": 0.02, "light": 110},
        vary=_ELSEWHERE,
        hints=(
            says(
                "The robot stopped before the line, because of a single reading. Take several together: a"
                " condition that has to hold `for` a while, or a variable that follows the readings slowly.",
                _stopped,
            ),
            _MISSED,
        ),
    ),
)
