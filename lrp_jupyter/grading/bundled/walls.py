"""Challenges about driving along walls."""

from __future__ import annotations

import math
from collections.abc import Iterator

from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import Criterion, stays_near, touches_nothing, visits
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.grading.variation import moves
from lrp_jupyter.sim.world import BoxSolid, BoxZone, CircleZone, Pose, RobotSpec, World

_QUARTER = math.pi / 2
_BEND = math.radians(20)
_RAYS = ((0.0, 2.0), (_QUARTER, 2.0), (_QUARTER / 2, 2.0))  # ahead, to the left, between these


def _long_wall(name: str, pose: Pose, bend: float = 0.0) -> World:
    """Return a world with a wall on the left of the robot, which does not face along it.

    `bend`: the angle by which the wall turns in its middle, to the left, in radians.
    """
    x, y, half, thick = 1.5, 1.3, 0.85, 0.1
    across, up = half * math.cos(bend), half * math.sin(bend)
    return World(
        name=name,
        size=(2 * x, 1.9),
        solids=(
            BoxSolid((x / 2, y, x, thick), name="wall"),
            BoxSolid((x + across, y + up, 2 * half, thick), bend, name="wall"),
        ),
        robots=(RobotSpec(pose, distance=_RAYS),),
        zones={"end of the wall": BoxZone((2.7, 0.95, 0.3, 1.9))},
    )


def _block(name: str, width: float, height: float) -> World:
    """Return a world with a block, and the robot beside it with a distance sensor to its left."""
    x, y = 1.5, 1.2
    around = {
        "south": (x, y - height / 2 - 0.4),
        "east": (x + width / 2 + 0.4, y),
        "north": (x, y + height / 2 + 0.4),
        "west": (x - width / 2 - 0.4, y),
    }
    return World(
        name=name,
        size=(2 * x, 2 * y),
        solids=(BoxSolid((x, y, width, height), name="wall"),),
        robots=(RobotSpec((x - width / 4, y - height / 2 - 0.3, 0), distance=_RAYS),),
        zones={zone: CircleZone((*place, 0.39)) for zone, place in around.items()},
    )


def _straight_or_too_near(run: RunRecord) -> Iterator[str]:
    if not run.turned.total and run.driven >= 0.3:
        yield (
            f"The robot drove {run.driven:.2f} m straight on, and it does not start along the wall. Turn"
            " towards the wall when it is far, and away from it when it is near: `robot.move` takes `linear`"
            " and `angular` together."
        )
    touched = run.touch()
    if touched and min(touched.touched) == "edge":
        yield (
            f"The robot left the wall and drove into the edge after {touched.time:.1f} s. Turn towards the"
            " wall when it is further away than the distance to keep."
        )
    elif touched:
        yield (
            f"The robot touched the {min(touched.touched)} after {touched.time:.1f} s. Turn away when it is"
            " nearer than the distance to keep: to the right, `angular` is negative."
        )


def _turned_on_the_spot(run: RunRecord) -> Iterator[str]:
    if run.driven <= 0.3 and run.turned.total >= 180:
        yield (
            f"The robot turned {run.turned.total:.0f}° and drove only {run.driven:.2f} m. Give `robot.move`"
            " both `linear` and `angular`."
        )


def _did_not_keep_along(run: RunRecord) -> Iterator[str]:
    yield from _straight_or_too_near(run)
    yield from _went_away(run, _NEAR)
    yield from _turned_on_the_spot(run)


def _went_away(run: RunRecord, near: Criterion) -> Iterator[str]:
    if too_far := near.missing(run):
        yield (
            f"The robot went too far away from the wall: {too_far}. Turn to the left, with a positive"
            " `angular`, when the sensor reads more than the distance to keep."
        )


def _did_not_go_around(run: RunRecord) -> Iterator[str]:
    yield from _straight_or_too_near(run)
    yield from _turned_on_the_spot(run)
    yield from _went_away(run, _AROUND)
    if run.entry("south") and not run.entry("east") and run.driven >= 0.5:
        yield (
            "The robot did not get around the first corner. There the sensor on the left sees nothing near:"
            " drive a bit further, then in a bend to the left, until it sees the wall again."
        )


_NEAR, _AROUND = stays_near("wall", 0.5), stays_near("wall", 0.6)

KEEP_ALONG = Challenge(
    "keep along the wall",
    "The wall is on the left, and not always straight. Drive to its end, without touching it and without"
    " going further away than half a metre.",
    (
        _long_wall("towards the wall", (0.4, 0.95, 0.35)),
        _long_wall("away from the wall", (0.4, 1.05, -0.35), -_BEND),
        _long_wall("far from the wall", (0.4, 0.85, -0.1), _BEND),
    ),
    (visits("end of the wall"), touches_nothing(), _NEAR),
    90,
    (_did_not_keep_along,),
    noise={"motor": 0.02},
    vary=moves("robot", x=0.1, y=0.03, degrees=5),
    starter=starter("keep along the wall"),
)

WALL_FOLLOWER = Challenge(
    "wall follower",
    "Go once around the block on the left, without touching it and without going further away than 60 cm.",
    (_block("long block", 1.6, 0.4), _block("cube", 0.7, 0.7), _block("pillar", 0.4, 1.1)),
    (visits("east", "north", "west", "south"), touches_nothing(), _AROUND),
    180,
    (_did_not_go_around,),
    noise={"motor": 0.02},
    vary=(moves("robot", x=0.08, y=0.03, degrees=8), moves("wall", degrees=5)),
    starter=starter("wall follower"),
)
