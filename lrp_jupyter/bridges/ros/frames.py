"""The frames of a rosbridge server: JSON, or CBOR with packed arrays of numbers (RFC 8746), or fragments.

A topic with large arrays is subscribed to as CBOR, where the library `cbor2` is installed: the server packs
an array instead of writing a text of it, which takes a tenth of the time on either side.
"""

from __future__ import annotations

import json
import sys
from array import array
from collections.abc import Mapping
from typing import Any

_PACKED = {64: "B", 69: "H", 70: "I", 71: "Q", 72: "b", 77: "h", 78: "i", 79: "q", 85: "f", 86: "d"}
"""The tags of packed arrays with the type codes of Python; all are little-endian."""

_MOST = 8  # messages of which fragments are waited for


def knows_cbor() -> bool:
    """Return whether the library that reads CBOR is installed."""
    try:
        import cbor2  # noqa: F401
    except ImportError:
        return False
    return True


def decode(frame: str | bytes) -> Mapping[str, Any] | None:
    """Return a message, in which packed arrays are `array.array`; None for what is not a message."""
    try:
        message = json.loads(frame) if isinstance(frame, str) else _from_cbor(frame)
    except (ValueError, RecursionError):
        return None
    return message if isinstance(message, dict) else None


def _from_cbor(frame: bytes) -> Any:
    try:
        import cbor2
    except ImportError:
        return None
    try:
        return cbor2.loads(frame, tag_hook=_unpack)
    except cbor2.CBORDecodeError as error:
        raise ValueError(str(error)) from error


def _unpack(tag: Any, _immutable: bool) -> Any:
    code = _PACKED.get(tag.tag)
    if code is None:
        return tag.value
    numbers = array(code, tag.value)
    if sys.byteorder == "big":
        numbers.byteswap()
    return numbers


class Fragments:
    """Joins messages that are larger than the server's limit, and therefore come in parts."""

    def __init__(self) -> None:
        self._parts: dict[object, list[str]] = {}

    def join(self, message: Mapping[str, Any] | None) -> Mapping[str, Any] | None:
        """Return the whole message once its last fragment is there, and any other message as it is."""
        if message is None or message.get("op") != "fragment":
            return message
        key, number, total = message.get("id"), message.get("num"), message.get("total")
        if not isinstance(number, int) or not isinstance(total, (int, float)):
            return None
        parts = self._parts.setdefault(key, [])
        if number == 0:
            parts.clear()
        if number != len(parts):  # one is missing: the message cannot be joined
            self._parts.pop(key)
            return None
        parts.append(str(message.get("data", "")))
        if number + 1 < int(total):
            while len(self._parts) > _MOST:
                self._parts.pop(next(iter(self._parts)))
            return None
        return decode("".join(self._parts.pop(key)))
