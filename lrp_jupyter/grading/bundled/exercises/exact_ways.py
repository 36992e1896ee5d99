"""Exercises of lesson 14: ways that are measured, by the wheels and by the gyro."""

from __future__ import annotations

import math

from lrp_jupyter.grading.bundled.exercises.exercise import exercise, says, without_reading
from lrp_jupyter.grading.bundled.exercises.exercise_worlds import polygon
from lrp_jupyter.grading.criteria import ends_in, ends_still, stays_in, visits, without
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.grading.variation import wears
from lrp_jupyter.sim.world import BoxZone, CircleZone, RobotSpec, World

__all__ = ["EXERCISES"]

_NOISE = {"motor": 0.02, "odom": 0.01, "gyro": 0.01}
_BATTERY = wears(speed=0.3)
_TASKS = without("drive_by", "turn_by", "drive_to")
_ASKED = says(
    "The program asks the robot for a task. Here the program itself has to measure: drive with `robot.move`,"
    " and let `robot.odom` and `robot.gyro` decide.",
    lambda run: _TASKS.missing(run),
)
_ROUND = visits("corner 1", "corner 2", "corner 3", "home")
_IN_CORRIDOR = stays_in("corridor")
_WAY = World(
    name="way",
    size=(3.2, 1),
    robots=(RobotSpec((0.5, 0.5, 0)),),
    zones={"there": BoxZone((2, 0.5, 0.2, 1))},
)
_THERE_AND_BACK = World(
    name="there and back",
    size=(2.8, 2),
    robots=(RobotSpec((0.9, 1, 0)),),
    zones={"turning point": CircleZone((1.9, 1, 0.15)), "home": CircleZone((0.9, 1, 0.15))},
)


def _corridor(name: str, left: float, right: float) -> World:
    """Return a corridor for a robot whose wheels turn at these fractions of what they are told."""
    return World(
        name=name,
        size=(3.6, 1.6),
        robots=(RobotSpec((0.5, 0.8, 0), wheels=(left, right)),),
        zones={"corridor": BoxZone((1.8, 0.8, 3.6, 0.24)), "there": BoxZone((2.5, 0.8, 0.2, 0.24))},
    )


def _turned(run: RunRecord) -> float:
    """Return the degrees by which the robot has turned to the left in the end."""
    return math.degrees(run.samples[-1].heading - run.samples[0].heading)


def _steers_weakly(run: RunRecord) -> bool:
    """Whether the robot left the corridor, but hardly turned off."""
    reads = "robot.gyro" in run.programs[-1].text
    return reads and abs(_turned(run)) <= 20 and _IN_CORRIDOR.missing(run) is not None


EXERCISES = (
    exercise(
        "14.1",
        "Drive 1.5 m straight on and stop there, to within 10 cm, whatever the battery. Tasks such as"
        " `drive_by` are not allowed.",
        _WAY,
        _TASKS,
        ends_in("there"),
        ends_still(2),
        seconds=30,
        seeds=5,
        noise=_NOISE,
        vary=_BATTERY,
        hints=(
            _ASKED,
            without_reading(
                "odom",
                "With a weak battery the robot gets less far in the same time. `robot.odom.x` says how far it"
                " has come.",
            ),
            says(
                "The robot did not stop 1.5 m from its start. `robot.odom.x` is in metres, and counts from"
                " the start.",
            ),
        ),
    ),
    exercise(
        "14.2",
        "Drive 2 m along the corridor and stop there, although the wheels are uneven. The middle of the robot"
        " must never be further than 12 cm from the middle of the corridor. Tasks such as `drive_by` are not"
        " allowed.",
        (_corridor("to the left", 0.985, 1.015), _corridor("to the right", 1.015, 0.985)),
        _TASKS,
        _IN_CORRIDOR,
        ends_in("there"),
        ends_still(2),
        seconds=30,
        seeds=3,
        noise=_NOISE,
        vary=_BATTERY,
        hints=(
            _ASKED,
            without_reading(
                "gyro",
                "The robot veers off course and does not notice: `robot.gyro.data` says by how much it has"
                " turned.",
            ),
            says(
                "The robot turned further off course instead of back. When the gyro says more than 0, the"
                " robot faces too far to the left: `angular` then has to be less than 0.",
                lambda run: abs(_turned(run)) > 20,
            ),
            says(
                "The robot left the corridor, although it steers. A number before the bracket makes it steer"
                " more strongly.",
                _steers_weakly,
            ),
        ),
    ),
    exercise(
        "14.3",
        "Drive 1 m straight on, turn round, drive back, and stop where the robot began, to within 15 cm,"
        " whatever the battery. Tasks such as `drive_by` are not allowed.",
        _THERE_AND_BACK,
        _TASKS,
        visits("turning point", "home"),
        ends_in("home"),
        ends_still(2),
        seconds=60,
        seeds=5,
        noise=_NOISE,
        vary=_BATTERY,
        hints=(
            _ASKED,
            without_reading(
                "gyro",
                "With a weak battery the robot turns less far in the same time. Let the gyro end the turn.",
            ),
            says(
                "The robot turned round more than once. The gyro is in radians: half a turn is"
                " `degrees(180)`.",
                lambda run: abs(_turned(run)) > 360,
            ),
            says(
                "The robot turned round, but did not stop where it began. `robot.odom.x` counts from the"
                " start: what does it say when the robot is back?",
                lambda run: abs(_turned(run) - 180) < 20,
            ),
        ),
    ),
    exercise(
        "14.5",
        "Drive a square with sides of 80 cm, turning left at each corner, and stop where the robot began."
        " Reach each corner to within 15 cm, whatever the battery, and although the wheels are uneven. Tasks"
        " such as `drive_by` are not allowed.",
        polygon(4, 0.8, 0.15),
        _TASKS,
        _ROUND,
        ends_in("home"),
        ends_still(2),
        seconds=90,
        seeds=5,
        noise=_NOISE,
        vary=wears(speed=0.3, wheels=0.02),
        hints=(
            _ASKED,
            without_reading(
                "gyro", "The gyro ends each corner at a multiple of 90°, and keeps each side straight."
            ),
            without_reading(
                "odom",
                "Odometry counts from the start: on entry to a side, keep what it says in variables, and"
                " compare.",
            ),
            says(
                "The robot missed a corner. By how much do `robot.odom.x` and `.y` change on each side, and"
                " in which direction should the robot face there?",
                _ROUND.missing,
            ),
        ),
    ),
)
