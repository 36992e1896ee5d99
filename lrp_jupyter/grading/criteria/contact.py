"""Criteria about what the robot touches."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

from lrp_jupyter.grading.criteria.criterion import Criterion, Found
from lrp_jupyter.grading.criteria.motion import times_of
from lrp_jupyter.grading.criteria.order import in_order, longest, reason_of
from lrp_jupyter.grading.criteria.places import no_solid
from lrp_jupyter.grading.run_record import RunRecord, Sample
from lrp_jupyter.live.running.frame import is_active
from lrp_jupyter.sim.world import BoxSolid

_APART = 0.5  # s; contacts that are closer are one bump


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
            if not now.bumper:
                return so_far
            return so_far | {state for state in states if is_active(state, before.active)}

        nothing: frozenset[str] = frozenset()
        found = run.fold(collect, nothing, ("bumps in", states))
        missing = [f"`{state}`" for state in states if state not in found]
        reason = f"it never bumped in {' or '.join(missing)}" if missing else "it bumped in each of them"
        return Found(len(found) / len(states), reason)

    return Criterion("bumps in " + ", ".join(f"`{state}`" for state in states), judge, "once")


def never_pushes(seconds: float) -> Criterion:
    """Require that the robot never drives against anything for longer than this time."""

    def judge(run: RunRecord) -> Found:
        pushed = longest(run, lambda now, _: now.touched and now.command[0] > 0, "pushes for")
        reason = f"it pushed for {pushed:.1f} s" if pushed else "it never pushed"
        return Found(pushed <= seconds + 1e-6, reason)

    return Criterion(f"never pushes for longer than {seconds:g} s", judge, "always")


def stops_at(solid: str, seconds: float) -> Criterion:
    """Require that the robot stops within this time after it has touched a solid, and does not go on."""

    def judge(run: RunRecord) -> Found:
        _check(run, (solid,))

        def step(so_far: tuple[float | None, float], now: Sample, _: Sample) -> tuple[float | None, float]:
            touched, drove = so_far
            touched = now.time if touched is None and solid in now.touched else touched
            return touched, now.time if any(now.command) else drove

        nothing: tuple[float | None, float] = (None, 0.0)
        touched, drove = run.fold(step, nothing, ("stops at", solid))
        if touched is None:
            return Found(1, f"it has not touched the {solid}")
        if drove - touched > seconds + 1e-6:
            return Found(0, f"it was still driving {drove - touched:.1f} s after touching the {solid}")
        return Found(1, f"it stopped {max(0.0, drove - touched):.1f} s after touching the {solid}")

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
