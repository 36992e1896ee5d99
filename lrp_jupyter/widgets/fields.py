"""What the readings and messages of a robot consist of: known from their types, before anything arrived."""

from __future__ import annotations

import re
from collections.abc import Iterator

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.members import Member
from lrp_jupyter.errors import LRPError
from lrp_jupyter.interpreter.frame import render
from lrp_jupyter.widgets.protocol import Option

__all__ = ["arguments_of", "fields_of"]

_ARGUMENT = re.compile(r"[(,]\s*(\w+)")


def fields_of(bridge: Bridge, chain: str) -> list[Option] | None:
    """Give the fields of ``robot.odom``, or of what ``robot.move()`` sends; None for other chains.

    Parameters
    ----------
    bridge : Bridge
    chain : str
        ``robot.odom.pose``, ``robot.move().linear``.
    """
    command, called, inner = chain.partition("()")
    root, _, path = command.partition(".")
    if root != "robot" or not path:
        return None
    try:
        if called:
            return [_field(field) for field in bridge.describe(path + inner).fields]
        names = path.split(".")
        if any(bridge.describe(".".join(names[:end])).kind == "method" for end in range(1, len(names) + 1)):
            return []
        return [_field(field) for field in bridge.describe(path).fields] or None
    except LRPError:
        return None


def _field(member: Member) -> Option:
    value = "" if member.value is None or member.fields else render(member.value)[:40]
    kind = "method" if member.kind == "method" else "property"
    detail = value or member.signature or member.type
    return {"label": member.name.rpartition(".")[2], "kind": kind, "detail": detail, "info": member.doc}


def arguments_of(bridge: Bridge, command: str) -> list[Option]:
    """Give the arguments of a command: ``robot.move`` takes ``linear=`` and ``linear_x=``.

    Parameters
    ----------
    bridge : Bridge
    command : str
        ``robot.move``.
    """
    root, _, path = command.partition(".")
    try:
        member = bridge.describe(path) if root == "robot" and path else None
    except LRPError:
        member = None
    if member is None or member.kind != "method":
        return []
    found = dict.fromkeys(_ARGUMENT.findall(member.signature), "")
    for field in _leaves(member):
        found[field.name.removeprefix(f"{path}.").replace(".", "_")] = field.type
    return [
        {"label": f"{name}=", "kind": "property", "detail": type_, "info": ""}
        for name, type_ in found.items()
    ]


def _leaves(member: Member) -> Iterator[Member]:
    for field in member.fields:
        if field.fields:
            yield from _leaves(field)
        else:
            yield field
