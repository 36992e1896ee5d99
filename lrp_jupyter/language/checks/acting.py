"""550: blocks that act on the world by themselves, past `robot`.

Nothing records, limits or stops what they do, and it happens again whenever the block is repeated to answer
why or what if.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import lru_cache

from lrp_jupyter.language.checks.report import Reporter
from lrp_jupyter.language.checks.scanned import ScannedBlock, scanned, whole_name
from lrp_jupyter.language.program import Span
from lrp_jupyter.language.resolution import Resolution

_ACTING = (
    *("rospy", "rclpy", "roslibpy", "actionlib", "cyclonedds"),
    *("ev3dev", "ev3dev2", "pybricks", "RPi", "gpiozero", "pigpio", "smbus", "smbus2"),
    *("serial", "bluetooth", "bleak", "paho", "socket", "websocket", "websockets", "zmq"),
    *("requests", "httpx", "aiohttp", "http.client", "urllib.request"),
    *("subprocess", "os.system", "os.popen"),
)
"""Modules and functions whose purpose is to act on a robot, another computer or another program."""
_SIGNS = tuple({name.partition(".")[0] for name in _ACTING})


def check_acting(report: Reporter, names: Resolution) -> None:
    """Report the first place of each block where it acts past `robot`."""
    for place in names.all_blocks:
        for span, what, outside in _acts(place.block.text):
            if not outside or (outside in report.names and outside not in place.visible):
                message = (
                    f"`{what}` bypasses `robot`: nothing records, limits or stops what it does, and a "
                    "replay or `what_if` does it again. Do it in your own bridge."
                )
                report.add("LRP550", place.block.at(span), message)
                break


@lru_cache(maxsize=20_000)
def _acts(text: str) -> tuple[tuple[Span, str, str], ...]:
    """Return where a block acts, by which module or function, and the outside name on which that depends."""
    block = scanned(text, _SIGNS)
    if block is None:
        return ()
    found = []
    for node, whole, outside in _places(block):
        acting = next((name for name in _ACTING if f"{whole}.".startswith(f"{name}.")), None)
        if acting is not None and outside not in block.stored:
            found.append((block.span(node), acting, outside))
    return tuple(sorted(found))


def _places(block: ScannedBlock) -> Iterator[tuple[ast.expr | ast.alias, str, str]]:
    for node in block.nodes:
        if isinstance(node, ast.Import | ast.ImportFrom):
            for alias in node.names:
                yield alias, whole_name(node, alias), ""
        elif isinstance(node, ast.Call):
            yield node.func, *block.whole(node.func)
