"""Eight programs with one mistake each, of the kinds that students make, in rising difficulty."""

from __future__ import annotations

from dataclasses import replace

from lrp_jupyter.grading.bundled.exercises.exercise import bug, says
from lrp_jupyter.grading.bundled.exercises.exercise_worlds import HALLS, across, hall, lane
from lrp_jupyter.grading.bundled.rooms import ROOMS
from lrp_jupyter.grading.criteria import (
    backs_off,
    backs_off_at_bumps,
    bumps,
    ends_in,
    ends_still,
    finds_line,
    near_line,
    never_pushes,
    stays_in,
    stops_at,
    touches,
    touches_nothing,
    visits,
)
from lrp_jupyter.grading.criteria.motion import backed
from lrp_jupyter.grading.variation import moves
from lrp_jupyter.sim.world import World

__all__ = ["BUGS"]

_STARTS = moves("robot", x=0.15, y=0.3)
_TURNED = moves("robot", x=0.1, y=0.1, degrees=60)


def _stripes(name: str, first: float, gap: float) -> World:
    """Return a lane with five wide lines, and the zone `stop` at the third."""
    lines = tuple((first + number * gap, 0.06) for number in range(5))
    return replace(lane(name, across(*lines), lines[2][0], 0.18), name=name)


BUGS = (
    bug(
        1,
        "Drive to the wall. After the bump, drive backward for two seconds, and stop.",
        tuple(hall(ahead, distance=0.38) for ahead in (0.6, 1.0, 1.5)),
        touches("wall ahead"),
        never_pushes(1),
        ends_in("before the wall"),
        ends_still(2),
        seconds=30,
        vary=_STARTS,
        hints=(
            says(
                "The robot hardly backed off. Ask `tstop` why it fired: how long had `backing` been active?",
            ),
        ),
    ),
    bug(
        2,
        "Drive up to the wall, and stop about 30 cm before it.",
        tuple(map(hall, (0.65, 1.05, 1.55))),  # in steps of 2 cm, no reading is 0.3
        touches_nothing(),
        ends_in("before the wall"),
        ends_still(2),
        seconds=30,
        vary=_STARTS,
        hints=(
            says(
                "The robot drove into the wall. Go back to the moment at which it was 30 cm away, and ask"
                " `tstop`: what exactly did the sensor read?",
            ),
        ),
    ),
    bug(
        3,
        "Drive up to the wall, slowly from 60 cm on, and stop about 20 cm before it.",
        tuple(hall(ahead, distance=0.2) for ahead in (0.9, 1.2, 1.5)),
        touches_nothing(),
        ends_in("before the wall"),
        ends_still(2),
        seconds=30,
        vary=_STARTS,
        hints=(
            says(
                "The robot drove into the wall. Which state was active when it was 20 cm away? Ask `tstop` at"
                " that moment.",
            ),
        ),
    ),
    bug(
        4,
        "Drive along the edge of the line, to the right end, to the left end, and to the right end again.",
        "oval",
        near_line(0.15),
        visits("right", "left", "right"),
        seconds=90,
        seeds=4,
        vary=moves("robot", x=0.1),
        hints=(
            says(
                "The robot drives in a circle. Ask it why it does this, once in `left` and once in"
                " `right`: what is the difference?",
                lambda run: near_line(0.15).missing(run),
            ),
        ),
    ),
    bug(
        5,
        "Back off at each bump, turn, and drive on. Stop after the third bump.",
        ROOMS,
        backs_off_at_bumps(1),
        bumps(3),
        backs_off(3),
        ends_still(2),
        seconds=60,
        vary=_TURNED,
        hints=(
            says(
                "The robot stopped after its first bump. Step through that moment, and watch `bumps`: in"
                " which ticks does it grow?",
                lambda run: run.stood > 2 and run.fold(backed, 0) < 2,
            ),
        ),
    ),
    bug(
        6,
        "Drive to the wall ahead, back off, turn round, drive to the wall behind, and stop there.",
        HALLS,
        touches("wall ahead", "wall behind"),
        never_pushes(1),
        stops_at("wall behind", 1),
        ends_still(2),
        seconds=60,
        vary=_STARTS,
        hints=(
            says(
                "The robot ended at the first wall. Ask why `ended` was entered: in the tick before, was the"
                " bumper pressed, and what was the value of `bumps`?",
                lambda run: not run.touch("wall behind"),
            ),
        ),
    ),
    bug(
        7,
        "Drive about, turn every four seconds, and stop for good on the black border.",
        "arena",
        finds_line(),
        stays_in("inside"),
        ends_still(5),
        seconds=60,
        seeds=6,
        vary=moves("robot", x=0.3, y=0.2, degrees=180),
        hints=(
            says(
                "The robot was on the border, stood there for four seconds, and left it. Put a breakpoint on"
                " `turning`, and ask which transition led there, and from which state.",
            ),
        ),
    ),
    bug(
        8,
        "Stop on the third of the five lines. The robot does so in some runs, and stops too early in others.",
        (_stripes("stripes", 1.0, 0.3), _stripes("narrow stripes", 0.9, 0.22)),
        ends_in("stop"),
        ends_still(2),
        seconds=40,
        seeds=12,
        noise={"motor": 0.02, "light": 45},
        vary=_STARTS,
        hints=(
            says(
                "The robot stopped too early: it counted a line more than once, or one that is not there."
                " Put a breakpoint on `black`, and look at the readings of the light sensor in the ticks"
                " around it.",
                lambda run: run.stood > 1,
            ),
        ),
    ),
)
