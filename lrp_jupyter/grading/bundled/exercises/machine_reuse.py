"""Exercises of lesson 13: one machine in several states, and what is done when a transition fires."""

from __future__ import annotations

from lrp_jupyter.grading.bundled.exercises.exercise import exercise, says
from lrp_jupyter.grading.bundled.exercises.exercise_criteria import turns_to
from lrp_jupyter.grading.criteria import Criterion, ends_in, ends_still, reused, visits
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.sim.world import CircleZone, RobotSpec, World

__all__ = ["EXERCISES"]

_ROOM = World(name="wide room", size=(3, 2.4), robots=(RobotSpec((1.5, 1.2, 0)),))
_SIDES = (0.2, 0.4, 0.6, 0.8)  # m


def _spiral() -> World:
    """Return a world with zones at the corners of a spiral whose sides grow."""
    x, y, zones = 1.3, 1.1, {}
    for number, (side, (along, up)) in enumerate(
        zip(_SIDES, ((1, 0), (0, 1), (-1, 0), (0, -1)), strict=True), 1
    ):
        x, y = x + side * along, y + side * up
        zones[f"corner {number}"] = CircleZone((x, y, 0.17))
    return World(name="spiral", size=(2.6, 2.2), robots=(RobotSpec((1.3, 1.1, 0)),), zones=zones)


def _three_circles(run: RunRecord) -> tuple[float, str]:
    return 3.5 <= run.driven <= 4.1, f"it drove {run.driven:.2f} m"


_ONE_WAY = says(
    "The robot did not turn to the right. Give the second spawn another value of `side`:"
    " `(spawn circle driving (var side := [-1]))`.",
    lambda run: run.turned.right < 45,
)
_GOES_ON = says(
    "The robot never stopped. `eights` has to grow when the transition from `right` to `left` fires:"
    " `(effect [eights += 1])`, before its last bracket.",
    lambda run: run.stood < 1,
)
_TOO_SOON = says(
    "The robot stopped after its first eight. The robot begins in `left`, when no eight is complete yet.",
    lambda run: run.stood > 1,
)

EXERCISES = (
    exercise(
        "13.1",
        "Drive a figure of eight: a circle to the left, then one to the right. The machine `circle`, which"
        " is written once, drives both.",
        _ROOM,
        turns_to("left", 300),
        turns_to("right", 300),
        reused("circle"),
        seconds=40,
        seeds=3,
        hints=(_ONE_WAY,),
    ),
    exercise(
        "13.2",
        "Drive two figures of eight, and then stop.",
        _ROOM,
        turns_to("left", 660),
        turns_to("right", 660),
        reused("circle"),
        ends_still(2),
        seconds=70,
        seeds=3,
        hints=(_GOES_ON, _TOO_SOON),
    ),
    exercise(
        "13.3",
        "Drive a circle to the left with a radius of 25 cm, a small one to the right with a radius of 10 cm,"
        " another large one to the left, and then stop. The machine `circle`, which is written once, drives"
        " all three.",
        _ROOM,
        turns_to("left", 620),
        turns_to("right", 300),
        reused("circle", 3),
        Criterion("drives 3.5 m to 4.1 m", _three_circles),
        ends_still(2),
        seconds=60,
        seeds=3,
        hints=(
            _ONE_WAY,
            says(
                "The small circle is as large as the others: a spawn can set several variables,"
                " `(var side := [-1]) (var radius := [0.1])`.",
                lambda run: run.driven > 4.1,
            ),
            says(
                "There is no third circle. A third state can spawn `circle` again.",
                lambda run: run.turned.left < 620,
            ),
        ),
    ),
    exercise(
        "13.5",
        "Drive a spiral: four sides of 20, 40, 60 and 80 cm, with a quarter turn to the left after each,"
        " and then stop.",
        _spiral(),
        visits(*(f"corner {number}" for number, _ in enumerate(_SIDES, 1))),
        ends_in("corner 4"),
        ends_still(2),
        seconds=60,
        seeds=3,
        noise={"motor": 0.01},
        hints=(
            says(
                "All sides have the same length. `(spawn leg side (var way := [ways[n]]))` gives each use"
                " of `leg` its own; and `n` has to grow when one is done, in an `(effect …)`.",
            ),
        ),
    ),
)
