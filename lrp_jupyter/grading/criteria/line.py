"""Criteria about the line on the floor."""

from __future__ import annotations

from lrp_jupyter.grading.criteria.criterion import Criterion, Found
from lrp_jupyter.grading.run_record import RunRecord, Sample
from lrp_jupyter.sim.floor import distance_to

BLACK = 128  # a light reading below is the line, above is the floor


def sees_line(sample: Sample, sensor: int = 0) -> bool:
    """Return whether a light sensor sees black."""
    return sensor < len(sample.lights) and sample.lights[sensor] < BLACK


def finds_line(sensor: int = 0) -> Criterion:
    """Require that a light sensor sees the line."""

    def judge(run: RunRecord) -> Found:
        seen = run.first(lambda sample: sees_line(sample, sensor), ("finds the line", sensor))
        return Found(bool(seen), f"it saw it after {seen.time:.1f} s" if seen else "it never saw it")

    return Criterion("finds the line", judge, "once")


def on_line(share: float, sensor: int = 0) -> Criterion:
    """Require that a light sensor sees the line for at least this share of the time (0 … 1)."""

    def judge(run: RunRecord) -> Found:
        seen = run.fold(lambda so_far, now, _: so_far + sees_line(now, sensor), 0, ("on the line", sensor))
        part = seen / max(1, len(run.samples))
        return Found(part / share, f"it saw the line {part:.0%} of the time")

    return Criterion(f"sees the line at least {share:.0%} of the time", judge)


def near_line(metres: float) -> Criterion:
    """Require that the middle of the robot is never further than this from the line."""

    def judge(run: RunRecord) -> Found:
        def furthest(so_far: tuple[float, float], now: Sample, _: Sample) -> tuple[float, float]:
            return max(so_far, (distance_to(run.world.floor, now.x, now.y), now.time))

        distance, when = run.fold(furthest, (0.0, 0.0), "furthest from the line")
        if distance <= metres:
            return Found(1, f"it was at most {distance * 100:.0f} cm away")
        return Found(0, f"it was {distance * 100:.0f} cm away after {when:.1f} s")

    return Criterion(f"is never further than {metres * 100:g} cm from the line", judge, "always")


def ends_near_line(metres: float) -> Criterion:
    """Require that the middle of the robot is at most this far from the line at the end."""

    def judge(run: RunRecord) -> Found:
        last = run.samples[-1]
        distance = distance_to(run.world.floor, last.x, last.y)
        return Found(distance <= metres, f"it is {distance * 100:.0f} cm away from the line")

    return Criterion(f"ends at most {metres * 100:g} cm from the line", judge)
