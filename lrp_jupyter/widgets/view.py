"""One picture of a lab in a page, as the kernel knows it: what it was sent, and how much it may be sent."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from typing import Any

from lrp_jupyter.widgets.sight import Look

__all__ = ["WINDOW", "Send", "View"]

WINDOW = 3
"""Frames that may be on their way to a view."""

_PER_SECOND = 30.0
_BURST = 3.0
_GONE_AFTER = 15.0  # s without a credit while the window is full

Send = Callable[[Any, "list[bytes] | None"], None]


class View:
    """What has been sent to one view, and its credit.

    Parameters
    ----------
    name : str
        The page made it up.
    part : str
        Which part of the lab it shows.
    send : callable
        Sends a message (and buffers) on the comm of its widget.
    now : float
        Seconds on the wall.
    """

    def __init__(self, name: str, part: str, send: Send, now: float) -> None:
        self.name = name
        self.part = part
        self.sent: Look = {}
        self.scene: object = None
        self.picture: object = None
        self.marks = 0
        self.strokes = 0
        self.framed = self.drawn = float("-inf")  # when the last frame, the last world was sent
        self.fault = ""
        """The traceback of a message that could not be sent."""
        self._send = send
        self._number = 0
        self._on_their_way: set[int] = set()
        self._heard = now
        self._tokens = (_BURST, now)

    @property
    def shows_world(self) -> bool:
        """Whether poses are of use to it."""
        return self.part in ("lab", "world")

    @property
    def has_credit(self) -> bool:
        """Whether frames may be sent."""
        return len(self._on_their_way) < WINDOW

    def credit(self, number: int, now: float) -> None:
        """Take back the credit for a frame, and for all before it: they come in order."""
        self._on_their_way = {other for other in self._on_their_way if other > number}
        self._heard = now

    def is_gone(self, now: float) -> bool:
        """Whether it cannot be reached, or has been silent for so long that nobody can be there."""
        return bool(self.fault) or (not self.has_credit and now - self._heard > _GONE_AFTER)

    def may(self, now: float) -> bool:
        """Whether a frame may be sent now: there is credit, and not too much came before."""
        tokens, since = self._tokens
        self._tokens = min(_BURST, tokens + (now - since) * _PER_SECOND), now
        return self.has_credit and self._tokens[0] >= 1.0

    def number(self) -> int:
        """Give a number to the next frame, and count it as sent."""
        self._number += 1
        self._on_their_way.add(self._number)
        tokens, since = self._tokens
        self._tokens = tokens - 1.0, since
        return self._number

    def forget_world(self) -> None:
        """Count nothing of the world as known: poses and ink come anew."""
        self.marks = self.strokes = 0
        self.picture = None

    def send(self, message: Any, buffers: list[bytes] | None = None) -> None:
        """Send a message to this view; one that fails is no reason to tell the others nothing."""
        try:
            self._send({**message, "view": self.name}, buffers)
        except Exception:
            self.fault = traceback.format_exc()
