"""Exercises of lesson 1: what leads from state to state at a bump."""

from __future__ import annotations

from lrp_jupyter.grading.bundled.common_hints import kept_pushing, never_touched
from lrp_jupyter.grading.bundled.exercises.exercise import exercise, says
from lrp_jupyter.grading.bundled.exercises.exercise_criteria import turns_to
from lrp_jupyter.grading.bundled.exercises.exercise_worlds import HALLS
from lrp_jupyter.grading.criteria import ends_still, never_pushes, stops_at, touches
from lrp_jupyter.grading.variation import moves

__all__ = ["EXERCISES"]

_STARTS = moves("robot", x=0.15, y=0.3)

_GOES_ON = says(
    "After the second bump the robot goes on, as after the first. It has to be in another state then: one"
    " that drives, too, and from which a bump leads to a state that does nothing.",
    lambda run: run.touch("wall behind"),
)

EXERCISES = (
    exercise(
        "1.1",
        "Drive to the wall ahead. When the robot bumps, drive backward to the wall behind.",
        HALLS,
        touches("wall ahead", "wall behind"),
        never_pushes(1),
        seconds=60,
        vary=_STARTS,
        hints=(kept_pushing, never_touched),
    ),
    exercise(
        "1.2",
        "Drive to the wall ahead. There, turn on the spot to the left, at least twice around.",
        HALLS,
        touches("wall ahead"),
        turns_to("left", 720, after="wall ahead"),
        never_pushes(1),
        seconds=60,
        vary=_STARTS,
        hints=(kept_pushing, never_touched),
    ),
    exercise(
        "1.3",
        "Drive to and fro: to the wall ahead, to the wall behind, and to the wall ahead again. Back off"
        " before each turn, and never push for longer than a second.",
        HALLS,
        touches("wall ahead", "wall behind", "wall ahead"),
        never_pushes(1),
        seconds=90,
        vary=_STARTS,
        hints=(kept_pushing, never_touched),
    ),
    exercise(
        "1.5",
        "Drive to the wall ahead, back off, turn, and drive to the wall behind. This second bump is the last:"
        " stop there within a second, and stay.",
        HALLS,
        touches("wall ahead", "wall behind"),
        stops_at("wall behind", 1),
        never_pushes(1),
        ends_still(2),
        seconds=60,
        vary=_STARTS,
        hints=(kept_pushing, never_touched, _GOES_ON),
    ),
)
