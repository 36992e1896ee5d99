"""What arrives by itself, latched tick by tick: the newest value of a reading, and all since the last tick.

Owner: any thread puts and reads; the interpreter's thread latches. No reader waits for a writer.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Collection
from functools import partial
from typing import Generic, NamedTuple, TypeVar

MOST = 1000
"""Messages of a reading that a tick takes; of more, the last ones."""

T = TypeVar("T")


class Arrival(NamedTuple, Generic[T]):
    """A value, and when it was measured, by the clock of its bridge."""

    value: T
    time: float


class Arrivals(Generic[T]):
    """What arrives for one reading.

    Every message is kept only while the program takes them: nothing is paid for what is not used.

    `last`: the newest; None before the first.
    `dropped`: how many messages were dropped before the last tick, since there were more than it takes.
    """

    def __init__(self, lock: threading.RLock | None = None) -> None:
        self.last: Arrival[T] | None = None
        self.dropped = 0
        self._lock = lock or threading.RLock()
        self._latched: tuple[Arrival[T] | None, tuple[T, ...]] = None, ()
        self._old: Arrival[T] | None = None  # that the last tick saw, or that is no news for another reason
        self._waiting: deque[T] | None = None  # for the next tick; None: messages are not kept
        self._overflow = 0

    def put(self, value: T, at: float, is_news: bool = True) -> None:
        """Replace the value, measured at a time; one that is no news is no message."""
        with self._lock:
            self.last = Arrival(value, at)
            if not is_news:
                self._old = self.last
            elif self._waiting is not None:
                self._overflow += len(self._waiting) == MOST
                self._waiting.append(value)

    @property
    def is_heard(self) -> bool:
        """Whether every message is kept."""
        return self._waiting is not None

    def hear(self, every: bool) -> None:
        """Keep every message from now on, or only the newest value."""
        with self._lock:
            if not every:
                self._waiting = None
            elif self._waiting is None:
                last = self.last
                self._waiting = deque(() if last is None or last is self._old else (last.value,), MOST)

    def latch(self) -> None:
        """Hold what there is for the tick that begins: it sees one world."""
        with self._lock:
            self._latched, self._old = (self.last, tuple(self._waiting or ())), self.last
            self.dropped, self._overflow = self._overflow, 0
            if self._waiting:
                self._waiting.clear()

    def seen(self, in_tick: bool) -> Arrival[T] | None:
        """Return the value of the tick; between ticks, the newest."""
        return self._latched[0] if in_tick else self.last

    def messages(self, in_tick: bool) -> tuple[T, ...]:
        """Return those of the tick; between ticks, those that wait for the next one."""
        if in_tick:
            return self._latched[1]
        with self._lock:
            return tuple(self._waiting or ())

    def clear(self) -> None:
        """Forget all values."""
        with self._lock:
            self.last, self._latched = None, (None, ())
            if self._waiting:
                self._waiting.clear()


class FedValues:
    """What every variable was fed, by its path.

    `clock`: returns the seconds that ages are measured in: by default `time.monotonic`; for a bridge with a
        clock, the time of its world. Tests set it.
    `in_tick`: returns whether a tick is under way.
    """

    def __init__(self, clock: Callable[[], float] | None, in_tick: Callable[[], bool]) -> None:
        self.clock = time.monotonic if clock is None else clock
        self.wall_clock: Callable[[], float] = time.time  # what stamps are compared with; tests set it
        self.count = 0  # values that have arrived
        self._in_tick = in_tick
        self._lock = threading.RLock()  # of all, so that a tick sees nothing that is newer than the rest
        self._all: dict[str, Arrivals[object]] = {}
        self._getters: dict[str, Callable[[], object]] = {}

    def getter(self, path: str) -> Callable[[], object]:
        """Return the function that returns the value of a variable; always the same one."""
        return self._getters.setdefault(path, partial(self.value, path))

    def of(self, path: str) -> Arrivals[object]:
        """Return what arrives for a variable; always the same object."""
        known = self._all.get(path)
        if known is not None:  # no lock: who reads does not wait
            return known
        with self._lock:
            return self._all.setdefault(path, Arrivals(self._lock))

    def put(self, path: str, value: object, stamp: float | None) -> None:
        """Replace a value; `stamp` is when it was measured, by the wall clock, if that is known."""
        late = 0.0 if stamp is None else max(0.0, self.wall_clock() - stamp)
        self.of(path).put(value, self.clock() - late)
        self.count += 1

    def hear(self, paths: Collection[str]) -> None:
        """Keep every message of these variables from now on, and no others."""
        for path in {*self._all, *paths}:
            self.of(path).hear(path in paths)

    def latch(self) -> None:
        """Hold what there is for the tick that begins."""
        with self._lock:
            for each in self._all.values():
                each.latch()

    def value(self, path: str) -> object:
        """Return a value; None before the first."""
        seen = self.of(path).seen(self._in_tick())
        return None if seen is None else seen.value

    def age(self, path: str) -> float | None:
        """Return the seconds since a value was measured; None before the first."""
        seen = self.of(path).seen(self._in_tick())
        return None if seen is None else max(0.0, self.clock() - seen.time)

    def clear(self) -> None:
        """Forget all values."""
        with self._lock:
            for each in self._all.values():
                each.clear()
