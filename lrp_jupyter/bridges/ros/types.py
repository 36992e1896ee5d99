"""ROS message types as Python classes: messages that a program fills, and messages that it receives.

Both are made from a definition when the first connection of a type is set up. A message checks
every field and type where it is filled, because rosbridge reports nothing to its client and rospy
checks only while there are subscribers. A received message is an immutable value: it does not change while a
program reads it.

Paper: §7.1 (``data linear x: forwardSpeed``; the last odometry as ``robot odom``).
"""

from __future__ import annotations

import base64
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from lrp_jupyter.bridges.members import MemberError
from lrp_jupyter.bridges.message import Message, Plain, listed, real_number
from lrp_jupyter.bridges.ros.definitions import (
    FLOATS,
    INTEGERS,
    KNOWN,
    PRIMITIVES,
    STRINGS,
    Definition,
    FieldType,
    canonical,
)
from lrp_jupyter.bridges.ros.transforms import Rotation
from lrp_jupyter.bridges.scans import Scanned
from lrp_jupyter.errors import BridgeError, did_you_mean

VELOCITIES = frozenset(
    {
        *("geometry_msgs/Twist", "geometry_msgs/TwistStamped"),
        *("ackermann_msgs/AckermannDrive", "ackermann_msgs/AckermannDriveStamped"),
    }
)
"""Types of which a zero stops the robot; the command watchdog watches over them."""

_WORDS = {
    "geometry_msgs/Twist": {"linear": "linear.x", "angular": "angular.z"},
    "geometry_msgs/TwistStamped": {"linear": "twist.linear.x", "angular": "twist.angular.z"},
}

Decode = Callable[[Any], Any]


@dataclass(frozen=True, slots=True)
class Form:
    """The decoder of a message type.

    `decode`: makes a reading of a dictionary (rosbridge) or of an object with attributes (rospy); raises
        ValueError, TypeError or AttributeError for data that is not a message of the type.
    `zero`: the one in which nothing is set.
    `unclear`: counts what it could not decode for certain.
    """

    kind: type[ReceivedMessage]
    decode: Callable[[Any], ReceivedMessage]
    zero: ReceivedMessage
    unclear: Unclear


class Unclear:
    """Counts the numbers that were infinite or NaN, where it is not known which: they are taken as NaN."""

    count = 0

    def take(self) -> float:
        """Return one of them."""
        self.count += 1
        return math.nan


class RosMessage(Message):
    """A ROS message to be filled.

    The time stamp of a header is part of its values only if it was set: the robot's side fills in the time.
    """

    __slots__ = ()

    def _assign(self, name: str, value: object, called: str = "") -> None:
        if isinstance(value, ReceivedMessage):  # what arrived on one topic may go out on another
            value = value._as_dict()
        super()._assign(name, value, called)


class ReceivedMessage:
    """A ROS message that arrived, as an immutable value."""

    __slots__: tuple[str, ...] = ()
    _type: ClassVar[str] = ""
    _of_fields: ClassVar[Decode]

    def __init__(self, *values: object) -> None:
        for name, value in zip(self.__slots__, values, strict=True):
            object.__setattr__(self, name, value)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):  # copy, pickle and notebooks ask for these
            raise MemberError(f"`{type(self).__name__}` has no `{name}`.")
        if name in ("new", "age"):
            raise MemberError(
                f"A `{self._type}` has no `{name}`: that is asked of the robot, in a block, with the name of"
                f" the reading, as in `robot.order.{name}`."
            )
        hint = did_you_mean(name, (*self.__slots__, *getattr(type(self), "QUESTIONS", ())))
        raise MemberError(f"`{self._type}` has no `{name}`; it has {listed(self.__slots__)}.{hint}")

    def __setattr__(self, name: str, value: object) -> None:
        raise MemberError(f"`{name}` was read from the robot and cannot be assigned.")

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and self._values() == other._values()

    def __hash__(self) -> int:
        return hash(self._values())

    def __copy__(self) -> ReceivedMessage:
        return self

    def __deepcopy__(self, memo: object) -> ReceivedMessage:
        return self

    def __repr__(self) -> str:
        inside = zip(self.__slots__, self._values(), strict=True)
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in inside)})"

    @property
    def _content(self) -> object:
        """Itself, or its only field if that is ``data``."""
        return self.data if self.__slots__ == ("data",) else self

    def _values(self) -> tuple[object, ...]:
        return tuple(getattr(self, name) for name in self.__slots__)

    def _as_dict(self) -> dict[str, Any]:
        extra = _EXTRA.get(self._type, ())
        return {
            name: _plain(value)
            for name, value in zip(self.__slots__, self._values(), strict=True)
            if name not in extra
        }


