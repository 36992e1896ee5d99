"""The timing of a run: its current time, its speed, and when the next tick is due.

With a simulated robot the clock only sets the pace: a tick has the time at which it was due, and if the host
is too slow the clock is set back. With a real robot the clock is authoritative: a late tick has the actual
time. The clock may be that of the robot's own world, which can stand and jump: then no two ticks have the
same time. A tick comes *before* its period: ``run(1)`` at 10 Hz ticks at 0, 0.1, … 0.9 and ends at 1.0, as do
ten single steps.

Paper: §5.1.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from numbers import Real
from time import perf_counter

from lrp_jupyter.arguments import check_type
from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.world_clock import WorldClock
from lrp_jupyter.live.clock import LAG, Clock

STEP = 0.01
"""Seconds from tick to tick at rate 0 in virtual time."""

SLOWEST, FASTEST = 0.01, 1e6
"""The lowest and the highest rate, in ticks per second: a step waits for its period, and time must pass."""

ROUNDING = 1e-6
"""Seconds by which two equal times may differ."""

_PICTURES = 30.0  # of a world that moves between two ticks, per wall second


class Timing:
    """The time of a run, in its seconds; it belongs to the thread that drives the loop.

    `move`: moves the simulated world by a number of seconds, which are whole physics steps.
    `step`: seconds per physics step; None where time passes in the real world.
    `due`: when the next tick is due.
    `end`: when a run paced by a clock comes to rest; may be infinite.
    `follows`: whether the time is that of the robot's own world, where it has one, or of the given clock.
    `achieved`: the rate that was reached, and seconds of the run per wall second.
    """

    def __init__(self, clock: Clock, bridge: Bridge, rate: float, move: Callable[[float], object]) -> None:
        self.clock = self._given = clock
        self.follows = False
        self._world: WorldClock | None = None  # that the time comes from
        self.step = bridge.time_step
        self._bridge = bridge
        self._move = move
        self._steps = 0
        self.now = self.due = 0.0
        self.end = math.inf
        self._measured: tuple[float, int, float] | None = None  # wall time, tick, time
        self._last = perf_counter(), 0.0  # wall time and time of the last tick, or of the beginning
        self.achieved = (0.0, 0.0)
        self.set_rate(rate)

    def set_rate(self, rate: float) -> None:
        """Change the rate, in ticks per second; 0 is as fast as possible. Paper: §5.1."""
        check_type("rate", rate, Real, "a number of ticks per second")
        if not (rate == 0 or SLOWEST <= rate <= FASTEST):
            raise ValueError(
                f"A rate is between {SLOWEST:g} and {FASTEST:,.0f} ticks per second, "
                f"or 0 for as many as possible, not {rate!r}."
            )
        step = self.step
        self.rate = float(rate)
        if rate == 0:
            self.period = step or STEP
        else:
            self.period = 1 / rate if step is None else max(1, round(1 / rate / step)) * step
        self.due = min(self.due, self.now + self.period)

    @property
    def free(self) -> bool:
        """Whether ticks follow each other without waiting."""
        return self.rate == 0 and self.step is None and self._world is None

    @property
    def may_stand(self) -> bool:
        """Whether the time is that of the robot's world, so that the next turn may never come."""
        return self._world is not None

    @property
    def is_due(self) -> bool:
        """Whether a tick is due."""
        return self.now >= self.due - ROUNDING and self.clock.now() > -math.inf

    @property
    def over(self) -> bool:
        """Whether the run has come to its end."""
        return self.now >= self.end - ROUNDING

    def set_speed(self, speed: float) -> None:
        """Change the speed, in seconds of the session per wall second."""
        if self._bridge.hardware and speed != 1:
            raise ValueError(f"`{self._bridge.name}` is a real robot, whose time passes at speed 1.")
        self.clock.speed = speed

    def advance(self, seconds: float) -> None:
        """Advance the time without a tick; a simulated world moves by whole steps."""
        if self.step is None:
            self.now = round((self.now + seconds) * 1e12) / 1e12  # half the time of round(…, 12)
        elif (steps := math.floor(seconds / self.step + 1e-6)) > 0:
            self._move(steps * self.step)
            self._steps += steps
            self.now = round(self._steps * self.step, 9)

    def catch_up(self) -> None:
        """Advance the time to that of the clock, at most to the end and, with a world, to the next tick."""
        if self.follows and self._bridge.world_clock is not self._world:
            self._follow()
        clock = self.clock.now()
        if self.step is None:
            self.now = max(min(clock, self.end), self.now)
            return
        if clock - self.due > LAG * min(self.clock.speed, 1e9):
            clock = self.due  # never a larger or a skipped step: the run becomes slower instead
            self.clock.rebase(clock)
        self.advance(min(clock, self._next()) - self.now)

    def go_to(self, time: float) -> None:
        """Advance the time to that of a recorded entry, without a tick."""
        if self.step is None:
            self.now = max(self.now, time)
        else:
            self.advance(time - self.now)
        self.due = self.now

    def jump(self, time: float, due: float) -> None:
        """Set the time of the run to that of an earlier moment or of another session."""
        self.now, self.due = time, due
        if self.step is not None:
            self._steps = round(time / self.step)
        self.clock.rebase(time)

    def resume(self) -> None:
        """Continue after a pause; a tick missed during it is due now."""
        self._follow()
        self.due = max(self.due, self.now)
        self._measured, self._last = None, (perf_counter(), self.now)

    def _follow(self) -> None:
        """Go on by the clock of the robot's world, if it has one now."""
        self._world = self._bridge.world_clock if self.follows else None
        self.clock = self._given if self._world is None else self._world
        self.clock.resume()
        self.clock.rebase(self.now)

    def expected(self) -> float:
        """Return the time as it should be by now if ticks came, for the watchdog; from any thread.

        A clock of the robot's world may stand, and something real may move all the same. So this is the time
        of the last tick and what passes of the wall's since, as much slower as the world was.
        """
        if (world := self._world) is None:
            return self.clock.now()
        wall, time = self._last
        return time + (perf_counter() - wall) * min(1.0, world.pace)

    def next_turn(self) -> float:
        """Return the time of the next turn: that of the next tick, or of a frame of the world before it."""
        if self.free:
            return self.now
        if self.step is None:
            return min(self.due, self.end)
        ahead = self._next() - self.now  # in equal parts, so that none ends just before the tick
        parts = math.floor(ahead / max(self.step, self.clock.speed / _PICTURES) + ROUNDING)
        return self.now + ahead / max(1, parts)

    def _next(self) -> float:
        """Return the time of the next tick, or that of the world's last step before an earlier end."""
        if self.step is None or self.end >= self.due:
            return self.due
        return math.ceil(self.end / self.step - ROUNDING) * self.step

    def set_due(self, now: float) -> None:
        """Set when the next tick is due, after one."""
        on_time = self.step is None and now - self.due <= LAG
        self.due = (self.due if on_time else now) + self.period
        if self._world is not None and self.due <= now + ROUNDING:  # the clock has jumped over it
            self.due += (math.floor((now + ROUNDING - self.due) / self.period) + 1) * self.period

    def measure(self, tick: int) -> None:
        """Measure the achieved rate and speed, after a tick with this number."""
        wall = perf_counter()
        self._last = wall, self.now
        if self._measured is not None:
            since, before, time = self._measured
            span = wall - since
            if span < 0.5:
                return
            self.achieved = ((tick - before) / span, (self.now - time) / span)
        self._measured = (wall, tick, self.now)
