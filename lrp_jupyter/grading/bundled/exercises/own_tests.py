"""Exercises of lesson 16: programs that work where they were written, and not yet in all situations."""

from __future__ import annotations

import math
from dataclasses import replace

from lrp_jupyter.grading.bundled.exercises.exercise import exercise, says
from lrp_jupyter.grading.bundled.exercises.exercise_worlds import RADIUS, across, hall, lane
from lrp_jupyter.grading.bundled.rooms import THICK
from lrp_jupyter.grading.challenge import Hint
from lrp_jupyter.grading.criteria import ends_in, ends_still, never_pushes, touches, touches_nothing, visits
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.grading.variation import moves, wears
from lrp_jupyter.sim.world import BoxZone, World

__all__ = ["EXERCISES"]

_NOISE = {"motor": 0.02, "distance": 0.005}
_FAR = 3.2 - THICK  # m, where the wall of a lane is
_HAD_FAILED = says(
    "The robot touched the wall. Shortly before, its sensor had failed: it read `inf`, as if nothing were"
    " there. How far does the robot drive in the second for which that lasts?",
    lambda run: (
        run.touch()
        and "robot.distance" in run.programs[-1].text
        and any(math.isinf(sample.distances[0]) for sample in run.samples[-15:])
    ),
)


def _regression(*worlds: str) -> Hint:
    """Return a hint for worlds in which the program that one begins with passes."""
    return says(
        "With the program that you began with, this run passes: an edit has broken it. Which one, and how?",
        lambda run: run.world.name in worlds,
    )


def _narrow(ahead: float, behind: float) -> World:
    """Return a hall with a zone for a robot that is 10 cm away from both walls at least."""
    world = hall(ahead, behind)
    width, height = world.size
    free = width - 2 * (THICK + RADIUS + 0.1)
    zones = {"between the walls": BoxZone((width / 2, height / 2, free, height))}
    return replace(world, zones=zones)


def _return(ahead: float) -> World:
    """Return a hall with a zone close to the wall, and one where the robot begins."""
    world = hall(ahead)
    (x, y, _), (width, height) = world.robots[0].pose, world.size
    near = BoxZone((width - THICK - RADIUS - 0.175, y, 0.35, height))
    return replace(world, zones={"near the wall": near, "home": BoxZone((x, y, 0.2, height))})


def _gap(run: RunRecord) -> float:
    """Return how far the robot is from the wall ahead of it in the end, in metres."""
    return run.world.size[0] - THICK - RADIUS - run.samples[-1].x


EXERCISES = (
    exercise(
        "16.1",
        "Drive to the wall ahead. After the bump, back off and stop, at least 10 cm away from both walls, in"
        " wide rooms and in narrow ones. In the narrowest room, the robot has only 30 cm to move in.",
        (_narrow(1.0, 0.5), _narrow(0.5, 0.6), _narrow(0.2, 0.1)),
        touches("wall ahead"),
        never_pushes(1),
        ends_in("between the walls"),
        ends_still(2),
        seconds=30,
        hints=(
            says(
                "The robot backed off as far as the wall behind it. How far does it drive backward, and how"
                " much space is there?",
                lambda run: run.touch("wall behind"),
            ),
            _regression("wall after 1 m", "wall after 0.5 m"),
            says(
                "The robot stopped less than 10 cm before the wall ahead.",
                lambda run: run.stood > 1 and _gap(run) < 0.1,
            ),
        ),
    ),
    exercise(
        "16.2",
        "Stop 15 to 35 cm before the wall, and touch nothing, although the distance sensor fails now and"
        " then: for a second, it reads `inf`.",
        tuple(hall(ahead, distance=0.25) for ahead in (1.2, 0.8)),
        touches_nothing(),
        ends_in("before the wall"),
        ends_still(2),
        seconds=40,
        seeds=8,
        noise={**_NOISE, "dropout": 0.06},
        hints=(
            _HAD_FAILED,
            says(
                "The robot stopped less than 15 cm before the wall. How far does it drive in a second for"
                " which its sensor fails?",
                lambda run: run.stood > 1 and _gap(run) < 0.15,
            ),
            says(
                "Time ran out before the robot was at the wall. Which speed is slow enough for the sensor,"
                " and fast enough for the time limit?",
                lambda run: run.stood < 1 and not run.touch(),
            ),
        ),
    ),
    exercise(
        "16.3",
        "Stop on the line, to within 5 cm, whether it is black or grey. Grey reads about 90. Where there is"
        " no line, stop 15 to 35 cm before the wall. Touch nothing.",
        (
            lane("black line", across((1.4, 0.06)), 1.4, 0.1),
            lane("line near the wall", across((_FAR - 0.22, 0.06)), _FAR - 0.22, 0.1),
            lane("grey line", across((1.4, 0.06), grey=90), 1.4, 0.1),
            lane("no line", across(), _FAR - 0.27, 0.2),
        ),
        touches_nothing(),
        ends_in("stop"),
        ends_still(2),
        seconds=60,
        noise={**_NOISE, "light": 5},
        vary=moves("robot", x=0.1, y=0.2),
        hints=(
            _regression("black line", "line near the wall"),
            says(
                "The robot drove over the grey line. White reads 255, and this grey reads 90.",
                lambda run: run.world.name == "grey line" and run.samples[-1].x > 1.45,
            ),
            says(
                "The robot touched the wall of a lane that has no line. What else can tell it to stop?",
                lambda run: run.world.name == "no line" and run.touch(),
            ),
            says(
                "There is no line in this world, and the robot did not stop 15 to 35 cm before the wall.",
                lambda run: run.world.name == "no line" and run.stood > 1,
            ),
        ),
    ),
    exercise(
        "16.5",
        "Drive towards the wall until it is less than 35 cm away, and back to where the robot began, to"
        " within 10 cm. Touch nothing. This has to work in every room and with every battery, although the"
        " distance sensor fails now and then: for a second, it reads `inf`.",
        tuple(map(_return, (1.2, 2.6, 0.6))),
        touches_nothing(),
        visits("near the wall", "home"),
        ends_in("home"),
        ends_still(2),
        seconds=30,
        seeds=8,
        noise={**_NOISE, "dropout": 0.04},
        vary=wears(speed=0.1),
        hints=(
            _HAD_FAILED,
            says(
                "The robot stopped, but not where it began. What says how far away from its start it is, in"
                " each room?",
                lambda run: run.stood > 1 and ends_in("home").missing(run),
            ),
            says(
                "Time ran out. Where does it do no harm if the sensor fails? There the robot may be quick.",
                lambda run: run.stood < 1 and not run.touch(),
            ),
        ),
    ),
)
