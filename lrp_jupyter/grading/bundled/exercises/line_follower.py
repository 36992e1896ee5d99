"""Exercises of lesson 7: a line follower that grows."""

from __future__ import annotations

from lrp_jupyter.grading.bundled.common_hints import kept_pushing, lost_the_line
from lrp_jupyter.grading.bundled.exercises.exercise import exercise, says
from lrp_jupyter.grading.bundled.exercises.exercise_worlds import course
from lrp_jupyter.grading.criteria import ends_still, near_line, stops_at, touches, visits

__all__ = ["EXERCISES"]

_NEAR = near_line(0.15)
_NOISE = {"motor": 0.02, "light": 5.0}
_TO_THE_LEFT = (
    course("a quarter to the left", (0.4, 0), (0.9, 90), (0.3, 0)),
    course("half a turn to the left", (0.3, 0), (1.3, 180), (0.3, 0)),
    course("a tight bend to the left", (0.6, 0), (0.7, 120), (0.3, 0)),
)
_BENDS = (
    course("left and right", (0.3, 0), (0.8, 90), (0.8, -90), (0.3, 0)),
    course("right and left", (0.3, 0), (0.8, -90), (0.8, 90), (0.3, 0)),
    course("right and right", (0.3, 0), (0.7, -60), (0.2, 0), (0.7, -60), (0.2, 0)),
)
_WHITE = (
    course("white, left and right", (0.3, 0), (0.8, 90), (0.8, -90), (0.3, 0), inverse=True),
    course("white, right and left", (0.3, 0), (0.8, -90), (0.8, 90), (0.3, 0), inverse=True),
)
_GAPS = (
    course("a gap in the straight", (0.5, 0), (0.06, 0), (0.4, 0), (0.8, 60), (0.2, 0), gap=2),
    course("a gap after a bend", (0.3, 0), (0.8, -60), (0.2, 0), (0.06, 0), (0.5, 0), gap=4),
)
_OFF = says(
    "The robot drove away from the line. In `looking` it has to stay where it is, and turn until its sensor"
    " sees the line.",
    lambda run: _NEAR.missing(run),
)

EXERCISES = (
    exercise(
        "7.1",
        "Follow the line to its end. It bends to the left only.",
        _TO_THE_LEFT,
        visits("end"),
        _NEAR,
        seconds=60,
        noise=_NOISE,
        hints=(
            says(
                "The robot turned on the spot and did not go on. When it sees the line again, a"
                " transition has to lead from `looking` to `moving`.",
                lambda run: run.turned.left > 360,
            ),
            lost_the_line,
        ),
    ),
    exercise(
        "7.2",
        "Follow the line to the wall at its end, and stop there, whichever state is active at the bump.",
        _BENDS,
        _NEAR,
        touches("wall"),
        stops_at("wall", 1),
        ends_still(2),
        seconds=90,
        noise=_NOISE,
        hints=(kept_pushing, lost_the_line),
    ),
    exercise(
        "7.3",
        "The line is white now, and the floor black. Follow it to its end.",
        _WHITE,
        visits("end"),
        _NEAR,
        seconds=90,
        seeds=3,
        noise=_NOISE,
        hints=(
            says(
                "The robot takes black for the line. White reads 255: where is the robot on the line, and"
                " where is it not?",
            ),
        ),
    ),
    exercise(
        "7.5",
        "The line has a gap of 6 cm. Follow it to its end all the same, and never stray further than 15 cm"
        " from it.",
        _GAPS,
        visits("end"),
        _NEAR,
        seconds=120,
        seeds=3,
        noise=_NOISE,
        hints=(
            says(
                "The robot did not get over the gap. Before it turns to look for the line, let it drive"
                " on for a moment: for how many milliseconds?",
            ),
        ),
    ),
)
