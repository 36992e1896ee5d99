"""A program that runs: its loop, its time, its life, and looking at it.

The lower half of a session, and all of it that does not change the program.
"""

from __future__ import annotations

import atexit
import math
import threading
import weakref
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from dataclasses import replace
from time import monotonic
from typing import TYPE_CHECKING, Any, Literal, Self

from lrp_jupyter.bridges.discovery import make_bridge
from lrp_jupyter.errors import LRPError, SessionClosedError, SessionTimeoutError
from lrp_jupyter.interpreter.frame import Frame, Status, matches
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.issues import Issue
from lrp_jupyter.language.program import Path, Program
from lrp_jupyter.live import commands as do
from lrp_jupyter.live.clock import Clock, MonotonicClock
from lrp_jupyter.live.loop import Loop
from lrp_jupyter.live.output import Output
from lrp_jupyter.live.turns import Turns

if TYPE_CHECKING:
    from lrp_jupyter.bridges.bridge import Bridge

__all__ = ["Condition", "Running"]

Condition = str | Path | Callable[[Frame], object]
"""A state, by bare name or path, or a function of a frame."""

_open_sessions: weakref.WeakSet[Running] = weakref.WeakSet()


class Running:
    """See :class:`~lrp_jupyter.live.session.Session`, which is all of it."""

    def __init__(
        self,
        program: Program,
        bridge: str | Bridge = "none",
        clock: Clock | None = None,
        rate: float = 10,
        *,
        namespace: dict[str, Any] | None = None,
        on_active_edit: Literal["restart", "keep"] = "restart",
        on_issue: Literal["record", "pause"] = "record",
        name: str = "lrp",
        journal: int = 10_000,
        speed: float = 1.0,
        driver: Literal["thread", "asyncio"] = "thread",
        hung_after: float = 2.0,
        dead_man: float | None = None,
        **options: Any,
    ) -> None:
        self.name = name
        self.namespace = {} if namespace is None else namespace
        self.output = Output()
        self.bridge = make_bridge(bridge, **options) if isinstance(bridge, str) else bridge
        interpreter = Interpreter(
            program,
            robot=self.bridge.robot,
            namespace=self.namespace,
            on_active_edit=on_active_edit,
            on_issue=on_issue,
            journal=journal,
            output=self.output.print,
        )
        self._changed = threading.Condition()
        self._news = 0  # grows whenever a waiting caller should look again
        self._listeners: tuple[Callable[[], None], ...] = ()
        self._frame = Frame(program=program, rate=rate)
        self._loop = Loop(
            interpreter,
            self.bridge,
            MonotonicClock(speed) if clock is None else clock,
            rate,
            self._store,
            journal,
            lambda: self.output.count,
        )
        self._turns = Turns(self._loop, name)
        self._driver_kind: Literal["thread", "asyncio"] = driver
        self._hung_after = hung_after
        self._dead_man = dead_man
        self._ended: Status | None = None
        self._loop.show()
        _open_sessions.add(self)

    # -- what it is ------------------------------------------------------------------------------

    @property
    def frame(self) -> Frame:
        """The newest look at the run; from any thread."""
        frame = self._frame
        if self._ended is not None:
            return replace(frame, status=self._ended, achieved_rate=0.0, achieved_speed=0.0)
        hung = self._turns.hung
        return replace(frame, status="hung", reason=hung) if hung else frame

    @property
    def status(self) -> Status:
        """See :attr:`Frame.status <lrp_jupyter.interpreter.frame.Frame>`."""
        return self.frame.status

    @property
    def issues(self) -> Sequence[Issue]:
        """The faults of the program so far."""
        return self._frame.issues

    @property
    def program(self) -> Program:
        """The program that runs."""
        return self._frame.program

    @property
    def fault(self) -> str:
        """The traceback of what broke the session; empty while it is whole."""
        return self._loop.fault

    @property
    def interpreter(self) -> Interpreter:
        """The interpreter: for observers and tests. It belongs to the driver's thread."""
        return self._loop.interpreter

    @property
    def rate(self) -> float:
        """Ticks per second, 0 for as many as possible; may be set at any time. Paper: §5.1."""
        return self._loop.rate

    @rate.setter
    def rate(self, rate: float) -> None:
        self._do(do.SetRate(rate))

    @property
    def speed(self) -> float:
        """Seconds of the session per second of the wall; may be set at any time."""
        return self._loop.clock.speed

    @speed.setter
    def speed(self, speed: float) -> None:
        self._do(do.SetSpeed(speed))

    def __repr__(self) -> str:
        frame = self.frame
        active = ", ".join("/".join(path) for path in frame.active) or "nothing"
        return f"<Session {self.name}: {frame.status}, tick {frame.tick}, {active} active>"

    # -- running ---------------------------------------------------------------------------------

    def open(self) -> None:
        """Connect the robot, once; :meth:`start`, :meth:`step` and :meth:`run` do it too."""
        self._check_open()
        self.bridge.open()

    def start(self, paused: bool = False) -> None:
        """Run; after :meth:`stop`, from the beginning. What runs already runs on."""
        self.open()
        if not self._turns.driven:
            self._begin_anew()
            self._turns.start(self._driver_kind, self._notify, self._hung_after, self._dead_man)
        if not paused:
            self.resume()

    def _begin_anew(self) -> None:
        """After a stop: the program starts from the beginning."""
        if self._ended == "stopped":
            with self._turns.own("start"):
                self._ended = None
                self._loop.carry_out(do.Reset())

    def pause(self, reason: str = "") -> None:
        """Stand still: program, time, robot. Paper: §6.3."""
        self._do(do.Pause(reason))

    def resume(self) -> None:
        """Go on after a pause."""
        self._do(do.Resume())

    def step(self) -> None:
        """One tick and one period of time; a running program is paused first. Paper: §6.3."""
        self.open()
        self._do(do.Step())

    def reset(self) -> None:
        """Start the program anew at the next tick; the robot stops, its world stays."""
        self._do(do.Reset())

    def stop_robot(self) -> None:
        """Stop the robot, at once, whatever the program does; then pause."""
        self.bridge.stop_all()
        self.submit(do.Pause("the robot was stopped"))

    def stop(self) -> None:
        """End the run: the robot stops, the threads are gone; :meth:`start` begins anew."""
        self._end("stopped")

    def close(self) -> None:
        """Stop, and let the robot's connection go. Doing it twice does nothing."""
        self._end("closed")
        self.bridge.close()
        _open_sessions.discard(self)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _end(self, status: Literal["stopped", "closed"]) -> None:
        if self.bridge.is_open:
            self.bridge.stop_all()
        if self._turns.end() and self._ended is None:
            self._loop.halt()
        self._ended = "closed" if self._ended == "closed" else status
        self._notify()

    def interrupt(self) -> bool:
        """Make the block that runs fail at its next bytecode; whether one runs.

        It becomes an issue of that block, and the tick goes on.
        """
        return self._turns.interrupt()

    def seen(self) -> None:
        """Somebody watches the robot: resets the dead man's switch."""
        self._turns.seen()

    def run(self, seconds: float | None = None, until: Condition | None = None) -> bool:
        """Run on the caller's thread, in virtual time: nothing waits.

        A thread of the session stands by meanwhile. A pause of the program ends the run.

        Parameters
        ----------
        seconds : float, optional
            At most so long, in seconds of the session.
        until : str, path or callable, optional
            A state to be entered, or a condition on the frame; looked at after every tick.

        Returns
        -------
        bool
            Whether `until` was reached; without it, whether the time was run to its end.
        """
        if seconds is None and until is None:
            raise ValueError("run for how long? Give `seconds`, `until`, or both")
        self.open()
        reached = self._watch(until)
        with self._turns.own("run"):
            self._begin_anew()
            self._loop.carry_out_waiting()
            span = math.inf if seconds is None else seconds
            end = self._loop.now + span
            found = self._loop.run(span, reached)
            return found if until is not None else self._loop.now >= end - 1e-6

    def _watch(self, until: Condition | None) -> Callable[[], bool]:
        """Make the question that `run` asks after every tick, cheap where it can be."""
        if until is None:
            return lambda: False
        loop = self._loop
        if callable(until):
            return lambda: bool(until(loop.make_frame()))
        state, visits = until, loop.tally.visits
        before = _count(visits, state)

        def entered() -> bool:
            return _count(visits, state) > before or loop.is_active(state)

        return entered

    def wait_for(self, condition: Condition, timeout: float | None = None) -> Frame:
        """Wait, in wall time, until a state is active (or was, however shortly) or a condition holds.

        Returns
        -------
        Frame
            The one in which it was so.

        Raises
        ------
        SessionTimeoutError
            It did not happen in `timeout` seconds.
        LRPError
            It cannot happen: the session is stopped, broken or closed, or nothing turns its loop.
        """
        if not self._turns.waits_elsewhere and (timeout is None or self._turns.driven):
            raise LRPError("nothing would run meanwhile: `start` it before, or use `run(until=…)`")
        end = math.inf if timeout is None else monotonic() + timeout
        before = 0 if callable(condition) else self._frame.count_of(condition)
        while True:
            news, frame = self._news, self.frame
            if callable(condition):
                if condition(frame):
                    return frame
            elif frame.is_active(condition) or frame.count_of(condition) > before:
                return frame
            if frame.status in ("stopped", "broken", "closed"):
                raise LRPError(f"the session is {frame.status}: {frame.reason or 'nothing runs'}")
            if (left := end - monotonic()) <= 0:
                what = "the condition" if callable(condition) else f"`{_text(condition)}`"
                raise SessionTimeoutError(f"{what} did not come in {timeout:g} s; {self!r}")
            with self._changed:
                self._changed.wait_for(lambda seen=news: self._news != seen, min(left, 3600))  # type: ignore[misc]

    def listen(self, callback: Callable[[], None]) -> Callable[[], None]:
        """Call `callback` whenever there is a new frame; return what ends that.

        It is called on the thread that brings the news, and must not wait there.
        """
        self._listeners = (*self._listeners, callback)

        def unlisten() -> None:
            self._listeners = tuple(other for other in self._listeners if other is not callback)

        return unlisten

    # -- inside ----------------------------------------------------------------------------------

    def submit(self, command: do.Command) -> Future[Any]:
        """Queue a command and do not wait."""
        self._check_open()
        return self._turns.submit(command)

    def ask(self, command: do.Command) -> Future[Any]:
        """Have a command carried out without waiting for it: here, if nothing else turns the loop."""
        self._check_open()
        if self._turns.waits_elsewhere:
            return self._turns.submit(command)
        answer: Future[Any] = Future()
        try:
            answer.set_result(self._turns.do(command))
        except Exception as error:
            answer.set_exception(error)
        return answer

    def _do(self, command: do.Command) -> Any:
        self._check_open()
        return self._turns.do(command)

    def _check_open(self) -> None:
        if self._ended == "closed":
            raise SessionClosedError(f"the session `{self.name}` is closed")

    def _store(self, frame: Frame) -> None:
        self._frame = frame
        self._notify()

    def _notify(self) -> None:
        with self._changed:
            self._news += 1
            self._changed.notify_all()
        for listener in self._listeners:
            listener()


def _count(visits: dict[Path, int], state: str | Path) -> int:
    return sum(count for path, count in visits.items() if matches(state, path))


def _text(path: str | Path) -> str:
    return path if isinstance(path, str) else "/".join(path)


@atexit.register
def _close_all() -> None:
    for session in tuple(_open_sessions):
        session.close()
