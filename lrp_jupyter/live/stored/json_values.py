"""Values as JSON: readings, and the arguments of commands, in recordings and traces."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from lrp_jupyter.bridges.scans import Scanned
from lrp_jupyter.errors import BridgeError, NoDataYet
from lrp_jupyter.interpreter.rendering import render


def plain(value: object) -> Any:
    """Return a reading, or an argument of a command, as JSON.

    A value without a JSON type becomes an object with its kind as the only key, ``{"tuple": [1, 2]}``; the
    parts of an object keep their names.
    """
    if value is None or type(value) in (bool, int, str):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else {"float": repr(value)}
    if isinstance(value, (int, str)):
        return value.real if isinstance(value, int) else str(value)
    if isinstance(value, NoDataYet):
        return {"no data": str(value)}
    if isinstance(value, Exception):
        return {"error": str(value)}
    if isinstance(value, Mapping):
        if all(isinstance(key, str) for key in value):
            return {"dict": {str(key): plain(part) for key, part in value.items()}}
        return {"items": [[plain(key), plain(part)] for key, part in value.items()]}
    parts = getattr(value, "_fields", None)
    if isinstance(value, (list, tuple)) and parts is None:
        items = [plain(part) for part in value]
        return items if isinstance(value, list) else {"tuple": items}
    if parts is None:
        slots = getattr(type(value), "__slots__", ())
        parts = [*((slots,) if isinstance(slots, str) else slots), *getattr(value, "__dict__", ())]
    public = [name for name in parts if not name.startswith("_") and hasattr(value, name)]
    is_empty = isinstance(value, Fields) or getattr(type(value), "__slots__", None) == ()
    if not (public or is_empty):  # a message may have no fields
        return {"text": render(value)}
    return {"fields": {name: plain(getattr(value, name)) for name in public}}


class Fields:
    """An object in a reading, with its recorded fields."""

    def __init__(self, fields: Mapping[str, Any]) -> None:
        vars(self).update(fields)

    def __repr__(self) -> str:
        return f"({', '.join(f'{name}={value!r}' for name, value in vars(self).items())})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Fields) and vars(self) == vars(other)

    def __hash__(self) -> int:
        return hash(tuple(vars(self)))


class ScanFields(Scanned, Fields):
    """The recorded fields of a scan."""


_SCAN = {"angle_min", "angle_increment", "range_min", "range_max", "ranges"}


def unplain(value: Any) -> Any:
    """Return the value that :func:`plain` converted; an object has only its fields."""
    if isinstance(value, list):
        return [unplain(part) for part in value]
    if not isinstance(value, dict):
        return value
    ((kind, content),) = value.items()
    match kind:
        case "float":
            return float(content)
        case "no data":
            return NoDataYet(content)
        case "error":
            return BridgeError(content)
        case "tuple":
            return tuple(unplain(part) for part in content)
        case "dict":
            return {key: unplain(part) for key, part in content.items()}
        case "items":
            return {unplain(key): unplain(part) for key, part in content}
        case "fields":
            kind = ScanFields if content.keys() >= _SCAN else Fields
            return kind({name: unplain(part) for name, part in content.items()})
    return content