def _plain(value: object) -> object:
    if isinstance(value, ReceivedMessage):
        return value._as_dict()
    return tuple(map(_plain, value)) if isinstance(value, tuple) else value


class Types:
    """The types known so far, and their classes.

    Owner: the thread of the connection adds; the classes may be used anywhere.
    """

    def __init__(self) -> None:
        self._definitions: dict[str, Definition] = dict(KNOWN)
        self._messages: dict[str, type[RosMessage]] = {}
        self._forms: dict[str, Form] = {}
        self._unclear = Unclear()

    def add(self, definitions: Mapping[str, Definition]) -> None:
        """Add definitions; those of the robot replace known ones."""
        self._definitions.update(definitions)
        self._messages.clear()
        self._forms.clear()

    def knows(self, type_: str) -> bool:
        """Whether a type and all that is in it are defined."""
        definition = self._definitions.get(canonical(type_))
        return definition is not None and all(
            field.base in PRIMITIVES or self.knows(field.base) for field in definition.fields.values()
        )

    def names(self) -> list[str]:
        """Return the names of all known types, for "did you mean"."""
        return [name for name in self._definitions if "/" in name]

    def _definition(self, type_: str) -> Definition:
        definition = self._definitions.get(type_)
        if definition is None:
            raise BridgeError(f"There is no message type `{type_}`.{did_you_mean(type_, self.names())}")
        return definition

    def message(self, type_: str) -> type[RosMessage]:
        """Return the class of messages to fill; BridgeError: the type, or one in it, is not known."""
        name = canonical(type_)
        if name not in self._messages:
            fields = {field: self._kind(kind) for field, kind in self._definition(name).fields.items()}
            if name == "geometry_msgs/Quaternion" and isinstance(w := fields.get("w"), Plain):
                fields["w"] = replace(w, default=1.0)  # four zeros are no orientation
            self._messages[name] = type(
                name.rpartition("/")[2],
                (RosMessage,),
                {
                    "__slots__": (),
                    "__doc__": f"A `{name}`.",
                    "FIELDS": fields,
                    "WORDS": _WORDS.get(name, {}),
                    "OPTIONAL": ("stamp",) if name == "std_msgs/Header" else (),
                },
            )
        return self._messages[name]

    def _kind(self, field: FieldType) -> type[Message] | Plain:
        if field.length >= 0:
            return _array(field, None if field.base in PRIMITIVES else self.message(field.base))
        return _PLAIN[field.base] if field.base in PRIMITIVES else self.message(field.base)

    def lists(self, type_: str) -> list[str]:
        """Return the paths of the numbers in a message of which there may be any number."""
        found = []
        for name, field in self._definition(canonical(type_)).fields.items():
            if field.length == 0 and field.base in (*FLOATS, *INTEGERS):
                found.append(name)
            elif field.length < 0 and field.base not in PRIMITIVES:
                found += [f"{name}.{inner}" for inner in self.lists(field.base)]
        return found

    def form(self, type_: str) -> Form:
        """Return the decoder of received messages; BridgeError: the type, or one in it, is not known."""
        name = canonical(type_)
        if name not in self._forms:
            self._forms[name] = self._make_form(self._definition(name))
        return self._forms[name]

    def _make_form(self, definition: Definition) -> Form:
        fields = definition.fields
        far = _FAR.get(definition.type, ())
        decoders = {name: self._decoder(field, name in far) for name, field in fields.items()}
        zeros = {name: self._zero(field) for name, field in fields.items()}
        extra = [name for name in _EXTRA.get(definition.type, ()) if name not in fields]
        kind: type[ReceivedMessage] = type(
            definition.type.rpartition("/")[2],
            (*_QUESTIONS.get(definition.type, ()), ReceivedMessage),
            {
                "__slots__": (*fields, *extra),
                "__doc__": f"A `{definition.type}` that arrived.",
                "__annotations__": {**dict.fromkeys(extra, float), **{n: type(z) for n, z in zeros.items()}},
                "_type": definition.type,
            },
        )

        def make(values: dict[str, Any]) -> ReceivedMessage:
            return kind(*values.values(), *(_plane(values["pose"]) if extra else ()))

        def decode(raw: Any) -> ReceivedMessage:
            if not isinstance(raw, Mapping):
                return make({name: decoders[name](getattr(raw, name)) for name in fields})
            if fields and not any(name in raw for name in fields):
                raise ValueError(f"It has {', '.join(map(repr, raw)) or 'no fields'}.")
            return make({name: decoders[name](raw[name]) if name in raw else zeros[name] for name in fields})

        kind._of_fields = decode

        return Form(kind, decode, make(zeros), self._unclear)

    def _zero(self, field: FieldType) -> Any:
        one = _PYTHON[field.base]() if field.base in PRIMITIVES else self.form(field.base).zero
        if field.length < 0:
            return one
        return bytes(field.length) if field.base in _BYTES else (one,) * field.length

    def _decoder(self, field: FieldType, is_far: bool) -> Decode:
        """Make the decoder of a field; `is_far`: whether a number that is not finite means "out of reach"."""
        if field.base in FLOATS:
            one = _float(_infinity if is_far else self._unclear.take)
        else:
            one = _DECODERS[field.base] if field.base in PRIMITIVES else self.form(field.base).decode
        if field.length < 0:
            return one
        return _bytes if field.base in _BYTES else _many(one, _PYTHON.get(field.base))


