"""Plain data that a program may have written: what is not as expected raises TypeError or ValueError."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from lrp_jupyter.errors import printable

_LONGEST = 10_000  # characters of a text


def text_in(value: object) -> str:
    """Return a text without what a terminal obeys and no file can hold."""
    if not isinstance(value, str):
        raise TypeError("This is not a text.")
    return printable(value[:_LONGEST], "\n\t")


def number_in(value: Any, *kinds: type) -> Any:
    """Return a number that can be shown; by default of either kind."""
    if type(value) not in (kinds or (int, float)) or not -1e15 < value < 1e15:
        raise TypeError("This is not a number that can be shown.")
    return value


def share_in(value: Any) -> Any:
    """Return a number between 0 and 1."""
    return min(1, max(0, number_in(value)))


def one_of(value: Any, values: Sequence[Any]) -> Any:
    """Return one of some values."""
    return values[values.index(value)]  # a ValueError: it is none of them
