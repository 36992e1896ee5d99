"""A world as it is seen in a mirror."""

from __future__ import annotations

import math
from dataclasses import replace

from lrp_jupyter.sim.world import (
    ArcStroke,
    CircleStroke,
    PathStroke,
    Point,
    Solid,
    Stroke,
    World,
    middle_of,
    put_at,
)


def mirrored(world: World, name: str, *, x: bool = False, y: bool = False) -> World:
    """Return a world, seen in a mirror that swaps the ends of one axis, or of both."""
    width, height = world.size
    across, up = (-1 if x else 1), (-1 if y else 1)

    def there(at: Point) -> Point:
        return (width - at[0] if x else at[0], height - at[1] if y else at[1])

    def turned(angle: float) -> float:
        return math.atan2(math.sin(angle) * up, math.cos(angle) * across)

    def drawn(stroke: Stroke) -> Stroke:
        match stroke:
            case PathStroke(path=path):
                return replace(stroke, path=tuple(map(there, path)))
            case ArcStroke(arc=(a, b, radius, first, last)):
                begin = turned(first)
                return replace(
                    stroke, arc=(*there((a, b)), radius, begin, begin + (last - first) * across * up)
                )
            case CircleStroke(circle=(a, b, radius)):
                return replace(stroke, circle=(*there((a, b)), radius))

    def stood(solid: Solid) -> Solid:
        patrol = solid.patrol and replace(
            solid.patrol, path=tuple((a * across, b * up) for a, b in solid.patrol.path)
        )
        angle = solid.angle * across * up
        return replace(put_at(solid, there(middle_of(solid))), angle=angle, patrol=patrol)

    return replace(
        world,
        name=name,
        robots=tuple(
            replace(robot, pose=(*there(robot.pose[:2]), turned(robot.pose[2]))) for robot in world.robots
        ),
        floor=replace(world.floor, strokes=tuple(map(drawn, world.floor.strokes))),
        solids=tuple(map(stood, world.solids)),
        zones={key: put_at(zone, there(middle_of(zone))) for key, zone in world.zones.items()},
    )
