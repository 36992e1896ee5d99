"""The message types that are known on this computer, without a robot, for the checks of a program."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from lrp_jupyter.bridges.ros.channel import Channel
from lrp_jupyter.bridges.ros.definitions import KNOWN, Definition, FieldType, messages_of
from lrp_jupyter.bridges.ros.rclpy import RclpyTransport
from lrp_jupyter.bridges.ros.rospy import RospyTransport
from lrp_jupyter.bridges.ros.types import Types
from lrp_jupyter.errors import BridgeError

_NUMBER = FieldType("uint32")
_EITHER: Mapping[str, Definition] = {
    "std_msgs/Header": Definition(
        "std_msgs/Header",
        {"seq": _NUMBER, "stamp": FieldType("builtin_interfaces/Time"), "frame_id": FieldType("string")},
    ),
    "builtin_interfaces/Time": Definition(
        "builtin_interfaces/Time", dict.fromkeys(("sec", "nanosec", "secs", "nsecs"), _NUMBER)
    ),
}
"""A header with what it has in ROS 1 or in ROS 2, where it is not known which one a robot has."""


class TypesHere:
    """The types that a back end knows without a connection; `folders` are those with definitions, for dds.

    Of the others, and of rosbridge, what is the same in ROS 1 and ROS 2.
    """

    def __init__(self, backend: str, folders: Iterable[str]) -> None:
        self._types = Types()
        self._define = _source(backend, folders)

    def describe(self, channel: Channel) -> None:
        """Let a channel know its type, if that is known here."""
        wire = channel.wire
        messages = messages_of(wire.direction, wire.type) if wire.type else ()
        for message in messages:
            self._types.add(self._define(message))
        if messages and all(map(self._types.knows, messages)):
            channel.learn(self._types, messages)


def _source(backend: str, folders: Iterable[str]) -> Callable[[str], Mapping[str, Definition]]:
    """Return what defines a type and those in it; empty if the type is not known."""
    define: Callable[[str], Mapping[str, Definition]]
    try:
        if backend == "rospy":
            define = RospyTransport().define
        elif backend == "rclpy":
            define = RclpyTransport().define
        elif backend == "dds":
            from lrp_jupyter.bridges.ros.dds_types import MessageTypes

            define = MessageTypes(folders).define
        else:
            return lambda _: _EITHER
    except (BridgeError, ImportError):
        return lambda _: _EITHER

    def defined(type_: str) -> Mapping[str, Definition]:
        try:
            return define(type_) or _unknown(type_)
        except (BridgeError, ImportError):
            return _unknown(type_)

    return defined


def _unknown(type_: str) -> Mapping[str, Definition]:
    return _EITHER if type_ in KNOWN else {}
