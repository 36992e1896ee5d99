"""Exercises of lesson 9: numbers that are found by going back to the moment that decides."""

from __future__ import annotations

from lrp_jupyter.grading.bundled.exercises.exercise import exercise, says
from lrp_jupyter.grading.bundled.exercises.exercise_worlds import hall
from lrp_jupyter.grading.criteria import ends_in, ends_still, touches_nothing, visits
from lrp_jupyter.grading.variation import moves
from lrp_jupyter.sim.world import CircleZone, DiscSolid, RobotSpec, World

__all__ = ["EXERCISES"]

_GATE = World(
    name="gate",
    size=(2.4, 1.6),
    solids=(DiscSolid((1.39, 0.9, 0.1), name="left post"), DiscSolid((1.73, 0.5, 0.1), name="right post")),
    robots=(RobotSpec((0.4, 0.4, 0)),),
    zones={"gate": CircleZone((1.56, 0.7, 0.12)), "goal": CircleZone((1.94, 1.02, 0.2))},
)
_SLALOM = World(
    name="slalom",
    size=(2.8, 1.8),
    solids=(DiscSolid((1.35, 0.6, 0.1), name="can"), DiscSolid((1.9, 1.41, 0.12), name="barrel")),
    robots=(RobotSpec((0.4, 0.4, 0)),),
    zones={"beside the can": CircleZone((1.17, 0.82, 0.15)), "goal": CircleZone((2.3, 1.1, 0.15))},
)
_TOUCHED = says(
    "The robot touched something. Go back to the moment before it, change a number there, and see where the"
    " ghost of the robot goes.",
    lambda run: run.touch(),
)
_MISSED = says(
    "The robot missed its goal. Go back to the moment at which it begins to bend, and change a number there.",
)

EXERCISES = (
    exercise(
        "9.1",
        "The robot is fast, and it stops too late. Let it stop about 30 cm before the wall.",
        tuple(map(hall, (1.0, 1.4, 1.8))),
        touches_nothing(),
        ends_in("before the wall"),
        ends_still(2),
        seconds=20,
        vary=moves("robot", x=0.15, y=0.3),
        hints=(
            says(
                "The robot touched the wall. Go back to the moment at which `stopped` is entered: how far"
                " does the robot go on from there?",
                lambda run: run.touch(),
            ),
            says(
                "The robot stopped, but not about 30 cm before the wall. Go back, and try another distance.",
            ),
        ),
    ),
    exercise(
        "9.2",
        "Drive through the gate between the two posts, on to the goal. Touch nothing.",
        _GATE,
        visits("gate", "goal"),
        touches_nothing(),
        seconds=20,
        seeds=4,
        hints=(_TOUCHED, _MISSED),
    ),
    exercise(
        "9.3",
        "Drive around the can on its left, then around the barrel on its right, and to the goal. Touch"
        " nothing.",
        _SLALOM,
        visits("beside the can", "goal"),
        touches_nothing(),
        seconds=30,
        seeds=4,
        hints=(_TOUCHED, _MISSED),
    ),
    exercise(
        "9.5",
        "Two carts cross the robot's path. Get to the goal, and touch nothing. The robot does not always"
        " start in the same place.",
        "crossing",
        visits("goal"),
        touches_nothing(),
        seconds=90,
        seeds=6,
        vary=moves("robot", x=0.06),
        hints=(
            says(
                "The robot and a cart collided. Go back to the moment before: how far away was the cart"
                " when the robot saw it? It has to wait where no cart comes, until one has passed.",
                lambda run: run.touch(),
            ),
            says("Time ran out before the robot reached the goal."),
        ),
    ),
)
