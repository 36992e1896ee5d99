"""Completion of Python in a block: its names, what is in a value, and a robot's readings and commands.

What a robot offers is known from the types of its members, before anything arrives.
"""

from __future__ import annotations

import builtins
import inspect
import keyword
import re
from collections.abc import Callable, Iterator, Mapping
from typing import TypedDict

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.members import Member, signature_text
from lrp_jupyter.errors import LRPError
from lrp_jupyter.interpreter.rendering import of_type, render
from lrp_jupyter.language.blocks.builtin_names import TIME_TEXTS, degrees

_MOST = 300  # completions
_ARGUMENT = re.compile(r"[(,]\s*(\w+)")


class PythonOption(TypedDict):
    """One completion; `detail` stands beside it, `info` in its card."""

    label: str
    kind: str
    detail: str
    info: str


def names_beginning(begun: str, namespace: Mapping[str, object]) -> list[PythonOption]:
    """Return the names that a block can use besides the program's own, and Python's keywords.

    `namespace`: those of the session.
    """
    known: dict[str, object] = {**vars(builtins), "degrees": degrees, **namespace}
    names = [name for name in known if name.startswith(begun) and (begun.startswith("_") or name[0] != "_")]
    names.sort(key=lambda name: (name[:1].isupper(), name))
    words = [word for word in keyword.kwlist if word.startswith(begun)]
    options = [_option(name, known[name]) for name in names[:_MOST]]
    options += [
        {"label": name, "kind": "variable", "detail": "s", "info": text}
        for name, text in TIME_TEXTS.items()
        if name.startswith(begun) and name not in namespace
    ]
    return options + [{"label": word, "kind": "keyword", "detail": "", "info": ""} for word in words]


def members_beginning(value: object, begun: str) -> list[PythonOption]:
    """Return the members of a value whose names begin so."""
    names = [
        name for name in dir(value) if name.startswith(begun) and (begun.startswith("_") or name[0] != "_")
    ]
    options = []
    for name in names[:_MOST]:
        try:
            member = inspect.getattr_static(value, name)
            if not isinstance(member, property):
                member = getattr(value, name)
        except Exception:  # it is listed anyway
            member = None
        options.append(_option(name, member))
    return options


def _option(name: str, value: object) -> PythonOption:
    if inspect.isclass(value):
        kind, detail = "class", ""
    elif inspect.ismodule(value):
        kind, detail = "namespace", ""
    elif callable(value):
        kind, detail = "function", signature_of(value)
    elif isinstance(value, property):
        kind, detail = "property", ""
    else:
        kind, detail = "variable", "" if value is None else render(value, of_type)[:40]
    return {"label": name, "kind": kind, "detail": detail, "info": doc_of(value) if callable(value) else ""}


def signature_of(value: Callable[..., object]) -> str:
    """Return the parameters of a callable."""
    try:
        return signature_text(inspect.signature(value))
    except (TypeError, ValueError):
        return "(…)"


def doc_of(value: object) -> str:
    """Return the first paragraph of a documentation."""
    try:
        return (inspect.getdoc(value) or "").partition("\n\n")[0][:300]
    except Exception:  # an unusual object: no documentation
        return ""


def fields_of(bridge: Bridge, chain: str) -> list[PythonOption] | None:
    """Return the fields of ``robot.odom``, or of what ``robot.move()`` sends; None for other chains."""
    command, called, inner = chain.partition("()")
    root, _, path = command.partition(".")
    if root != "robot" or not path:
        return None
    try:
        if called:
            asked: tuple[Member, ...] | None = bridge.describe(path).arguments
            for name in filter(None, inner.split(".")):
                asked = next((each.fields for each in asked or () if each.name.endswith(f".{name}")), None)
            return None if asked is None else [option_of(field) for field in asked]
        names = path.split(".")
        if any(bridge.describe(".".join(names[:end])).kind == "method" for end in range(1, len(names))):
            return []
        member = bridge.describe(path)
        found = [option_of(field) for field in member.fields]
        return found if found or member.kind == "method" else None
    except LRPError:
        return None


def option_of(member: Member) -> PythonOption:
    """Return the completion of a member of a robot."""
    is_shown = member.value is not None and not (member.fields or member.stale)
    value = render(member.value, of_type)[:40] if is_shown else ""
    kind = "method" if member.kind in ("method", "task") else "property"
    detail = value or member.signature or member.type
    return {"label": member.name.rpartition(".")[2], "kind": kind, "detail": detail, "info": member.doc}


def arguments_of(bridge: Bridge, command: str) -> list[PythonOption]:
    """Return the arguments of a command: ``robot.move`` takes ``linear=`` and ``linear_x=``."""
    root, _, path = command.partition(".")
    try:
        member = bridge.describe(path) if root == "robot" and path else None
    except LRPError:
        member = None
    if member is None or member.kind not in ("method", "task"):
        return []
    found = dict.fromkeys(_ARGUMENT.findall(member.signature), "")
    for field in _leaves(member.arguments):
        found[field.name.removeprefix(f"{path}.").replace(".", "_")] = field.type
    return [
        {"label": f"{name}=", "kind": "property", "detail": type_, "info": ""}
        for name, type_ in found.items()
    ]


def _leaves(fields: tuple[Member, ...]) -> Iterator[Member]:
    for field in fields:
        if field.fields:
            yield from _leaves(field.fields)
        else:
            yield field
