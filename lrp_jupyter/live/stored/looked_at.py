"""What a person looked at and did, in a recording; not inputs of the run, so a replay skips it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from lrp_jupyter.errors import FileError
from lrp_jupyter.interpreter.rendering import short

_FIELDS = ("tick", "time", "wall", "look", "about", "on")
_TYPES: dict[str, type | tuple[type, ...]] = {"wall": (int, float), "look": str, "about": str, "on": bool}


class Look(NamedTuple):
    """A person started (`on`) or stopped looking at something, or did something.

    `wall`: seconds since the recording began.
    `what`: its kind: ``why``, ``hover``, ``playhead``, ``command``, …
    """

    tick: int
    time: float
    wall: float
    what: str
    about: str
    on: bool = True

    def line(self) -> dict[str, Any]:
        """Return its line of a recording."""
        return dict(zip(_FIELDS, self, strict=True))


def look_of(line: Mapping[str, Any], tick: int, time: float) -> Look:
    """Return the :class:`Look` of a line, or raise FileError if a field has a wrong type."""
    for name, kinds in _TYPES.items():
        if not isinstance(line[name], kinds):
            raise FileError(f"The field `{name}` is wrong: it is {short(line[name])}.")
    return Look(tick, time, float(line["wall"]), line["look"], line["about"], line["on"])
