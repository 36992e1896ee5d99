"""Criteria about what the robot touches."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

from lrp_jupyter.grading.criteria.criterion import Criterion, Found
from lrp_jupyter.grading.criteria.motion import times_of
from lrp_jupyter.grading.criteria.order import in_order, reason_of
from lrp_jupyter.grading.criteria.places import no_solid
from lrp_jupyter.grading.run_record import RunRecord, Sample
from lrp_jupyter.live.running.frame import is_active
from lrp_jupyter.sim.world import BoxSolid

_APART = 0.5  # s; contacts that are closer are one bump
_PLACE = 0.03  # m; a robot that comes no further away still pushes at the same place
_AWAY = 0.06  # m; so far off, a robot has left what it has touched


def touches(*solids: str) -> Criterion:
    """Require that the robot touches these solids, in this order."""

    def judge(run: RunRecord) -> Found:
        _check(run, solids)
        done = in_order(run, [partial(_touches, solid) for solid in solids], ("touches", solids))
        return Found(len(done) / len(solids), reason_of(done, solids, "touched the"))

    return Criterion("touches the " + ", then the ".join(solids), judge, "once")


def touches_nothing() -> Criterion:
    """Require that the robot touches no solid and not the edge of the world."""

    def judge(run: RunRecord) -> Found:
        found = run.first(lambda sample: sample.touched, "touches anything")
        if found is None:
            return Found(1, "it touched nothing")
        return Found(0, f"it touched the {min(found.touched)} after {found.time:.1f} s")

    return Criterion("touches nothing", judge, "always")


def bumps(times: int, walls: int = 1) -> Criterion:
    """Require that the robot bumps into something so often, and into so many different things."""

    def judge(run: RunRecord) -> Found:
        def count(so_far: tuple[int, float], now: Sample, _: Sample) -> tuple[int, float]:
            bumped, last = so_far
            if not now.touched:
                return so_far
            return (bumped + (now.time - last > _APART), now.time)

        def collect(so_far: frozenset[str], now: Sample, _: Sample) -> frozenset[str]:
            return so_far if now.touched <= so_far else so_far | now.touched

        nothing: frozenset[str] = frozenset()
        bumped, _ = run.fold(count, (0, -1.0), "bumps")
        different = len(run.fold(collect, nothing, "has touched"))
        reason = f"it {times_of('bumped', bumped)}"
        if walls > 1 and bumped:
            reason += f", into {different} of {walls} walls"
        return Found(min(bumped / times, different / walls), reason)

    sentence = f"bumps into {walls} different walls" if walls > 1 else times_of("bumps", times)
    return Criterion(sentence, judge, "once")


def bumps_in(*states: str) -> Criterion:
    """Require that the robot bumps while each of these states is active."""

    def judge(run: RunRecord) -> Found:
        def collect(so_far: frozenset[str], now: Sample, before: Sample) -> frozenset[str]:
            if not now.bumper or before.bumper:
                return so_far
            return so_far | {state for state in states if is_active(state, before.active)}

        nothing: frozenset[str] = frozenset()
        found = run.fold(collect, nothing, ("bumps in", states))
        missing = [f"`{state}`" for state in states if state not in found]
        reason = f"it never bumped in {' or '.join(missing)}" if missing else "it bumped in each of them"
        return Found(len(found) / len(states), reason)

    return Criterion("bumps in " + ", ".join(f"`{state}`" for state in states), judge, "once")


def never_pushes(seconds: float) -> Criterion:
    """Require that the robot never drives against anything for longer than this time, pauses left out.

    Only what presses its bumper counts: along a wall beside it, it may drive.
    """

    def judge(run: RunRecord) -> Found:
        pushed = longest_push(run).seconds
        reason = f"it pushed for {pushed:.1f} s" if pushed else "it never pushed"
        return Found(pushed <= seconds + 1e-6, reason)

    return Criterion(f"never pushes for longer than {seconds:g} s", judge, "always")


class Push(NamedTuple):
    """The robot pushes against a solid, for some seconds altogether, without leaving the place."""

    seconds: float = 0.0
    since: float = 0.0
    solid: str = ""


def longest_push(run: RunRecord) -> Push:
    """Return the longest push of a run."""
    nothing: tuple[Push, Push, Sample | None] = (Push(), Push(), None)
    return run.fold(_push, nothing)[0]


def _push(
    so_far: tuple[Push, Push, Sample | None], now: Sample, before: Sample
) -> tuple[Push, Push, Sample | None]:
    """Keep the longest push, this one, and where the robot last touched something."""
    longest, present, place = so_far
    if not now.touched:
        has_left = place is not None and now.distance(place) > _PLACE
        return (longest, Push(), None) if has_left else so_far
    if now.command[0] > 0 and now.bumper:
        since, solid = (present.since, present.solid) if present.solid else (before.time, min(now.touched))
        present = Push(present.seconds + now.time - before.time, since, solid)
    return max(longest, present), present, now


def backs_off_at_bumps(seconds: float) -> Criterion:
    """Require that the robot drives backward within this time after each bump, and at no other time."""

    def judge(run: RunRecord) -> Found:
        def step(so_far: tuple[float, float, str], now: Sample, before: Sample) -> tuple[float, float, str]:
            """Keep the bump that waits for an answer, when something was touched, and what is wrong."""
            waiting, touched, wrong = so_far
            if now.touched:
                touched = now.time
            if now.command[0] < 0:
                if before.command[0] >= 0 and now.time - touched > seconds + 1e-6:
                    wrong = wrong or f"it backed off after {now.time:.1f} s, and had not bumped"
                waiting = _NEVER
            elif now.bumper and before.command[0] > 0 and waiting == _NEVER:
                waiting = now.time
            if now.time - waiting > seconds + 1e-6 and waiting != _NEVER:
                wrong = wrong or f"it bumped after {waiting:.1f} s, and did not back off"
            return waiting, touched, wrong

        _, _, wrong = run.fold(step, (_NEVER, _NEVER, ""), ("backs off at bumps", seconds))
        return Found(not wrong, wrong or "it did so each time")

    return Criterion(f"backs off within {seconds:g} s of each bump, and only then", judge, "always")


def turns_at_bumps(degrees: float) -> Criterion:
    """Require that the robot turns by at least this much after each bump, before it drives forward again."""

    def judge(run: RunRecord) -> Found:
        def step(
            so_far: tuple[float | None, float, str], now: Sample, before: Sample
        ) -> tuple[float | None, float, str]:
            """Keep when it bumped, if it has not driven on, its heading then, and what is wrong."""
            bumped, heading, wrong = so_far
            if now.bumper and before.command[0] > 0 and bumped is None:
                return now.time, now.heading, wrong
            if bumped is not None and before.command[0] <= 0 < now.command[0]:
                turned = abs(math.degrees(now.heading - heading))
                if turned < degrees:
                    wrong = (
                        wrong or f"it bumped after {bumped:.1f} s, and drove on after turning {turned:.0f}°"
                    )
                bumped = None
            return bumped, heading, wrong

        nothing: tuple[float | None, float, str] = (None, 0.0, "")
        _, _, wrong = run.fold(step, nothing, ("turns at bumps", degrees))
        return Found(not wrong, wrong or "it did so each time")

    sentence = f"turns by at least {degrees:g}° after each bump, and then drives on"
    return Criterion(sentence, judge, "always")


_NEVER = -1e9  # s


def stops_at(solid: str, seconds: float) -> Criterion:
    """Require that the robot stops within this time after it has touched a solid, and stays there."""

    def judge(run: RunRecord) -> Found:
        _check(run, (solid,))

        def step(
            so_far: tuple[Sample | None, float, float], now: Sample, _: Sample
        ) -> tuple[Sample | None, float, float]:
            touched, drove, away = so_far
            touched = now if touched is None and solid in now.touched else touched
            drove = now.time if any(now.command) else drove
            return touched, drove, away if touched is None else max(away, now.distance(touched))

        nothing: tuple[Sample | None, float, float] = (None, 0.0, 0.0)
        touched, drove, away = run.fold(step, nothing, ("stops at", solid))
        if touched is None:
            return Found(1, f"it has not touched the {solid}")
        took = max(0.0, drove - touched.time)
        if took > seconds + 1e-6:
            return Found(0, f"it was still driving {took:.1f} s after touching the {solid}")
        if away > _AWAY:
            return Found(0, f"it drove {away * 100:.0f} cm away after touching the {solid}")
        return Found(1, f"it stopped {took:.1f} s after touching the {solid}")

    return Criterion(f"stops within {seconds:g} s of touching the {solid}", judge, "always")


def keeps_distance(solid: str, least: float, most: float) -> Criterion:
    """Require that the gap between the robot and a solid is never narrower or wider than this, in metres."""

    def judge(run: RunRecord) -> Found:
        _check(run, (solid,))

        def extremes(so_far: _Gaps, now: Sample, _: Sample) -> _Gaps:
            gap = gap_to(run, solid, now)
            nearest, furthest = so_far
            return min(nearest, (gap, now.time)), max(furthest, (gap, now.time))

        nearest, furthest = run.fold(extremes, ((math.inf, 0.0), (-math.inf, 0.0)), ("keeps distance", solid))
        for worst, is_wrong in ((nearest, nearest[0] < least), (furthest, furthest[0] > most)):
            if is_wrong:
                return Found(0, f"it was {worst[0] * 100:.0f} cm away after {worst[1]:.1f} s")
        return Found(1, f"it was {nearest[0] * 100:.0f} to {furthest[0] * 100:.0f} cm away")

    sentence = f"stays {least * 100:g} to {most * 100:g} cm away from the {solid}"
    return Criterion(sentence, judge, "always")


def gap_to(run: RunRecord, solid: str, sample: Sample) -> float:
    """Return the gap between the robot's rim and a named solid, in metres."""
    index = next(index for index, each in enumerate(run.world.solids) if each.name == solid)
    shape, (x, y, angle) = run.world.solids[index], sample.solids[index]
    cos, sin = math.cos(angle), math.sin(angle)
    ahead, left = sample.x - x, sample.y - y
    ahead, left = abs(cos * ahead + sin * left), abs(cos * left - sin * ahead)
    if isinstance(shape, BoxSolid):
        half_length, half_width = shape.box[2] / 2, shape.box[3] / 2
        gap = math.hypot(max(0.0, ahead - half_length), max(0.0, left - half_width))
    else:
        gap = math.hypot(ahead, left) - shape.circle[2]
    return gap - run.world.robots[0].radius


_Gaps = tuple[tuple[float, float], tuple[float, float]]  # the narrowest and the widest, each with its time


def _touches(solid: str, now: Sample) -> bool:
    return solid in now.touched


def _check(run: RunRecord, solids: Sequence[str]) -> None:
    """Raise an LRPError if nothing in the world has one of these names."""
    known = {solid.name or f"solid {index}" for index, solid in enumerate(run.world.solids)}
    for solid in solids:
        if solid not in known | {"edge", "robot"}:
            raise no_solid(run.world, solid, known)
