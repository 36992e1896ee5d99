"""How often the messages of a topic come, and after which silence something must be wrong.

A topic is steady once enough messages came without a pause. From then on, a silence that is a second longer
than twice its longest pause of the last minutes is one too long: that forgives a lost message at any pace,
and some delay. Pauses count even if they were too long, so the same one does not stop a robot a second time.

A button, a map or an order never gets that far: it pauses. A joystick that is moved all the time may, and
then its next rest is one too long, once. An odometry that is published only while the robot moves ceases as
that comes to rest: such a silence counts from when the robot moves again.

Owner: the thread on which messages arrive; any other may read.
"""

from __future__ import annotations

import math
from collections import deque

_ENOUGH = 20  # messages without a pause …
_STEADY = 3.0  # … for so many seconds: of events, they would be a long burst
_PAUSE = 0.5  # seconds; a pause is longer than this, and than twice the mean of what came without one
_SLACK = 1.0  # seconds
_RECENT = 600.0  # seconds for which a pause counts
_BEFORE, _AFTER = 1.0, 3.0  # seconds around a stop in which a topic ceases because of it: a robot coasts


class Rhythm:
    """The times at which messages came, in seconds of one clock."""

    def __init__(self) -> None:
        self.is_steady = False
        self.longest = 0.0  # recent pause in seconds
        self._times: deque[float] = deque(maxlen=20)
        self._began, self._count, self._last = 0.0, 0, float("-inf")  # of what came without a pause
        self._pauses: deque[tuple[float, float]] = deque()  # with when they ended: the longest of each rest

    @property
    def last(self) -> float | None:
        """When the last message came; None before the first."""
        times = self._times
        return times[-1] if times else None

    def note(self, now: float, has_reason: bool = False) -> None:
        """Note that a message has come; `has_reason`: the pause before it was none of the topic."""
        before = self.last
        pause = 0.0 if before is None else now - before
        if (has_reason and pause > max(_PAUSE, 2 * self.longest)) or not 0 <= pause < _RECENT:
            self.interrupt()
            before = None
        self._times.append(now)
        if before is None:
            self._began, self._count = now, 0
            return
        self._count += 1
        self._remember(now, pause)
        if self.is_steady:
            return
        mean = (now - self._began) / self._count
        if self.longest > max(_PAUSE, 2 * mean):
            self._began, self._count = now, 0
            self._pauses.clear()
        self.is_steady = self._count >= _ENOUGH and now - self._began >= _STEADY

    def _remember(self, now: float, pause: float) -> None:
        pauses = self._pauses
        while pauses and pauses[-1][1] <= pause:
            pauses.pop()
        pauses.append((now, pause))
        while pauses[0][0] < now - _RECENT:
            pauses.popleft()
        self.longest = pauses[0][1]

    def interrupt(self) -> None:
        """Count the silence that begins as no pause of the topic: the robot cannot be reached."""
        self._times.clear()

    @property
    def period(self) -> float | None:
        """Recent seconds from one message to the next; None where that is not known."""
        times = list(self._times)
        return (times[-1] - times[0]) / (len(times) - 1) if len(times) > 1 and times[-1] > times[0] else None

    def rate(self, now: float) -> float:
        """Return the recent messages per second; 0 when they have ceased."""
        period, last = self.period, self.last
        if period is None or last is None or now - last > max(1.0, 5 * period):
            return 0.0
        return 1 / period

    @property
    def patience(self) -> float | None:
        """The seconds of a silence that is not too long; None: the topic is not steady."""
        return _SLACK + 2 * self.longest if self.is_steady else None


class Motion:
    """When the robot was set in motion, and stopped, by the clock of a topic."""

    def __init__(self) -> None:
        self._moves = False
        self._began = self._ended = float("-inf")

    def note(self, moves: bool, now: float) -> None:
        """Note in each tick whether a command moves it."""
        if moves and not self._moves:
            self._began = now
        elif self._moves and not moves:
            self._ended = now
        self._moves = moves

    def excused(self, last: float | None) -> float:
        """Return the seconds of a silence, since a message came last, that do not count; inf: none does."""
        if last is None or not self._ended - _BEFORE <= last <= self._ended + _AFTER:
            return 0.0
        return max(0.0, self._began - last) if self._moves else math.inf
