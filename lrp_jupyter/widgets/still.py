"""Still pictures of a lab: what a saved notebook shows where no kernel runs."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import LRPError
from lrp_jupyter.graph.still import draw
from lrp_jupyter.sim.svg import svg as world_svg

if TYPE_CHECKING:
    from lrp_jupyter.widgets.connection import Connection

__all__ = ["pictures"]

_WIDTH = 480
_SIZE = re.compile(r'viewBox="0 0 ([\d.]+) ([\d.]+)"')


def pictures(connection: Connection) -> dict[str, str]:
    """Draw the graph and the world as they are now; as plain text the program."""
    look = connection.look()
    fired = look["fired"]
    last: dict[str, tuple[int, str]] = {}
    for name, seen in fired.items():
        machine = name.partition(":")[0]
        last[machine] = max(last.get(machine, (0, "")), (seen["tick"], name))
    active = [tuple(path.split("/")) for path in look["lit"]]
    graph = draw(list(look["layouts"].values()), active, [name for _, name in last.values()])
    return {"image/svg+xml": _stacked(graph, _world(connection)), "text/plain": connection.texts.text}


def _world(connection: Connection) -> str:
    bridge = connection.session.bridge
    if not isinstance(bridge, SimBridge):
        return ""
    try:
        now: str = connection.session.call(lambda: world_svg(bridge.simulation, _WIDTH))
        return now
    except LRPError:  # the loop is held up or has ended: the world as it began
        return world_svg(bridge.world, _WIDTH)


def _stacked(upper: str, lower: str) -> str:
    """Put one picture above the other."""
    sizes = [_SIZE.search(picture) for picture in (upper, lower)]
    if not upper or not lower or not all(sizes):
        return upper or lower
    (width, height), (wide, high) = ((float(size[1]), float(size[2])) for size in sizes if size)
    whole, tall = max(width, wide), height + high + 12
    place = f'<svg y="{height + 12:g}" height="{high:g}" '
    size = f'viewBox="0 0 {whole:g} {tall:g}" width="{whole:g}"'
    lower = lower.replace("<svg ", place, 1)
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="group">{upper}{lower}</svg>'
