"""Exercises of lesson 0: numbers are changed while the robot drives."""

from __future__ import annotations

from lrp_jupyter.grading.bundled.common_hints import restarted_or_not_edited
from lrp_jupyter.grading.bundled.exercises.exercise import exercise, says
from lrp_jupyter.grading.bundled.exercises.exercise_criteria import turns_to
from lrp_jupyter.grading.criteria import (
    edited,
    keeps_driving,
    never_restarts,
    slows_to,
    visits,
    within,
)
from lrp_jupyter.grading.variation import moves

__all__ = ["EXERCISES"]

_LIVE = {"live": 3, "vary": moves("robot", x=0.1, y=0.1, degrees=180)}
_OTHER_SPEED = says(
    "The robot drove on, but not at twice the speed. Which number is its speed, and what is twice that?",
    lambda run: slows_to(2).missing(run),
)
_OTHER_WAY = says(
    "The robot did not turn to the right for long enough. A negative `angular` turns it to the right.",
    lambda run: run.turned.right < 300,
)
_SLOW = says(
    "The robot did not get around in time. To drive faster, it also has to turn faster: change both numbers.",
)

EXERCISES = (
    exercise(
        "0.1",
        "The robot drives in a circle. Change the program while it runs, so that it drives on at twice the"
        " speed. It must not start over.",
        "empty",
        edited(),
        slows_to(2),
        keeps_driving(1),
        never_restarts(),
        hints=(restarted_or_not_edited, _OTHER_SPEED),
        **_LIVE,
    ),
    exercise(
        "0.2",
        "The robot drives in a circle to the left. Change the program while it runs, so that the circle goes"
        " to the right. The program must not start over.",
        "empty",
        edited(),
        turns_to("right", 300),
        keeps_driving(1),
        never_restarts(),
        hints=(restarted_or_not_edited, _OTHER_WAY),
        **_LIVE,
    ),
    exercise(
        "0.3",
        "The robot drives in a circle to the left. Change the program while it runs, so that the circle goes"
        " to the right, at twice the speed. The program must not start over.",
        "empty",
        edited(),
        slows_to(2),
        turns_to("right", 300),
        keeps_driving(1),
        never_restarts(),
        hints=(restarted_or_not_edited, _OTHER_WAY, _OTHER_SPEED),
        **_LIVE,
    ),
    exercise(
        "0.5",
        "The robot is slow. Change the program while it runs, so that the robot follows the line to the right"
        " end, to the left end, and to the right end again within 45 seconds. It must not start over.",
        "oval",
        edited(),
        within(45, visits("right", "left", "right")),
        never_restarts(),
        seconds=45,
        live=3,
        seeds=3,
        vary=moves("robot", x=0.1),
        hints=(restarted_or_not_edited, _SLOW),
    ),
)
