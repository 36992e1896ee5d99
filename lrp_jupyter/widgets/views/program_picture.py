"""Pictures of a program and its world as they are now: what a saved notebook shows where no kernel runs."""

from __future__ import annotations

import re
from base64 import b64encode

from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import LRPError
from lrp_jupyter.graph.still import draw
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim.svg import svg as world_svg
from lrp_jupyter.widgets.views.view_state import last_fired
from lrp_jupyter.widgets.wire.protocol import ViewState

_WIDTH = 480  # px
_SIZE = re.compile(r'viewBox="0 0 ([\d.]+) ([\d.]+)"')


def still(session: Session, state: ViewState) -> str:
    """Return an SVG of the graph, as the conditions of a study allow it, and of a simulated world."""
    active = [tuple(path.split("/")) for path in state["lit"]]
    layouts = list(state["layouts"].values())
    match state["settings"]["graph"]:
        case "live":
            graph = draw(layouts, active, last_fired(state), state["users"])
        case "static":
            graph = draw(layouts)
        case "hidden":
            graph = ""
    return _stacked(graph, _world(session))


def bitmap(picture: str) -> dict[str, str]:
    """Return a picture as PNG, for readers that show no SVG; nothing without the extra ``png``."""
    try:
        from resvg_py import svg_to_bytes
    except ImportError:
        return {}
    return {"image/png": b64encode(svg_to_bytes(svg_string=picture, zoom=2)).decode()}


def _world(session: Session) -> str:
    bridge = session.bridge
    if not isinstance(bridge, SimBridge):
        return ""
    try:
        return session.call(lambda: world_svg(bridge.simulation, _WIDTH))
    except LRPError:  # the loop is blocked or has ended: the world as it began
        return world_svg(bridge.world, _WIDTH)


def _stacked(upper: str, lower: str) -> str:
    sizes = [_SIZE.search(picture) for picture in (upper, lower)]
    if not upper or not lower or not all(sizes):
        return upper or lower
    (width, height), (wide, high) = ((float(size[1]), float(size[2])) for size in sizes if size)
    whole, tall = max(width, wide), height + high + 12
    place = f'<svg y="{height + 12:g}" height="{high:g}" '
    size = f'viewBox="0 0 {whole:g} {tall:g}" width="{whole:g}"'
    lower = lower.replace("<svg ", place, 1)
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="group">{upper}{lower}</svg>'
