"""Exercises of lesson 2: which action of which state."""

from __future__ import annotations

import math

from lrp_jupyter.grading.bundled.common_hints import kept_pushing
from lrp_jupyter.grading.bundled.exercises.exercise import exercise, says
from lrp_jupyter.grading.bundled.exercises.exercise_worlds import HALLS
from lrp_jupyter.grading.bundled.rooms import ROOMS
from lrp_jupyter.grading.criteria import (
    backs_off,
    backs_off_at_bumps,
    ends_still,
    lit_while,
    stops_at,
    touches,
)
from lrp_jupyter.grading.run_record import Sample
from lrp_jupyter.grading.variation import moves

__all__ = ["EXERCISES"]

_STARTS = moves("robot", x=0.15, y=0.3)


def _drives_forward(sample: Sample) -> bool:
    return sample.command[0] > 0


def _drives_back_or_turns(sample: Sample) -> bool:
    return sample.command[0] <= 0 and any(sample.command)


def _drives_to_the_wall_ahead(sample: Sample) -> bool:
    return sample.command[0] > 0 and math.cos(sample.heading) > 0


_STILL_LIT = says(
    "The lamp stays as it was switched until the next `robot.lamp`. Switch it off where the state is left, in"
    " its `onexit`, or where the next one is entered.",
    lambda run: run.samples[-1].lamp,
)
_NEVER_LIT = says(
    "The lamp was dark. `robot.lamp(True)` in the `onentry` of a state lights it.",
    lambda run: not run.first(lambda sample: sample.lamp),
)

EXERCISES = (
    exercise(
        "2.1",
        "Drive to the wall and stop there. Light the lamp while the robot drives, and only then.",
        HALLS,
        lit_while("drives", _drives_forward, 0.6),
        touches("wall ahead"),
        stops_at("wall ahead", 1),
        ends_still(2),
        seconds=30,
        vary=_STARTS,
        hints=(kept_pushing, _STILL_LIT),
    ),
    exercise(
        "2.2",
        "Drive to the wall, and stop there within a second.",
        HALLS,
        touches("wall ahead"),
        stops_at("wall ahead", 1),
        ends_still(2),
        seconds=30,
        vary=_STARTS,
        hints=(kept_pushing,),
    ),
    exercise(
        "2.3",
        "At a bump the robot backs off and turns. Light its lamp while it does either, and only then; let it"
        " do so three times.",
        ROOMS,
        lit_while("backs off or turns", _drives_back_or_turns),
        backs_off_at_bumps(1),
        backs_off(4),
        seconds=90,
        vary=moves("robot", x=0.1, y=0.1, degrees=60),
        hints=(_NEVER_LIT, _STILL_LIT),
    ),
    exercise(
        "2.5",
        "The robot drives to and fro between two walls. Light its lamp whenever it drives to the wall ahead,"
        " and only then: on the way back it is dark.",
        HALLS,
        lit_while("drives to the wall ahead", _drives_to_the_wall_ahead),
        touches("wall ahead", "wall behind", "wall ahead", "wall behind"),
        seconds=120,
        vary=_STARTS,
        hints=(
            _NEVER_LIT,
            says(
                "The lamp was lit on the way back, too. It is a different state that drives back: give the"
                " robot two states that drive, and light the lamp in one of them.",
                lambda run: run.first(
                    lambda sample: sample.lamp and _drives_forward(sample) and math.cos(sample.heading) < 0
                ),
            ),
        ),
    ),
)
