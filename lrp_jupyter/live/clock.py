"""The clocks of sessions; that of a robot's own world belongs to its bridge.

Times are floats, in seconds. A session reads the time from a clock and waits for it; whether waiting takes
wall time is up to the clock. The same loop therefore serves a robot, a test and a grader.
"""

from __future__ import annotations

import math
from numbers import Real
from threading import Event
from time import monotonic

from lrp_jupyter.arguments import check_type
from lrp_jupyter.bridges.world_clock import Clock

__all__ = ["LAG", "Clock", "MonotonicClock", "VirtualClock"]

LAG = 0.25
"""Wall seconds by which a host may fall behind before pacing restarts from the present."""

_LONGEST = 3600.0  # wall seconds of a single wait: an extreme speed would exceed what a timer accepts
_FASTEST = 1e9  # above it, the time per wall second is no longer exact


class VirtualClock:
    """A virtual clock: its time advances only when it is waited for, by jumping.

    Parameters
    ----------
    start : float
        The time at the beginning, in seconds.

    Examples
    --------
    >>> from lrp_jupyter import Session
    >>> with Session("(machine m (state a)) (spawn m a)", clock=VirtualClock()) as session:
    ...     session.start()
    ...     session.wait_for(lambda frame: frame.time > 3600).status  # at once
    'running'
    """

    speed = math.inf

    def __init__(self, start: float = 0.0) -> None:
        check_type("start", start, Real, "a time in seconds")
        self._now = start

    def __repr__(self) -> str:
        return f"<VirtualClock at {self._now:g} s>"

    def now(self) -> float:
        """Return the virtual time."""
        return self._now

    def sleep_until(self, t: float, wake: Event) -> None:
        """Set the time to `t` at once, unless `wake` is set or `t` is infinite."""
        if t == math.inf:
            wake.wait()
        elif not wake.is_set():
            self._now = max(self._now, t)

    def delay(self, t: float) -> float:
        """Set the time to `t`; return 0, because there is nothing to wait for."""
        if t == math.inf:
            return math.inf
        self._now = max(self._now, t)
        return 0.0

    def rebase(self, t: float) -> None:
        """Set the time to `t`."""
        self._now = t

    def pause(self) -> None:
        """Do nothing: a virtual clock advances only when it is waited for."""

    def resume(self) -> None:
        """Do nothing."""


class MonotonicClock:
    """The wall clock, pausable, faster or slower by a factor.

    It never jumps on its own: a session that is more than :data:`LAG` behind calls :meth:`rebase` and
    continues from there instead of racing to catch up.

    `speed`: seconds of this clock per second of wall time; above 1e9, as for `math.inf`, it never waits.
    """

    def __init__(self, speed: float = 1.0) -> None:
        self._speed = _checked(speed)
        self._base = 0.0  # the time …
        self._since: float | None = monotonic()  # … at this wall time; None while paused

    @property
    def speed(self) -> float:
        """The factor; changing it does not change the current time."""
        return self._speed

    @speed.setter
    def speed(self, speed: float) -> None:
        speed = _checked(speed)
        self.rebase(self.now())
        self._speed = speed

    def now(self) -> float:
        """Return the time, in seconds."""
        if self._since is None or self._speed == math.inf:
            return self._base
        return self._base + (monotonic() - self._since) * self._speed

    def delay(self, t: float) -> float:
        """Return the wall seconds until `t`, an hour at most; infinite while paused."""
        if t == math.inf or self._since is None:
            return math.inf
        if self._speed == math.inf:
            self._base = max(self._base, t)
            return 0.0
        return min(max(0.0, (t - self.now()) / self._speed), _LONGEST)

    def sleep_until(self, t: float, wake: Event) -> None:
        """Wait until `t` or `wake`; while paused, until `wake`."""
        delay = self.delay(t)
        if delay == math.inf:
            wake.wait()
        elif delay > 0:
            wake.wait(delay)

    def rebase(self, t: float) -> None:
        """Set the time to `t`; a paused clock stays paused."""
        self._base = t
        if self._since is not None:
            self._since = monotonic()

    def pause(self) -> None:
        """Stop the time."""
        if self._since is not None:
            self._base = self.now()
            self._since = None

    def resume(self) -> None:
        """Continue from the current time."""
        if self._since is None:
            self._since = monotonic()


def _checked(speed: float) -> float:
    check_type("speed", speed, Real, "a number")
    if not speed > 0:
        raise ValueError(f"The speed must be above 0, not {speed!r}.")
    return float(speed) if speed <= _FASTEST else math.inf
