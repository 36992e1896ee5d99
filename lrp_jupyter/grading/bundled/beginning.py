"""The first challenges: a program that drives, and an edit while it runs."""

from __future__ import annotations

from collections.abc import Iterator

from lrp_jupyter.grading.bundled.common_hints import restarted_or_not_edited
from lrp_jupyter.grading.bundled.starters import starter
from lrp_jupyter.grading.challenge import Challenge
from lrp_jupyter.grading.criteria import edited, gets_away, keeps_driving, never_restarts, slows_to
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.grading.variation import moves


def _stayed(run: RunRecord) -> Iterator[str]:
    if run.driven < 0.01 and not run.turned.total:
        return
    if run.turned.total > 90:
        yield (
            f"The robot turned {run.turned.total:.0f}° and stayed in place: `angular` turns, `linear`"
            " drives. Write `robot.move(linear=0.2)`."
        )
    elif run.driven > 0.3:
        yield f"The robot drove {run.driven * 100:.0f} cm, but it kept coming back. Let it drive on."
    elif run.stood <= 1:
        yield f"The robot drove {run.driven * 100:.0f} cm in {run.seconds:.0f} s. Let it drive faster."


def _other_speed(run: RunRecord) -> Iterator[str]:
    yield from restarted_or_not_edited(run)
    if len(run.programs) < 2 or run.restarts:
        return
    if run.stood > 1:
        yield f"After the edit, the robot stopped at {run.still_since:.1f} s. Change only its speed."
    else:
        yield (
            "After the edit, the robot drove on, but not at half the speed. Which number is its speed, and"
            " what is half of it?"
        )


_ANYWHERE = moves("robot", x=0.3, y=0.2, degrees=180)

FIRST_MOVE = Challenge(
    "first move",
    "Drive: get 30 cm away from the place where the robot starts.",
    ("empty",),
    (gets_away(0.3),),
    10,
    (_stayed,),
    noise={"motor": 0.02},
    seeds=3,
    vary=(_ANYWHERE,),
    starter=starter("first move"),
)

HALF_THE_SPEED = Challenge(
    "half the speed",
    "The robot drives in a circle. Change the program while it runs, so that the robot drives on at half the"
    " speed: it must neither restart nor stand still.",
    ("empty",),
    (edited(), slows_to(0.5), keeps_driving(1), never_restarts()),
    120,
    (_other_speed,),
    noise={"motor": 0.02},
    seeds=3,
    vary=(_ANYWHERE,),
    starter=starter("half the speed"),
    live=3,
)
