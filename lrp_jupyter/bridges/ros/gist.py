"""A ROS message in a line, for a person to read at a glance."""

from __future__ import annotations

import reprlib
from collections.abc import Iterator, Mapping
from itertools import islice

from lrp_jupyter.bridges.ros.types import Reading, RosMessage

__all__ = ["gist"]

_MOST = 6  # fields
_short = reprlib.Repr()
_short.maxother = _short.maxstring = 120


def gist(message: Reading | RosMessage) -> str:
    """Write what a message says: the place of an odometry, the one value of a simple message.

    Of others the fields that are not zero. Headers and covariances say nothing at a glance.
    """
    fields = message._as_dict() if isinstance(message, Reading) else message.as_dict()
    short = [name for name in type(message).__slots__ if name not in fields]
    leaves = {name: getattr(message, name) for name in short} or dict(_leaves(fields))
    if len(leaves) == 1:
        return _text(*leaves.values())
    told = leaves if short else {name: value for name, value in leaves.items() if value} or leaves
    return ", ".join(f"{name}={_text(value)}" for name, value in islice(told.items(), _MOST))


def _leaves(fields: Mapping[str, object], path: str = "") -> Iterator[tuple[str, object]]:
    for name, value in fields.items():
        if isinstance(value, Mapping):
            if name != "header":
                yield from _leaves(value, f"{path}{name}.")
        elif name != "covariance":
            yield f"{path}{name}", value


def _text(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else _short.repr(value)
