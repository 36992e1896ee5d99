"""550, 551: blocks that act on the world by themselves, past `robot`.

Nothing records, limits or stops what they do, and it happens again whenever the block is repeated to answer
why or what if.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator, Mapping
from functools import lru_cache
from types import BuiltinFunctionType, FunctionType, MethodType, ModuleType
from typing import Any

from lrp_jupyter.language.checks.report import Reporter
from lrp_jupyter.language.checks.scanned import ScannedBlock, scanned, whole_name
from lrp_jupyter.language.program import Span
from lrp_jupyter.language.resolution import Resolution

_ROS = (
    *("rospy", "rclpy", "roslibpy", "actionlib", "cyclonedds", "dynamic_reconfigure", "smach_ros"),
    *("tf2_ros", "rosservice", "rostopic", "moveit_commander", "nav2_simple_commander"),
)
"""The client libraries of ROS."""
_OF_DEVICES = (
    *("ev3dev", "ev3dev2", "pybricks", "RPi", "gpiozero", "pigpio", "smbus", "smbus2"),
    *("serial", "bluetooth", "bleak", "paho", "socket", "websocket", "websockets", "zmq"),
)
_ACTING = (
    *(*_ROS, *_OF_DEVICES),
    *("requests", "httpx", "aiohttp", "http.client", "urllib.request"),
    *("subprocess", "os.system", "os.popen"),
)
"""Modules and functions whose purpose is to act on a robot, another computer or another program."""
_WITH_OBJECTS = frozenset({*_ROS, *_OF_DEVICES})
"""Those whose objects act when they are called; what others return are mostly data."""
_SIGNS = tuple({name.partition(".")[0] for name in _ACTING})

_MESSAGES = {
    "LRP550": (
        "`{}` bypasses `robot`: nothing records, limits or stops what it does, and a replay or `what_if` "
        "does it again. Do it in your own bridge."
    ),
    "LRP551": (
        "`{}` reaches the robot past `robot`: no pause, stop or limit holds for it, and a replay, `lrp why`, "
        "a fork or `what_if` does it once more, on the live robot. Connect the topic, service or action to "
        "`robot`, and use that."
    ),
}


def check_acting(report: Reporter, names: Resolution) -> None:
    """Report the first place of each block where it acts past `robot`."""
    objects = _acting_objects(report.names)
    for place in names.all_blocks:
        for span, acting, outside in _acts(place.block.text, objects):
            if not outside or (outside in report.names and outside not in place.visible):
                code = "LRP551" if acting in _ROS else "LRP550"
                report.add(code, place.block.at(span), _MESSAGES[code].format(acting))
                break


def _acting_objects(names: Collection[str]) -> tuple[tuple[str, str], ...]:
    """Return the names of a namespace that stand for something that acts, each with what it is of."""
    values = list(names.items()) if isinstance(names, Mapping) else []
    found = [(name, _acting(origin)) for name, value in values if (origin := _origin(value))]
    return tuple([(name, acting) for name, acting in found if acting])


def _origin(value: Any) -> str:
    """Return the module of a value, with the function's name; found without running code of the value."""
    kind = type(value)
    if kind is ModuleType:
        return str(vars(value).get("__name__", ""))
    if kind is FunctionType:
        return f"{value.__module__}.{value.__name__}"
    if kind in (MethodType, BuiltinFunctionType):  # the latter may belong to a module
        return _origin(value.__self__)
    module = vars(value if issubclass(kind, type) else kind).get("__module__", "")
    return module if type(module) is str and _acting(module) in _WITH_OBJECTS else ""


@lru_cache(maxsize=5_000)
def _acting(name: str) -> str:
    """Return what acts that a whole name belongs to; empty if that does not act."""
    return next((acting for acting in _ACTING if f"{name}.".startswith(f"{acting}.")), "")


@lru_cache(maxsize=20_000)
def _acts(text: str, objects: tuple[tuple[str, str], ...]) -> tuple[tuple[Span, str, str], ...]:
    """Return where a block acts, by which module or function, and the outside name on which that depends."""
    known = dict(objects)
    block = scanned(text, (*_SIGNS, *known))
    if block is None:
        return ()
    found = []
    for node, whole, outside in _places(block):
        acting = known.get(outside) or _acting(whole)
        if acting and outside not in block.stored:
            found.append((block.span(node), acting, outside))
    return tuple(sorted(found))


def _places(block: ScannedBlock) -> Iterator[tuple[ast.expr | ast.alias, str, str]]:
    for node in block.nodes:
        if isinstance(node, ast.Import | ast.ImportFrom):
            for alias in node.names:
                yield alias, whole_name(node, alias), ""
        elif isinstance(node, ast.Call):
            yield node.func, *block.whole(node.func)
