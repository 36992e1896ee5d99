"""Exercises of lesson 5: what runs inside a state, and how the machine around it knows of it."""

from __future__ import annotations

from dataclasses import replace

from lrp_jupyter.grading.bundled.common_hints import kept_pushing
from lrp_jupyter.grading.bundled.exercises.exercise import exercise, says
from lrp_jupyter.grading.bundled.exercises.exercise_criteria import turns_to
from lrp_jupyter.grading.bundled.exercises.exercise_worlds import HALLS
from lrp_jupyter.grading.bundled.rooms import ROOMS, room
from lrp_jupyter.grading.criteria import (
    backs_off,
    bumps,
    ends_in,
    ends_still,
    looks,
    never_pushes,
    touches,
    touches_nothing,
)
from lrp_jupyter.grading.criteria.motion import backed
from lrp_jupyter.grading.variation import moves
from lrp_jupyter.sim.world import BoxZone, Pose, World

__all__ = ["EXERCISES"]

_LONG, _WIDE, _END = 2.3, 1.0, 0.6  # m
_TURNED = moves("robot", x=0.1, y=0.1, degrees=60)


def _chamber(name: str, width: float, height: float, pose: Pose, far: tuple[float, float]) -> World:
    """Return a room in which one wall is further away than the others; the zone `far end` is before it."""
    return replace(room(name, width, height, pose), name=name, zones={"far end": BoxZone((*far, _END, _END))})


_CHAMBERS = (
    _chamber("far ahead", _LONG, _WIDE, (0.5, 0.5, 0), (_LONG - 0.4, 0.5)),
    _chamber("far behind", _LONG, _WIDE, (_LONG - 0.5, 0.5, 0), (0.4, 0.5)),
    _chamber("far on the left", _WIDE, _LONG, (0.5, 0.5, 0), (0.5, _LONG - 0.4)),
    _chamber("far on the right", _WIDE, _LONG, (0.5, _LONG - 0.5, 0), (0.5, 0.4)),
)

EXERCISES = (
    exercise(
        "5.1",
        "Drive up to the wall ahead, look at least 40° to the left and to the right there, and then drive"
        " backward to the wall behind.",
        HALLS,
        looks("before the wall", 40),
        touches("wall behind"),
        seconds=60,
        vary=moves("robot", x=0.15, y=0.3),
        hints=(
            says(
                "The robot stood before the wall: the machine `look` never ran. `(spawn look left)` in the"
                " `onentry` of `looking` starts it.",
                lambda run: run.entry("before the wall") and run.stood > 3,
            ),
        ),
    ),
    exercise(
        "5.2",
        "At a bump the robot has to back off and turn: let it do both, until it has bumped into three"
        " different walls.",
        ROOMS,
        bumps(3, walls=3),
        backs_off(2),
        never_pushes(1),
        seconds=60,
        vary=_TURNED,
        hints=(
            kept_pushing,
            says(
                "The robot never turned, so it came back to the same wall: `escaping` was left too early, and"
                " with it `escape` ended. Let `driving` wait until `escape` is in its state `done`.",
                lambda run: run.turned.total < 60,
            ),
        ),
    ),
    exercise(
        "5.3",
        "Bump three times, and back off and turn each time. After the third time stop, and stay.",
        ROOMS,
        bumps(3),
        backs_off(3),
        ends_still(2),
        never_pushes(1),
        seconds=60,
        vary=_TURNED,
        hints=(
            kept_pushing,
            says(
                "The robot never stopped. Look at `bumps` in the lab: it gets its first value again whenever"
                " `escape` is spawned. Declare further out what has to survive.",
                lambda run: run.fold(backed, 0) > 3,
            ),
            says(
                "The robot stopped too early. It has to back off and turn after the third bump, too.",
                lambda run: run.stood > 2,
            ),
        ),
    ),
    exercise(
        "5.5",
        "Look in all four directions, ahead, left, behind, right, and then drive towards the wall that is"
        " furthest away. Stop before it, and touch nothing.",
        _CHAMBERS,
        turns_to("left", 240),
        touches_nothing(),
        ends_in("far end"),
        ends_still(2),
        seconds=60,
        vary=moves("robot", x=0.05, y=0.05, degrees=5),
        hints=(
            says(
                "The robot has to look in all four directions, and the readings have to be kept:"
                " `[seen.append(robot.distance.data)]`.",
                lambda run: run.turned.left < 240,
            ),
            says(
                "The robot drove to a wall that is not the furthest one. `seen.index(max(seen))` is the"
                " position of the greatest of the four readings: 0 ahead, 1 left, 2 behind, 3 right.",
            ),
        ),
    ),
)
