"""The message that a latched topic keeps for those who come later."""

from __future__ import annotations

import time
from typing import Any

_COMES_AGAIN = 0.5  # seconds after a change of a subscription in which the kept message may come again


class LastMessage:
    """The last message of a topic: for a variable that comes later, and where the robot sends it again.

    A topic that keeps its last message sends it to every new subscription. One that only replaces another,
    so that it has other properties, has had it already: it does not count twice.
    """

    def __init__(self) -> None:
        self.raw: Any = None
        self.at = 0.0  # when it arrived, by `time.monotonic`
        self._copies, self._until = 0, 0.0  # how many may still come, and until when

    def renew(self) -> None:
        """Note that the subscription is being replaced."""
        now = time.monotonic()
        self._copies = (self._copies if now < self._until else 0) + (self.raw is not None)
        self._until = now + _COMES_AGAIN

    def is_news(self, raw: Any) -> bool:
        """Take a message that arrives; return whether it has not been had before."""
        last, self.raw, self.at = self.raw, raw, time.monotonic()
        is_copy = self._copies > 0 and self.at < self._until and raw == last
        self._copies = self._copies - 1 if is_copy else 0
        return not is_copy
