"""The simulated world, told as messages: what stands still, what moves, what pens have drawn.

Everything here is read from frozen values and from lists that only grow, so it may be read on any thread;
the physics stays with the interpreter's.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.sim import SimBridge, SimPicture
from lrp_jupyter.sim.floor import Mark, Paint
from lrp_jupyter.sim.world import ArcStroke, BoxSolid, BoxZone, CircleStroke, Solid, Stroke, Zone
from lrp_jupyter.widgets import protocol
from lrp_jupyter.widgets.protocol import pack_poses

__all__ = ["poses", "strokes_of", "world_view"]


def world_view(bridge: Bridge, picture: object) -> protocol.WorldView | None:
    """Tell the world, its solids where they are now; None for a bridge without a world."""
    if not isinstance(bridge, SimBridge):
        return None
    world = bridge.world
    places = picture.solids if isinstance(picture, SimPicture) else ()
    return {
        "version": 1,
        "name": world.name,
        "open": world.open,
        "size": world.size,
        "seed": world.seed,
        "floor": {
            "grey": round(world.floor.grey),
            "strokes": [_stroke(stroke) for stroke in world.floor.strokes],
        },
        "solids": [
            _solid(solid, places[i] if i < len(places) else None) for i, solid in enumerate(world.solids)
        ],
        "robots": [
            {
                "pose": robot.pose,
                "radius": robot.radius,
                "light": list(robot.light),
                "bumper": robot.bumper,
                "distance": list(robot.distance),
            }
            for robot in world.robots
        ],
        "zones": {name: _zone(zone) for name, zone in world.zones.items()},
    }


def _stroke(stroke: Stroke) -> protocol.Stroke:
    told: protocol.Stroke = {"width": stroke.width, "grey": round(stroke.grey)}
    if isinstance(stroke, CircleStroke):
        told["circle"] = stroke.circle
    elif isinstance(stroke, ArcStroke):
        told["arc"] = list(stroke.arc)
    else:
        told["path"] = list(stroke.path)
    return told


def _solid(solid: Solid, place: tuple[float, float, float] | None) -> protocol.Solid:
    shape: tuple[float, ...] = solid.box if isinstance(solid, BoxSolid) else solid.circle
    x, y, angle = place or (*shape[:2], solid.angle)
    told: protocol.Solid = {"angle": angle, "push": solid.push}
    if isinstance(solid, BoxSolid):
        told["box"] = [x, y, *solid.box[2:]]
    else:
        told["circle"] = (x, y, solid.circle[2])
    return told


def _zone(zone: Zone) -> protocol.Zone:
    return {"box": list(zone.box)} if isinstance(zone, BoxZone) else {"circle": zone.circle}


def poses(bridge: SimBridge, picture: SimPicture) -> bytes:
    """Tell where everything is, as the buffer of a `Frame` message."""
    robots: list[Any] = []
    for robot, spec in zip(picture.robots, bridge.world.robots, strict=False):
        lights: list[float] = [*robot.lights, *[math.nan] * len(spec.light)]
        distances = [*robot.distances, *[math.inf] * len(spec.distance)]
        robots.append(
            (
                *robot.pose,
                bool(robot.bumper),
                robot.pen,
                robot.command[0],
                lights[: len(spec.light)],
                distances[: len(spec.distance)],
            )
        )
    pushed = [
        place
        for place, solid in zip(picture.solids, bridge.world.solids, strict=False)
        if solid.push is not None
    ]
    return pack_poses(picture.time, robots, pushed)


def strokes_of(marks: Sequence[Mark]) -> list[protocol.Stroke]:
    """Tell pieces of trails and drawings as strokes: those that go on from each other are one."""
    strokes: list[protocol.Stroke] = []
    before: tuple[Paint, float, float] | None = None
    for _, paint, piece in marks:
        x, y, end_x, end_y = piece.ends()
        if before and before[0] is paint and math.isclose(before[1], x) and math.isclose(before[2], y):
            strokes[-1]["path"].append((end_x, end_y))
        else:
            stroke: protocol.Stroke = {
                "path": [(x, y), (end_x, end_y)],
                "width": 2 * paint.half,
                "grey": round(paint.grey),
            }
            if paint.ink:
                stroke["ink"] = True
            strokes.append(stroke)
        before = paint, end_x, end_y
    return strokes
