"""Definitions of ROS message types: the few built in, what rosapi answers, and the text of ``.msg`` files.

ROS 1 writes ``geometry_msgs/Twist``, ROS 2 ``geometry_msgs/msg/Twist``: here it is the short form
throughout.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from lrp_jupyter.errors import BridgeError

INTEGERS = {
    **{f"int{bits}": (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)},
    **{f"uint{bits}": (0, 2**bits - 1) for bits in (8, 16, 32, 64)},
    "byte": (-128, 255),  # signed in ROS 1, an octet in ROS 2
    "char": (0, 255),
}
"""Integer types with their smallest and largest number."""

FLOATS = {"float32": 3.4028235e38, "float64": float("inf")}
"""Types of real numbers with the largest one."""

STRINGS = ("string", "wstring")
PRIMITIVES = frozenset([*INTEGERS, *FLOATS, *STRINGS, "bool"])

_OTHER_NAMES = {"double": "float64", "float": "float32", "boolean": "bool", "octet": "byte"}  # of ROS 2
_SECTION = re.compile(r"^={10,}\s*\nMSG: *(\S+) *$", re.MULTILINE)
_LINE = re.compile(r"(?P<type>[^\s=#]\S*)\s+(?P<name>[A-Za-z]\w*)\s*(?P<rest>[=#].*|\s\S.*)?$")
_TIMES = {"time", "duration"}  # of ROS 1: neither primitive nor in a package
_SHAPE = re.compile(r"(?:sequence<)?\s*([\w/]+)\s*(?:<=?\d+>?)?(?:,[^>]*>|>)?\s*(\[[^\]]*\])?$")


_PARTS = {"action": ("Goal", "Feedback", "Result"), "service": ("Request", "Response")}
_PART = re.compile(rf"(.+)_({'|'.join(part for parts in _PARTS.values() for part in parts)})$")


def messages_of(direction: str, type_: str) -> tuple[str, ...]:
    """Return the message types that go over a topic, an action or a service: first what is sent there.

    Those of an action and a service are called as in ROS 2, ``nav2_msgs/NavigateToPose_Goal``, also in ROS 1.
    """
    return tuple(f"{type_}_{part}" for part in _PARTS[direction]) if direction in _PARTS else (type_,)


def part_of(type_: str) -> tuple[str, str, str]:
    """Return the type that a message type is part of, which part it is, and of what: an action or a service.

    Of the type of a message that is none, the last two are empty.
    """
    found = _PART.match(type_)
    if found is None:
        return type_, "", ""
    return found[1], found[2], next(kind for kind, parts in _PARTS.items() if found[2] in parts)


@dataclass(frozen=True, slots=True)
class FieldType:
    """The type of a field: a primitive or a message, one (`length` -1), any number (0), or that many."""

    base: str
    length: int = -1

    def __str__(self) -> str:
        return self.base if self.length < 0 else f"{self.base}[{self.length or ''}]"


@dataclass(frozen=True, slots=True)
class Definition:
    """The fields of a message type, in their order."""

    type: str
    fields: Mapping[str, FieldType]


def canonical(type_: str) -> str:
    """Return the short form of the name of a type: ``pkg/msg/Type`` is ``pkg/Type``."""
    parts = type_.strip().split("/")
    if len(parts) == 3 and parts[1] in ("msg", "srv", "action"):
        parts = [parts[0], parts[2]]
    name = "/".join(parts)
    return _OTHER_NAMES.get(name, name)


def parse_field(text: str, length: int = -1) -> FieldType:
    """Read the type of a field: ``float64[36]``, ``geometry_msgs/Point[]``, ``sequence<double>``.

    `length`: where it is separate from the type, as in rosapi.
    """
    found = _SHAPE.match(text.partition(", ")[0].strip() if "sequence" not in text else text.strip())
    if found is None:
        raise BridgeError(f"The type of a field cannot be understood: {text!r}.")
    base, array = found.groups()
    if text.strip().startswith("sequence<"):
        length = 0
    elif array is not None:
        digits = array[1:-1]
        length = int(digits) if digits.isdigit() else 0  # `[<=10]` is a bounded sequence
    return FieldType(canonical(base), length)


def definitions_of(type_: str, fields_of: Callable[[str], Mapping[str, FieldType]]) -> dict[str, Definition]:
    """Return the definitions of a type and of those in it; `fields_of` returns the fields of one."""
    found: dict[str, Definition] = {}
    wanted = [type_]
    while wanted:
        name = wanted.pop()
        if name not in found:
            found[name] = Definition(name, fields_of(name))
            wanted += [field.base for field in found[name].fields.values() if "/" in field.base]
    return found


def from_rosapi(typedefs: Iterable[Mapping[str, Any]]) -> dict[str, Definition]:
    """Parse an answer of ``/rosapi/message_details``: a type and all those in it."""
    found = {}
    try:
        for typedef in typedefs:
            names = [str(name).removeprefix("_") for name in typedef["fieldnames"]]  # ROS 2 shows its slots
            shapes = zip(names, typedef["fieldtypes"], typedef["fieldarraylen"], strict=True)
            fields = {name: parse_field(text, int(length)) for name, text, length in shapes}
            name = canonical(typedef["type"])
            found[name] = Definition(name, fields)
    except (KeyError, TypeError, ValueError) as error:
        raise BridgeError(f"The server's description of a type cannot be understood: {error!r}.") from error
    return found


def definitions_from_text(type_: str, text: str) -> dict[str, Definition]:
    """Read the definition of a type, as ROS 1 and ROS 2 write it, and those of the types in the same text.

    Each of these is below a line of ``=`` and ``MSG: package/Type``, as in bag files and rosapi's raw types.
    A type in a field without a package is of the same package. Constants and default values are read over: a
    message that a program fills begins with zeros everywhere.
    """
    first, *rest = _SECTION.split(text)
    sections = [(type_, first), *zip(rest[::2], rest[1::2], strict=True)]
    found = {}
    for name, lines in sections:
        short = canonical(name)
        found[short] = Definition(short, dict(_fields(short, lines)))
    return found


def _fields(type_: str, text: str) -> Iterator[tuple[str, FieldType]]:
    for number, line in enumerate(text.splitlines(), 1):
        bare = line.strip()
        if not bare or bare.startswith("#"):
            continue
        found = _LINE.match(bare)
        try:
            if found is None:
                raise BridgeError("Write `type name`, like `float64 x`.")
            kind = parse_field(found["type"])
        except BridgeError as error:
            raise BridgeError(f"`{type_}`, line {number}: `{bare}` cannot be read. {error}") from None
        if not (found["rest"] or "").startswith("="):
            yield found["name"], FieldType(_resolved(kind.base, type_), kind.length)


def _resolved(base: str, type_: str) -> str:
    """Return the full name of a type in a field of another type."""
    if "/" in base or base in PRIMITIVES or base in _TIMES:
        return base
    return "std_msgs/Header" if base == "Header" else f"{type_.partition('/')[0]}/{base}"


def _built_in(text: str) -> dict[str, Definition]:
    """Read lines such as ``package/Type: type name, type name``; one that ends with a comma goes on."""
    found = {}
    for line in filter(None, map(str.strip, text.replace(",\n", ",").splitlines())):
        type_, _, fields = line.partition(":")
        pairs = [field.split() for field in fields.split(",") if field.strip()]
        found[type_] = Definition(type_, {name: parse_field(kind) for kind, name in pairs})
    return found


# A server without rosapi describes no types; these are the same everywhere. Of a header it has what
# ROS 1 and ROS 2 have in common (their time stamps differ): a server fills in what is not sent.
_SIMPLE = {
    **{kind.capitalize(): kind for kind in ("bool", "byte", "char", "string")},
    **{kind.replace("int", "Int").replace("uI", "UI"): kind for kind in INTEGERS if "int" in kind},
    **{kind.capitalize(): kind for kind in FLOATS},
}
KNOWN: Mapping[str, Definition] = {
    **_built_in("\n".join(f"std_msgs/{name}: {kind} data" for name, kind in _SIMPLE.items())),
    **_built_in("""
    std_msgs/Empty:
    std_msgs/Header: string frame_id
    std_msgs/ColorRGBA: float32 r, float32 g, float32 b, float32 a
    geometry_msgs/Vector3: float64 x, float64 y, float64 z
    geometry_msgs/Point: float64 x, float64 y, float64 z
    geometry_msgs/Quaternion: float64 x, float64 y, float64 z, float64 w
    geometry_msgs/Pose: geometry_msgs/Point position, geometry_msgs/Quaternion orientation
    geometry_msgs/Pose2D: float64 x, float64 y, float64 theta
    geometry_msgs/PoseStamped: std_msgs/Header header, geometry_msgs/Pose pose
    geometry_msgs/PoseWithCovariance: geometry_msgs/Pose pose, float64[36] covariance
    geometry_msgs/Twist: geometry_msgs/Vector3 linear, geometry_msgs/Vector3 angular
    geometry_msgs/TwistStamped: std_msgs/Header header, geometry_msgs/Twist twist
    geometry_msgs/TwistWithCovariance: geometry_msgs/Twist twist, float64[36] covariance
    geometry_msgs/Transform: geometry_msgs/Vector3 translation, geometry_msgs/Quaternion rotation
    geometry_msgs/TransformStamped: std_msgs/Header header, string child_frame_id,
        geometry_msgs/Transform transform
    tf2_msgs/TFMessage: geometry_msgs/TransformStamped[] transforms
    nav_msgs/Odometry: std_msgs/Header header, string child_frame_id,
        geometry_msgs/PoseWithCovariance pose, geometry_msgs/TwistWithCovariance twist
    sensor_msgs/Illuminance: std_msgs/Header header, float64 illuminance, float64 variance
    sensor_msgs/Range: std_msgs/Header header, uint8 radiation_type, float32 field_of_view,
        float32 min_range, float32 max_range, float32 range
    sensor_msgs/LaserScan: std_msgs/Header header, float32 angle_min, float32 angle_max,
        float32 angle_increment, float32 time_increment, float32 scan_time,
        float32 range_min, float32 range_max, float32[] ranges, float32[] intensities
    sensor_msgs/Imu: std_msgs/Header header, geometry_msgs/Quaternion orientation,
        float64[9] orientation_covariance, geometry_msgs/Vector3 angular_velocity,
        float64[9] angular_velocity_covariance, geometry_msgs/Vector3 linear_acceleration,
        float64[9] linear_acceleration_covariance
    """),
    "time": Definition("time", {"secs": FieldType("uint32"), "nsecs": FieldType("uint32")}),
    "duration": Definition("duration", {"secs": FieldType("int32"), "nsecs": FieldType("int32")}),
}
"""Definitions that need no server."""

CLOCK = "rosgraph_msgs/Clock"
"""Type of the topic with the time of a simulation, or of a bag."""

_TIME = Definition("builtin_interfaces/Time", {"sec": FieldType("int32"), "nanosec": FieldType("uint32")})
_FRAME = {"frame_id": FieldType("string")}

HEADERS: Mapping[int, Mapping[str, Definition]] = {
    1: {
        "std_msgs/Header": Definition(
            "std_msgs/Header", {"seq": FieldType("uint32"), "stamp": FieldType("time"), **_FRAME}
        ),
        CLOCK: Definition(CLOCK, {"clock": FieldType("time")}),
    },
    2: {
        _TIME.type: _TIME,
        "std_msgs/Header": Definition("std_msgs/Header", {"stamp": FieldType(_TIME.type), **_FRAME}),
        CLOCK: Definition(CLOCK, {"clock": FieldType(_TIME.type)}),
    },
}
"""What a header is, and the time itself, in ROS 1 and in ROS 2."""