# -- fields to fill -------------------------------------------------------------------------------


def _integer(name: str) -> Plain:
    low, high = INTEGERS[name]

    def check(value: object, path: str) -> int:
        if isinstance(value, bool) or not hasattr(value, "__index__"):
            raise BridgeError(f"`{path}` must be a whole number, not {value!r} ({type(value).__name__}).")
        number = value.__index__()
        if not low <= number <= high:
            raise BridgeError(f"`{path}` goes from {low} to {high}, not {number}.")
        return int(number)

    return Plain(name, 0, check)


def _real(name: str) -> Plain:
    largest = FLOATS[name]

    def check(value: object, path: str) -> float:
        number = real_number(value, path)
        if abs(number) > largest:
            raise BridgeError(f"`{path}` is too large for a {name}: {number:g}.")
        return number

    return Plain(name, 0.0, check)


def _text(value: object, path: str) -> str:
    if not isinstance(value, str):
        raise BridgeError(f"`{path}` must be a string, not {value!r} ({type(value).__name__}).")
    return str(value)


def _truth(value: object, path: str) -> bool:
    if not isinstance(value, bool) and str(getattr(value, "dtype", "")) != "bool":
        raise BridgeError(f"`{path}` must be True or False, not {value!r} ({type(value).__name__}).")
    return bool(value)


_PLAIN = {
    **{name: _integer(name) for name in INTEGERS},
    **{name: _real(name) for name in FLOATS},
    **{name: Plain(name, "", _text) for name in STRINGS},
    "bool": Plain("bool", False, _truth),
}


