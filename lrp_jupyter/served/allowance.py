"""How much of something may come in a time."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic


class Allowance:
    """So much a second, and at most `most` at once."""

    def __init__(self, per_second: float, most: float, clock: Callable[[], float] = monotonic) -> None:
        self._per_second = per_second
        self._most = most
        self._clock = clock
        self._left, self._since = most, clock()

    @property
    def left(self) -> float:
        """How much may come now."""
        now = self._clock()
        self._left = min(self._most, self._left + (now - self._since) * self._per_second)
        self._since = now
        return self._left

    def take(self, amount: float = 1.0) -> bool:
        """Count what has come; return whether that was allowed."""
        allowed = self.left >= amount
        self._left -= amount
        return allowed
