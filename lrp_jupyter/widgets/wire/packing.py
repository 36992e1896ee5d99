"""Messages as JSON texts, because notebooks treat None and subclasses of `str` differently."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any

from lrp_jupyter.language.program import path_text


def packed(message: Any) -> str:
    """Return a message as a text that every notebook passes on unchanged."""
    return json.dumps(message, separators=(",", ":"), default=as_fields)


def as_fields(value: Any) -> dict[str, Any]:
    """Return a dataclass as its fields in plain data, without those that its `repr` hides."""
    kind: Any = type(value)
    return {name: write(getattr(value, name)) for name, write in _writers(kind)}


@cache
def _writers(kind: Any) -> list[tuple[str, Callable[[Any], Any]]]:
    return [(field.name, _WRITERS.get(field.type, plain)) for field in fields(kind) if field.repr]


def plain(value: Any) -> Any:
    """Return a value as plain data, rounded: no page shows more, and a plot is a third shorter."""
    kind = type(value)
    if kind is float:
        return round(value, 4 if abs(value) >= 0.01 else 8)
    if kind is tuple or kind is list:
        return [plain(each) for each in value]
    if kind is dict:
        return {key: plain(each) for key, each in value.items()}
    return as_fields(value) if is_dataclass(kind) else value


_WRITERS: dict[Any, Callable[[Any], Any]] = {"Path": path_text}
"""How fields of some types are written."""


def unpacked(content: Any) -> Any:
    """Return the message that a page has sent through a notebook; anything else is refused later."""
    try:
        return json.loads(content["json"])
    except (LookupError, TypeError, ValueError, RecursionError):
        return content
