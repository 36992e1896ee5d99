"""The decoder of what a page sends: JSON, checked against annotations.

The code that receives a message need not expect a missing field, a text where a number belongs, or a number
that JSON should not contain.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from inspect import Parameter, signature
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints

from lrp_jupyter.errors import LRPError


class DecodeError(LRPError):
    """A JSON value does not have the form that it must have."""


@dataclass(frozen=True)
class Between:
    """The bounds of a number, both included."""

    low: float
    high: float


Fields = Mapping[str, tuple[Any, bool]]
"""The annotation of each field, and whether it is required."""

_COUNT = Between(0, 2**53)  # an int counts something; JavaScript cannot count further
_NUMBER = Between(-1e6, 1e6)
_LONGEST = 10_000  # items of a list


@cache
def fields_of(target: Callable[..., Any]) -> Fields:
    """Return the fields of which a class or function is made, or called with."""
    hints = get_type_hints(target, include_extras=True)
    return {
        name: (hints[name], parameter.default is Parameter.empty)
        for name, parameter in signature(target).parameters.items()
    }


def decode(fields: Fields, name: str, content: Mapping[str, object]) -> dict[str, Any]:
    """Return the fields of a JSON object, or raise a DecodeError, which calls it by this name."""
    values = {}
    for field, (hint, required) in fields.items():
        if field in content:
            values[field] = _checked(hint, content[field], f"`{field}` of `{name}`")
        elif required:
            raise DecodeError(f"`{name}` needs `{field}`.")
    return values


def _checked(hint: Any, value: object, where: str) -> Any:
    origin, arguments = get_origin(hint), get_args(hint)
    if origin is Annotated:
        return _number(arguments[0], arguments[1], value, where)
    if origin is Literal:
        if value in arguments:
            return value
        words = " or ".join(f"`{word}`" for word in arguments)
        raise DecodeError(f"{where} must be {words}, not {_shown(value)}.")
    if origin is UnionType and NoneType in arguments:
        return None if value is None else _checked(arguments[0], value, where)
    if origin is UnionType:
        first, second = arguments
        return _checked(second if isinstance(value, get_origin(second) or second) else first, value, where)
    if hint in (int, float):
        return _number(hint, _COUNT if hint is int else _NUMBER, value, where)
    if origin is list and isinstance(value, list) and len(value) <= _LONGEST:
        return [_checked(arguments[0], item, f"An item in {where}") for item in value]
    if origin is tuple and isinstance(value, (list, tuple)) and len(value) == len(arguments):
        return tuple(
            _checked(part, item, f"An item in {where}") for part, item in zip(arguments, value, strict=True)
        )
    if origin is dict and isinstance(value, dict) and all(isinstance(key, str) for key in value):
        return {key: _checked(arguments[1], item, f"An item in {where}") for key, item in value.items()}
    if hint in (str, bool) and isinstance(value, hint):
        return value
    raise DecodeError(f"{where} must be {_WORDS[origin or hint]}, not {_shown(value)}.")


_WORDS = {str: "a string", bool: "true or false", list: "a list", tuple: "a point", dict: "an object"}


def _number(kind: type, bounds: Between, value: object, where: str) -> int | float:
    whole = "a whole number" if kind is int else "a number"
    is_number = isinstance(value, int if kind is int else (int, float)) and not isinstance(value, bool)
    if is_number and not math.isnan(value) and bounds.low <= value <= bounds.high:  # type: ignore[arg-type,operator]
        return value  # type: ignore[return-value]
    limits = f"from {bounds.low:.16g} to {bounds.high:.16g}"
    raise DecodeError(f"{where} must be {whole} {limits}, not {_shown(value)}.")


def _shown(value: object) -> str:
    return f"`{str(value)[:40]}`"
