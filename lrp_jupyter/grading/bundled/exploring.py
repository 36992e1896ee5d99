"""Challenges about finding one's way."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from lrp_jupyter.grading.bundled.common_hints import kept_pushing
from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import covers, looks, sees_line, stays_in, touches_nothing, visits
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.sim.world import BoxSolid, BoxZone, RobotSpec, World, middle_of, put_at
from lrp_jupyter.sim.worlds import load


def _junction(name: str, free: int, corridor: float) -> World:
    """Return a corridor with a wall at its end, and a way to each side, of which one is free.

    `free`: 1 if the way to the left is free, -1 if that to the right is.
    `corridor`: length of the corridor, in metres.
    """
    wide, long, thick = 0.5, 1.0, 0.06  # of the ways to both sides
    middle, crossing = 1.3, 0.3 + corridor + wide / 2  # y of the corridor, x of the ways
    far = crossing + wide / 2 + thick / 2
    near = crossing - wide / 2

    def beside(side: int) -> BoxSolid:
        box = (near / 2, middle + side * (wide / 2 + thick / 2), near, thick)
        return BoxSolid(box, name="corridor")

    def flank(side: int) -> BoxSolid:
        depth = long - thick
        box = (near - thick / 2, middle + side * (wide / 2 + thick + depth / 2), thick, depth)
        return BoxSolid(box, name="corner")

    return World(
        name=name,
        size=(far + thick / 2, 2 * middle),
        solids=(
            BoxSolid((far, middle, thick, 2 * middle), name="wall ahead"),
            BoxSolid((crossing, middle - free * (wide / 2 + 0.1), wide, 0.2), name="block"),
            *(wall for side in (1, -1) for wall in (beside(side), flank(side))),
        ),
        robots=(RobotSpec((0.3, middle, 0)),),
        zones={
            "junction": BoxZone((crossing, middle, wide, wide)),
            "free way": BoxZone((crossing, middle + free * (wide / 2 + 0.5), wide, 0.6)),
        },
    )


def _mirrored(world: World, name: str, *, x: bool = False, y: bool = False) -> World:
    """Return a world, in which no solid is turned, as it is seen in a mirror along an axis, or both."""
    width, height = world.size

    def there(at: tuple[float, float]) -> tuple[float, float]:
        return (width - at[0] if x else at[0], height - at[1] if y else at[1])

    (robot,) = world.robots
    heading = math.atan2(
        math.sin(robot.pose[2]) * (-1 if y else 1), math.cos(robot.pose[2]) * (-1 if x else 1)
    )
    return replace(
        world,
        name=name,
        solids=tuple(put_at(solid, there(middle_of(solid))) for solid in world.solids),
        robots=(replace(robot, pose=(*there(robot.pose[:2]), heading)),),
        zones={key: put_at(zone, there(middle_of(zone))) for key, zone in world.zones.items()},
    )


def _went_blindly(run: RunRecord) -> Iterator[str]:
    touched = run.touch("wall ahead")
    if touched and run.turned.total <= 30:
        yield (
            f"The robot bumped into the wall ahead after {touched.time:.1f} s. Stop before it:"
            " `[robot.distance.data < 0.2]`."
        )
    missing = _LOOKS.missing(run)
    if not run.entry("junction"):
        yield (
            f"The robot stopped before the junction, after {run.driven:.2f} m. The corridor is not equally"
            " long in every world."
        )
    elif missing:
        yield (
            f"The robot has to look to both sides before it goes on: {missing}. A machine inside a state can"
            " look to the left, remember the distance, look to the right, and compare."
        )
    if not missing and not run.entry("free way"):
        free = run.world.zones["free way"]
        side = "left" if isinstance(free, BoxZone) and free.box[1] > run.samples[0].y else "right"
        yield (
            f"The robot looked to both sides, but did not take the free way, which here is to the {side}."
            " Compare the two values of `robot.distance.data` that were measured: the greater one is the way."
            " After looking to the right, the robot still faces right; from there to the left is half a"
            " turn, pi radians."
        )
    yield from kept_pushing(run)


def _crossed_or_repeated(run: RunRecord) -> Iterator[str]:
    inside, seen = run.world.zones["inside"], run.first(sees_line)
    left = run.first(lambda sample: not inside.contains(sample.x, sample.y))
    _, reason = _COVERS.judge(run)
    if left and (seen is None or seen.time >= left.time):
        yield "The robot left the field before its light sensor had seen the border. Drive more slowly."
    elif left and seen:
        yield (
            f"The robot saw the border after {seen.time:.1f} s and had crossed it after {left.time:.1f} s. At"
            " black, drive back first, and then turn."
        )
    elif seen:
        yield (
            f"The robot came to the same places again and again: {reason}. Turn by a different angle"
            " each time, or for longer."
        )
    else:
        yield (
            f"The robot never came to the border: {reason}. Drive straight on to the border, and turn there."
        )


def _lost_its_way(run: RunRecord) -> Iterator[str]:
    yield from kept_pushing(run)
    if not run.entry("goal"):
        yield (
            "The robot never came to `goal`. Keep a hand on one wall: a wall on the left leads to every"
            " place."
        )


_LOOKS = looks("junction", 60)
_COVERS = covers("inside", 0.6)

LOOK_BOTH_WAYS = Challenge(
    "look left, look right",
    "Drive to the wall ahead and stop before it. Look at least 60° to the left and to the right, then take"
    " the way that is free, and touch nothing.",
    (
        _junction("left is free", 1, 0.5),
        _junction("right is free", -1, 0.5),
        _junction("right is free, after a longer corridor", -1, 0.9),
    ),
    (_LOOKS, visits("free way"), touches_nothing()),
    60,
    (_went_blindly,),
    noise={"motor": 0.02},
    starter=starter("look left, look right"),
)

EDGE_GUARD = Challenge(
    "edge guard",
    "Drive about in the field with the black border until you have been in 60% of it, and never leave it.",
    ("arena",),
    (_COVERS, stays_in("inside")),
    120,
    (_crossed_or_repeated,),
    noise={"motor": 0.02},
    seeds=3,
    starter=starter("edge guard"),
)

MAZE = Challenge(
    "maze",
    "Find the way to the goal, in the opposite corner, in three mazes.",
    (
        "maze",
        _mirrored(load("maze"), "mirrored maze", y=True),
        _mirrored(load("maze"), "turned maze", x=True, y=True),
    ),
    (visits("goal"),),
    150,
    (_lost_its_way,),
    noise={"motor": 0.02},
    starter=starter("maze"),
)
