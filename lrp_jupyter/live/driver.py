"""Drivers of a loop (a thread, an asyncio task or the caller), and the monitor that watches it.

A :class:`Driver` decides which thread may run the loop, and lets other threads submit commands to
it. A command is applied

* by the driver's thread if there is one; the caller waits, for at most a second;
* by the caller if nothing else drives the loop;
* after the tick, without waiting, if the call comes from a block of the program.

Every driver alternates between a turn of the loop and waiting for the time that the turn returns. They
differ in how they wait.

The monitor is a second thread. A block that does not return holds up its loop and nothing else: the
monitor reports which block it is, stops the robot, and can interrupt the block. It also feeds the
bridge's watchdog and pauses a robot that is no longer watched. It never touches the interpreter.
"""

from __future__ import annotations

import asyncio
import contextvars
import ctypes
import math
import re
import sys
import threading
import time
from collections.abc import Iterator
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeout
from contextlib import contextmanager, suppress
from time import monotonic, perf_counter
from typing import Any, Literal

from lrp_jupyter.errors import SessionClosedError, SessionTimeoutError
from lrp_jupyter.interpreter.frame import Hung
from lrp_jupyter.live.commands import Pause
from lrp_jupyter.live.loop import Command, Interrupted, Loop

__all__ = ["PATIENCE", "Driver", "LoopTask", "LoopThread", "Monitor"]

PATIENCE = 1.0
"""Wall seconds that a call waits for its command."""

_HOLD = 0.0005  # wall seconds for which a loop that never waits may keep others from running …
_YIELD = 0.00005  # … and those for which it then sleeps
_INTERVAL = 0.1  # wall seconds between two checks of the monitor


class LoopThread:
    """A daemon thread that drives the loop.

    Parameters
    ----------
    loop : Loop
    turning : RLock
        Held during each turn; another thread that drives for a while acquires it.
    name : str
        The thread's name.
    """

    def __init__(self, loop: Loop, turning: threading.RLock, name: str) -> None:
        self._loop = loop
        self._turning = turning
        self._ended = False
        self._suspended = 0  # number of callers that drive the loop themselves
        # The context is copied, or output of the thread would be routed to the cell run last.
        context = contextvars.copy_context()
        self._thread = threading.Thread(target=context.run, args=(self._run,), name=name, daemon=True)

    @property
    def ident(self) -> int | None:
        """The identity of the thread that drives the loop, or None."""
        return self._thread.ident if self._thread.is_alive() else None

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def suspend(self) -> None:
        """Make no turn until :meth:`unsuspend`; the turn under way is finished."""
        self._suspended += 1

    def unsuspend(self) -> None:
        """Continue, once called as often as :meth:`suspend`."""
        self._suspended -= 1
        self._loop.inbox.notify()

    def end(self) -> None:
        """Make no further turn; from any thread."""
        self._ended = True
        self._loop.inbox.notify()

    def join(self, timeout: float) -> bool:
        """Wait for the last turn; return whether it is over. A thread does not wait for itself."""
        if self._thread is not threading.current_thread():
            self._thread.join(timeout)
        return not self._thread.is_alive()

    def _run(self) -> None:
        loop, wake = self._loop, self._loop.inbox.wake
        rested = perf_counter()
        while not self._ended:
            try:
                wake.clear()
                until = math.inf
                if not self._suspended:
                    with self._turning:
                        until = loop.turn()
                before = perf_counter()
                if not self._ended:
                    loop.clock.sleep_until(until, wake)
                after = perf_counter()
                if after - before > _YIELD:
                    rested = after
                elif after - rested > _HOLD:  # others would wait 5 ms for the interpreter lock
                    time.sleep(_YIELD)
                    rested = perf_counter()
            except Interrupted:  # too late: the block had returned
                pass
            except BaseException as error:  # the thread never ends without a trace
                loop.break_down(error)
                wake.wait(_INTERVAL)


class LoopTask:
    """A task of the running event loop that drives the loop: for places without threads (Pyodide)."""

    def __init__(self, loop: Loop) -> None:
        self._loop = loop
        self._ended = False
        self._task: asyncio.Task[None] | None = None
        self._wake = asyncio.Event()
        self.ident: int | None = None
        """The identity of the thread that drives the loop, or None."""

    def start(self) -> None:
        """Create the task; an event loop must be running."""
        home = asyncio.get_running_loop()

        def notify() -> None:
            if not home.is_closed():
                home.call_soon_threadsafe(self._wake.set)

        self._loop.inbox.notify = notify
        self._task = home.create_task(self._run())
        self.ident = threading.get_ident()

    def suspend(self) -> None:
        """Do nothing: tasks of one thread do not run at the same time."""

    def unsuspend(self) -> None:
        """Make a turn at once."""
        self._loop.inbox.notify()

    def end(self) -> None:
        """Make no further turn; from any thread."""
        self._ended = True
        self._loop.inbox.notify()

    def join(self, timeout: float) -> bool:
        """Return at once: the task ends when the event loop gets to it."""
        self.ident = None
        return True

    async def _run(self) -> None:
        loop = self._loop
        while not self._ended:
            try:
                self._wake.clear()
                delay = loop.clock.delay(loop.turn())
                if delay == math.inf:
                    await self._wake.wait()
                else:
                    await asyncio.wait_for(self._wake.wait(), max(delay, 0.0))
            except TimeoutError:
                await asyncio.sleep(0)  # a wait of 0 lets no other task run
            except Exception as error:  # the task never ends without a trace
                loop.break_down(error)
                await asyncio.sleep(_INTERVAL)


