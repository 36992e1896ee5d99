"""The values that a bridge was fed, with their ages, latched tick by tick; and messages until the next tick.

Owner: any thread feeds; the interpreter's thread latches. A value is replaced by one assignment, so no
reader waits for a writer.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Iterable
from functools import partial
from typing import NamedTuple

MOST = 1000
"""Messages of a reading that a tick takes; of more, the last ones."""


class Backlog:
    """The messages of one reading since the last tick, oldest first.

    Kept only while the program takes them: nothing is paid for what is not used.

    `dropped`: how many were dropped before the last tick, since there were more than it takes.
    """

    def __init__(self, first: Iterable[object] = ()) -> None:
        self.dropped = 0
        self._lock = threading.Lock()
        self._waiting = deque(first, MOST)
        self._overflow = 0
        self._latched: tuple[object, ...] | None = None  # None between ticks

    def put(self, message: object) -> None:
        """Add a message; on any thread."""
        with self._lock:
            self._overflow += len(self._waiting) == MOST
            self._waiting.append(message)

    def latch(self) -> None:
        """Take what has come since the last tick."""
        empty: deque[object] = deque(maxlen=MOST)
        with self._lock:
            waiting, self._waiting = self._waiting, empty
            self.dropped, self._overflow = self._overflow, 0
        self._latched = tuple(waiting)

    def release(self) -> None:
        """Let readers see what waits for the next tick."""
        self._latched = None

    def messages(self) -> tuple[object, ...]:
        """Return those of this tick; between ticks, those that wait for the next one."""
        if self._latched is not None:
            return self._latched
        with self._lock:
            return tuple(self._waiting)


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
        self._last: dict[str, _Fed] = {}  # what the last tick saw
        self._backlogs: dict[str, Backlog] = {}
        self._getters: dict[str, Callable[[], object]] = {}

    def getter(self, path: str) -> Callable[[], object]:
        """Return the function that returns the value of a variable; always the same one."""
        return self._getters.setdefault(path, partial(self.value, path))

    def put(self, path: str, value: object, stamp: float | None) -> None:
        """Replace a value; `stamp` is when it was measured, by the wall clock, if that is known."""
        late = 0.0 if stamp is None else max(0.0, self.wall_clock() - stamp)
        self._latest[path] = _Fed(value, self.clock() - late)
        self.count += 1
        backlog = self._backlogs.get(path)
        if backlog is not None:
            backlog.put(value)

    def hear(self, paths: Iterable[str]) -> None:
        """Keep every message of these variables from now on, and no others."""
        known, latest = self._backlogs, self._latest
        fresh = {path: fed.value for path, fed in latest.items() if fed is not self._last.get(path)}
        self._backlogs = {
            path: known.get(path) or Backlog([fresh[path]] if path in fresh else []) for path in paths
        }

    def backlog(self, path: str) -> Backlog | None:
        """Return the messages of a variable, if they are kept."""
        return self._backlogs.get(path)

    def latch(self) -> None:
        """Hold the present values until `release`: a tick sees one world."""
        self._latched = self._last = self._latest.copy()
        for backlog in self._backlogs.values():
            backlog.latch()

    def release(self) -> None:
        """Let readers see what is newest again."""
        self._latched = None
        for backlog in self._backlogs.values():
            backlog.release()

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
        self._latest, self._latched, self._last = {}, None, {}
        self._backlogs = {path: Backlog() for path in self._backlogs}

    def _seen(self, path: str) -> _Fed | None:
        latched = self._latched
        return (self._latest if latched is None else latched).get(path)