def _array(field: FieldType, message: type[Message] | None) -> Plain:
    """Make a kind of field for many: of numbers and texts, or of messages as nested dictionaries."""

    def one(value: object, path: str) -> object:
        if message is None:
            return _PLAIN[field.base].check(value, path)
        if isinstance(value, message):
            return value.as_dict()
        if isinstance(value, ReceivedMessage):
            value = value._as_dict()
        if not isinstance(value, Mapping):
            raise BridgeError(f"`{path}` must be a `{field.base}`, or a dictionary, not {value!r}.")
        return message(path, **value).as_dict()

    def check(value: object, path: str) -> tuple[object, ...]:
        if isinstance(value, (str, Mapping)) or not isinstance(value, Iterable):
            raise BridgeError(f"`{path}` must be a list, not {value!r} ({type(value).__name__}).")
        items = tuple(one(item, f"{path}[{index}]") for index, item in enumerate(value))
        if field.length and len(items) != field.length:
            raise BridgeError(f"`{path}` has {field.length} elements, not {len(items)}.")
        return items

    empty: object = _PLAIN[field.base].default if message is None else message().as_dict()
    return Plain(str(field), (empty,) * field.length, check)


# -- fields that arrived --------------------------------------------------------------------------

_BYTES = ("uint8", "char", "byte")
_PYTHON = {
    **dict.fromkeys(INTEGERS, int),
    **dict.fromkeys(FLOATS, float),
    **dict.fromkeys(STRINGS, str),
    "bool": bool,
}


def _float(other: Callable[[], float]) -> Decode:
    """Make the decoder of a float; `other` returns what null is: JSON has no NaN and no infinity."""

    def decode(raw: Any) -> float:
        return other() if raw is None else float(_number(raw))

    return decode


def _infinity() -> float:
    return math.inf


_FAR = {
    "sensor_msgs/Range": ("range",),
    "sensor_msgs/LaserScan": ("ranges",),
    "sensor_msgs/LaserEcho": ("echoes",),
}
"""Fields in which a number that is not finite means, by their definition, that nothing is in reach."""


def _bytes(raw: Any) -> bytes:
    """Octets come as base64 over rosbridge, as bytes or a list otherwise."""
    return base64.b64decode(raw) if isinstance(raw, str) else bytes(raw)


def _as_list(raw: Any) -> Any:
    """Return an array of numbers, which ROS 2 gives as one of `array` or NumPy, with those of Python."""
    return raw.tolist() if hasattr(raw, "tolist") else raw


def _many(one: Decode, plain: type | None) -> Decode:
    """Make the decoder of an array; where all elements are of the plain type, none has to be decoded."""

    def decode(raw: Any) -> tuple[object, ...]:
        items = _as_list(raw)
        if isinstance(items, (list, tuple)) and set(map(type, items)) == {plain}:
            return tuple(items)
        return tuple(map(one, items))

    return decode


def _exactly(kind: type, *also: type) -> Decode:
    def decode(raw: Any) -> object:
        if not isinstance(raw, (kind, *also)):
            raise TypeError(f"{raw!r} is not a {kind.__name__}")
        return kind(raw)

    return decode


_number = _exactly(float, int)
_DECODERS: Mapping[str, Decode] = {
    **dict.fromkeys(INTEGERS, _exactly(int)),
    **dict.fromkeys(STRINGS, _exactly(str)),
    "bool": _exactly(bool, int),
}

_QUESTIONS = {"sensor_msgs/LaserScan": (Scanned,)}
_EXTRA = {"nav_msgs/Odometry": ("x", "y", "theta")}


def _plane(pose: Any) -> tuple[float, float, float]:
    """Return x, y (metres) and the heading (radians) of a robot on the floor."""
    position, turn = pose.pose.position, pose.pose.orientation
    return position.x, position.y, Rotation(turn.x, turn.y, turn.z, turn.w).yaw
