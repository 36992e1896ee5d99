"""The interfaces of clocks: what a session reads the time from, and waits for.

Times are floats, in seconds.
"""

from __future__ import annotations

from threading import Event
from typing import Protocol, runtime_checkable


@runtime_checkable
class Clock(Protocol):
    """The interface of a clock. Only the thread that drives the session calls it."""

    speed: float

    def now(self) -> float:
        """Return the seconds since the clock was created, without pauses; ``-inf``: it has not begun."""

    def sleep_until(self, t: float, wake: Event) -> None:
        """Wait until time `t`, or until `wake` is set."""

    def delay(self, t: float) -> float:
        """Return the wall seconds until `t`, 0 if it has passed; used by asyncio to wait."""

    def rebase(self, t: float) -> None:
        """Set the time to `t`."""

    def pause(self) -> None:
        """Stop the time; idempotent."""

    def resume(self) -> None:
        """Continue the time; idempotent."""


class WorldClock(Clock, Protocol):
    """The interface of the clock of a robot's world, which the world itself sets and may stop.

    A session that runs by it ticks at most once at each time that the clock shows.
    """

    @property
    def pace(self) -> float:
        """Seconds of the world per wall second, as it went lately; from any thread."""
