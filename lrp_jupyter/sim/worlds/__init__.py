"""The bundled worlds, drawn by code."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from pathlib import Path

from lrp_jupyter.sim.reading import did_you_mean, read_file, read_world
from lrp_jupyter.sim.world import (
    ArcStroke,
    Box,
    Floor,
    PathStroke,
    RobotSpec,
    World,
    WorldError,
)

__all__ = ["BUNDLED", "load"]

_QUARTER = math.pi / 2
_EIGHTH = math.pi / 4


def _empty() -> World:
    """Draw an empty room."""
    return World(name="empty", size=(3, 2), robots=(RobotSpec((1.5, 1, 0)),))


def _line() -> World:
    """Draw an S course between two walls: the paper's scenario."""
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
        floor=Floor(strokes=strokes),
        solids=(
            Box((left - 0.03, level, 0.06, 0.3), name="near wall"),
            Box((right + 0.03, level, 0.06, 0.3), name="far wall"),
        ),
        robots=(RobotSpec((left + 0.3, level, 0)),),
    )


BUNDLED: Mapping[str, Callable[[], World]] = {
    "empty": _empty,
    "line": _line,
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
        There is no such world, or it has a mistake; the message says where.
    """
    if isinstance(world, World):
        return world
    if isinstance(world, Mapping):
        return read_world(world)
    if isinstance(world, str) and world in BUNDLED:
        return BUNDLED[world]()
    if not isinstance(world, str | os.PathLike):
        raise WorldError(f"a world is a name, a file, a dict or a World, not {type(world).__name__}")
    path = Path(world)
    if isinstance(world, os.PathLike) or path.suffix == ".json" or len(path.parts) > 1:
        return read_file(path)
    raise WorldError(
        f"no world {world!r}: choose {', '.join(BUNDLED)} or a .json file{did_you_mean(world, BUNDLED)}"
    )