class Driver:
    """Decides which thread may run a loop, and lets other threads submit commands to it.

    Parameters
    ----------
    loop : Loop
    name : str
        Name of the session, for its threads.
    """

    def __init__(self, loop: Loop, name: str) -> None:
        self.loop = loop
        self.name = name
        self._motor: LoopThread | LoopTask | None = None
        self._monitor: Monitor | None = None
        self._turning = threading.RLock()
        self._caller: int | None = None  # the thread that drives the loop itself, for a while

    @property
    def running(self) -> bool:
        """Return whether a thread or a task drives the loop."""
        return self._motor is not None and self._motor.ident is not None

    @property
    def runs_elsewhere(self) -> bool:
        """Whether another thread drives the loop, so that this one may wait for it."""
        return self._thread not in (None, threading.get_ident())

    @property
    def _inside_block(self) -> bool:
        """Whether a block of the program itself is the caller."""
        return self.loop.ticking and self._thread == threading.get_ident()

    @property
    def _thread(self) -> int | None:
        return self._caller or (self._motor.ident if self._motor is not None else None)

    # -- life ------------------------------------------------------------------------------------

    def start(self, kind: Literal["thread", "asyncio"], hung_after: float, dead_man: float | None) -> None:
        """Start a thread or a task and, where there are threads, the monitor."""
        if kind == "asyncio":
            self._motor = LoopTask(self.loop)
            self._motor.start()
            return
        self._motor = motor = LoopThread(self.loop, self._turning, f"lrp {self.name}")
        motor.start()
        self._monitor = Monitor(self.loop, motor, hung_after, dead_man)
        self._monitor.start()

    def end(self) -> bool:
        """End and join the threads, unless a block of their own asks; return whether they are gone.

        A block that does not return is interrupted; inside a call of C that does not help, and the
        thread, a daemon, is left running.
        """
        motor, monitor = self._motor, self._monitor
        over = True
        if motor is not None:
            motor.end()
            over = motor.join(PATIENCE)
            if not over and motor.ident not in (None, threading.get_ident()):
                _interrupt(motor.ident)
                over = motor.join(PATIENCE)
        if monitor is not None:
            monitor.end()
        if over:
            self._motor = self._monitor = None
        return over and not self.loop.ticking

    def interrupt(self) -> bool:
        """Make the running block fail at its next bytecode; return whether one runs."""
        thread = self._thread
        return bool(_running_block(self.loop, thread)) and thread is not None and _interrupt(thread)

    def seen(self) -> None:
        """Reset the dead man's switch."""
        if self._monitor is not None:
            self._monitor.seen()

    # -- commands --------------------------------------------------------------------------------

    def ask(self, command: Command) -> Future[Any]:
        """Queue a command, and apply it here if nothing else drives the loop; does not wait.

        Raises
        ------
        SessionClosedError
        """
        self.check_open()
        answer = self.loop.inbox.put(command)
        if not (self.runs_elsewhere or self._inside_block):
            with suppress(SessionTimeoutError), self.exclusive("ask"):  # if another is faster, it applies it
                self.loop.apply_queued()
        return answer

    def wait(self, answer: Future[Any], what: str) -> Any:
        """Wait for what :meth:`ask` returned; inside a block return None, as it is applied after the tick.

        Raises
        ------
        SessionTimeoutError
            The command is not applied yet and stays in the queue; the message names what blocks it.
        """
        if self._inside_block:
            return None
        try:
            return answer.result(PATIENCE)
        except FutureTimeout:
            if answer.done():  # the error is the command's own
                raise
            raise self._blocked(what) from None

    def do(self, command: Command) -> Any:
        """Apply a command, or have it applied, and return its result; see :meth:`ask`, :meth:`wait`."""
        what = re.sub(r"\B(?=[A-Z])", " ", type(command).__name__).lower()
        return self.wait(self.ask(command), what)

    def check_open(self) -> None:
        """Raise SessionClosedError if the session is closed."""
        if self.loop.status == "closed":
            raise SessionClosedError(f"The session `{self.name}` is closed.")

    @contextmanager
    def exclusive(self, what: str) -> Iterator[None]:
        """Drive the loop on the calling thread for a while; the driver's own thread is suspended.

        Raises
        ------
        SessionTimeoutError
            The driver's thread does not finish its turn.
        """
        motor = self._motor
        if motor is not None:
            motor.suspend()
        try:
            if not self._turning.acquire(timeout=PATIENCE):
                raise self._blocked(what)
            before, self._caller = self._caller, threading.get_ident()
            try:
                yield
            finally:
                self._caller = before
                self._turning.release()
        finally:
            if motor is not None:
                motor.unsuspend()

    def _blocked(self, what: str) -> SessionTimeoutError:
        block = _running_block(self.loop, self._thread)
        why = f"`{block}` has not returned" if block else "the session has been busy"
        return SessionTimeoutError(f"The command `{what}` waits: {why} for {PATIENCE:g} s.")


