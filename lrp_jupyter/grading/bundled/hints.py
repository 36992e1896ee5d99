"""Hints that several challenges give."""

from __future__ import annotations

from lrp_jupyter.grading.challenge import Hint
from lrp_jupyter.grading.criteria import sees_line
from lrp_jupyter.grading.record import RunRecord, Sample


def ignores(sensor: str, advice: str) -> Hint:
    """Return the hint that the program does not read a sensor.

    `sensor`: such as ``"light"``.
    `advice`: a sentence.
    """

    def find(run: RunRecord) -> str | None:
        if f"robot.{sensor}" in run.programs[-1].text:
            return None
        return f"The program does not read `robot.{sensor}`. {advice}"

    return find


def never_touched(run: RunRecord) -> str | None:
    """Say that the robot never bumped, and what it did instead."""
    if run.first(lambda sample: sample.touched, "touches anything"):
        return None
    if run.still_since < run.seconds - 3 and run.driven > 0.1:
        return (
            f"The robot stopped after {run.still_since:.1f} s, before it touched anything. Let the bumper"
            " decide when it stops, not the time: `[robot.bumper.data == 1]`."
        )
    left, right = run.turned
    if left + right > 360:
        return (
            f"The robot turned {left + right:.0f}° and never met anything. Drive straight on until it bumps."
        )
    return f"The robot drove {run.driven:.2f} m and never touched anything. Drive on until it bumps."


def kept_pushing(run: RunRecord) -> str | None:
    """Say that the robot pushed against something for long."""
    longest, since, name, _ = run.fold(longest_push, (0.0, 0.0, "", 0.0))
    if longest <= 1:
        return None
    return (
        f"The robot pushed against {_named(name)} for {longest:.1f} s, from {since:.1f} s on. A transition"
        " with the condition `[robot.bumper.data == 1]` has to lead out of the state that drives."
    )


def _named(solid: str) -> str:
    return "a wall" if solid.startswith("solid") else f"the {solid}"


def longest_push(
    so_far: tuple[float, float, str, float], now: Sample, _: Sample
) -> tuple[float, float, str, float]:
    """Keep the longest push (how long, since when, against what), and since when this one lasts."""
    longest, began, name, since = so_far
    if not now.touched or now.command[0] <= 0:
        return longest, began, name, now.time
    if now.time - since > longest:
        return now.time - since, since, min(now.touched), since
    return so_far


def never_saw_the_line(run: RunRecord) -> str | None:
    """Say that the light sensor never saw the line."""
    if run.first(sees_line, "sees the line"):
        return None
    return (
        f"The robot drove {run.driven:.2f} m, and its light sensor never saw the line. White reads 255 and"
        " black reads 0: on the line it is below 128."
    )


def lost_the_line(run: RunRecord) -> str | None:
    """Say that the robot lost the line and did not find it again."""
    last: float | None = None
    last = run.fold(lambda so_far, now, _: now.time if sees_line(now) else so_far, last, "last saw the line")
    if last is None or run.seconds - last < 5:
        return None
    return (
        f"The robot lost the line after {last:.1f} s and did not find it again."
        " Look to the left, then to the right, and each time a bit further."
    )


def never_came(zone: str, advice: str) -> Hint:
    """Return the hint that the robot never came to a zone."""

    def find(run: RunRecord) -> str | None:
        if next(run.inside(zone), None) is not None:
            return None
        return f"The robot never came to `{zone}`. {advice}"

    return find


def restarted(run: RunRecord) -> str | None:
    """Say why an edit has restarted the program."""
    if not run.restarts:
        return None
    return (
        f"The program restarted: {run.restart_reason} A change of a variable, an event or a transition never"
        " restarts it, and neither does a change of a state that is not active."
    )


def was_not_edited(run: RunRecord) -> str | None:
    """Say that nothing was edited while the program ran."""
    if len(run.programs) > 1:
        return None
    return "The program is still the one that you were given. Change it while it runs; comments do not count."
