"""Exercises of lesson 12: edits of a program whose robot must not stop, or not hit anything meanwhile."""

from __future__ import annotations

from dataclasses import replace

from lrp_jupyter.grading.bundled.common_hints import restarted_or_not_edited
from lrp_jupyter.grading.bundled.exercises.exercise import exercise, says
from lrp_jupyter.grading.bundled.exercises.exercise_worlds import hall
from lrp_jupyter.grading.criteria import (
    Criterion,
    edited,
    ends_in,
    ends_still,
    keeps_driving,
    never_restarts,
    slows_to,
    stops_at,
    touches,
    touches_nothing,
    visits,
)
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.grading.variation import moves
from lrp_jupyter.sim.world import BoxZone, World

__all__ = ["EXERCISES"]

_LONG = tuple(map(hall, (1.5, 1.8)))
_STARTS = moves("robot", x=0.1, y=0.2)
_SLOW, _FROM = 0.15, 0.45  # m/s; m before the wall


def _patrol(ahead: float) -> World:
    """Return a hall with a zone at both ends."""
    world = hall(ahead, behind=0.6)
    width, height = world.size
    zones = {"west": BoxZone((0.4, height / 2, 0.5, height))}
    zones["east"] = BoxZone((width - 0.4, height / 2, 0.5, height))
    return replace(world, zones=zones)


def _slow_near_the_wall(run: RunRecord) -> tuple[float, str]:
    fast = run.first(lambda sample: sample.distances[0] < _FROM and sample.command[0] > _SLOW + 1e-6, "fast")
    return fast is None, "it was slow there" if fast is None else f"it was too fast after {fast.time:.1f} s"


EXERCISES = (
    exercise(
        "12.1",
        "The robot is on its way to the wall. Change the program before it gets there, without a restart, so"
        " that a bump stops it within a second.",
        _LONG,
        edited(),
        touches("wall ahead"),
        stops_at("wall ahead", 1),
        ends_still(2),
        never_restarts(),
        seconds=40,
        live=2,
        vary=_STARTS,
        hints=(
            restarted_or_not_edited,
            says(
                "The robot kept pushing. When it bumps, a transition has to lead from `driving` to"
                " `stopped`.",
                lambda run: run.touch("wall ahead"),
            ),
        ),
    ),
    exercise(
        "12.2",
        "The robot is about to hit the wall: it turns too late. Change the program while it runs, without a"
        " restart, so that the robot patrols from wall to wall and touches neither.",
        tuple(map(_patrol, (1.5, 1.8))),
        edited(),
        visits("east", "west"),
        touches_nothing(),
        never_restarts(),
        seconds=60,
        live=2,
        vary=_STARTS,
        hints=(
            restarted_or_not_edited,
            says(
                "The robot touched a wall. `near` is in metres: 0.3 is 30 cm.",
                lambda run: run.touch(),
            ),
        ),
    ),
    exercise(
        "12.3",
        "Change the program while it runs, without a restart: within 45 cm of the wall, the robot must not"
        " be faster than 0.15 m/s. It has to stop before the wall as it does now.",
        tuple(hall(ahead, distance=0.2) for ahead in (1.7, 2.0)),
        edited(),
        Criterion("is never faster than 0.15 m/s near the wall", _slow_near_the_wall, "always"),
        touches_nothing(),
        ends_in("before the wall"),
        ends_still(2),
        never_restarts(),
        seconds=40,
        live=2,
        vary=_STARTS,
        hints=(
            restarted_or_not_edited,
            says(
                "The robot was too fast near the wall. A state that drives slowly has to be entered before it"
                " is 45 cm away.",
            ),
        ),
    ),
    exercise(
        "12.5",
        "The robot drives in a circle. Let it drive on at half the speed, without a restart. Its only state"
        " is always active, and the speed is written in the `running` of that state.",
        "empty",
        edited(),
        slows_to(0.5),
        keeps_driving(1),
        never_restarts(),
        seconds=60,
        live=3,
        vary=moves("robot", x=0.1, y=0.1, degrees=180),
        hints=(
            restarted_or_not_edited,
            says(
                "After the edit the robot did not drive on at half the speed.",
                lambda run: slows_to(0.5).missing(run),
            ),
        ),
    ),
)
