"""Criteria that only exercises have."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Literal

from lrp_jupyter.grading.criteria import Criterion, Found
from lrp_jupyter.grading.criteria.order import longest
from lrp_jupyter.grading.criteria.places import zone_of
from lrp_jupyter.grading.run_record import RunRecord, Sample, angle_between


def turns_to(side: Literal["left", "right"], degrees: float, after: str = "") -> Criterion:
    """Require that the robot turns this far to one side: in all, or after it has touched a solid."""

    def judge(run: RunRecord) -> Found:
        def step(so_far: tuple[bool, float], now: Sample, before: Sample) -> tuple[bool, float]:
            counts, turned = so_far
            angle = math.degrees(angle_between(before, now)) * (1 if side == "left" else -1)
            turned += max(0.0, angle) if counts and before.command[1] else 0.0
            return counts or after in now.touched, turned

        _, turned = run.fold(step, (not after, 0.0), ("turns to", side, after))
        return Found(turned / degrees, f"it turned {turned:.0f}° to the {side}")

    there = f" after touching the {after}" if after else ""
    return Criterion(f"turns at least {degrees:g}° to the {side}{there}", judge, "once")


def rests_in(zone: str, seconds: float) -> Criterion:
    """Require that the robot stands still in a zone for this time, and may then go on."""

    def judge(run: RunRecord) -> Found:
        region = zone_of(run.world, zone)
        stood = longest(
            run,
            lambda now, before: not now.moved(before) and region.contains(now.x, now.y),
            ("rests in", zone),
        )
        return Found((stood + 0.15) / seconds, f"it stood there for {stood:.1f} s")

    return Criterion(f"stands still in `{zone}` for {seconds:g} s", judge, "once")


def hardly_moves(metres: float, seconds: float) -> Criterion:
    """Require that the robot drives less than this in the last seconds, in both directions together."""

    def judge(run: RunRecord) -> Found:
        last = [sample for sample in run.samples[-1000:] if sample.time > run.seconds - seconds - 1e-6]
        way = sum(now.distance(before) for before, now in pairwise(last))
        share = 1 if run.seconds >= seconds and way < metres else 0
        return Found(share, f"it drove {way * 100:.0f} cm in the last {seconds:g} s")

    return Criterion(f"drives less than {metres * 100:g} cm in the last {seconds:g} s", judge)
