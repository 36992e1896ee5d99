"""Worlds of several exercises."""

from __future__ import annotations

from lrp_jupyter.sim.world import BoxSolid, BoxZone, Pose, RobotSpec, World

THICK = 0.06  # m, of walls
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
