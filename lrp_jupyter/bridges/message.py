"""Messages that a program fills: the argument of ``robot.move``.

The paper writes ``robot move: [:data | data linear x: forwardSpeed]``. In Python, with the same
meaning, and all of them checked here rather than on the robot::

    robot.move(linear=0.2)
    robot.move(linear_x=0.2, angular_z=0.1)
    robot.move(lambda msg: msg.linear(x=forward))
    with robot.move as msg:
        msg.linear.x = forward

Paper: §3.2, §7.1.
"""

from __future__ import annotations

import math
import numbers
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from lrp_jupyter.bridges.members import Member, MemberError
from lrp_jupyter.errors import BridgeError, did_you_mean


def real_number(value: object, what: str) -> float:
    """Return a finite real number as a float, or raise a BridgeError; ``True`` does not count as one."""
    if type(value) is not float and (isinstance(value, bool) or not isinstance(value, numbers.Real)):
        kind = _KINDS.get(type(value), type(value).__name__)
        raise BridgeError(f"`{what}` must be a number, not {value!r} ({kind}).{_remedy(value)}")
    number = float(value)
    if not math.isfinite(number):
        raise BridgeError(f"`{what}` must be a finite number, not {number}.")
    return number


_KINDS: dict[type, str] = {str: "a text", tuple: "a tuple", list: "a list", bool: "a truth value"}


def _remedy(value: object) -> str:
    """Return what may be meant by a value that is not a number: a sentence, or an empty text."""
    if type(value) is tuple and len(value) == 2 and all(type(part) is int for part in value):
        return f" A decimal number has a point: {value[0]}.{abs(value[1])}."
    if isinstance(value, str):
        with suppress(ValueError):
            return f" Write {float(value):g} without quotes."
    return ""


@dataclass(frozen=True, slots=True)
class Plain:
    """A kind of field that is not a message.

    `type`: its name in views.
    `default`: the value of a field that is not set.
    `check`: maps a value and the name of the field to what is stored, or raises `BridgeError`.
    """

    type: str
    default: Any
    check: Callable[[object, str], Any]


NUMBER = Plain("float", 0.0, real_number)


