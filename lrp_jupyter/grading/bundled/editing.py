"""Challenges about changing a program while it drives a robot."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from lrp_jupyter.grading.bundled.common_hints import restarted_or_not_edited
from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import (
    Criterion,
    Found,
    drives_differently,
    drives_on,
    edited,
    never_restarts,
    touches_nothing,
    visits,
)
from lrp_jupyter.grading.run_record import RunRecord, Sample
from lrp_jupyter.grading.variation import moves
from lrp_jupyter.sim.world import BoxSolid, BoxZone, RobotSpec, World


def _hall() -> World:
    """Return a hall with a wall at both ends."""
    return World(
        name="hall",
        size=(2.8, 2),
        solids=(
            BoxSolid((0.03, 1, 0.06, 2), name="west wall"),
            BoxSolid((2.77, 1, 0.06, 2), name="east wall"),
        ),
        robots=(RobotSpec((0.8, 1, 0), distance=((0.0, 4.0),)),),
        # where one turns who sees the wall at 40 cm
        zones={"west": BoxZone((0.35, 1, 0.6, 2)), "east": BoxZone((2.45, 1, 0.6, 2))},
    )


def _sees_nothing(sample: Sample) -> bool:
    return sample.distances[0] == float("inf")


def _not_blindly(metres: float) -> Criterion:
    """Require that the robot drives no further than this while its sensor sees nothing, after the edit."""

    def judge(run: RunRecord) -> Found:
        def step(so_far: tuple[float, float], now: Sample, before: Sample) -> tuple[float, float]:
            """Keep the longest way without sight, and this one."""
            longest, way = so_far
            way = way + now.distance(before) if before.version and _sees_nothing(before) else 0.0
            return max(longest, way), way

        longest, _ = run.fold(step, (0.0, 0.0), "drives blindly")
        return Found(longest <= metres, f"it drove {longest * 100:.0f} cm")

    return Criterion(f"drives {metres * 100:g} cm at most while it sees nothing", judge, "always")


def _begins_to_turn(before: Sample, now: Sample) -> bool:
    return now.command[1] != 0 and now.command[0] == 0 and before.command[0] > 0


def _was_unsafe(run: RunRecord) -> Iterator[str]:
    yield from restarted_or_not_edited(run)
    turns = ((before, now) for before, now in pairwise(run.samples) if _begins_to_turn(before, now))
    if blind := next((now for pair in turns for now in pair if _sees_nothing(now)), None):
        yield (
            f"After {blind.time:.1f} s the sensor saw nothing, and the robot began to turn as if a wall were"
            " near. It has to stand still until the sensor sees again, and then go on with what it was doing."
        )
    touched, far = run.touch(), _NOT_BLINDLY.missing(run)
    last = (each for each in run.samples if each.time > run.seconds - 1.5)
    blind = next((each for each in last if _sees_nothing(each) and any(each.command)), None)
    if blind and (touched or far):
        yield (
            f"After {blind.time:.1f} s the sensor saw nothing, and the robot drove on. In this hall there is"
            " always a wall ahead: when `robot.distance.data` is `inf`, the sensor has failed, and the robot"
            " has to stand still until it sees again."
        )
    elif touched:
        yield (
            f"The robot touched the {min(touched.touched)} after {touched.time:.1f} s, and its sensor had"
            " not failed. Turn when it is still further away."
        )
    if run.stood >= 5:
        yield (
            f"The robot stopped after {run.still_since:.1f} s and stayed there. When the sensor sees again, a"
            " transition has to lead back to the state that drives."
        )


def _drove_on_little(run: RunRecord) -> Iterator[str]:
    yield from restarted_or_not_edited(run)
    if len(run.programs) < 2 or run.restarts:
        return
    if reason := _DRIVES_ON.missing(run):
        yield f"The edit has stopped the robot: {reason}. It has to drive on."
    elif drives_differently().missing(run):
        yield (
            "The program has changed, but the robot drives as it did before. Which number makes it drive"
            " faster, which one bends its curves, and which ones say how long they are?"
        )


_DRIVES_ON = drives_on(0.5)

_NOT_BLINDLY = _not_blindly(0.35)

SAFE_EDITS = Challenge(
    "safe edits",
    "The robot patrols between two walls, and its distance sensor fails now and then: for a second, it reads"
    " `inf`. Change the program while it runs, without a restart, so that the robot goes on with its patrol,"
    " four times to each wall, touches neither, and never drives further than 35 cm while it sees nothing.",
    (_hall(),),
    (edited(), _NOT_BLINDLY, visits(*("east", "west") * 4), touches_nothing(), never_restarts()),
    150,
    (_was_unsafe,),
    noise={"motor": 0.003, "dropout": 0.08},
    seeds=5,
    vary=(moves("robot", x=0.3, y=0.3),),
    starter=starter("safe edits"),
    live=2,
)

EDIT_IT_LIVE = Challenge(
    "edit it live",
    "Change how the robot drives while the program runs: at a different speed, in different curves, or with"
    " a different rhythm. It drives on for half a metre, and the program never restarts.",
    ("oval",),
    (edited(), drives_differently(), _DRIVES_ON, never_restarts()),
    120,
    (_drove_on_little,),
    noise={"motor": 0.02},
    seeds=3,
    vary=(moves("robot", x=0.2, y=0.1, degrees=10),),
    starter=starter("edit it live"),
    live=3.5,  # in `right`, when both have been seen
)
