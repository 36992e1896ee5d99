"""Criteria about where the robot looks."""

from __future__ import annotations

import math

from lrp_jupyter.grading.criteria.criterion import Criterion, Found
from lrp_jupyter.grading.criteria.places import zone_of
from lrp_jupyter.grading.run_record import RunRecord, Sample


def looks(zone: str, degrees: float) -> Criterion:
    """Require that the robot turns this far to both sides of the direction in which it came into a zone.

    It counts until the robot leaves the zone again.
    """

    def judge(run: RunRecord) -> Found:
        region = zone_of(run.world, zone)

        def step(
            so_far: tuple[float, float, float, bool] | None, now: Sample, _: Sample
        ) -> tuple[float, float, float, bool] | None:
            """Keep the heading on coming, the furthest ones to both sides, and whether it has left."""
            inside = region.contains(now.x, now.y)
            if so_far is None:
                return (now.heading, now.heading, now.heading, False) if inside else None
            came, right, left, is_over = so_far
            if is_over or not inside:
                return came, right, left, True
            return came, min(right, now.heading), max(left, now.heading), False

        seen = run.fold(step, None, ("looks", zone))
        if seen is None:
            return Found(0, f"it never reached `{zone}`")
        came, right, left, _ = seen
        angles = math.degrees(left - came), math.degrees(came - right)
        share = sum(min(1.0, angle / degrees) for angle in angles) / 2
        return Found(share, f"it looked {angles[0]:.0f}° to the left and {angles[1]:.0f}° to the right")

    sentence = f"looks at least {degrees:g}° to the left and to the right in `{zone}` before it goes on"
    return Criterion(sentence, judge, "once")
