"""Definitions of message types from the text of ``.msg`` files, as ROS 1 and ROS 2 write them.

A text may contain the types that it uses, each below a line of ``=`` and ``MSG: package/Type``, as in bag
files and in rosapi's raw types. Constants and default values are read over: a message that a program
fills begins with zeros everywhere.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from lrp_jupyter.bridges.ros.definitions import PRIMITIVES, Definition, FieldType, canonical, parse_field
from lrp_jupyter.errors import BridgeError

_SECTION = re.compile(r"^={10,}\s*\nMSG: *(\S+) *$", re.MULTILINE)
_LINE = re.compile(r"(?P<type>[^\s=#]\S*)\s+(?P<name>[A-Za-z]\w*)\s*(?P<rest>[=#].*|\s\S.*)?$")
_PLAIN = {"time", "duration"}  # of ROS 1: neither primitive nor in a package


def definitions_from_text(type_: str, text: str) -> dict[str, Definition]:
    """Read the definition of a type, and those of the types below it in the same text.

    `type_`: name of the first one; a type in its fields without a package is of the same package.
    Raises BridgeError: a line is neither a field nor a constant; the message contains it with its number.
    """
    first, *rest = _SECTION.split(text)
    sections = [(type_, first), *zip(rest[::2], rest[1::2], strict=True)]
    found = {}
    for name, lines in sections:
        short = canonical(name)
        found[short] = Definition(short, dict(_fields(short, lines)))
    return found


def _fields(type_: str, text: str) -> Iterator[tuple[str, FieldType]]:
    for number, line in enumerate(text.splitlines(), 1):
        bare = line.strip()
        if not bare or bare.startswith("#"):
            continue
        found = _LINE.match(bare)
        try:
            if found is None:
                raise BridgeError("Write `type name`, like `float64 x`.")
            kind = parse_field(found["type"])
        except BridgeError as error:
            raise BridgeError(f"`{type_}`, line {number}: `{bare}` cannot be read. {error}") from None
        if not (found["rest"] or "").startswith("="):
            yield found["name"], FieldType(_resolved(kind.base, type_), kind.length)


def _resolved(base: str, type_: str) -> str:
    """Return the full name of a type in a field of another type."""
    if "/" in base or base in PRIMITIVES or base in _PLAIN:
        return base
    return "std_msgs/Header" if base == "Header" else f"{type_.partition('/')[0]}/{base}"
