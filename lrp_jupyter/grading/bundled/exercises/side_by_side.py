"""Exercises of lesson 11: machines side by side, and how they agree."""

from __future__ import annotations

from itertools import pairwise

from lrp_jupyter.grading.bundled.exercises.exercise import exercise, says
from lrp_jupyter.grading.bundled.exercises.exercise_worlds import HALLS, hall
from lrp_jupyter.grading.criteria import (
    Criterion,
    blinks,
    drives,
    ends_in,
    ends_still,
    lit_while,
    touches_nothing,
    turns,
)
from lrp_jupyter.grading.run_record import RunRecord, Sample
from lrp_jupyter.grading.variation import moves

__all__ = ["EXERCISES"]

_STARTS = moves("robot", x=0.15, y=0.3)
_NEAR_HALLS = tuple(hall(ahead, distance=0.2) for ahead in (0.6, 1.0, 1.5))


def _turns_now(sample: Sample) -> bool:
    return sample.command[1] != 0


def _blinked_then_lit(run: RunRecord) -> tuple[float, str]:
    """Return whether the lamp changed about twice a second up to the stop, and was lit from then on."""
    times = [now.time for before, now in pairwise(run.samples) if now.lamp != before.lamp]
    stop = run.still_since
    phases = [after - before for before, after in pairwise([0.0, *(t for t in times if t < stop - 0.3)])]
    worst = max(phases, key=lambda phase: abs(phase - 0.5), default=stop)
    if abs(worst - 0.5) > 0.25:
        return 0, f"while it drove, the lamp once took {worst:.1f} s to change"
    if stop - max((t for t in times if t < stop - 0.3), default=0.0) > 1:
        return 0, "the lamp did not blink all the way"
    late = [t for t in times if t > stop + 0.7]
    if late or not run.samples[-1].lamp:
        return 0, "after the stop the lamp was not lit all the time"
    return 1, "it blinked, and was lit in the end"


_ONE_MACHINE = says(
    "Only one machine is active. A second `(spawn machine state)`, outside all machines, starts the other one"
    " beside it.",
    lambda run: max(len(sample.active) for sample in run.samples) < 2,
)

EXERCISES = (
    exercise(
        "11.1",
        "Drive in a circle, and let the lamp blink all the time: one second lit, one second dark.",
        "empty",
        drives(2),
        blinks(1),
        seconds=30,
        hints=(_ONE_MACHINE,),
    ),
    exercise(
        "11.2",
        "The robot turns away from the walls. Light its lamp while it turns, and only then.",
        HALLS,
        turns(360),
        lit_while("turns", _turns_now),
        seconds=60,
        vary=_STARTS,
        hints=(
            says(
                "The lamp stayed lit. A transition has to lead back from `lit` to `dark`, when `legs` is"
                " no longer"
                ' in its state `bend`: `[legs.state == "straight"]`.',
                lambda run: run.samples[-1].lamp,
            ),
        ),
    ),
    exercise(
        "11.3",
        "The machine `guard` sees the wall: let it stop `legs`, about 20 cm before the wall, whatever"
        " `legs` is doing. Touch nothing.",
        _NEAR_HALLS,
        touches_nothing(),
        ends_in("before the wall"),
        ends_still(2),
        seconds=40,
        vary=_STARTS,
        hints=(
            says(
                "`guard` saw the wall, and `legs` drove on. They share the variable `danger`: one of them"
                " has to set it to `True`, and a transition of the other one waits for it, from any"
                " state.",
                lambda run: run.touch(),
            ),
        ),
    ),
    exercise(
        "11.5",
        "Drive to about 20 cm before the wall, and stop. On the way, let the lamp blink: half a second lit,"
        " half a second dark. Once the robot has stopped, the lamp stays lit.",
        _NEAR_HALLS,
        touches_nothing(),
        ends_in("before the wall"),
        ends_still(2),
        Criterion("blinks while it drives, and is lit from the stop on", _blinked_then_lit),
        seconds=40,
        vary=_STARTS,
        hints=(
            _ONE_MACHINE,
            says(
                'The lamp has to know that `legs` has stopped: `[legs.state == "there"]` is true then.'
                " Which state of `lamp` does that lead to, and from which?",
            ),
        ),
    ),
)
