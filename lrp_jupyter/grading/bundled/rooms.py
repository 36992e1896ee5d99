"""Rooms between four walls, of several challenges."""

from __future__ import annotations

from lrp_jupyter.sim.world import BoxSolid, Pose, RobotSpec, World

THICK = 0.06  # m, of walls


def room(name: str, width: float, height: float, pose: Pose) -> World:
    """Return a room between four walls that have names."""
    walls = {
        "west wall": (THICK / 2, height / 2, THICK, height),
        "east wall": (width - THICK / 2, height / 2, THICK, height),
        "south wall": (width / 2, THICK / 2, width, THICK),
        "north wall": (width / 2, height - THICK / 2, width, THICK),
    }
    solids = tuple(BoxSolid(box, name=wall) for wall, box in walls.items())
    return World(name=name, size=(width, height), solids=solids, robots=(RobotSpec(pose),))


ROOMS = (
    room("room", 1.8, 1.4, (0.6, 0.7, 0)),
    room("wide room", 2.4, 1.4, (1.2, 0.6, 0.5)),
    room("narrow room", 1.2, 1.6, (0.5, 0.8, 2)),
)
