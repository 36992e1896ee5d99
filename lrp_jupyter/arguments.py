"""Checks of arguments: a mistake is one sentence, where it is made."""

from __future__ import annotations

import math
from collections.abc import Iterable
from numbers import Real
from typing import Any

from lrp_jupyter.errors import did_you_mean

A_PROGRAM = "a Program, which `parse(text)` makes of a text"  # what a program is, for `check_type`


def check_type(name: str, value: object, kind: type | tuple[type, ...], what: str) -> None:
    """Raise a TypeError unless an argument is `what`, such as ``a text``; a truth value is not a number."""
    if not isinstance(value, kind) or isinstance(value, (bool, type)):
        raise TypeError(f"`{name}` must be {what}, not {_kind(value)}.")


def check_switch(name: str, value: object) -> None:
    """Raise a TypeError if an argument is not a truth value."""
    if not isinstance(value, bool):
        raise TypeError(f"`{name}` must be True or False, not {_kind(value)}.")


def check_callable(name: str, value: object) -> None:
    """Raise a TypeError if an argument cannot be called."""
    if not callable(value):
        raise TypeError(f"`{name}` must be a function, not {_kind(value)}.")


def check_choice(name: str, value: object, choices: Iterable[str]) -> None:
    """Raise a ValueError if an argument is not one of some words."""
    known = list(choices)
    if value not in known:
        listed = " or ".join(f"`{choice}`" for choice in known)
        shown = f"`{value}`" if isinstance(value, str) else _kind(value)
        raise ValueError(f"`{name}` must be {listed}, not {shown}.{did_you_mean(str(value), known)}")


def check_number(
    name: str, value: Any, what: str, *, above: float = -math.inf, least: float = -math.inf
) -> None:
    """Raise an error if an argument is not a number, or too small.

    `what`: what the argument is, in words: ``a number of seconds``.
    `above`, `least`: the number must be greater than `above`, and not less than `least`.
    """
    check_type(name, value, Real, what)
    if not (value > above and value >= least):
        limit = f" above {above:g}" if above > -math.inf else f", {least:g} or more"
        raise ValueError(f"`{name}` must be {what}{limit}, not {value!r}.")


def _kind(value: object) -> str:
    if isinstance(value, type):
        return f"the class {value.__name__}"
    return "None" if value is None else type(value).__name__
