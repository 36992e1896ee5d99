"""Times: how old a message is by the robot's clock, and how often a program can use one.

Where the time of the robot's world arrives on `/clock`, all of it is that time, and so is the present one.

The age of a message follows from its time stamp, although the robot's clock is not this computer's. A message
cannot arrive before it is made. So the smallest difference between the time of arrival here and the stamp,
among all messages of the robot, is that of the two clocks, and the shortest way. Whatever a message has
beyond that is its age: time that it spent in a queue or in a slow network. What every message spends on its
way, i.e. half a round trip, cannot be seen.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Mapping
from statistics import median
from typing import Any, Protocol

_SIMULATED = 1e8  # seconds; clocks of simulations begin at 0 and may run at another speed
_OTHER = 60.0  # seconds; a stamp that is so old is of another clock, or recorded
_BACK = 1.0  # seconds by which a clock must be off to have been set
_SET_BACK = 10.0  # seconds with stamps that are lower than an earlier one
_PACES = (0.0, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1)  # seconds
_DRIFT = 1e-4  # seconds per second by which two clocks may drift apart


class WorldTime(Protocol):
    """The interface of the time of the robot's world; see `SimTime`."""

    @property
    def elapsed(self) -> float:
        """The seconds that have passed."""

    @property
    def stamp(self) -> int | None:
        """The time now, in ns; None while it is not known."""

    def made_at(self, stamp: int) -> float:
        """Return which `elapsed` belongs to a time stamp, in ns."""


class RobotClock:
    """Relates the robot's clock to `time.monotonic` here; for any thread.

    `world`: where the time comes from instead, if it is simulated.
    """

    def __init__(self) -> None:
        self.world: WorldTime | None = None
        self._lock = threading.Lock()
        self.reset()

    def now(self) -> float:
        """Return the seconds that ages are measured in."""
        return time.monotonic() if self.world is None else self.world.elapsed

    def time_ns(self) -> int:
        """Return the time of ROS, in ns: that of the robot's world, or else of this computer."""
        stamp = None if self.world is None else self.world.stamp
        return time.time_ns() if stamp is None else stamp

    def reset(self) -> None:
        """Forget what was learned."""
        self._offset: float | None = None
        self._at = 0.0

    def made_at(self, stamp: float | None, now: float) -> float:
        """Return when a message was made, in seconds of `time.monotonic`.

        `stamp`: its time stamp in seconds; None or 0: it has none, and was made now.
        `now`: when it arrived.
        """
        if not stamp or stamp < _SIMULATED:
            return now
        with self._lock:
            difference, offset = now - stamp, self._offset
            if offset is None or difference < offset:
                self._offset, self._at = difference, now
                return now
            self._offset = offset = offset + _DRIFT * max(0.0, now - self._at)
            self._at = now
            age = max(0.0, difference - offset)
        return now if age > _OTHER else now - age

    def read(self, stamp: float | None, now: float) -> None:
        """Note what the robot's clock shows now; it may have been set back since."""
        self.made_at(stamp, now)
        if stamp and stamp >= _SIMULATED:
            with self._lock:
                if self._offset is not None and now - stamp > self._offset + _BACK:
                    self._offset, self._at = now - stamp, now


class Stamps:
    """The time stamps of one topic."""

    def __init__(self, clock: RobotClock) -> None:
        self._clock = clock
        self._highest = 0.0
        self._since = 0.0

    def made_at(self, message: Any, now: float) -> float:
        """Return when a raw message was made, in seconds of `time.monotonic`.

        Old messages come with higher and higher stamps, too. So a topic whose stamps stay below an earlier
        one is of a clock that was set back.
        """
        if (world := self._clock.world) is not None:
            made = nanoseconds_of(message)
            return world.made_at(made) if made else now
        stamp = stamp_of(message)
        if stamp is not None and stamp < self._highest - _BACK:
            if now - self._since > _SET_BACK:
                self._clock.reset()
                self._highest = stamp
        elif stamp is not None:
            self._highest, self._since = max(stamp, self._highest), now
        return self._clock.made_at(stamp, now)


def stamp_of(message: Any) -> float | None:
    """Return the time stamp in the header of a raw message, in seconds; None where it has none."""
    stamp = nanoseconds_of(message)
    return None if stamp is None else stamp / 1_000_000_000


def nanoseconds_of(message: Any, field: str = "") -> int | None:
    """Return a field with a time, by default the stamp of the header, in ns; None where there is none."""
    stamp = _part(message, field) if field else _part(_part(message, "header"), "stamp")
    whole, rest = _part(stamp, "secs", "sec"), _part(stamp, "nsecs", "nanosec")
    if isinstance(whole, int) and isinstance(rest, int):
        return whole * 1_000_000_000 + rest
    return None


def _part(value: Any, *names: str) -> Any:
    """Return a field of a dictionary or an object, under one of its names."""
    for name in names:
        found = value.get(name) if isinstance(value, Mapping) else getattr(value, name, None)
        if found is not None:
            return found
    return None


class ProgramPace:
    """How often a program can use a new message: twice in a tick.

    Measured, since a program may run faster or slower than its robot's world.
    """

    def __init__(self) -> None:
        self.seconds = 0.02  # one of a few values, so that a tick that comes late changes nothing
        self._last: float | None = None
        self._gaps: deque[float] = deque(maxlen=9)

    def tick(self) -> None:
        """Note that a tick begins."""
        now = time.monotonic()
        if self._last is not None:
            self._gaps.append(now - self._last)
        self._last = now
        if len(self._gaps) == self._gaps.maxlen:
            wanted = 1.1 * median(self._gaps) / 2  # a little more: ticks are not exact
            self.seconds = max(pace for pace in _PACES if pace <= wanted)
