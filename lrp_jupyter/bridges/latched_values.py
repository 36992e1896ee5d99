"""The values that a bridge was fed, with their ages, latched tick by tick.

Owner: any thread feeds; the interpreter's thread latches. A value is replaced by one assignment, so no
reader waits for a writer.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from typing import NamedTuple


class _Fed(NamedTuple):
    value: object
    since: float  # when it was measured, by the clock


class FedValues:
    """The newest value of every variable that is fed, by its path.

    `clock`: returns the seconds that ages are measured in: by default `time.monotonic`; for a bridge with a
        clock, the time of its world. Tests set it.
    """

    def __init__(self, clock: Callable[[], float] | None = None) -> None:
        self.clock = time.monotonic if clock is None else clock
        self.wall_clock: Callable[[], float] = time.time  # what stamps are compared with; tests set it
        self.count = 0  # values that have arrived
        self._latest: dict[str, _Fed] = {}
        self._latched: dict[str, _Fed] | None = None  # None between ticks
        self._getters: dict[str, Callable[[], object]] = {}

    def getter(self, path: str) -> Callable[[], object]:
        """Return the function that returns the value of a variable; always the same one."""
        return self._getters.setdefault(path, partial(self.value, path))

    def put(self, path: str, value: object, stamp: float | None) -> None:
        """Replace a value; `stamp` is when it was measured, by the wall clock, if that is known."""
        late = 0.0 if stamp is None else max(0.0, self.wall_clock() - stamp)
        self._latest[path] = _Fed(value, self.clock() - late)
        self.count += 1

    def latch(self) -> None:
        """Hold the present values until `release`: a tick sees one world."""
        self._latched = self._latest.copy()

    def release(self) -> None:
        """Let readers see what is newest again."""
        self._latched = None

    def value(self, path: str) -> object:
        """Return a value; None before the first."""
        fed = self._seen(path)
        return None if fed is None else fed.value

    def age(self, path: str) -> float | None:
        """Return the seconds since a value was measured; None before the first."""
        fed = self._seen(path)
        return None if fed is None else max(0.0, self.clock() - fed.since)

    def clear(self) -> None:
        """Forget all values."""
        self._latest, self._latched = {}, None

    def _seen(self, path: str) -> _Fed | None:
        latched = self._latched
        return (self._latest if latched is None else latched).get(path)
