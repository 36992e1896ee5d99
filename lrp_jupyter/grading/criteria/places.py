"""Criteria about where the robot is, and where it has brought things."""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import partial

from lrp_jupyter.errors import LRPError, did_you_mean
from lrp_jupyter.grading.criteria.criterion import Criterion, Found
from lrp_jupyter.grading.criteria.order import in_order, reason_of
from lrp_jupyter.grading.run_record import RunRecord, Sample
from lrp_jupyter.sim.floor import distance_to
from lrp_jupyter.sim.world import (
    BoxZone,
    DiscSolid,
    FloorSpec,
    PathStroke,
    Pose,
    Solid,
    World,
    Zone,
    middle_of,
)

_REST = 0.001  # m; a solid that lies still may tremble so far in one period


def zone_of(world: World, name: str) -> Zone:
    """Return a zone of a world.

    Raises LRPError: the world has no such zone; the message suggests the closest one.
    """
    if name in world.zones:
        return world.zones[name]
    hint = did_you_mean(name, world.zones)
    known = ", ".join(f"`{each}`" for each in world.zones) or "none"
    raise LRPError(f"The world `{world.name}` has no zone `{name}`.{hint} Its zones: {known}.")


def no_solid(world: World, name: str, known: Iterable[str]) -> LRPError:
    """Return the error that says that a world has no such solid, and suggests the closest one."""
    return LRPError(f"The world `{world.name}` has no solid `{name}`.{did_you_mean(name, known)}")


def gets_away(metres: float) -> Criterion:
    """Require that the robot comes this far away from where it started."""

    def judge(run: RunRecord) -> Found:
        def further(so_far: float, now: Sample, _: Sample) -> float:
            return max(so_far, now.distance(run.samples[0]))

        furthest = run.fold(further, 0.0, "furthest from the start")
        return Found(furthest / metres, f"it was at most {furthest * 100:.0f} cm away")

    return Criterion(f"gets {metres * 100:g} cm away from its start", judge, "once")


def visits(*zones: str) -> Criterion:
    """Require that the robot comes to these zones, in this order."""

    def judge(run: RunRecord) -> Found:
        regions = [zone_of(run.world, zone) for zone in zones]
        done = in_order(run, [partial(_is_in, region) for region in regions], zones)
        return Found(len(done) / len(zones), reason_of(done, [f"`{zone}`" for zone in zones], "reached"))

    return Criterion("reaches " + ", then ".join(f"`{zone}`" for zone in zones), judge, "once")


def keeps_to(metres: float, *zones: str) -> Criterion:
    """Require that the robot was never further than this from the straight ways from zone to zone."""

    def judge(run: RunRecord) -> Found:
        way = FloorSpec(strokes=(PathStroke(tuple(middle_of(zone_of(run.world, each)) for each in zones)),))

        def furthest(so_far: tuple[float, float], now: Sample, _: Sample) -> tuple[float, float]:
            return max(so_far, (distance_to(way, now.x, now.y), now.time))

        off, when = run.fold(furthest, (0.0, 0.0), ("furthest from the way", zones))
        reason = f"it was {off * 100:.0f} cm away after {when:.1f} s" if off else "it never left it"
        return Found(off <= metres, reason)

    return Criterion(f"is never further than {metres * 100:g} cm from the straight path", judge)


def covers(zone: str, share: float, cell: float = 0.3) -> Criterion:
    """Require that the robot comes to this share (0 … 1) of a zone, in cells of this width (metres)."""

    def judge(run: RunRecord) -> Found:
        region = zone_of(run.world, zone)
        if not isinstance(region, BoxZone):
            raise LRPError(f"The zone `{zone}` is not a rectangle. Only rectangles can be covered.")
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
        return Found(part / share, f"it covered {part:.0%} of it")

    return Criterion(f"covers {share:.0%} of `{zone}`", judge, "once")


