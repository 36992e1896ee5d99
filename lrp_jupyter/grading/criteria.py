"""Criteria for a run: regions and times, never exact poses.

A criterion inspects the record of a run and returns whether it is met, with a reason. These functions
make criteria; a teacher writes more of them as ``Criterion(sentence, judge)``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

from lrp_jupyter.grading.record import RunRecord, Sample

__all__ = [
    "Criterion",
    "Verdict",
    "drives",
    "ends_in",
    "ends_still",
    "enters",
    "never_restarts",
    "no_faults",
    "on_line",
    "pushes",
    "stays_in",
    "touches",
    "touches_nothing",
    "turns",
    "visits",
]

_BLACK = 128  # a light reading below is the line, above is the floor


class Verdict(NamedTuple):
    """The result of one criterion for one run."""

    sentence: str
    passed: bool
    reason: str

    def __str__(self) -> str:
        return f"{'✓' if self.passed else '✗'} {self.sentence}: {self.reason}"


class Criterion(NamedTuple):
    """A sentence ("reaches `far`") and a function that returns whether a run meets it, and why."""

    sentence: str
    judge: Callable[[RunRecord], tuple[bool, str]]

    def __call__(self, run: RunRecord) -> Verdict:
        """Return the verdict on a run."""
        passed, reason = self.judge(run)
        return Verdict(self.sentence, passed, reason)


def drives(metres: float) -> Criterion:
    """Require that the robot drives at least this far, anywhere."""

    def judge(run: RunRecord) -> tuple[bool, str]:
        return run.driven >= metres, f"it drove {run.driven:.2f} m"

    return Criterion(f"drives at least {metres:g} m", judge)


def turns(degrees: float) -> Criterion:
    """Require that the robot turns by at least this much, left and right turns added up."""

    def judge(run: RunRecord) -> tuple[bool, str]:
        steps = zip(run.samples, run.samples[1:], strict=False)
        turned = math.degrees(sum(abs(_angle(b.heading - a.heading)) for a, b in steps))
        return turned >= degrees, f"it turned {turned:.0f}°"

    return Criterion(f"turns at least {degrees:g}°", judge)


def visits(*zones: str) -> Criterion:
    """Require that the robot comes to these zones, in this order."""

    def judge(run: RunRecord) -> tuple[bool, str]:
        missing, when = _one_after_another(zones, run.inside)
        if missing is None:
            return True, f"it was there {when}"
        return False, f"it never came to `{missing}` {when}".rstrip()

    return Criterion("comes to " + ", then ".join(f"`{zone}`" for zone in zones), judge)


def stays_in(zone: str) -> Criterion:
    """Require that the robot never leaves a zone."""

    def judge(run: RunRecord) -> tuple[bool, str]:
        inside = {sample.time for sample in run.inside(zone)}
        left = next((sample for sample in run.samples if sample.time not in inside), None)
        return left is None, "it never left" if left is None else f"it left after {left.time:.1f} s"

    return Criterion(f"stays in `{zone}`", judge)


def ends_in(zone: str) -> Criterion:
    """Require that the robot is in a zone at the end."""

    def judge(run: RunRecord) -> tuple[bool, str]:
        last = run.samples[-1]
        inside = run.world.zones[zone].contains(last.x, last.y)
        return inside, f"it ended at x = {last.x:.2f} m, y = {last.y:.2f} m"

    return Criterion(f"ends in `{zone}`", judge)


def ends_still(seconds: float) -> Criterion:
    """Require that the robot stands still at the end for this time, without trying to move."""

    def judge(run: RunRecord) -> tuple[bool, str]:
        stood = run.seconds - run.still_since
        return stood >= seconds - 1e-6, f"it stood still for {stood:.1f} s"

    return Criterion(f"stands still for {seconds:g} s at the end", judge)


def touches(*solids: str) -> Criterion:
    """Require that the robot touches these solids, in this order."""

    def judge(run: RunRecord) -> tuple[bool, str]:
        missing, when = _one_after_another(solids, run.touches)
        if missing is None:
            return True, f"it touched it {when}"
        return False, f"it never touched the {missing} {when}".rstrip()

    return Criterion("touches the " + ", then the ".join(solids), judge)


def touches_nothing() -> Criterion:
    """Require that the robot touches no solid and not the edge of the world."""

    def judge(run: RunRecord) -> tuple[bool, str]:
        found = next((sample for sample in run.samples if sample.touched), None)
        if found is None:
            return True, "it touched nothing"
        return False, f"it touched the {min(found.touched)} after {found.time:.1f} s"

    return Criterion("touches nothing", judge)


def pushes(solid: str, zone: str) -> Criterion:
    """Require that a solid is in a zone at the end."""

    def judge(run: RunRecord) -> tuple[bool, str]:
        names = [getattr(each, "name", "") for each in run.world.solids]
        x, y, _ = run.samples[-1].solids[names.index(solid)]
        return run.world.zones[zone].contains(x, y), f"the {solid} is at x = {x:.2f} m, y = {y:.2f} m"

    return Criterion(f"brings the {solid} into `{zone}`", judge)


def on_line(share: float, sensor: int = 0) -> Criterion:
    """Require that a light sensor sees the line for at least this share of the time (0 … 1)."""

    def judge(run: RunRecord) -> tuple[bool, str]:
        seen = [sample for sample in run.samples if sees_line(sample, sensor)]
        part = len(seen) / max(1, len(run.samples))
        return part >= share, f"it saw the line {part:.0%} of the time"

    return Criterion(f"sees the line at least {share:.0%} of the time", judge)


def sees_line(sample: Sample, sensor: int = 0) -> bool:
    """Return whether a light sensor sees black."""
    return sensor < len(sample.lights) and sample.lights[sensor] < _BLACK


def enters(state: str) -> Criterion:
    """Require that a state of the program, given by name or path, is entered."""

    def judge(run: RunRecord) -> tuple[bool, str]:
        entries = run.entries(state)
        return bool(entries), f"entered after {entries[0].now:.1f} s" if entries else "never entered"

    return Criterion(f"enters the state `{state}`", judge)


def never_restarts() -> Criterion:
    """Require that no edit restarts the program."""

    def judge(run: RunRecord) -> tuple[bool, str]:
        found = next((event for event in run.events if event.kind == "restarted"), None)
        return found is None, "no restart" if found is None else str(found.data)

    return Criterion("never restarts", judge)


def no_faults() -> Criterion:
    """Require that the program runs without issues."""

    def judge(run: RunRecord) -> tuple[bool, str]:
        if not run.issues:
            return True, "no issue"
        issue = run.issues[0]
        return False, f"line {issue.line}: {issue.message}"

    return Criterion("runs without issues", judge)


def _one_after_another(
    names: Sequence[str], samples_of: Callable[[str], Iterable[Sample]]
) -> tuple[str | None, str]:
    """Return the first name without a sample, in this order, and when the last sample was found."""
    after, when = -1.0, ""
    for name in names:
        found = next((sample for sample in samples_of(name) if sample.time > after), None)
        if found is None:
            return name, when
        after, when = found.time, f"after {found.time:.1f} s"
    return None, when


def _angle(difference: float) -> float:
    return (difference + math.pi) % (2 * math.pi) - math.pi
