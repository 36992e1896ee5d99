"""Challenges about asking the robot for something, and waiting for it."""

from __future__ import annotations

from collections.abc import Iterator

from lrp_jupyter.grading.bundled.squares import CORNERS, ELSEWHERE, square
from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import backs_off_at_bumps, ends_in, ends_still, keeps_to, visits
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.grading.variation import moves
from lrp_jupyter.sim.world import CircleZone, DiscSolid, RobotSpec, World

_START = (0.5, 1.0)
_TABLES = ((0.9, 0.6), (1.5, 0.0), (0.9, -0.6))  # m, from where the robot starts


def _tables(blocked: int) -> World:
    """Return a world with three tables, one of which has something on its place that does not move."""
    places = [(_START[0] + x, _START[1] + y) for x, y in _TABLES]
    barrel = DiscSolid((*places.pop(blocked), 0.15), name="barrel")
    zones = {"home": CircleZone((*_START, 0.1))}
    zones |= {
        name: CircleZone((*place, 0.1)) for name, place in zip(("first", "second"), places, strict=True)
    }
    name = f"three tables, number {blocked + 1} blocked"
    return World(name=name, size=(2.6, 2.0), robots=(RobotSpec((*_START, 0)),), solids=(barrel,), zones=zones)


_CORNERS = visits(*CORNERS)
_SIDES = keeps_to(0.06, "home", *CORNERS)
_ROUND = visits("first", "second", "home")
_GIVES_UP = backs_off_at_bumps(5)


def _drove_no_exact_square(run: RunRecord) -> Iterator[str]:
    reason, (left, right) = _CORNERS.missing(run) or _SIDES.missing(run), run.turned
    if right > 45 and right > 2 * left:
        yield f"The robot turned {right:.0f}° to the right. To the left, the angle of `turn_by` is positive."
    if left > 1000 * run.driven > 0:
        yield f"The robot turned {left:.0f}°. `turn_by` takes radians: `robot.turn_by(degrees(90))`."
    if run.driven > 2.7 or left > 405:
        yield (
            f"The robot drove {run.driven:.2f} m and turned {left:.0f}°: more than four sides and corners."
            " Is each corner counted once, on leaving it?"
        )
    if run.stood > 5 and run.driven < 2.2:
        yield (
            f"The robot stopped after {run.still_since:.1f} s and {run.driven:.2f} m: it has done what you"
            " asked for. Let a transition wait for that, as in `(on [robot.drive_by.succeeded] side ->"
            " corner)`."
        )
    if reason:
        yield (
            f"The robot missed the square: {reason}. Its motors are uneven, so a speed and a time do not make"
            " a distance. Ask for the distance: `robot.drive_by(0.6)`, and `robot.turn_by(degrees(90))`."
        )


def _served_no_tables(run: RunRecord) -> Iterator[str]:
    reason, met, wrong = _ROUND.missing(run), run.touch("barrel"), _GIVES_UP.missing(run)
    if wrong and wrong.endswith("had not bumped"):
        yield (
            f"The robot backed off where no barrel stood: {wrong}. Only a drive that fails may lead to the"
            " state that backs off."
        )
    elif met and wrong and run.stood > 1:
        yield (
            f"The robot met the barrel after {met.time:.1f} s, gave up, and stayed there. In `driving`,"
            " `robot.drive_to.failed` is true then: let a transition lead out."
        )
    elif met and wrong:
        yield (
            f"The robot met the barrel after {met.time:.1f} s and did not get away from it. It still touches"
            " it when it has given up: back off first, with `robot.drive_by(-0.2)`."
        )
    elif reason:
        yield f"The robot drove {run.driven:.2f} m, but has not been everywhere: {reason}."


EXACT_SQUARE = Challenge(
    "exact square",
    "Drive a square with sides of 60 cm, to the left, and stop where it began: never further than 6 cm from"
    " the exact square, although the motors are uneven.",
    (square("exact square", 0.06),),
    (_CORNERS, _SIDES, ends_in("home"), ends_still(1)),
    120,
    (_drove_no_exact_square,),
    noise={"motor": 0.15},
    seeds=3,
    vary=(ELSEWHERE,),
    starter=starter("exact square"),
)

THREE_TABLES = Challenge(
    "three tables",
    "Drive to the three tables, one after the other, and home. A barrel stands in place of one of them, a"
    " different one in each world: there, and only there, the robot has to give up, back off, and drive on.",
    tuple(_tables(blocked) for blocked in range(3)),
    (_GIVES_UP, _ROUND, ends_in("home"), ends_still(1)),
    180,
    (_served_no_tables,),
    noise={"motor": 0.02},
    seeds=3,
    vary=(moves("robot", "home", "first", "second", "barrel", x=0.05, y=0.05),),
    starter=starter("three tables"),
)