class Message:
    """A message with named fields, each of them plain or another message.

    A subclass names its fields in `FIELDS`; `WORDS` are short forms: ``{"linear": "linear.x"}``
    accepts a number in place of the nested message, and `UNITS` are the units of such numbers.
    """

    __slots__ = ("_fields", "_path", "_was_assigned")
    FIELDS: ClassVar[Mapping[str, type[Message] | Plain]] = {}
    WORDS: ClassVar[Mapping[str, str]] = {}
    UNITS: ClassVar[Mapping[str, str]] = {}
    OPTIONAL: ClassVar[tuple[str, ...]] = ()  # parts that are among its values only if something is set there

    _fields: dict[str, Any]
    _was_assigned: bool
    _path: str

    def __init__(self, path: str = "msg", /, **fields: object) -> None:
        values = {
            name: kind.default if isinstance(kind, Plain) else kind(f"{path}.{name}")
            for name, kind in self.FIELDS.items()
        }
        object.__setattr__(self, "_path", path)
        object.__setattr__(self, "_was_assigned", False)
        object.__setattr__(self, "_fields", values)
        self(**fields)

    def __call__(self, **fields: object) -> Self:
        """Set several fields at once, the paper's way: ``msg.linear(x=forward)``."""
        for name, value in fields.items():
            self._assign(name, value)
        return self

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):  # copy, pickle and notebooks ask for these
            raise MemberError(f"`{type(self).__name__}` has no `{name}`.")
        try:
            return self._fields[name]
        except KeyError:
            raise self._unknown(name) from None

    def __setattr__(self, name: str, value: object) -> None:
        self._assign(name, value)

    def __dir__(self) -> list[str]:
        return [*self.FIELDS]

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and self._fields == other._fields

    __hash__ = None  # type: ignore[assignment]  # a message is filled, thus mutable

    def __copy__(self) -> Self:
        return type(self)(self._path, **self._fields)

    def __deepcopy__(self, memo: object) -> Self:
        return self.__copy__()  # parts are always copied

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{k}={v!r}' for k, v in self._fields.items())})"

    @classmethod
    def paths(cls) -> Iterator[str]:
        """Dotted names of every plain field of the message: ``linear.x``, ``linear.y``, ..."""
        for name, kind in cls.FIELDS.items():
            if isinstance(kind, Plain):
                yield name
            else:
                yield from (f"{name}.{inner}" for inner in kind.paths())

    @classmethod
    def describe(cls, path: str) -> tuple[Member, ...]:
        """Describe the fields, below the name `path`."""
        return tuple(
            Member(f"{path}.{name}", "variable", kind.type)
            if isinstance(kind, Plain)
            else Member(f"{path}.{name}", "variable", kind.__name__, fields=kind.describe(f"{path}.{name}"))
            for name, kind in cls.FIELDS.items()
        )

    def get(self, path: str) -> Any:
        """Read a field by its dotted name, or by its short form."""
        value: Any = self
        for name in self.WORDS.get(path, path).split("."):
            value = value._fields[name]
        return value

    def set(self, path: str, value: object) -> None:
        """Write a field by its dotted name, or by its short form."""
        *parents, last = self.WORDS.get(path, path).split(".")
        target: Message = self
        for name in parents:
            target = getattr(target, name)
        target._assign(last, value, path)

    def as_dict(self) -> dict[str, Any]:
        """Return the fields as nested dictionaries."""
        return {
            name: value if isinstance(self.FIELDS[name], Plain) else value.as_dict()
            for name, value in self._fields.items()
            if name not in self.OPTIONAL or value._is_set
        }

    @property
    def _is_set(self) -> bool:
        """Whether something was set here or in a part."""
        parts = (each for each in self._fields.values() if isinstance(each, Message))
        return self._was_assigned or any(part._is_set for part in parts)

    def _assign(self, name: str, value: object, called: str = "") -> None:
        """Set a field; `called`: its name in messages, where that is not the whole one."""
        object.__setattr__(self, "_was_assigned", True)
        kind = self.FIELDS.get(name)
        if kind is None and name in self.WORDS:
            self.set(name, value)
        elif kind is None:
            self._assign_long_name(name, value)
        elif isinstance(kind, Plain):
            self._fields[name] = kind.check(value, called or f"{self._path}.{name}")
        elif isinstance(value, kind) and not value._is_set:
            self._fields[name] = kind(f"{self._path}.{name}")
        elif isinstance(value, kind):
            for inner in kind.FIELDS:  # a copy: two messages never share a part
                self._fields[name]._assign(inner, getattr(value, inner))
        elif isinstance(value, Mapping):
            self._fields[name](**value)
        elif name in self.WORDS:
            self.set(name, value)
        else:
            inside = ", ".join(f"`{self._path}.{name}.{inner}`" for inner in kind.FIELDS)
            raise BridgeError(f"`{self._path}.{name}` has fields of its own. Set these: {inside}.")

    def _assign_long_name(self, name: str, value: object) -> None:
        """``linear_x=0.2`` is ``linear.x``."""
        for field, kind in self.FIELDS.items():  # names of fields may have underscores of their own
            rest = name.removeprefix(f"{field}_")
            if rest != name and not isinstance(kind, Plain):
                try:
                    self._fields[field]._assign(rest, value)
                except MemberError:
                    continue
                return
        raise self._unknown(name)

    def _unknown(self, name: str) -> MemberError:
        known = [*self.FIELDS, *(path.replace(".", "_") for path in self.paths() if "." in path)]
        return MemberError(
            f"`{self._path}` has no `{name}`; it has {listed(self.FIELDS)}.{did_you_mean(name, known)}"
        )


def listed(fields: Iterable[str]) -> str:
    """Return the names of the fields of a message for a sentence."""
    return ", ".join(f"`{field}`" for field in fields) or "no fields"


class Vector3(Message):
    """Three numbers, x forward, y to the left, z up (REP 103)."""

    __slots__ = ()
    FIELDS = {"x": NUMBER, "y": NUMBER, "z": NUMBER}  # noqa: RUF012


class Twist(Message):
    """A velocity: ``linear`` in m/s, ``angular`` in rad/s; ``linear=0.2`` means ``linear.x``."""

    __slots__ = ()
    FIELDS = {"linear": Vector3, "angular": Vector3}  # noqa: RUF012
    WORDS = {"linear": "linear.x", "angular": "angular.z"}  # noqa: RUF012
    UNITS = {"linear": "m/s", "angular": "rad/s"}  # noqa: RUF012


def moves(command: object) -> bool:
    """Return whether any number of a command, however deep, is not zero; a header has no velocities."""
    return any(number != 0 for number in _numbers_in(command))


def stands(command: object) -> bool:
    """Return whether a command has numbers, and all of them are zero; what a text does is unknown."""
    found = _numbers_in(command)
    return next(found, 1) == 0 and all(number == 0 for number in found)


def _numbers_in(command: object) -> Iterator[float | numbers.Real]:
    if isinstance(command, (int, float)):
        yield command
    elif isinstance(command, (dict, Mapping)):  # the usual one first: the others take long to be told
        for name, each in command.items():
            if name != "header":
                yield from _numbers_in(each)
    elif isinstance(command, (list, tuple)):
        for each in command:
            yield from _numbers_in(each)
    elif isinstance(command, numbers.Real):  # numpy's
        yield command
