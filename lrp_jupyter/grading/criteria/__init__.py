"""Criteria for a run: regions and times, never exact poses.

A criterion is a sentence and a function of the record of a run. The record grows while the robot drives, and
the function is asked after every tick: so the same criteria are shown live, and judge a finished run. These
functions make criteria; a teacher writes more of them as ``Criterion(sentence, judge)``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Literal, NamedTuple

from lrp_jupyter.grading.record import RunRecord, Sample
from lrp_jupyter.sim.floor import distance_to
from lrp_jupyter.sim.world import BoxZone, Zone

__all__ = [
    "EDITED",
    "Criterion",
    "Found",
    "State",
    "Verdict",
    "When",
    "covers",
    "drives",
    "edited",
    "ends_in",
    "ends_still",
    "enters",
    "lasts",
    "near_line",
    "never_restarts",
    "no_faults",
    "not_carried",
    "on_line",
    "pushes",
    "sees_line",
    "stays_in",
    "touches",
    "touches_nothing",
    "turns",
    "visits",
]

EDITED = "is edited while it runs"
BLACK = 128  # a light reading below is the line, above is the floor

When = Literal["once", "always", "at the end"]
State = Literal["open", "so far", "met", "failed"]


class Found(NamedTuple):
    """What a criterion finds in a run: how much of it is met (0 … 1), and why.

    A partial result is what partial credit is given for.
    """

    share: float
    reason: str


class Verdict(NamedTuple):
    """The result of one criterion for one run.

    Parameters
    ----------
    sentence : str
    passed : bool
    reason : str
        With the measured figure.
    share : float
        How much of it is met, 0 to 1.
    state : {"open", "so far", "met", "failed"}
        While the run goes on, what is not met yet is open, and what can still be broken is met so far.
    decided : float or None
        When it was met or broken for good, in seconds of the run; None if only the end decides.
    """

    sentence: str
    passed: bool
    reason: str
    share: float = 0.0
    state: State = "open"
    decided: float | None = None

    def __str__(self) -> str:
        return f"{'✓' if self.passed else '✗'} {self.sentence}: {self.reason}"


class Criterion(NamedTuple):
    """A sentence ("comes to `far`"), and the function that judges a run by it.

    Parameters
    ----------
    sentence : str
    judge : callable
        Takes a :class:`~lrp_jupyter.grading.record.RunRecord` and returns whether the criterion is met (or
        how much of it, 0 to 1), and the reason. It is asked after every tick.
    when : {"at the end", "once", "always"}
        Whether it counts at the end only, is met for good when it was met once, or is broken for good when
        it was broken once; a run ends there.

    Examples
    --------
    >>> hurry = Criterion("is there in six seconds", lambda run: (run.seconds < 6, f"{run.seconds:.1f} s"))
    """

    sentence: str
    judge: Callable[[RunRecord], tuple[float, str]]
    when: When = "at the end"


def drives(metres: float) -> Criterion:
    """Require that the robot drives at least this far, anywhere."""

    def judge(run: RunRecord) -> Found:
        return Found(run.driven / metres, f"it drove {run.driven:.2f} m")

    return Criterion(f"drives at least {metres:g} m", judge, "once")


def turns(degrees: float) -> Criterion:
    """Require that the robot turns by at least this much, left and right turns added up."""

    def judge(run: RunRecord) -> Found:
        turned = sum(run.turned)
        return Found(turned / degrees, f"it turned {turned:.0f}°")

    return Criterion(f"turns at least {degrees:g}°", judge, "once")


def visits(*zones: str) -> Criterion:
    """Require that the robot comes to these zones, in this order."""

    def judge(run: RunRecord) -> Found:
        done = _in_order(run, [partial(_is_in, run.world.zones[zone]) for zone in zones], zones)
        when = f"after {done[-1]:.1f} s" if done else ""
        if len(done) == len(zones):
            return Found(1, f"it was there {when}")
        return Found(len(done) / len(zones), f"it never came to `{zones[len(done)]}` {when}".rstrip())

    return Criterion("comes to " + ", then ".join(f"`{zone}`" for zone in zones), judge, "once")


def touches(*solids: str) -> Criterion:
    """Require that the robot touches these solids, in this order."""

    def judge(run: RunRecord) -> Found:
        done = _in_order(run, [partial(_touches, solid) for solid in solids], ("touches", solids))
        when = f"after {done[-1]:.1f} s" if done else ""
        if len(done) == len(solids):
            return Found(1, f"it touched it {when}")
        return Found(len(done) / len(solids), f"it never touched the {solids[len(done)]} {when}".rstrip())

    return Criterion("touches the " + ", then the ".join(solids), judge, "once")


def covers(zone: str, share: float, cell: float = 0.3) -> Criterion:
    """Require that the robot comes to this share (0 … 1) of a zone, in cells of this width (metres)."""

    def judge(run: RunRecord) -> Found:
        region = run.world.zones[zone]
        if not isinstance(region, BoxZone):
            raise TypeError(f"`{zone}` is not a rectangle, and only rectangles have cells.")
        x, y, width, height = region.box
        columns, rows = max(1, round(width / cell)), max(1, round(height / cell))

        def visit(cells: frozenset[tuple[int, int]], now: Sample, _: Sample) -> frozenset[tuple[int, int]]:
            if not region.contains(now.x, now.y):
                return cells
            column = min(columns - 1, int((now.x - x + width / 2) / width * columns))
            row = min(rows - 1, int((now.y - y + height / 2) / height * rows))
            return cells if (column, row) in cells else cells | {(column, row)}

        nothing: frozenset[tuple[int, int]] = frozenset()
        part = len(run.fold(visit, nothing, ("covers", zone, cell))) / (columns * rows)
        return Found(part / share, f"it was in {part:.0%} of it")

    return Criterion(f"comes to {share:.0%} of `{zone}`", judge, "once")


def lasts(seconds: float) -> Criterion:
    """Require that the run goes on for this time: what must always hold has held so long."""

    def judge(run: RunRecord) -> Found:
        return Found((run.seconds + 1e-6) / seconds, f"{run.seconds:.0f} s have passed")

    return Criterion(f"goes on for {seconds:g} s", judge, "once")


def stays_in(zone: str) -> Criterion:
    """Require that the robot never leaves a zone."""

    def judge(run: RunRecord) -> Found:
        region = run.world.zones[zone]
        left = run.first(lambda sample: not region.contains(sample.x, sample.y), ("leaves", zone))
        return Found(left is None, "it never left" if left is None else f"it left after {left.time:.1f} s")

    return Criterion(f"stays in `{zone}`", judge, "always")


def touches_nothing() -> Criterion:
    """Require that the robot touches no solid and not the edge of the world."""

    def judge(run: RunRecord) -> Found:
        found = run.first(lambda sample: sample.touched, "touches anything")
        if found is None:
            return Found(1, "it touched nothing")
        return Found(0, f"it touched the {min(found.touched)} after {found.time:.1f} s")

    return Criterion("touches nothing", judge, "always")


def near_line(metres: float) -> Criterion:
    """Require that the middle of the robot is never further than this from the line."""

    def judge(run: RunRecord) -> Found:
        def furthest(so_far: tuple[float, float], now: Sample, _: Sample) -> tuple[float, float]:
            return max(so_far, (distance_to(run.world.floor, now.x, now.y), now.time))

        distance, when = run.fold(furthest, (0.0, 0.0), "furthest from the line")
        reason = f"at most {distance * 100:.0f} cm"
        return Found(distance <= metres, reason if distance <= metres else f"{reason}, after {when:.1f} s")

    return Criterion(f"is never further than {metres * 100:g} cm from the line", judge, "always")


def on_line(share: float, sensor: int = 0) -> Criterion:
    """Require that a light sensor sees the line for at least this share of the time (0 … 1)."""

    def judge(run: RunRecord) -> Found:
        seen = run.fold(lambda so_far, now, _: so_far + sees_line(now, sensor), 0, ("on the line", sensor))
        part = seen / max(1, len(run.samples))
        return Found(part / share, f"it saw the line {part:.0%} of the time")

    return Criterion(f"sees the line at least {share:.0%} of the time", judge)


def sees_line(sample: Sample, sensor: int = 0) -> bool:
    """Return whether a light sensor sees black."""
    return sensor < len(sample.lights) and sample.lights[sensor] < BLACK


def ends_in(zone: str) -> Criterion:
    """Require that the robot is in a zone at the end."""

    def judge(run: RunRecord) -> Found:
        last = run.samples[-1]
        inside = run.world.zones[zone].contains(last.x, last.y)
        return Found(inside, f"it is at x = {last.x:.2f} m, y = {last.y:.2f} m")

    return Criterion(f"ends in `{zone}`", judge)


def ends_still(seconds: float) -> Criterion:
    """Require that the robot stands still at the end for this time, without trying to move."""

    def judge(run: RunRecord) -> Found:
        stood = run.seconds - run.still_since
        return Found((stood + 1e-6) / seconds, f"it stood still for {stood:.1f} s")

    return Criterion(f"stands still for {seconds:g} s at the end", judge)


def pushes(solid: str, zone: str) -> Criterion:
    """Require that a solid is in a zone at the end."""

    def judge(run: RunRecord) -> Found:
        names = [each.name for each in run.world.solids]
        x, y, _ = run.samples[-1].solids[names.index(solid)]
        return Found(run.world.zones[zone].contains(x, y), f"the {solid} is at x = {x:.2f} m, y = {y:.2f} m")

    return Criterion(f"brings the {solid} into `{zone}`", judge)


def enters(state: str) -> Criterion:
    """Require that a state of the program, given by name or path, is entered."""

    def judge(run: RunRecord) -> Found:
        found = run.entered(state)
        return Found(bool(found), f"entered after {found.time:.1f} s" if found else "never entered")

    return Criterion(f"enters the state `{state}`", judge, "once")


def edited(times: int = 1) -> Criterion:
    """Require that the program was edited while it ran, so that it ran in this many versions more."""

    def judge(run: RunRecord) -> Found:
        edits = max(0, len(run.programs) - 1)
        return Found(edits / times, {0: "no edit", 1: "1 edit"}.get(edits, f"{edits} edits"))

    return Criterion(EDITED, judge, "once")


def never_restarts() -> Criterion:
    """Require that no edit restarts the program."""

    def judge(run: RunRecord) -> Found:
        return Found(not run.restarts, run.restart_reason if run.restarts else "no restart")

    return Criterion("never restarts", judge, "always")


def no_faults() -> Criterion:
    """Require that the program runs without issues."""

    def judge(run: RunRecord) -> Found:
        if not run.issues:
            return Found(1, "no issue")
        issue = run.issues[0]
        return Found(0, f"line {issue.line}: {issue.message}")

    return Criterion("runs without issues", judge)


def not_carried() -> Criterion:
    """Require that the robot comes from place to place by driving; holds in every challenge."""

    def judge(run: RunRecord) -> Found:
        jump = run.fold(_jump, None)
        if jump is None:
            return Found(1, "it drove by itself")
        return Found(0, f"it was put down elsewhere after {jump:.1f} s")

    return Criterion("is not carried", judge, "always")


_FASTEST, _SLACK = 0.8, 0.05  # m/s; metres, which a collision may add


def _jump(found: float | None, now: Sample, before: Sample) -> float | None:
    if found is not None or now.distance(before) <= _FASTEST * (now.time - before.time) + _SLACK:
        return found
    return now.time


def _is_in(zone: Zone, now: Sample) -> bool:
    return zone.contains(now.x, now.y)


def _touches(solid: str, now: Sample) -> bool:
    return solid in now.touched


def _in_order(run: RunRecord, places: Sequence[Callable[[Sample], bool]], key: object) -> tuple[float, ...]:
    """Return when the robot was at several places, one after the other, up to the first it was not at."""

    def step(done: tuple[float, ...], now: Sample, _: Sample) -> tuple[float, ...]:
        is_later = not done or done[-1] < now.time
        return (*done, now.time) if len(done) < len(places) and is_later and places[len(done)](now) else done

    return run.fold(step, (), key)
