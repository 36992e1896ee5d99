"""The loop of §5.1 with everything around a tick: commands, time, robot, frames.

There is one loop body, :meth:`Loop.turn`, and whoever drives (a thread, asyncio, the caller) only
calls it and waits as long as it says. A turn

1. carries out the commands that wait,
2. lets time pass, up to the next tick at most: a simulated world is moved on by whole physics
   steps, so that it stands at the tick's time when the tick looks at it,
3. ticks, if it is time: latch the sensors, one step of the interpreter, flush the commands,
4. publishes a frame, now and then.

*Time.* With a simulated robot the clock only paces: a tick's time is the one it was due at, and if
the host is too slow the clock is set back. With a real robot the clock is the truth: a late tick
is told the real time. A tick comes *before* its period: ``run(1)`` at 10 Hz ticks at 0, 0.1, … 0.9
and ends at 1.0, and ten single steps do the same.

*Going back.* Before each tick the loop notes the time. Rewinding restores the interpreter by its
journal and the world to the moment before the first tick undone; the next step repeats that tick.

Owned by the thread that drives; only :attr:`Loop.inbox` and the values read by the monitor
(`ticking`, `interpreter.tick`) are for others.
"""

from __future__ import annotations

import math
import threading
import traceback
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from time import perf_counter
from typing import TYPE_CHECKING, Any, NamedTuple

from lrp_jupyter.errors import LRPError
from lrp_jupyter.interpreter.frame import Frame, Status, Tally, is_active
from lrp_jupyter.language.program import Path
from lrp_jupyter.live import commands as do
from lrp_jupyter.live.clock import LAG, Clock
from lrp_jupyter.live.control import carry_out, stand_still

if TYPE_CHECKING:
    from lrp_jupyter.bridges.bridge import Bridge
    from lrp_jupyter.interpreter.interpreter import Interpreter

__all__ = ["STEP", "Interrupted", "Loop", "Moment"]

STEP = 0.01
"""Seconds from tick to tick at rate 0 where time is virtual."""

SLOWEST = 0.01
"""Ticks per second, at least: a step waits for its period."""

_FREE = 0.0005  # wall seconds that a free-running loop keeps the interpreter lock
_FRAMES = 60.0  # frames per wall second, at most
_PICTURES = 30.0  # of a world that moves between two ticks, per wall second
_ROUNDING = 1e-6  # s


class Interrupted(BaseException):
    """A person interrupted a block that did not return. It becomes an issue of that block."""

    def __str__(self) -> str:
        return "the block did not return and was interrupted"


class Moment(NamedTuple):
    """The moment before a tick: ticks done, time, and what the bridge calls it."""

    tick: int
    now: float
    bridge: object


