"""Exercises of lesson 4: readings with thresholds, and what the robot is asked for."""

from __future__ import annotations

from lrp_jupyter.grading.bundled.exercises.exercise import exercise, says
from lrp_jupyter.grading.bundled.exercises.exercise_worlds import HALLS, RADIUS, across, lane
from lrp_jupyter.grading.bundled.rooms import THICK
from lrp_jupyter.grading.criteria import ends_in, ends_still, touches_nothing, visits
from lrp_jupyter.grading.variation import moves
from lrp_jupyter.sim.world import BoxSolid, CircleZone, RobotSpec, World

__all__ = ["EXERCISES"]

_FAINT = tuple(lane(f"grey line at {x:g} m", across((x, 0.05), grey=150), x, 0.16) for x in (1.0, 1.5, 2.2))
_BEND = World(
    name="a bend",
    size=(2.2, 1.8),
    robots=(RobotSpec((0.5, 0.6, 0)),),
    zones={"bend": CircleZone((1.1, 0.6, 0.06)), "end": CircleZone((1.1, 1.0, 0.06))},
)


def _corner(ahead: float, beside: float) -> World:
    """Return a world with a wall ahead of the robot and one to its left, so far from where it starts."""
    x, y, gap = 0.4, 0.3, 0.3 + RADIUS
    width, height = x + ahead + THICK, y + beside + THICK
    return World(
        name=f"corner after {ahead:g} m",
        size=(width, height),
        solids=(
            BoxSolid((width - THICK / 2, height / 2, THICK, height), name="wall ahead"),
            BoxSolid((width / 2, height - THICK / 2, width, THICK), name="wall on the left"),
        ),
        robots=(RobotSpec((x, y, 0)),),
        zones={"parking place": CircleZone((x + ahead - gap, y + beside - gap, 0.17))},
    )


_BY_THE_CLOCK = says(
    "The program does not ask the robot for a distance or an angle, and its motors are uneven:"
    " `robot.turn_by(degrees(90))` turns it by a quarter.",
    lambda run: "_by(" not in run.programs[-1].text,
)
_TOO_FAR = says(
    "The robot touched the wall ahead. `robot.distance.data` is in metres: 0.3 is 30 cm.",
    lambda run: run.touch("wall ahead"),
)

EXERCISES = (
    exercise(
        "4.1",
        "Drive to the wall, and stop about 30 cm before it, however far away it is.",
        HALLS,
        touches_nothing(),
        ends_in("before the wall"),
        ends_still(2),
        seconds=30,
        vary=moves("robot", x=0.15, y=0.3),
        hints=(
            _TOO_FAR,
            says(
                "The robot stopped, but not about 30 cm before the wall. `robot.distance.data` is in metres.",
                lambda run: run.stood > 1,
            ),
        ),
    ),
    exercise(
        "4.2",
        "The line across the robot's path is grey, and the robot drives over it. Let it stop at the line.",
        _FAINT,
        ends_in("stop"),
        ends_still(2),
        seconds=20,
        noise={"motor": 0.02, "light": 3},
        vary=moves("robot", x=0.15, y=0.2),
        hints=(
            says(
                "The robot drove over the line. What does `robot.light.data` read there? Drag the robot onto"
                " the line, and look under Robot.",
                lambda run: run.touch("wall"),
            ),
            says(
                "The robot stopped before the line: white is not exactly 255 in every tick. Put the"
                " threshold halfway between the line and the floor.",
                lambda run: run.stood > 1,
            ),
        ),
    ),
    exercise(
        "4.3",
        "Drive 60 cm straight on, turn to the left by 90°, drive 40 cm, and stop. Reach both places to"
        " within 6 cm, although the motors are uneven.",
        _BEND,
        visits("bend", "end"),
        ends_in("end"),
        ends_still(1),
        seconds=40,
        seeds=4,
        noise={"motor": 0.15},
        hints=(_BY_THE_CLOCK,),
    ),
    exercise(
        "4.5",
        "Park in the corner: drive straight on to about 30 cm before the wall ahead, turn to the left by 90°,"
        " and drive to about 30 cm before the next wall. Touch nothing.",
        tuple(_corner(*at) for at in ((0.9, 0.8), (1.3, 1.1), (1.0, 1.5))),
        touches_nothing(),
        ends_in("parking place"),
        ends_still(2),
        seconds=50,
        noise={"motor": 0.02},
        vary=moves("robot", x=0.1, y=0.1),
        hints=(
            says(
                "The robot never turned. When it is 30 cm before the wall ahead, a transition has to lead to"
                " a state that turns.",
                lambda run: run.turned.total < 20,
            ),
            says(
                "The robot touched a wall. `robot.distance.data` is measured from the rim of the robot, in"
                " metres: 0.3 is 30 cm.",
                lambda run: run.touch(),
            ),
            _BY_THE_CLOCK,
        ),
    ),
)
