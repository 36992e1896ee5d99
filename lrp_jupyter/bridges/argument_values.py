"""The values that a command is given: kept as they were then, and compared."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from copy import copy
from typing import Any


def kept(value: Any) -> Any:
    """Return a value that stays as it is when the program changes a list, an array, … in place."""
    try:
        return _kept(value)
    except RecursionError:  # it contains itself
        return value


def are_same(one: Any, other: Any) -> bool:
    """Return whether two values ask for the same; NaN is the same as NaN here."""
    try:
        if type(one) is type(other) is dict and one == other:  # soon told, of what is not an array
            return True
    except Exception:  # of arrays
        pass
    try:
        return _are_same(one, other)
    except Exception:  # of values that cannot be compared
        return False


def is_told(recorded: object) -> bool:
    """Return whether a recorded answer of a method is told with the arguments, as a pair."""
    return isinstance(recorded, tuple) and len(recorded) == 2 and isinstance(recorded[0], dict)


def answer_to(asked: Mapping[str, Any], recorded: Iterable[Any]) -> tuple[Mapping[str, Any], Any] | None:
    """Return the first recorded pair with the same arguments; None: there is none."""
    return next((each for each in recorded if is_told(each) and are_same(each[0], asked)), None)


def _kept(value: Any) -> Any:
    if type(value) is dict:
        return {name: _kept(each) for name, each in value.items()}
    if type(value) in (list, tuple):
        return type(value)(map(_kept, value))
    changes = isinstance(value, (dict, list, set)) or hasattr(type(value), "__array__")
    return copy(value) if changes else value


def _are_same(one: Any, other: Any) -> bool:
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(_are_same(one[name], other[name]) for name in one)
    if isinstance(one, (list, tuple)) and isinstance(other, (list, tuple)):
        return len(one) == len(other) and all(map(_are_same, one, other))
    equal = one == other
    if hasattr(equal, "all"):  # of arrays
        return bool(equal.all())
    return bool(equal) or bool(one != one and other != other)
