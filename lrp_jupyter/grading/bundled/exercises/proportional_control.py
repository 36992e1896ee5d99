"""Exercises of lesson 15: a command that follows an error."""

from __future__ import annotations

from dataclasses import replace

from lrp_jupyter.grading.bundled.exercises.exercise import exercise, says, without_reading
from lrp_jupyter.grading.bundled.exercises.exercise_criteria import hardly_moves
from lrp_jupyter.grading.bundled.exercises.exercise_worlds import RADIUS, hall
from lrp_jupyter.grading.bundled.rooms import THICK
from lrp_jupyter.grading.criteria import avoids, ends_in, ends_still, stays_in, touches_nothing
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.grading.variation import moves, wears
from lrp_jupyter.sim.world import BoxSolid, BoxZone, RobotSpec, World

__all__ = ["EXERCISES"]

_NOISE = {"motor": 0.02, "distance": 0.003}
_STARTS = moves("robot", x=0.05, y=0.2)
_PLACE = "50 cm before the wall"
_IN_CORRIDOR = stays_in("corridor")
_IN_LANE = avoids("left of the lane"), avoids("right of the lane")
_LAST = "In the last three seconds the robot must drive less than 5 cm, forward and backward added together."
_AT_REST = hardly_moves(0.05, 3)


def _place(ahead: float, behind: float, slack: float) -> World:
    """Return a hall in which the robot should be 50 cm before the wall, to within `slack` metres."""
    world = hall(ahead, behind)
    width, height = world.size
    place = BoxZone((width - THICK - RADIUS - 0.5, height / 2, 2 * slack, height))
    return replace(world, zones={_PLACE: place})


def _corridor(name: str, left: float, right: float) -> World:
    """Return a corridor to a wall for a robot whose wheels turn at these fractions of what they are told."""
    x, y, length = 0.4, 0.8, 2.3
    return World(
        name=name,
        size=(length, 2 * y),
        solids=(BoxSolid((length - THICK / 2, y, THICK, 2 * y), name="wall"),),
        robots=(RobotSpec((x, y, 0), wheels=(left, right)),),
        zones={
            "corridor": BoxZone((length / 2, y, length, 0.2)),
            "40 cm before the wall": BoxZone((length - THICK - RADIUS - 0.4, y, 0.1, 0.2)),
        },
    )


def _lane(name: str, left: float, right: float) -> World:
    """Return a world with a lane 40 cm to the left of a robot, and zones beside it."""
    x, y = 0.4, 0.5
    middle, half, first, last = y + 0.4, 0.06, x + 1.5, x + 3.1
    return World(
        name=name,
        size=(4.2, 1.6),
        robots=(RobotSpec((x, y, 0), wheels=(left, right)),),
        zones={
            "left of the lane": _between(first, last, middle + half, 1.6),
            "right of the lane": _between(first, last, 0, middle - half),
            "end of the lane": _between(x + 2.9, last, middle - half, middle + half),
        },
    )


def _between(left: float, right: float, bottom: float, top: float) -> BoxZone:
    return BoxZone(((left + right) / 2, (bottom + top) / 2, right - left, top - bottom))


def _is_restless(run: RunRecord) -> bool:
    """Whether the robot drives to and fro in the end."""
    last = [sample.command[0] for sample in run.samples[-20:]]
    return min(last) < -0.05 and max(last) > 0.05


EXERCISES = (
    exercise(
        "15.1",
        f"Drive to 50 cm before the wall, forward or backward, and stay there, to within 5 cm. {_LAST}",
        (_place(1.4, 0.5, 0.05), _place(0.8, 0.5, 0.05), _place(0.2, 0.8, 0.05)),
        touches_nothing(),
        ends_in(_PLACE),
        _AT_REST,
        seconds=40,
        noise=_NOISE,
        vary=_STARTS,
        hints=(
            says(
                "The robot fled from the place where it should be. Where it is too far away, the error is"
                " more than 0, and so has to be the speed.",
                lambda run: run.touch("wall behind"),
            ),
            says(
                "The robot drove to and fro, because it is just as fast for a small error as for a large one."
                " Let the speed follow the error.",
                _is_restless,
            ),
            says(
                "The robot is not 50 cm before the wall. The speed has to be the gain times the error.",
                ends_in(_PLACE).missing,
            ),
        ),
    ),
    exercise(
        "15.2",
        f"Drive to 50 cm before the wall, and stay there, to within 3 cm. {_LAST}",
        (_place(1.4, 0.5, 0.03), _place(1.1, 0.5, 0.03), _place(0.2, 0.8, 0.03)),
        touches_nothing(),
        ends_in(_PLACE),
        _AT_REST,
        seconds=10,
        noise=_NOISE,
        vary=_STARTS,
        hints=(
            says(
                "The robot overshoots, and drives to and fro: the gain is too large.",
                _is_restless,
            ),
            says(
                "Time ran out while the robot was still on its way: the gain is too small.",
                lambda run: not run.touch() and run.stood < 1 and ends_in(_PLACE).missing(run),
            ),
        ),
    ),
    exercise(
        "15.3",
        "Drive along the corridor to 40 cm before the wall, although the wheels are uneven, and stay there,"
        f" to within 5 cm. {_LAST} The middle of the robot must never be further than 10 cm from the middle"
        " of the corridor.",
        (_corridor("to the left", 0.98, 1.02), _corridor("to the right", 1.02, 0.98)),
        _IN_CORRIDOR,
        touches_nothing(),
        ends_in("40 cm before the wall"),
        _AT_REST,
        seconds=40,
        seeds=3,
        noise=_NOISE,
        vary=wears(speed=0.1),
        hints=(
            without_reading(
                "gyro",
                "The robot veers off course and does not notice: let `angular` follow the error of its"
                " angle.",
            ),
            without_reading(
                "distance",
                "The robot does not slow down: let `linear` follow the error of the distance.",
            ),
            says(
                "The robot left the corridor. It has to steer against its error, and strongly enough.",
                _IN_CORRIDOR.missing,
            ),
            says(
                "The robot did not stay 40 cm before the wall: how large is the error of the distance there,"
                " and how large the speed?",
                lambda run: not _IN_CORRIDOR.missing(run),
            ),
        ),
    ),
    exercise(
        "15.5",
        "A lane, 12 cm wide, runs 40 cm to the left of the robot. Get into it within 1.5 m, drive along it,"
        " and stop after 3 m. The middle of the robot must not leave the lane again.",
        (_lane("to the left", 0.99, 1.01), _lane("to the right", 1.01, 0.99)),
        *_IN_LANE,
        ends_in("end of the lane"),
        ends_still(2),
        seconds=60,
        seeds=3,
        noise={"motor": 0.02, "odom": 0.01, "gyro": 0.01},
        hints=(
            without_reading(
                "gyro",
                "Which way should the robot face in the middle of the lane, and what tells the program which"
                " way it does face? Let the error in position set a course, and steer to that course as in"
                " lesson 14.",
            ),
            says(
                "The robot was not in the lane. How large is its course in the middle of the lane, and how"
                " large 40 cm beside it?",
                lambda run: any(each.missing(run) for each in _IN_LANE),
            ),
        ),
    ),
)
