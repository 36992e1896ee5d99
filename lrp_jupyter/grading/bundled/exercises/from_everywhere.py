"""Exercises of lesson 6: transitions from many states, and out of a machine inside."""

from __future__ import annotations

from dataclasses import replace

from lrp_jupyter.grading.bundled.common_hints import kept_pushing
from lrp_jupyter.grading.bundled.exercises.exercise import exercise, says
from lrp_jupyter.grading.bundled.exercises.exercise_worlds import across, lane
from lrp_jupyter.grading.bundled.rooms import ROOMS, THICK
from lrp_jupyter.grading.criteria import (
    Criterion,
    backs_off,
    bumps,
    bumps_in,
    ends_still,
    finds_line,
    never_pushes,
    stays_in,
    stops_at,
    touches,
)
from lrp_jupyter.grading.criteria.contact import longest_push
from lrp_jupyter.grading.criteria.motion import backed
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.grading.variation import moves
from lrp_jupyter.sim.world import BoxSolid, RobotSpec, World

__all__ = ["EXERCISES"]


def _dock(line: float) -> World:
    """Return a lane with a wall at both ends, and a line across it, whose robot faces the wrong one."""
    world = lane(f"line at {line:g} m", across((line, 0.05)), line, 0.2)
    behind = BoxSolid((THICK / 2, 1, THICK, 2), name="wall behind")
    robot = RobotSpec((0.9, 1, 3.1416))
    return replace(world, solids=(*world.solids, behind), robots=(robot,))


def _lit_at_the_end(run: RunRecord) -> tuple[float, str]:
    return run.samples[-1].lamp, f"its lamp is {'lit' if run.samples[-1].lamp else 'dark'}"


def _backs_off_twice(run: RunRecord) -> tuple[float, str]:
    times = run.fold(backed, 0)
    return times <= 2, f"it backed off {times} times"


def _pushed_in(run: RunRecord) -> str | None:
    push = longest_push(run)
    later = run.first(lambda sample: sample.time > push.since + 0.5 and sample.active)
    if push.seconds <= 1 or later is None:
        return None
    state = later.active[0][-1]
    return (
        f"The robot pushed against the {push.solid} while `{state}` was active: no transition leads out of"
        " that state when the robot bumps. `*` as the source stands for every state."
    )


_TURNED = moves("robot", x=0.1, y=0.1, degrees=60)

EXERCISES = (
    exercise(
        "6.1",
        "Wander about, and stop at the black border, whichever state is active.",
        "arena",
        stays_in("inside"),
        finds_line(),
        ends_still(2),
        seconds=60,
        seeds=6,
        vary=moves("robot", x=0.4, y=0.3, degrees=180),
        hints=(
            says(
                "The robot saw the border and drove on: in the state that was active, no transition waits for"
                " `black`. `*` as the source of a transition stands for every state.",
                lambda run: stays_in("inside").missing(run),
            ),
        ),
    ),
    exercise(
        "6.2",
        "Turn away from every wall except the one behind the black line: drive up to that one until the"
        " robot bumps, and stay there.",
        tuple(map(_dock, (1.8, 2.2, 2.6))),
        touches("wall"),
        stops_at("wall", 1),
        ends_still(2),
        seconds=60,
        vary=moves("robot", x=0.15, y=0.3),
        hints=(
            kept_pushing,
            says(
                "The robot turned away from the wall behind the line, too: `*` means every state,"
                " `parking` as well. `*-{…}` leaves out those in the braces.",
                lambda run: run.first(lambda sample: sample.lights[0] < 128),
            ),
        ),
    ),
    exercise(
        "6.3",
        "Whichever of `straight` and `left` is active at a bump, let the robot escape: back off, turn until"
        " the way ahead is clear, and then wander on.",
        ROOMS,
        bumps_in("left"),
        backs_off(4),
        never_pushes(3),
        seconds=200,
        vary=_TURNED,
        hints=(
            _pushed_in,
            kept_pushing,
            says(
                "The robot turned and turned: nothing ends `escaping`. An `exit` leads out of the machine"
                " inside: `(exit [robot.distance.data > 0.5] turning -> straight)`.",
                lambda run: run.fold(backed, 0) < 4 and run.turned.total > 720,
            ),
        ),
    ),
    exercise(
        "6.5",
        "Wander about, and back off at the first two bumps. At the third one, whichever state is active,"
        " stop for good with the lamp lit.",
        ROOMS,
        bumps(3),
        Criterion("backs off twice at most", _backs_off_twice, "always"),
        never_pushes(2),
        ends_still(2),
        Criterion("has its lamp lit at the end", _lit_at_the_end),
        seconds=150,
        vary=_TURNED,
        hints=(
            says(
                "The robot backed off a third time. Of two enabled transitions the first in the text fires,"
                " so the one that leads to the end has to stand above the other; and something has to count"
                " the bumps.",
                lambda run: run.fold(backed, 0) > 2,
            ),
            kept_pushing,
            says(
                "The lamp is dark at the end. Light it in the `onentry` of the state in which the robot"
                " stays.",
                lambda run: run.stood > 2 and not run.samples[-1].lamp,
            ),
        ),
    ),
)
