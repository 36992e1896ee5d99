"""Challenges about driving by time."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise

from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import (
    blinks,
    drives_straight,
    ends_in,
    ends_still,
    keeps_to,
    moves_only_in,
    reused,
    visits,
)
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.grading.variation import moves
from lrp_jupyter.language.program import Block, Program
from lrp_jupyter.sim.world import CircleZone, RobotSpec, World


def square(name: str = "square", radius: float = 0.1) -> World:
    """Return a world with zones at the corners of a square to the left of the robot."""
    corners = {
        "home": (1.0, 0.6),
        "first corner": (1.6, 0.6),
        "second corner": (1.6, 1.2),
        "third corner": (1.0, 1.2),
    }
    zones = {corner: CircleZone((x, y, radius)) for corner, (x, y) in corners.items()}
    return World(name=name, size=(2.6, 1.8), robots=(RobotSpec((1.0, 0.6, 0)),), zones=zones)


def _two_squares() -> World:
    """Return a world with zones at the corners of a square to the left, and of a smaller one to the right."""
    x, y = 1.0, 1.1
    corners = {"home": (x, y)}
    for side, length in (("left", 0.6), ("right", -0.3)):
        corners |= {
            f"{side} 1": (x + abs(length), y),
            f"{side} 2": (x + abs(length), y + length),
            f"{side} 3": (x, y + length),
        }
    zones = {name: CircleZone((*at, 0.12)) for name, at in corners.items()}
    return World(name="two squares", size=(2.4, 2.2), robots=(RobotSpec((x, y, 0)),), zones=zones)


_STRAIGHT = drives_straight(0.9)
_ON_THE_LEFT = visits("left 1", "left 2", "left 3", "home")
_ON_THE_RIGHT = visits("left 3", "right 1", "right 2", "right 3", "home")
_EIGHT = ("left 1", "left 2", "left 3", "home", "right 1", "right 2", "right 3", "home")
_BOTH = keeps_to(0.12, "home", *_EIGHT)
_REUSED = reused("square")
_ALONE = moves_only_in("square")
CORNERS = ("first corner", "second corner", "third corner", "home")
ELSEWHERE = moves("robot", *CORNERS, x=0.3, y=0.2)
_BLINKS = blinks(1)
_CORNERS = visits(*CORNERS)
_SIDES = keeps_to(0.1, "home", *CORNERS)


def _drove_no_square(run: RunRecord) -> Iterator[str]:
    left, right = run.turned
    if run.turned.total < 20:
        yield (
            f"The robot drove {run.driven:.2f} m straight on and turned {run.turned.total:.0f}°."
            " `robot.move(angular=1)` for pi / 2 s is a quarter turn."
        )
    elif right > 45 and right > 2 * left:
        yield f"The robot turned {right:.0f}° to the right. To the left, `angular` is positive."
    if run.driven < 0.3:
        yield (
            f"The robot turned {run.turned.total:.0f}° on the spot. Drive a side with"
            " `robot.move(linear=0.2)`."
        )
    elif _STRAIGHT.missing(run):
        yield (
            "The robot turned while it drove. Drive a side with `linear` only, then turn on the spot with"
            " `angular` only: in two states."
        )
    if left - right >= 420:
        yield _too_many_corners(run)
    yield from _other_corner(run)


def _too_many_corners(run: RunRecord) -> str:
    left = run.turned.left
    if _counts_ticks(run.programs[-1]):
        return (
            "The corners are counted in `running`, which runs in every tick of a corner. Count in `onexit`,"
            " which runs once: `(onexit [corners += 1])`."
        )
    if run.stood > 1:
        return (
            f"The robot stopped after {left:.0f}°. If there were four corners, each was {left / 4:.0f}° and"
            " not 90°: at 1 rad/s, a quarter turn takes pi / 2 s."
        )
    return (
        f"The robot turned {left:.0f}° and went on after the fourth corner. Count the corners, for example"
        " with `(onexit [corners += 1])`, and leave when there are four."
    )


def _counts_ticks(program: Program) -> bool:
    """Return whether a `running` action adds something to a variable."""
    texts = (
        action.text
        for _, machine in program.walk()
        for state in machine.states
        for action in state.running
        if isinstance(action, Block)
    )
    return any(_ADDS.search(text) for text in texts)


_ADDS = re.compile(r"(\b\w+)\s*(\+=|=\s*\1\s*\+)")


def _other_corner(run: RunRecord) -> Iterator[str]:
    if reason := _CORNERS.missing(run) or _SIDES.missing(run):
        left, right = run.turned
        yield (
            f"The robot missed the square: {reason}. Altogether it drove {run.driven:.2f} m and turned"
            f" {left - right:.0f}°; a side is 0.6 m (at 0.2 m/s, 3000 ms), and each of the four corners 90°"
            " (at 1 rad/s, 1571 ms)."
        )


def _drove_other_squares(run: RunRecord) -> Iterator[str]:
    left, right = run.turned
    missed = _ON_THE_LEFT.missing(run) or _ON_THE_RIGHT.missing(run)
    if left >= 330 and run.stood > 1 and left + right < 400:
        yield (
            f"The robot stopped after {run.still_since:.1f} s, after its first square. `square` is `done`"
            " then: `(on square.done left -> right)` can lead to a second state, which spawns `square` again."
        )
    if left >= 450 and right < 45:
        yield (
            f"The robot turned {left:.0f}° to the left and {right:.0f}° to the right. Give `square` a"
            " variable for the speed at which it turns, `(var turn := [1])`, and the second spawn another"
            " value: `(spawn square side (var turn := [-1]))`."
        )
    if missed:
        yield (
            f"The robot missed a square: {missed}. Altogether it drove {run.driven:.2f} m, turned {left:.0f}°"
            f" to the left and {right:.0f}° to the right. At 0.2 m/s, a side of 60 cm takes 3000 ms, and one"
            " of 30 cm 1500 ms."
        )
    elif reason := _REUSED.missing(run) or _ALONE.missing(run):
        yield (
            f"Both squares are there, but {reason}. Spawn one machine `square` in both states, the second"
            " time with other values: `(spawn square side (var turn := [-1]))`."
        )
    elif run.stood < 1:
        yield (
            f"The robot drove both squares, but was still driving after {run.seconds:.0f} s. No transition"
            " may lead out of the state with the second one."
        )
    elif reason := _STRAIGHT.missing(run) or _BOTH.missing(run):
        yield f"The robot reached all corners, but did not drive straight from one to the next: {reason}."


def _blinked_wrongly(run: RunRecord) -> Iterator[str]:
    times = [now.time for before, now in pairwise(run.samples) if now.lamp != before.lamp]
    phases = [after - before for before, after in pairwise(times)]
    worst = max(phases, key=lambda phase: abs(phase - 1), default=1.0)
    if not times and max(len(sample.active) for sample in run.samples) < 2:
        yield "Only one machine is active. Give `lamp` two states, and spawn it beside the other one."
    elif not times:
        yield (
            f"The lamp was never switched in the first {run.seconds:.1f} s. `robot.lamp(True)` in the"
            " `onentry` of a state lights it, and `(ontime 1000 …)` leaves the state after a second."
        )
    elif abs(worst - 1) > 0.25:
        yield (
            f"There were {worst:.1f} s between two switches of the lamp. `(ontime 1000 lit -> dark)` is one"
            " second."
        )
    elif run.seconds - times[-1] > 1.25:
        yield (
            f"The lamp stopped changing after {times[-1]:.1f} s. It has to blink all the time: a"
            " machine of its own does not depend on what the other one does."
        )
    if not _BLINKS.missing(run):  # else that has ended the run
        yield from _other_corner(run)


SQUARE = Challenge(
    "square",
    "Drive a square with straight sides of 60 cm, to the left, and stop where it began: never further than"
    " 10 cm from the exact square.",
    (square(),),
    (_CORNERS, _STRAIGHT, _SIDES, ends_in("home"), ends_still(1)),
    90,
    (_drove_no_square,),
    noise={"motor": 0.01},
    seeds=3,
    vary=(ELSEWHERE,),
    starter=starter("square"),
)

TWO_SQUARES = Challenge(
    "two squares",
    "Drive a square with sides of 60 cm to the left, then one with sides of 30 cm to the right, and stop"
    " where it began: never further than 12 cm from the exact squares. The machine `square`, which is written"
    " once, drives both.",
    (_two_squares(),),
    (_ON_THE_LEFT, _ON_THE_RIGHT, _STRAIGHT, _BOTH, _REUSED, _ALONE, ends_in("home"), ends_still(1)),
    150,
    (_drove_other_squares,),
    noise={"motor": 0.01},
    seeds=3,
    vary=(moves("robot", *_EIGHT, x=0.2, y=0.2),),
    starter=starter("two squares"),
)

LAMP_AND_LEGS = Challenge(
    "lamp and legs",
    "Drive the square, never further than 10 cm from the exact one, and meanwhile let the lamp blink all the"
    " time: one second lit, one second dark.",
    (square(),),
    (_BLINKS, _CORNERS, _STRAIGHT, _SIDES),
    90,
    (_blinked_wrongly,),
    noise={"motor": 0.01},
    seeds=3,
    vary=(ELSEWHERE,),
    starter=starter("lamp and legs"),
)
