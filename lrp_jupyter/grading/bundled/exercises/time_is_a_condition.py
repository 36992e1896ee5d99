"""Exercises of lesson 3: how long a state is active, and how long something has been true."""

from __future__ import annotations

from lrp_jupyter.grading.bundled.exercises.exercise import exercise, says
from lrp_jupyter.grading.bundled.exercises.exercise_criteria import rests_in
from lrp_jupyter.grading.bundled.exercises.exercise_worlds import across, lane, polygon
from lrp_jupyter.grading.criteria import (
    drives_straight,
    ends_in,
    ends_still,
    lit_while,
    touches,
    visits,
)
from lrp_jupyter.grading.run_record import RunRecord, Sample
from lrp_jupyter.grading.variation import moves
from lrp_jupyter.sim.world import CircleZone, RobotSpec, World

__all__ = ["EXERCISES"]

_THIN, _WIDE = 0.03, 0.2  # m
_STREETS = (
    lane("three thin lines", across((0.8, _THIN), (1.1, _THIN), (1.9, _WIDE), (2.4, _THIN)), 1.9, 0.3),
    lane("two thin lines", across((1.0, _THIN), (1.4, _WIDE), (1.9, _THIN)), 1.4, 0.3),
    lane("thin lines near the wall", across((0.9, _WIDE), (1.6, _THIN), (2.6, _THIN)), 0.9, 0.3),
)
_METRE = World(
    name="a metre",
    size=(2.4, 1.4),
    robots=(RobotSpec((0.5, 0.7, 0)),),
    zones={"mark": CircleZone((1.5, 0.7, 0.1))},
)


def _stands(sample: Sample) -> bool:
    return not any(sample.command)


def _turned(degrees: float, least: int) -> list[object]:
    """Return a hint for robots that turn by a different angle at their corners."""

    def about(run: RunRecord) -> str | None:
        if run.turned.total < least:
            return None
        return (
            f"The robot drove {run.driven:.2f} m and turned {run.turned.left:.0f}° in all. At 1 rad/s, a"
            f" corner of {degrees:g}° takes {degrees * 3.14159 / 180 * 1000:.0f} ms."
        )

    return [about]


EXERCISES = (
    exercise(
        "3.1",
        "Drive one metre, to the mark, and stop there.",
        _METRE,
        ends_in("mark"),
        ends_still(2),
        seconds=20,
        seeds=4,
        hints=(
            says(
                "The robot stopped before the mark. How long does a metre take at 0.2 m/s, in milliseconds?",
                lambda run: run.driven < 0.9,
            ),
            says(
                "The robot went too far. How long does a metre take at 0.2 m/s, in milliseconds?",
                lambda run: run.driven > 1.1,
            ),
        ),
    ),
    exercise(
        "3.2",
        "The robot drives triangles. Let it drive a square instead, with straight sides of 40 cm.",
        polygon(4, 0.4, 0.15),
        visits("corner 1", "corner 2", "corner 3", "home"),
        drives_straight(0.8),
        seconds=40,
        seeds=4,
        hints=_turned(90, 90),
    ),
    exercise(
        "3.3",
        "The robot drives a triangle and stops. Let it drive a hexagon with sides of 30 cm, and stop where it"
        " began.",
        polygon(6, 0.3, 0.16),
        visits("corner 1", "corner 2", "corner 3", "corner 4", "corner 5", "home"),
        drives_straight(0.8),
        ends_in("home"),
        ends_still(1),
        seconds=40,
        seeds=4,
        hints=(
            says(
                "The robot stopped after three corners. A hexagon has six.",
                lambda run: run.driven < 1.0 and run.stood > 1,
            ),
            *_turned(60, 60),
        ),
    ),
    exercise(
        "3.5",
        "Drive over the thin lines. On the wide line, stop for three seconds with the lamp lit. Then drive"
        " on to the wall, over more thin lines, with the lamp dark.",
        _STREETS,
        lit_while("stands", _stands, 0.8),
        rests_in("stop", 3),
        touches("wall"),
        seconds=40,
        vary=moves("robot", x=0.15, y=0.2),
        hints=(
            says(
                "The lamp has to be lit while the robot stands on the wide line, and at no other time."
                " `robot.lamp(True)` lights it.",
                lambda run: lit_while("stands", _stands, 0.8).missing(run),
            ),
            says(
                "The robot did not drive on to the wall. After three seconds it is still on the wide line: a"
                " state of its own has to lead away from there, until the sensor sees white.",
                lambda run: not run.touch("wall"),
            ),
            says(
                "The robot has to stand on the wide line for three seconds: `(ontime 3000 …)`.",
                lambda run: rests_in("stop", 3).missing(run),
            ),
        ),
    ),
)
