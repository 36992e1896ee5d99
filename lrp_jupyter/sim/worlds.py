"""The bundled worlds, drawn by code."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Mapping
from pathlib import Path

from lrp_jupyter.sim.world import (
    ArcStroke,
    BoxSolid,
    BoxZone,
    CircleZone,
    DiscSolid,
    FloorSpec,
    PathStroke,
    Patrol,
    RobotSpec,
    World,
    WorldError,
)
from lrp_jupyter.sim.world_reading import did_you_mean, read_file, read_world

_QUARTER = math.pi / 2
_EIGHTH = math.pi / 4
_AROUND = ((0.0, 2.0), (_QUARTER, 2.0), (-_QUARTER, 2.0))  # rays ahead, to the left, to the right


def _empty() -> World:
    return World(name="empty", size=(3, 2), robots=(RobotSpec((1.5, 1, 0)),))


def _line() -> World:
    radius, straight, left, level = 0.6, 0.4, 0.4, 0.5
    rise = radius * (1 - math.cos(_EIGHTH))
    run = radius * math.sin(_EIGHTH)
    first = left + straight  # where the first arc begins
    right = first + 4 * run + straight
    top = level + 2 * rise - radius  # centre of the middle arc
    strokes = (
        PathStroke(((left, level), (first, level))),
        ArcStroke((first, level + radius, radius, -_QUARTER, -_EIGHTH)),
        ArcStroke((first + 2 * run, top, radius, 3 * _EIGHTH, _EIGHTH)),
        ArcStroke((first + 4 * run, level + radius, radius, -3 * _EIGHTH, -_QUARTER)),
        PathStroke(((right - straight, level), (right, level))),
    )
    return World(
        name="line",
        size=(right + 0.4, 1.3),
        floor=FloorSpec(strokes=strokes),
        solids=(
            BoxSolid((left - 0.03, level, 0.06, 0.3), name="near wall"),
            BoxSolid((right + 0.03, level, 0.06, 0.3), name="far wall"),
        ),
        robots=(RobotSpec((left + 0.3, level, 0)),),
        zones={"near": CircleZone((left, level, 0.25)), "far": CircleZone((right, level, 0.25))},
    )


def _oval() -> World:
    radius, left, right, middle = 0.5, 1.0, 2.0, 0.9
    strokes = (
        PathStroke(((left, middle - radius), (right, middle - radius))),
        ArcStroke((right, middle, radius, -_QUARTER, _QUARTER)),
        PathStroke(((right, middle + radius), (left, middle + radius))),
        ArcStroke((left, middle, radius, _QUARTER, 3 * _QUARTER)),
    )
    robot = RobotSpec((1.3, middle - radius, 0))
    zones = {
        "right": CircleZone((right + radius, middle, 0.25)),
        "left": CircleZone((left - radius, middle, 0.25)),
    }
    return World(name="oval", size=(3, 1.8), floor=FloorSpec(strokes=strokes), robots=(robot,), zones=zones)


_MAZE = """
+--+--+--+--+--+
|     |        |
+--+  +  +--+  +
|     |  |     |
+  +--+  +  +--+
|        |     |
+  +--+--+--+  +
|  |           |
+--+--+--+--+--+
"""


def _maze() -> World:
    return drawn_maze("maze", _MAZE)


def drawn_maze(name: str, drawing: str) -> World:
    """Build a wall for every stroke of a drawing; the way leads from its first cell to its last one."""
    cell, thick = 0.5, 0.04
    rows = drawing.strip().splitlines()
    width, height = (len(rows[0]) // 3) * cell, (len(rows) // 2) * cell
    solids = []
    for row, text in enumerate(rows[1:-1], start=1):  # the frame is the world's own edge
        y = height - row * cell / 2
        for column in range(0, len(text), 3):
            if row % 2 and 0 < column < len(text) - 1 and text[column] == "|":
                solids.append(BoxSolid((column / 3 * cell, y, thick, cell + thick)))
        if row % 2 == 0:
            for run in re.finditer(r"--(?:[+]--)*", text):
                first, last = (run.start() - 1) / 3, run.end() / 3
                solids.append(BoxSolid(((first + last) / 2 * cell, y, (last - first) * cell + thick, thick)))
    robot = RobotSpec((cell / 2, height - cell / 2, 0), distance=_AROUND)
    zones = {"goal": CircleZone((width - cell / 2, cell / 2, 0.2))}
    return World(name=name, size=(width, height), solids=tuple(solids), robots=(robot,), zones=zones)


def _arena() -> World:
    width, height, margin = 2.4, 1.8, 0.3
    left, bottom, right, top = margin, margin, width - margin, height - margin
    border = ((left, bottom), (right, bottom), (right, top), (left, top), (left, bottom))
    floor = FloorSpec(strokes=(PathStroke(border, width=0.05),))
    inside = BoxZone((width / 2, height / 2, width - 2 * margin, height - 2 * margin))
    robot = RobotSpec((width / 2, height / 2, 0.4))
    return World(name="arena", size=(width, height), floor=floor, robots=(robot,), zones={"inside": inside})


def _boxes() -> World:
    solids = (
        BoxSolid((1.2, 1, 0.2, 0.2), push=0.3, name="box"),
        BoxSolid((0.9, 1.6, 0.15, 0.15), angle=0.5, push=0.3, name="light box"),
        DiscSolid((1.5, 0.4, 0.1), push=0.2, name="can"),
        BoxSolid((2.6, 1.7, 0.3, 0.3), name="fixed box"),
    )
    zones = {"goal": CircleZone((2.4, 1, 0.25))}
    line = PathStroke(((2.28, 0.8), (2.28, 1.2)))  # where a robot is that has pushed a box into the goal
    floor = FloorSpec(strokes=(line,))
    robot = RobotSpec((0.5, 1, 0))
    return World(name="boxes", size=(3, 2), floor=floor, solids=solids, robots=(robot,), zones=zones)


def _walls() -> World:
    solids = (
        BoxSolid((1.6, 1, 1.2, 0.08), name="wall"),
        BoxSolid((2.16, 1.3, 0.08, 0.6), name="end of the wall"),
        DiscSolid((0.6, 1.5, 0.12), name="pillar"),
        DiscSolid((2.5, 0.5, 0.12), name="other pillar"),
    )
    robot = RobotSpec((0.5, 0.5, 0), distance=_AROUND)
    return World(name="walls", size=(3, 2), solids=solids, robots=(robot,))


def _crossing() -> World:
    level = 0.75
    solids = (
        BoxSolid((1.2, 0.2, 0.2, 0.2), name="cart", patrol=Patrol(((0, 1.1),), speed=0.2)),
        BoxSolid((2.0, 1.3, 0.2, 0.2), name="fast cart", patrol=Patrol(((0, -1.1),), speed=0.3)),
    )
    robot = RobotSpec((0.3, level, 0))
    zones = {"goal": CircleZone((2.7, level, 0.2))}
    return World(name="crossing", size=(3, 1.5), solids=solids, robots=(robot,), zones=zones)


def _convoy() -> World:
    leader = RobotSpec((1.2, 0.4, 0), name="leader")
    follower = RobotSpec((0.5, 0.4, 0), name="follower")
    return World(name="convoy", size=(4, 0.8), robots=(leader, follower))


BUNDLED: Mapping[str, Callable[[], World]] = {
    "empty": _empty,
    "line": _line,
    "oval": _oval,
    "maze": _maze,
    "arena": _arena,
    "boxes": _boxes,
    "walls": _walls,
    "crossing": _crossing,
    "convoy": _convoy,
}

DESCRIPTIONS: Mapping[str, str] = {
    "empty": "An empty room.",
    "line": "An S-shaped line between two walls: the paper's scenario.",
    "oval": "A closed line: two straights of 1 m and two half circles.",
    "maze": "A maze of cells of 0.5 m; the goal is in the corner across.",
    "arena": "A field with a black border line that a robot should not cross.",
    "boxes": "Boxes that can be pushed, and a goal to push one into.",
    "walls": "A room with a wall in it and two pillars: something to follow and something to avoid.",
    "crossing": "Two carts that cross the way to the goal, to and fro.",
    "convoy": "A lane with two robots; the second one is `robot.follower`.",
}


def load(world: str | os.PathLike[str] | Mapping[str, object] | World) -> World:
    """Return a world by name, from a JSON file, from plain data, or as it is.

    Parameters
    ----------
    world : str, path, mapping or World
        A text that ends in ``.json`` or contains a slash is a file, any other a bundled world's name.

    Raises
    ------
    WorldError
        There is no such world, or it has a mistake; the message names the place.
    """
    if isinstance(world, World):
        return world
    if isinstance(world, Mapping):
        return read_world(world)
    if isinstance(world, str) and world in BUNDLED:
        return BUNDLED[world]()
    if not isinstance(world, str | os.PathLike):
        raise WorldError(f"A world is a name, a file, a dict or a World, not {type(world).__name__}.")
    path = Path(world)
    if isinstance(world, os.PathLike) or path.suffix == ".json" or len(path.parts) > 1:
        return read_file(path)
    raise WorldError(
        f"There is no world `{world}`.{did_you_mean(world, BUNDLED)} "
        f"Choose one of {', '.join(f'`{name}`' for name in BUNDLED)}, or a file whose name ends with `.json`."
    )
