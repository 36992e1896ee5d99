"""The time of a robot's world, as `/clock` tells it: of a simulation, or of a bag that is played.

It may pass faster or slower than that of the wall, stand, and go back. A session runs by it, and so do the
ages of messages: `elapsed` only goes forward, and what is stamped is compared with the last message.
"""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable
from threading import Event
from typing import Any, NamedTuple

from lrp_jupyter.bridges.ros.channel import Channel
from lrp_jupyter.bridges.ros.clock import nanoseconds_of
from lrp_jupyter.bridges.ros.definitions import CLOCK
from lrp_jupyter.bridges.ros.setup import Wire

TOPIC = "/clock"

_SECOND = 1_000_000_000
_AHEAD = _SECOND  # ns by which a stamp may be ahead of the time
_ROUNDING = 1e-6  # seconds by which two equal times may differ
_LOOK = 0.005  # wall seconds after which a task looks at the time again
_SILENT = 2.0  # wall seconds without a message after which the world stands
_SAMPLE = 0.1  # wall seconds between two samples of the pace


class _TimeTold(NamedTuple):
    """The last message: the time, in ns, when it came by the wall, and by how much time has gone back."""

    stamp: int
    wall: float
    back: int

    @property
    def elapsed(self) -> int:
        """The time as it would be if it had not been set back."""
        return self.stamp + self.back


class SimTime:
    """The robot's time, and the clock of the session that runs by it.

    Owner: `tell` is called on the thread of the connection, and replaces what it knows by one assignment; any
    thread may read. The part of a clock belongs to the thread that drives the session.

    `went_back`: called with a number of seconds when the time went back.
    """

    speed = 1.0

    def __init__(self, went_back: Callable[[float], None]) -> None:
        self._went_back = went_back
        self._told: _TimeTold | None = None
        self._samples: deque[tuple[float, float]] = deque(maxlen=20)  # wall time and elapsed
        self._steps: deque[float] = deque(maxlen=9)
        self._first = 0
        self._zero: int | None = None  # what `elapsed` counts from: the first time, or an earlier stamp
        self._base = 0.0  # the session's time …
        self._since: int | None = None  # … at this time of the world; None: at the first message
        self._is_paused = False
        self._waiting: tuple[float, Event] | None = None

    # -- what the robot says ----------------------------------------------------------------------

    def tell(self, stamp: int) -> None:
        """Take a time, in ns, from a message."""
        wall, last = time.monotonic(), self._told
        if last is None:
            self._first = stamp
            if self._zero is None or self._zero > stamp + _AHEAD:
                self._zero = stamp
            self._told = _TimeTold(stamp, wall, 0)
        else:
            self._told = _TimeTold(stamp, wall, last.back + max(0, last.stamp - stamp))
            if stamp > last.stamp:
                self._steps.append((stamp - last.stamp) / _SECOND)
            if wall - last.wall > _SILENT:
                self._samples.clear()
        if not self._samples or wall - self._samples[-1][0] >= _SAMPLE:
            self._samples.append((wall, self.elapsed))
        waiting = self._waiting
        if waiting is not None and self._has_come(waiting[0]):
            waiting[1].set()
        if last is not None and stamp < last.stamp:
            self._went_back((last.stamp - stamp) / _SECOND)

    @property
    def has_begun(self) -> bool:
        """Whether any time has arrived."""
        return self._told is not None

    @property
    def stands(self) -> bool:
        """Whether none arrives any more."""
        told = self._told
        return told is not None and time.monotonic() - told.wall > _SILENT

    @property
    def elapsed(self) -> float:
        """The seconds that have passed, without those that were set back; 0 before the first message."""
        told = self._told
        return 0.0 if told is None else (told.elapsed - (self._zero or 0)) / _SECOND

    @property
    def stamp(self) -> int | None:
        """The time now, in ns; None before the first message."""
        told = self._told
        return None if told is None else told.stamp

    def made_at(self, stamp: int) -> float:
        """Return which `elapsed` belongs to a time stamp, in ns; a message may arrive before its time does.

        One that is far ahead is of another clock, or of before the time went back: it was made now.
        """
        told = self._told
        if self._zero is None:
            self._zero = stamp
        if told is None:
            return (stamp - self._zero) / _SECOND
        made = told.elapsed if stamp - told.stamp > _AHEAD else stamp + told.back
        return (made - self._zero) / _SECOND

    @property
    def pace(self) -> float:
        """Seconds of it per wall second, lately; 1 while that is not known."""
        samples = tuple(self._samples)
        if len(samples) < 2:
            return 1.0
        (began, before), (ended, after) = samples[0], samples[-1]
        return (after - before) / (ended - began)

    @property
    def step(self) -> float:
        """The usual seconds from message to message; 0 while that is not known."""
        steps = sorted(self._steps)
        return steps[len(steps) // 2] if len(steps) == self._steps.maxlen else 0.0

    # -- the clock of a session -------------------------------------------------------------------

    def now(self) -> float:
        """Return the session's time, ``-inf`` before the first message."""
        told, since = self._told, self._since
        if told is None:
            return -math.inf
        if self._is_paused:
            return self._base
        return self._base + (told.elapsed - (self._first if since is None else since)) / _SECOND

    def _has_come(self, t: float) -> bool:
        return self.now() >= t - _ROUNDING

    def delay(self, t: float) -> float:
        """Return 0 if `t` has come, else the wall seconds until the next look; infinite while paused."""
        if self._has_come(t):
            return 0.0
        return math.inf if self._is_paused or t == math.inf else _LOOK

    def sleep_until(self, t: float, wake: Event) -> None:
        """Wait for the message that tells `t`, or for `wake`."""
        self._waiting = t, wake  # first: a message that comes now finds it
        if not self._has_come(t):
            wake.wait()
        self._waiting = None

    def rebase(self, t: float) -> None:
        """Set the session's time to `t`."""
        told = self._told
        self._base, self._since = t, None if told is None else told.elapsed

    def pause(self) -> None:
        """Stop the session's time; the robot's goes on."""
        if not self._is_paused:
            self._base = max(self._base, self.now())
            self._is_paused = True

    def resume(self) -> None:
        """Continue from the session's time."""
        if self._is_paused:
            self._is_paused = False
            self.rebase(self._base)


class ClockChannel(Channel):
    """The subscription of `/clock`; `reason`: what says that it counts."""

    def __init__(self, time: SimTime, reason: str) -> None:
        super().__init__(Wire("clock", "subscription", TOPIC, CLOCK))
        self.time, self.reason = time, reason

    def receive(self, raw: Any, at: float | None = None) -> None:
        """Take the time of a message."""
        stamp = nanoseconds_of(raw, "clock")
        if self.live and stamp is not None:
            self.time.tell(stamp)

    @property
    def expects(self) -> bool:
        """Whether no time has arrived so far."""
        return not self.time.has_begun

    def lack(self) -> str:
        """Return that no time arrives, in a sentence."""
        if self.time.has_begun and not self.time.stands:
            return ""
        if self.problem:
            return f"The time on `{TOPIC}`: {self.problem}"
        if self.time.has_begun:
            return f"The time on `{TOPIC}` stands still, and the program with it."
        return (
            f"{self.reason} is set, and no time arrives on `{TOPIC}`: the program waits for it. Start the"
            " simulation, or `rosbag play --clock`. For a robot that is real, set `sim_time=false`."
        )

    def remark(self) -> str:
        """Return that the program runs by this clock, and how fast it goes."""
        return f" The time is that of `{TOPIC}`, {float(f'{self.time.pace:.1g}'):g} times real time."
