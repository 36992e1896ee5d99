"""Descriptions of a robot's members as plain values, for completion, hover, member list and inspection."""

from __future__ import annotations

import dataclasses
import inspect
import reprlib
import typing
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Literal

from lrp_jupyter.errors import BridgeError

_DEEPEST = 6  # levels of nested fields that are described; a value may contain itself
_PLAIN = (bool, int, float, str, bytes, type(None))


class MemberError(BridgeError, AttributeError):
    """The robot (or a message) has no member of that name, or it cannot be assigned.

    `missing`: the dotted name of a member that the robot did not have, or empty.
    """

    missing = ""


@dataclass(frozen=True, slots=True)
class Member:
    """The description of one member of the robot, for views.

    Attributes
    ----------
    name : str
        Dotted path below ``robot``: ``"light.data"``.
    kind : {"variable", "method", "task", "part"}
        ``light`` is a part: it has the member ``light.data``.
    type : str
        Name of the type of the value, empty while nothing is known about it.
    unit : str
        ``"m/s"``, ``"rad"``, ... or empty.
    doc : str
    age : float or None
        Seconds since the reading arrived; None for methods and before the first reading.
    value : object
        The last reading, None before the first one; the state of a task.
    signature : str
        ``"(linear=0.0, angular=0.0)"`` for a method or a task, else empty.
    fields : tuple of Member
        Members of the value: ``odom`` has the fields ``odom.x``, ``odom.y``, ``odom.theta``. What can be read
        of a task.
    arguments : tuple of Member
        The fields of the message that a method or a task takes.
    stale : bool
        Whether the last reading is too old for a program to act on.
    """

    name: str
    kind: Literal["variable", "method", "task", "part"]
    type: str = ""
    unit: str = ""
    doc: str = ""
    age: float | None = None
    value: object = None
    signature: str = ""
    fields: tuple[Member, ...] = ()
    arguments: tuple[Member, ...] = ()
    stale: bool = False

    @property
    def absence(self) -> str:
        """What to show for want of a value: ``"waiting"``, ``"stale, 1.4 s old"``; empty if there is one."""
        if self.kind != "variable":
            return ""
        if self.stale:
            return f"stale, {age_text(self.age)} old"
        return "waiting" if self.value is None else ""

    def as_dict(self) -> dict[str, Any]:
        """Return a JSON form; a value without one becomes a short text."""
        form = {each.name: getattr(self, each.name) for each in dataclasses.fields(self)}
        inside = {name: [each.as_dict() for each in form[name]] for name in ("fields", "arguments")}
        value = str(self.value) if self.kind == "task" else _json_value(self.value)
        return {**form, "value": value, **inside}


def signature_text(signature: inspect.Signature) -> str:
    """Return a signature as one calls it: without annotations, which may be texts."""
    return str(inspect.Signature([p.replace(annotation=p.empty) for p in signature.parameters.values()]))


def age_text(seconds: float | None) -> str:
    """Return an age as it is shown: with tenths of a second up to ten seconds."""
    age = seconds or 0.0
    return f"{age:.1f} s" if age < 10 else f"{age:,.0f} s"


def _json_value(value: object) -> object:
    if isinstance(value, float) and (value != value or value in (float("inf"), float("-inf"))):
        return repr(value)  # JSON has neither NaN nor infinity
    if value is None or type(value) in (bool, int, float):
        return value
    return value if type(value) is str and len(value) <= 200 else reprlib.repr(value)


def _public_fields(value: object, type_: object) -> dict[str, object]:
    """Return names and values of an object's data; the values are None where only the type is known."""
    if value is None:
        if not isinstance(type_, type) or type_ in _PLAIN:
            return {}
        try:
            hints = typing.get_type_hints(type_)
        except Exception:  # an annotation that cannot be resolved must not hide the others
            hints = dict(getattr(type_, "__annotations__", {}))
        return {name: None for name in hints if not name.startswith("_")}
    if isinstance(value, (*_PLAIN, type)):
        return {}
    if dataclasses.is_dataclass(value):
        names: Iterable[str] = [field.name for field in dataclasses.fields(value)]
    elif isinstance(value, tuple):
        names = getattr(value, "_fields", ())
    else:
        slots = getattr(type(value), "__slots__", ())
        names = [*((slots,) if isinstance(slots, str) else slots), *getattr(value, "__dict__", ())]
    found = {name: getattr(value, name, None) for name in names if not name.startswith("_")}
    return {name: field for name, field in found.items() if not callable(field)}


def _questions(path: str, kind: object) -> Iterator[Member]:
    """Yield the methods by which a program asks a reading for more: its class names them in `QUESTIONS`.

    What they answer depends on the reading and the arguments alone.
    """
    for name in getattr(kind, "QUESTIONS", ()) if isinstance(kind, type) else ():
        function = getattr(kind, name)
        _self, *parameters = inspect.signature(function).parameters.values()
        signature = signature_text(inspect.Signature(parameters))
        doc = (inspect.getdoc(function) or "").partition("\n")[0]
        yield Member(f"{path}.{name}", "method", doc=doc, signature=signature)


def describe_value(member: Member, type_: object = None, depth: int = _DEEPEST) -> Member:
    """Add the fields of the member's value (or, before the first reading, of its type)."""
    if depth == 0:
        return member
    hints: dict[str, Any] = {}
    if isinstance(type_, type) and member.value is None:
        hints = dict(getattr(type_, "__annotations__", {}))
    fields = []
    for name, value in _public_fields(member.value, type_).items():
        field_type = hints.get(name) if value is None else type(value)
        text = field_type if isinstance(field_type, str) else getattr(field_type, "__name__", "")
        field = Member(
            f"{member.name}.{name}", "variable", text, age=member.age, value=value, stale=member.stale
        )
        fields.append(describe_value(field, field_type, depth - 1))
    fields.extend(_questions(member.name, type_ if member.value is None else type(member.value)))
    return dataclasses.replace(member, fields=tuple(fields))
