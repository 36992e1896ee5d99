"""Challenges about driving along walls."""

from __future__ import annotations

import math
from collections.abc import Iterator

from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import stays_in, touches_nothing, visits
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.sim.world import BoxSolid, BoxZone, CircleZone, Pose, RobotSpec, World

_QUARTER = math.pi / 2
_RAYS = ((0.0, 2.0), (_QUARTER, 2.0), (_QUARTER / 2, 2.0))  # ahead, to the left, between these


def _long_wall(name: str, pose: Pose) -> World:
    """Return a world with a wall on the left of the robot, which does not face along it."""
    return World(
        name=name,
        size=(3, 1.6),
        solids=(BoxSolid((1.5, 1.3, 3, 0.1), name="wall"),),
        robots=(RobotSpec(pose, distance=_RAYS),),
        zones={
            "along the wall": BoxZone((1.5, 0.975, 3, 0.55)),
            "end of the wall": BoxZone((2.7, 0.975, 0.3, 0.55)),
        },
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
    zone = run.world.zones["along the wall"]
    if left := run.first(lambda sample: not zone.contains(sample.x, sample.y)):
        yield (
            f"The robot was too far away from the wall after {left.time:.1f} s. Turn to the left, with a"
            " positive `angular`, when `robot.front_left.distance` is greater than the distance to keep."
        )
    yield from _turned_on_the_spot(run)


def _did_not_go_around(run: RunRecord) -> Iterator[str]:
    yield from _straight_or_too_near(run)
    yield from _turned_on_the_spot(run)
    if run.entry("south") and not run.entry("east") and run.driven >= 0.5:
        yield (
            "The robot did not get around the first corner. There the sensor on the left sees nothing near:"
            " drive a bit further, then in a bend to the left, until it sees the wall again."
        )


KEEP_ALONG = Challenge(
    "keep along the wall",
    "The wall is on the left. Drive to its end, without touching it and without going further away than half"
    " a metre.",
    (
        _long_wall("towards the wall", (0.4, 0.95, 0.35)),
        _long_wall("away from the wall", (0.4, 1.05, -0.35)),
        _long_wall("far from the wall", (0.4, 0.8, -0.1)),
    ),
    (visits("end of the wall"), touches_nothing(), stays_in("along the wall")),
    40,
    (_did_not_keep_along,),
    noise={"motor": 0.02},
    starter=starter("keep along the wall"),
)

WALL_FOLLOWER = Challenge(
    "wall follower",
    "Go once around the block on the left, without touching it.",
    (_block("long block", 1.2, 0.4), _block("cube", 0.7, 0.7), _block("pillar", 0.5, 1.0)),
    (visits("east", "north", "west", "south"), touches_nothing()),
    120,
    (_did_not_go_around,),
    noise={"motor": 0.02},
    starter=starter("wall follower"),
)
