"""Worlds of several exercises."""

from __future__ import annotations

import math

from lrp_jupyter.grading.bundled.rooms import THICK
from lrp_jupyter.sim.world import (
    BoxSolid,
    BoxZone,
    CircleZone,
    FloorSpec,
    PathStroke,
    RobotSpec,
    World,
)

RADIUS = 0.08  # m, of the robot


def hall(ahead: float, behind: float = 0.5, distance: float = 0.3) -> World:
    """Return a hall with a wall ahead of the robot and one behind it, so far from its rim, in metres.

    `distance`: from the wall ahead to the rim of a robot in the middle of the zone `before the wall`.
    """
    x, y = THICK + behind + RADIUS, 0.8
    width = x + RADIUS + ahead + THICK
    return World(
        name=f"wall after {ahead:g} m",
        size=(width, 2 * y),
        solids=(
            BoxSolid((THICK / 2, y, THICK, 2 * y), name="wall behind"),
            BoxSolid((width - THICK / 2, y, THICK, 2 * y), name="wall ahead"),
        ),
        robots=(RobotSpec((x, y, 0)),),
        zones={"before the wall": BoxZone((width - THICK - RADIUS - distance, y, 0.2, 2 * y))},
    )


HALLS = tuple(map(hall, (0.6, 1.0, 1.5)))


def polygon(corners: int, side: float, radius: float) -> World:
    """Return a world with zones at the corners of a polygon to the left of the robot, `home` last."""
    x, y = 0.9, 0.5
    zones = {}
    for number in range(1, corners + 1):
        angle = (number - 1) * 2 * math.pi / corners
        x, y = x + side * math.cos(angle), y + side * math.sin(angle)
        zones["home" if number == corners else f"corner {number}"] = CircleZone((x, y, radius))
    return World(name=f"{corners} corners", size=(2.4, 1.8), robots=(RobotSpec((0.9, 0.5, 0)),), zones=zones)


def across(*lines: tuple[float, float], grey: float = 0) -> FloorSpec:
    """Return a floor with lines across the way of a robot that starts at (0.4, 1): x and width, in metres."""
    return FloorSpec(strokes=tuple(PathStroke(((x, 0.5), (x, 1.5)), width, grey) for x, width in lines))


def lane(name: str, floor: FloorSpec, stop: float, width: float, length: float = 3.2) -> World:
    """Return a lane with lines across it, and a zone in which the light sensor is at x = `stop`.

    `width`: of the zone, in metres.
    """
    sensor = RobotSpec((0, 0, 0)).light[0][0]
    wall = BoxSolid((length - THICK / 2, 1, THICK, 2), name="wall")
    return World(
        name=name,
        size=(length, 2),
        floor=floor,
        solids=(wall,),
        robots=(RobotSpec((0.4, 1, 0)),),
        zones={"stop": BoxZone((stop - sensor, 1, width, 1))},
    )


def course(name: str, *pieces: tuple[float, float], gap: int = 0, inverse: bool = False) -> World:
    """Return a world with a line from the robot to the zone `end`, and a wall behind that.

    Parameters
    ----------
    name : str
    pieces : tuples
        Length of a piece of the line in metres, and by how many degrees it bends to the left.
    gap : int
        Number of a piece that is not drawn; 0: none.
    inverse : bool
        Whether the line is white and the floor black.
    """
    x, y, heading, step = 0.0, 0.0, 0.0, 0.02
    paths: list[list[tuple[float, float]]] = [[(-0.1, 0.0), (0.0, 0.0)]]
    for number, (length, bend) in enumerate(pieces, 1):
        steps = round(length / step)
        if number == gap:
            paths.append([])
        for _ in range(steps):
            heading += math.radians(bend) / steps
            x, y = x + step * math.cos(heading), y + step * math.sin(heading)
            if number != gap:
                paths[-1].append((x, y))
    points = [point for path in paths for point in path]
    left, bottom = (min(point[axis] for point in points) - 0.4 for axis in (0, 1))
    width, height = (max(point[axis] for point in points) + 0.4 for axis in (0, 1))
    strokes = tuple(
        PathStroke(tuple((a - left, b - bottom) for a, b in path), grey=255 if inverse else 0)
        for path in paths
    )
    end = x - left, y - bottom
    beyond = 0.11 + THICK / 2  # so that the sensor sees the line where the bumper meets the wall
    at = (end[0] + (beyond - 0.09) * math.cos(heading), end[1] + (beyond - 0.09) * math.sin(heading))
    return World(
        name=name,
        size=(width - left, height - bottom),
        floor=FloorSpec(0 if inverse else 255, strokes),
        solids=(BoxSolid((*at, THICK, 0.4), heading, name="wall"),),
        robots=(RobotSpec((0.05 - left, -bottom, 0)),),
        zones={"end": CircleZone((*end, 0.2))},
    )