class Monitor:
    """A thread that watches a loop and its robot.

    Parameters
    ----------
    loop : Loop
    motor : LoopThread
    hung_after : float
        Wall seconds after which a tick is reported.
    dead_man : float or None
        Wall seconds without :meth:`seen` after which the program is paused; None: never.
    """

    def __init__(
        self,
        loop: Loop,
        motor: LoopThread,
        hung_after: float = 2.0,
        dead_man: float | None = None,
    ) -> None:
        self._loop = loop
        self._motor = motor
        self._hung_after = hung_after
        self._dead_man = dead_man
        self._seen = monotonic()
        self._under_way: tuple[object, float] = (None, monotonic())  # at the last check, and since when
        self._end = threading.Event()
        context = contextvars.copy_context()
        self._thread = threading.Thread(
            target=context.run, args=(self._run,), name="lrp monitor", daemon=True
        )

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def end(self) -> None:
        """End the thread, and wait for it."""
        self._end.set()
        if self._thread is not threading.current_thread() and self._thread.ident is not None:
            self._thread.join(5)

    def seen(self) -> None:
        """Reset the dead man's switch: a view has answered."""
        self._seen = monotonic()

    def _run(self) -> None:
        while not self._end.wait(min(_INTERVAL, self._hung_after / 4)):
            try:
                self._check()
            except BaseException as error:  # an unwatched robot must not move
                self._loop.break_down(error)
        self._report(0.0)

    def _check(self) -> None:
        loop, wall = self._loop, monotonic()
        known, since = self._under_way
        under_way = loop.interpreter.tick if loop.ticking else loop.foreign
        if under_way is None or type(under_way) is not type(known) or under_way != known:
            since = wall
        self._under_way = under_way, since
        since = wall - since
        self._report(since if since >= self._hung_after else 0.0)
        if loop.status != "running":
            self._seen = wall
            return
        if loop.bridge.time_step is None:  # a simulated time stands still, too
            loop.bridge.check_watchdog(loop.clock.now())
        if self._dead_man is not None and wall - self._seen > self._dead_man:
            self._seen = wall
            loop.bridge.stop_all()
            loop.inbox.put(Pause(f"The robot has not been watched for {self._dead_man:g} s."))

    def _report(self, since: float) -> None:
        loop = self._loop
        if not since:
            if loop.hung is not None:
                loop.hung = None
                loop.changed()
            return
        block = _running_block(loop, self._motor.ident)
        if block or loop.ticking or loop.foreign is not None:
            first = loop.hung is None
            loop.hung = Hung(block or ("the robot" if loop.ticking else "a command"), round(since, 1))
            if first:
                loop.bridge.stop_all()
            loop.changed()


def _running_block(loop: Loop, thread: int | None) -> str:
    """Return the name of the block that a thread is running (``moving.running``), or an empty text.

    The rendering of a value is named as a block is: ``x.__repr__``.
    """
    foreign = loop.foreign
    if thread is None or not (loop.ticking or foreign is not None):
        return ""
    if foreign is not None and foreign.name:
        return foreign.name
    frame = sys._current_frames().get(thread)
    filename = loop.interpreter.program.filename
    name = ""
    while frame is not None:  # the outermost one: a block may have called functions of its own
        if frame.f_code.co_filename == filename:
            name = frame.f_code.co_name
        frame = frame.f_back
    return name


def _interrupt(thread: int) -> bool:
    """Raise :class:`Interrupted` in a thread, at its next bytecode; return whether there is such a thread.

    Nothing can be raised inside a call of C; the exception is raised when that call returns.
    """
    raised: int = ctypes.pythonapi.PyThreadState_SetAsyncExc(
        ctypes.c_ulong(thread), ctypes.py_object(Interrupted)
    )
    return raised == 1
