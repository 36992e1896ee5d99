"""Messages as texts in JSON: notebooks differ in what becomes of None and of subclasses of `str`."""

from __future__ import annotations

import json
from typing import Any


def packed(message: Any) -> str:
    """Return a message as a text that any notebook passes on as it is."""
    return json.dumps(message, separators=(",", ":"))


def unpacked(content: Any) -> Any:
    """Return the message that a page has sent through a notebook; what is none is refused later."""
    try:
        return json.loads(content["json"])
    except (LookupError, TypeError, ValueError, RecursionError):
        return content
