"""Questions of an editor and an inspector: completion, hover, references, looking into values.

On the worker's thread. Live values are fetched between two ticks, on the interpreter's thread; only what
comes of them, texts of bounded length, leaves it.
"""

from __future__ import annotations

import builtins
import inspect as inspection
import keyword
from collections.abc import Callable, Mapping
from itertools import islice
from typing import TYPE_CHECKING, Any

from lrp_jupyter.errors import LRPError, UnknownElementError
from lrp_jupyter.interpreter.frame import render
from lrp_jupyter.language.parser import scan
from lrp_jupyter.language.program import Path
from lrp_jupyter.language.rename import references as find_references
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.widgets.fields import arguments_of, fields_of
from lrp_jupyter.widgets.inspecting import inspect_element
from lrp_jupyter.widgets.paths import id_of
from lrp_jupyter.widgets.protocol import (
    Complete,
    Hover,
    HoverView,
    Inspect,
    Option,
    References,
    ReferencesView,
    Request,
    offset_of,
    range_of,
)

if TYPE_CHECKING:
    from lrp_jupyter.widgets.connection import Connection

__all__ = ["answer_request"]

_MOST = 300  # completions


class _NothingError(Exception):
    """A name means nothing here."""


def answer_request(connection: Connection, request: Request) -> Mapping[str, Any]:
    """Give the fields of the reply."""
    match request["type"]:
        case "complete":
            return {"options": complete(connection, request)}
        case "hover":
            return {"hover": hover(connection, request)}
        case "references":
            return {"references": references(connection, request)}
        case "inspect":
            return {"inspect": inspect_element(connection, _inspected(request))}
    raise LRPError(f"There is no request `{request['type']}`.")


def _inspected(request: Inspect) -> Inspect:
    return request


# -- Python names ----------------------------------------------------------------------------------------


def complete(connection: Connection, request: Complete) -> list[Option]:
    """Complete a name, or a member of what stands before the last dot.

    ``robot.move().`` asks for the fields of the message that a command sends, ``robot.move(`` for its
    arguments.
    """
    robot, prefix = connection.session.bridge, request["prefix"]
    command, bracket, argument = prefix.partition("(")
    if bracket and not argument.startswith(")"):
        return [each for each in arguments_of(robot, command) if each["label"].startswith(argument)]
    before, dot, begun = prefix.rpartition(".")
    if not dot:
        return _names(connection, begun)
    fields = fields_of(robot, before)
    if fields is not None:
        return [each for each in fields if each["label"].startswith(begun)]
    try:
        options: list[Option] = connection.session.call(
            lambda: _members(_value_of(connection, before, request["scope"]), begun)
        )
        return options
    except _NothingError:
        return []


def _names(connection: Connection, begun: str) -> list[Option]:
    known: dict[str, object] = {**vars(builtins), **connection.session.namespace}
    names = [name for name in known if name.startswith(begun) and (begun.startswith("_") or name[0] != "_")]
    words = [word for word in keyword.kwlist if word.startswith(begun)]
    options = [_option(name, known[name]) for name in islice(sorted(names, key=_by_case), _MOST)]
    return options + [{"label": word, "kind": "keyword", "detail": "", "info": ""} for word in words]


def _by_case(name: str) -> tuple[bool, str]:
    return name[:1].isupper(), name


def _members(value: object, begun: str) -> list[Option]:
    names = [
        name for name in dir(value) if name.startswith(begun) and (begun.startswith("_") or name[0] != "_")
    ]
    options = []
    for name in names[:_MOST]:
        try:
            member = inspection.getattr_static(value, name)
            if not isinstance(member, property):
                member = getattr(value, name)
        except Exception:  # it is listed all the same
            member = None
        options.append(_option(name, member))
    return options


def _option(name: str, value: object) -> Option:
    if inspection.isclass(value):
        kind, detail = "class", ""
    elif inspection.ismodule(value):
        kind, detail = "namespace", ""
    elif callable(value):
        kind, detail = "function", _signature(value)
    elif isinstance(value, property):
        kind, detail = "property", ""
    else:
        kind, detail = "variable", "" if value is None else render(value)[:40]
    return {"label": name, "kind": kind, "detail": detail, "info": _doc(value) if callable(value) else ""}


def hover(connection: Connection, request: Hover) -> HoverView | None:
    """Say what a dotted name is, and its value now."""
    chain, scope = request["chain"], request["scope"]
    if keyword.iskeyword(chain):
        return None
    robot = chain.removeprefix("robot.")
    if robot != chain:
        try:
            member = connection.session.bridge.describe(robot)
        except LRPError:
            return None
        value = "" if member.kind == "method" else "waiting" if member.value is None else render(member.value)
        return {"title": chain + member.signature, "type": member.type, "value": value, "doc": member.doc}
    try:
        card: HoverView = connection.session.call(lambda: _card(chain, _value_of(connection, chain, scope)))
        return card
    except _NothingError:
        return None


def _card(title: str, value: object) -> HoverView:
    if callable(value):
        return {
            "title": title + _signature(value),
            "type": type(value).__name__,
            "value": "",
            "doc": _doc(value),
        }
    doc = _doc(value) if inspection.ismodule(value) else ""
    return {"title": title, "type": type(value).__name__, "value": render(value), "doc": doc}


def _signature(value: Callable[..., object]) -> str:
    try:
        return str(inspection.signature(value))
    except (TypeError, ValueError):
        return "(…)"


def _doc(value: object) -> str:
    try:
        return (inspection.getdoc(value) or "").partition("\n\n")[0][:300]
    except Exception:  # a strange object: no documentation
        return ""


def _value_of(connection: Connection, chain: str, scope: str) -> object:
    """Find what a dotted name means in the scope of a machine; between two ticks."""
    first, *rest = chain.split(".")
    value = _root(connection, first, scope)
    for name in rest:
        try:
            value = getattr(value, name)
        except Exception:
            raise _NothingError from None
    return value


def _root(connection: Connection, name: str, scope: str) -> object:
    session = connection.session
    path = _variable_in_scope(connection, name, scope)
    if path is not None:
        try:
            return session.interpreter.variables[path]
        except UnknownElementError:
            raise _NothingError from None
    if name == "robot":
        return session.bridge.robot
    for names in (session.namespace, vars(builtins)):
        if name in names:
            return names[name]
    raise _NothingError


def _variable_in_scope(connection: Connection, name: str, scope: str) -> Path | None:
    names = resolve(connection.session.program)
    here = names.by_path.get(tuple(scope.split("/")), names.top)
    owner = here.visible.get(name)
    return None if owner is None else (*owner.path, name)


# -- references ------------------------------------------------------------------------------------------


def references(connection: Connection, request: References) -> ReferencesView | None:
    """Say whose name stands at a place of the text."""
    text = connection.texts.text
    program, _ = scan(text)
    if program is None:
        raise LRPError("The text is not a program at the moment: names cannot be followed.")
    found = find_references(program, offset_of(text, request["line"], request["column"]))
    if found is None:
        return None
    definition = range_of(text, *found.definition)
    others = [range_of(text, *span) for span in found.references if span != found.definition]
    kind: Any = found.element.kind
    return {
        "kind": kind,
        "path": id_of(kind, found.element.path),
        "name": text[slice(*found.definition)],
        "definition": definition,
        "references": [definition, *others],
    }