class Loop:
    """See the head of this module.

    Parameters
    ----------
    interpreter : Interpreter
    bridge : Bridge
        Opened by whoever made it.
    clock : Clock
    rate : float
        Ticks per second; 0 for as many as possible.
    publish : callable
        Gets every frame.
    remembered : int
        Ticks that can be taken back.
    printed : callable
        Gives the number of lines printed so far.
    """

    def __init__(
        self,
        interpreter: Interpreter,
        bridge: Bridge,
        clock: Clock,
        rate: float,
        publish: Callable[[Frame], None],
        remembered: int = 10_000,
        printed: Callable[[], int] = lambda: 0,
    ) -> None:
        self.interpreter = interpreter
        self.bridge = bridge
        self.clock = clock
        self.inbox = do.Inbox()
        self.status: Status = "ready"
        self.reason = ""
        self.fault = ""  # the traceback of what broke the session
        self.ticking = False
        self.tally = Tally()
        interpreter.observe(self.tally)
        self._step = bridge.time_step  # seconds; None where time passes by itself
        self._publish = publish
        self._printed = printed
        self.moments: deque[Moment] = deque(maxlen=remembered)
        self._steps = 0
        self.now = 0.0
        """Seconds of the run."""
        self.due = 0.0
        self._shown = -math.inf  # wall time of the last frame
        self._measured: tuple[float, int, float] | None = None  # wall time, tick, time
        self._achieved = (0.0, 0.0)  # ticks per second, seconds per second
        self.rate = _checked_rate(rate)

    # -- time ------------------------------------------------------------------------------------

    @property
    def period(self) -> float:
        """Seconds from one tick to the next."""
        step = self._step
        if self.rate == 0:
            return step or STEP
        return 1 / self.rate if step is None else max(1, round(1 / self.rate / step)) * step

    @property
    def free(self) -> bool:
        """Whether ticks follow each other at once, without waiting for a time."""
        return self.rate == 0 and self._step is None

    def set_rate(self, rate: float) -> None:
        """Tick so often from now on."""
        self.rate = _checked_rate(rate)
        self.due = min(self.due, self.now + self.period)

    def go_back(self, moment: Moment) -> None:
        """Let it be an earlier moment: the time, and the bridge's world."""
        self.bridge.rewind(moment.bridge)
        self.now = moment.now
        if self._step is not None:
            self._steps = round(moment.now / self._step)
        self.due = self.now
        self.clock.rebase(self.now)

    def measure(self) -> None:
        """Measure the achieved rate from now on, from tick to tick."""
        self._measured = None

    def _measure(self) -> None:
        wall = perf_counter()
        if self._measured is not None:
            since, tick, time = self._measured
            span = wall - since
            if span < 0.5:
                return
            self._achieved = ((self.interpreter.tick - tick) / span, (self.now - time) / span)
        self._measured = (wall, self.interpreter.tick, self.now)

    def advance(self, seconds: float) -> None:
        """Let time pass, without a tick; a simulated world moves, by whole steps."""
        if self._step is None:
            self.now = round(self.now + seconds, 12)
        elif (steps := math.floor(seconds / self._step + 1e-6)) > 0:
            self.bridge.advance(steps * self._step)
            self._steps += steps
            self.now = round(self._steps * self._step, 9)

    def _let_time_pass(self) -> None:
        clock = self.clock.now()
        late = clock - self.due > LAG * min(self.clock.speed, 1e9)
        if self._step is None:
            self.now = max(clock, self.now)
            if late and not self.free:
                self.due = self.now
            return
        if late:  # never a larger step, never a skipped one: the run goes slower instead
            clock = self.due
            self.clock.rebase(clock)
        self.advance(min(clock, self.due) - self.now)

    # -- the loop body ---------------------------------------------------------------------------

    def turn(self) -> float:
        """Do what is to be done now.

        Returns
        -------
        float
            The time (of the clock) until which there is nothing to do unless a command comes;
            infinite when only a command can change anything.
        """
        try:
            return self._turn()
        except Interrupted:  # it came too late: the block had returned
            return self.now
        except KeyboardInterrupt:
            self.ticking = False
            self.carry_out(do.Pause("interrupted from the keyboard"))
            self.show()
            if threading.current_thread() is threading.main_thread():
                raise
            return math.inf
        except Exception:
            self.break_down(traceback.format_exc())
            return math.inf

    def _turn(self) -> float:
        self.carry_out_waiting()
        if self.status != "running":
            return math.inf
        self._let_time_pass()
        if self.free:
            end = perf_counter() + _FREE
            while self.status == "running" and not self.inbox and perf_counter() < end:
                self.now = max(self.now, self.clock.now())
                self.tick()
                if self.clock.speed == math.inf:  # no time passes by itself
                    self.clock.rebase(self.now + STEP)
        elif self.now >= self.due - _ROUNDING:
            self.tick()
        if self.status != "running":  # it paused at an issue, and no later frame would tell
            self.show()
            return math.inf
        self.show_now_and_then()
        if self.free:
            return self.now
        if self._step is None:
            return self.due
        ahead = self.due - self.now  # in equal parts, so that none ends just before the tick
        parts = math.floor(ahead / max(self._step, self.clock.speed / _PICTURES) + _ROUNDING)
        return self.now + ahead / max(1, parts)

    def tick(self) -> None:
        """One tick, now; the next one is due a period later."""
        interpreter, bridge, now, period = self.interpreter, self.bridge, self.now, self.period
        self.moments.append(Moment(interpreter.tick, now, bridge.moment()))
        self.ticking = True
        try:
            bridge.begin_tick(now, period)
            interpreter.step(now)
            bridge.end_tick(now)
        finally:
            self.ticking = False
        self._measure()
        behind = now - self.due > LAG
        self.due = now + period if behind or self._step is not None else self.due + period
        if interpreter.paused and self.status == "running":  # at an issue
            stand_still(self, _last_message(interpreter))

    def run(self, seconds: float, reached: Callable[[], bool]) -> bool:
        """Tick in virtual time until `reached`, for so many seconds at most; no waiting.

        Afterwards the loop stands as it stood before: running if a driver turns it, else still,
        without the pause actions. Returns whether it was reached; a pause ends it early.
        """
        was_running = self.status == "running"
        self.carry_out(do.Resume())
        if self._step is not None and seconds < math.inf:  # a world knows whole steps only
            seconds = math.ceil(seconds / self._step - _ROUNDING) * self._step
        end = self.now + seconds
        try:
            while self.status == "running" and self.now < end - _ROUNDING:
                if self.now < self.due - _ROUNDING:  # what was left of a period
                    self.advance(min(self.due, end) - self.now)
                    continue
                self.due = self.now
                self.tick()
                if reached():
                    return True
                self.carry_out_waiting()
        except Interrupted:
            pass
        except Exception:
            self.break_down(traceback.format_exc())
        finally:
            self.clock.rebase(self.now)
            if self.status == "running" and not was_running:
                self.status = "paused"
                self.clock.pause()
            self.show()
        return False

    # -- frames ----------------------------------------------------------------------------------

    def show(self) -> None:
        """Publish a frame of this moment."""
        self._shown = perf_counter()
        self._publish(self.make_frame())

    def make_frame(self) -> Frame:
        """Make a frame of this moment."""
        rate, speed = self._achieved if self.status == "running" else (0.0, 0.0)
        return self.tally.frame(
            self.interpreter,
            self.now,
            status=self.status,
            reason=self.reason,
            rate=self.rate,
            achieved_rate=rate,
            speed=self.clock.speed,
            achieved_speed=speed,
            printed=self._printed(),
            bridge=self.bridge.status.sentence,
            robot=getattr(self.bridge, "picture", None),
        )

    def show_now_and_then(self) -> None:
        """Publish a frame unless the last one is too young."""
        if perf_counter() - self._shown >= 1 / _FRAMES:
            self.show()

    # -- commands --------------------------------------------------------------------------------

    def carry_out_waiting(self) -> None:
        """Carry out the commands that wait now, each as a whole; then show, then answer."""
        answers: list[tuple[Future[Any], Any, Exception | None]] = []
        for _ in range(len(self.inbox)):
            entry = self.inbox.take()
            if entry is None:  # a newer edit has taken its place
                break
            command, answer = entry
            if not answer.set_running_or_notify_cancel():
                continue
            try:
                answers.append((answer, self.carry_out(command), None))
            except Exception as error:
                answers.append((answer, None, error))
        if answers:
            self.show()
        for answer, result, refusal in answers:  # who waited finds the new frame
            if refusal is None:
                answer.set_result(result)
            else:
                answer.set_exception(refusal)

    def carry_out(self, command: do.Command) -> Any:
        """Carry out one command; between two ticks. Misuse raises."""
        if self.status == "broken":
            raise LRPError("the session is broken by a fault that is not the program's; see its `fault`")
        try:
            return carry_out(self, command)
        except Exception as error:
            if not _is_misuse(error, command):
                self.break_down(traceback.format_exc())
            raise

    def is_active(self, state: str | Path) -> bool:
        """Whether a state is active now, at any depth."""
        return is_active(state, self.interpreter.active)

    def halt(self) -> None:
        """Be stopped; the last look stays."""
        if self.status in ("running", "paused"):
            self.status = "ready"
        self.show()

    def break_down(self, fault: str) -> None:
        """Stop for good: a fault that is not the program's."""
        self.status, self.fault = "broken", fault
        self.reason = "a fault of the session, not of the program: " + fault.strip().splitlines()[-1]
        self.ticking = False
        self.bridge.stop_all()
        self.show()


def _checked_rate(rate: float) -> float:
    if rate == 0 or SLOWEST <= rate < math.inf:
        return float(rate)
    raise ValueError(
        f"a rate is {SLOWEST:g} ticks per second or more, or 0 for as many as possible, not {rate!r}"
    )


def _is_misuse(error: Exception, command: do.Command) -> bool:
    """Whether it is the asker's error; any other is ours, and stops the session."""
    match command:
        case do.Call() | do.SetVariable():  # these run code of the asker
            return True
        case do.Rename() | do.Rewind() | do.SetRate() | do.SetSpeed():
            return isinstance(error, (LRPError, ValueError, TypeError))
        case _:
            return isinstance(error, LRPError)


def _last_message(interpreter: Interpreter) -> str:
    last = max(interpreter.issues, key=lambda issue: issue.last_tick, default=None)
    return last.message if last else ""