def stays_in(zone: str) -> Criterion:
    """Require that the robot never leaves a zone."""

    def judge(run: RunRecord) -> Found:
        region = zone_of(run.world, zone)
        left = run.first(lambda sample: not region.contains(sample.x, sample.y), ("leaves", zone))
        return Found(left is None, "it never left" if left is None else f"it left after {left.time:.1f} s")

    return Criterion(f"stays in `{zone}`", judge, "always")


def avoids(zone: str) -> Criterion:
    """Require that the robot never comes into a zone."""

    def judge(run: RunRecord) -> Found:
        came = run.first(partial(_is_in, zone_of(run.world, zone)), ("comes into", zone))
        return Found(
            came is None, "it never entered it" if came is None else f"it entered it after {came.time:.1f} s"
        )

    return Criterion(f"never enters `{zone}`", judge, "always")


def stays_near(solid: str, metres: float) -> Criterion:
    """Require that the middle of the robot is never further than this from the nearest solid of a name."""

    def judge(run: RunRecord) -> Found:
        shapes = {index: each for index, each in enumerate(run.world.solids) if each.name == solid}
        if not shapes:
            raise no_solid(run.world, solid, (each.name for each in run.world.solids))

        def furthest(so_far: tuple[float, float], now: Sample, _: Sample) -> tuple[float, float]:
            nearest = min(
                _distance(shape, now.solids[index], now.x, now.y) for index, shape in shapes.items()
            )
            return max(so_far, (nearest, now.time))

        far, when = run.fold(furthest, (0.0, 0.0), ("furthest from", solid))
        if far <= metres:
            return Found(1, f"it was at most {far * 100:.0f} cm away")
        return Found(0, f"it was {far * 100:.0f} cm away after {when:.1f} s")

    return Criterion(f"is never further than {metres * 100:g} cm from the {solid}", judge, "always")


def ends_in(zone: str) -> Criterion:
    """Require that the robot is in a zone at the end."""

    def judge(run: RunRecord) -> Found:
        last = run.samples[-1]
        inside = zone_of(run.world, zone).contains(last.x, last.y)
        return Found(inside, f"it is at x = {last.x:.2f} m, y = {last.y:.2f} m")

    return Criterion(f"ends in `{zone}`", judge)


def pushes(solid: str, zone: str, seconds: float = 0.0) -> Criterion:
    """Require that a solid is in a zone at the end, and has lain still there for this time."""

    def judge(run: RunRecord) -> Found:
        names = [each.name for each in run.world.solids]
        if solid not in names:
            raise no_solid(run.world, solid, names)
        index, region = names.index(solid), zone_of(run.world, zone)

        def moved(since: float, now: Sample, before: Sample) -> float:
            (x, y, _), (former_x, former_y, _) = now.solids[index], before.solids[index]
            is_still = abs(x - former_x) < _REST and abs(y - former_y) < _REST
            return since if is_still and region.contains(x, y) else now.time

        x, y, _ = run.samples[-1].solids[index]
        place = f"the {solid} is at x = {x:.2f} m, y = {y:.2f} m"
        if not region.contains(x, y):
            return Found(0, place)
        lain = run.seconds - run.fold(moved, 0.0, ("lies still", solid, zone))
        return Found(
            (lain + 1e-6) / seconds if seconds else 1, f"{place}, and has been still for {lain:.1f} s"
        )

    stay = f" and leaves it there for {seconds:g} s" if seconds else ""
    return Criterion(f"brings the {solid} into `{zone}`{stay}", judge)


def _is_in(zone: Zone, now: Sample) -> bool:
    return zone.contains(now.x, now.y)


def _distance(shape: Solid, pose: Pose, x: float, y: float) -> float:
    """Return how far a point is from a solid at a pose; 0 inside of it."""
    dx, dy = x - pose[0], y - pose[1]
    if isinstance(shape, DiscSolid):
        return max(0.0, math.hypot(dx, dy) - shape.circle[2])
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    _, _, width, height = shape.box
    along, across = abs(dx * cos + dy * sin) - width / 2, abs(dy * cos - dx * sin) - height / 2
    return math.hypot(max(0.0, along), max(0.0, across))
