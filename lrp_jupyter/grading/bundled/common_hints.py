"""Hints that several challenges give."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from lrp_jupyter.grading.criteria import sees_line, stops_once
from lrp_jupyter.grading.criteria.contact import longest_push
from lrp_jupyter.grading.run_record import RunRecord
from lrp_jupyter.sim.floor import distance_to
from lrp_jupyter.sim.world import PathStroke


def ignores(run: RunRecord, sensor: str, advice: str) -> Iterator[str]:
    """Say that the program does not read a sensor, such as ``"light"``."""
    if f"robot.{sensor}" not in run.programs[-1].text:
        yield f"The program does not read `robot.{sensor}`. {advice}"


def never_touched(run: RunRecord) -> Iterator[str]:
    """Say that the robot never bumped, and what it did instead."""
    if run.touch():
        return
    if run.stood > 1 and run.driven > 0.1:
        yield (
            f"The robot stopped after {run.still_since:.1f} s, before it touched anything. Let the bumper"
            " decide when it stops: `[robot.bumper.data == 1]`."
        )
    elif run.turned.total > 360:
        yield (
            f"The robot turned {run.turned.total:.0f}° and never met anything. Drive straight on until it"
            " bumps."
        )
    elif run.driven > 0.01:
        yield f"The robot drove {run.driven:.2f} m and never touched anything. Drive on until it bumps."


def kept_pushing(run: RunRecord) -> Iterator[str]:
    """Say that the robot pushed against something for long."""
    push = longest_push(run)
    if push.seconds > 1:
        against = "a wall" if push.solid.startswith("solid") else f"the {push.solid}"
        states = next(sample for sample in run.samples if sample.time > push.since).active
        where = f" in `{states[-1][-1]}`" if states else ""
        yield (
            f"The robot pushed against {against}{where} for {push.seconds:.1f} s, from {push.since:.1f} s on."
            " A transition with the condition `[robot.bumper.data == 1]` has to lead out of that state."
        )


def stopped_too_early(run: RunRecord, where: str) -> Iterator[str]:
    """Say that the robot had stopped, and drove on."""
    if reason := _ONCE.missing(run):
        yield f"The robot stopped in the wrong place: {reason}. It may stop only once, {where}."


_ONCE = stops_once()


def never_saw_the_line(run: RunRecord) -> Iterator[str]:
    """Say that the light sensor never saw the line."""
    if not run.first(sees_line) and run.driven > 0.01:
        yield (
            f"The robot drove {run.driven:.2f} m, and its light sensor never saw the line. White reads 255"
            " and black reads 0: on the line it is below 128."
        )


def drove_over_the_line(run: RunRecord) -> Iterator[str]:
    """Say that the robot drove over the line, and that its light sensor missed it."""
    crossed = min(distance_to(run.world.floor, sample.x, sample.y) for sample in run.samples) < 0.1
    step = max((now.distance(before) for before, now in pairwise(run.samples)), default=0.0)
    if crossed and step >= _LINE and not run.first(sees_line):
        yield (
            f"The robot drove over the line and did not see it: its light sensor moved {step * 100:.1f} cm"
            f" from one reading to the next, and the line is {_LINE * 100:g} cm wide. Drive more slowly."
        )


_LINE = PathStroke(()).width  # m


def lost_the_line(run: RunRecord) -> Iterator[str]:
    """Say that the robot lost the line and did not find it again."""
    last = run.last(sees_line)
    if last and run.seconds - last.time >= 5:
        yield (
            f"The robot lost the line after {last.time:.1f} s and did not find it again."
            " Look to the left, then to the right, and each time a bit further."
        )


def restarted_or_not_edited(run: RunRecord) -> Iterator[str]:
    """Say why an edit has restarted the program, or that nothing was edited while it ran."""
    if len(run.programs) < 2:
        yield (
            "The program is still the one that you were given. Change it while it runs; comments do not"
            " count."
        )
    if run.restarts:
        yield (
            f"The program restarted: {run.restart_reason} Changing a variable, an event or a transition"
            " never restarts it, nor does changing a state that is not active."
        )
