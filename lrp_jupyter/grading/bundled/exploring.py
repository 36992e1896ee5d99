"""Challenges about finding one's way."""

from __future__ import annotations

from collections.abc import Iterator

from lrp_jupyter.grading.bundled.common_hints import ignores, kept_pushing
from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import avoids, covers, looks, sees_line, stays_in, touches_nothing, visits
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.grading.variation import moves, shades
from lrp_jupyter.sim.mirror import mirrored
from lrp_jupyter.sim.world import BoxSolid, BoxZone, RobotSpec, World
from lrp_jupyter.sim.worlds import drawn_maze, load


def _junction(name: str, free: int, corridor: float, blocked: float, deep: float) -> World:
    """Return a corridor with a wall at its end, and a way to each side, of which one is free.

    `free`: 1 if the way to the left is free, -1 if that to the right is.
    `corridor`: length of the corridor, in metres.
    `blocked`, `deep`: how far the blocked way and the free one go, from the middle, in metres.
    """
    wide, most, thick = 0.5, 1.4, 0.06  # of the ways to both sides
    middle, crossing = most, 0.3 + corridor + wide / 2  # y of the corridor, x of the ways
    far = crossing + wide / 2 + thick / 2
    near = crossing - wide / 2

    def beside(side: int) -> BoxSolid:
        box = (near / 2, middle + side * (wide / 2 + thick / 2), near, thick)
        return BoxSolid(box, name="corridor")

    def flank(side: int) -> BoxSolid:
        depth = most - wide / 2 - thick
        box = (near - thick / 2, middle + side * (wide / 2 + thick + depth / 2), thick, depth)
        return BoxSolid(box, name="corner")

    def end(side: int, depth: float) -> BoxSolid:
        return BoxSolid((crossing, middle + side * (depth + thick / 2), wide, thick), name="block")

    def way(side: int, depth: float) -> BoxZone:
        reach = depth - wide / 2 - 0.03
        return BoxZone((crossing, middle + side * (wide / 2 + 0.03 + reach / 2), wide, reach))

    return World(
        name=name,
        size=(far + thick / 2, 2 * middle),
        solids=(
            BoxSolid((far, middle, thick, 2 * middle), name="wall ahead"),
            end(-free, blocked),
            end(free, deep),
            *(wall for side in (1, -1) for wall in (beside(side), flank(side))),
        ),
        robots=(RobotSpec((0.3, middle, 0)),),
        zones={
            "junction": BoxZone((crossing, middle, wide, wide)),
            "longer way": way(free, deep),
            "shorter way": way(-free, blocked),
        },
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
            f"The robot stopped before the junction, after {run.driven:.2f} m. How long the corridor is"
            " differs from world to world."
        )
    elif missing:
        yield (
            f"The robot has to look to both sides before it goes on: {missing}. A machine inside a state can"
            " look to the left, remember the distance, look to the right, and compare."
        )
    if not missing and not run.entry("longer way"):
        way = run.world.zones["longer way"]
        side = "left" if isinstance(way, BoxZone) and way.box[1] > run.samples[0].y else "right"
        yield (
            f"The robot looked to both sides, but did not take the longer way, which here is to the {side}."
            " Compare the two values of `robot.distance.data` that were measured: the greater one is the way"
            " to go. After looking to the right, the robot still faces right; from there to the left is half"
            " a turn, pi radians."
        )
    yield from kept_pushing(run)


def _crossed_or_repeated(run: RunRecord) -> Iterator[str]:
    yield from ignores(run, "light", "It sees the border: at black, drive back, and then turn.")
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
            f"The robot never reached the border: {reason}. Drive straight on to the border, and turn there."
        )


def _lost_its_way(run: RunRecord) -> Iterator[str]:
    yield from kept_pushing(run)
    if not run.entry("goal"):
        yield (
            "The robot never reached `goal`. Keep a hand on one wall: a wall on the left leads to every"
            " place."
        )


_LOOKS = looks("junction", 60)
_COVERS = covers("inside", 0.6)

_OTHER_MAZE = """
+--+--+--+--+--+
|           |  |
+  +--+--+  +  +
|     |     |  |
+--+  +  +--+  +
|  |  |        |
+  +  +--+--+  +
|        |     |
+--+--+--+--+--+
"""

LOOK_BOTH_WAYS = Challenge(
    "look left, look right",
    "Drive to the wall ahead and stop before it. Look at least 60° to the left and to the right, then take"
    " the longer of the two ways, and touch nothing.",
    (  # the same depth is once the longer one and once the shorter one, so that both sides count
        _junction("the left is longer", 1, 0.5, blocked=0.45, deep=0.75),
        _junction("the right is longer", -1, 0.5, blocked=0.75, deep=1.2),
        _junction("the right is longer, after a longer corridor", -1, 0.9, blocked=0.45, deep=0.75),
        _junction("the left is longer, after a longer corridor", 1, 0.9, blocked=0.75, deep=1.2),
    ),
    (_LOOKS, visits("longer way"), touches_nothing(), avoids("shorter way")),
    90,
    (_went_blindly,),
    noise={"motor": 0.02},
    vary=moves("robot", x=0.08, y=0.02, degrees=2),
    starter=starter("look left, look right"),
)

EDGE_GUARD = Challenge(
    "edge guard",
    "Drive about in the field with the black border until you have been in 60% of it, and never leave it.",
    ("arena",),
    (_COVERS, stays_in("inside")),
    240,
    (_crossed_or_repeated,),
    noise={"motor": 0.02},
    seeds=3,
    vary=(moves("robot", x=0.3, y=0.2, degrees=180), shades(30)),
    starter=starter("edge guard"),
)

MAZE = Challenge(
    "maze",
    "Find the way to the goal, in the opposite corner, in three mazes.",
    ("maze", mirrored(load("maze"), "mirrored maze", y=True), drawn_maze("another maze", _OTHER_MAZE)),
    (visits("goal"),),
    240,
    (_lost_its_way,),
    noise={"motor": 0.02},
    vary=moves("robot", x=0.03, y=0.03, degrees=6),
    starter=starter("maze"),
)
