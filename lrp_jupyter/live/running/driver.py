"""Drivers of a loop: a thread, an asyncio task or the caller.

A :class:`Driver` decides which thread may run the loop, and lets other threads submit commands to it. A
command is applied

* by the driver's thread if there is one; the caller waits, for at most a few seconds;
* by the caller if nothing else drives the loop;
* after the tick, without waiting, if the call comes from a block of the program.
"""

from __future__ import annotations

import asyncio
import contextvars
import math
import re
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeout
from contextlib import contextmanager, suppress
from time import monotonic, perf_counter
from typing import Any, Literal

from lrp_jupyter.errors import LRPError, SessionClosedError, SessionTimeoutError
from lrp_jupyter.interpreter.faults import Interrupted
from lrp_jupyter.live.running.inbox import Command
from lrp_jupyter.live.running.interruption import RunningBlock, ending_calls, interrupt
from lrp_jupyter.live.running.loop import Loop
from lrp_jupyter.live.running.monitor import AGAIN, PATIENCE, Monitor, block_of
from lrp_jupyter.live.running.self_monitor import SelfMonitor
from lrp_jupyter.live.running.waking import TaskEvent

_HOLD = 0.0005  # wall seconds for which a loop that never waits may block other threads …
_YIELD = 0.00005  # … and for which it then sleeps
_REST = 0.1  # wall seconds for which a driver waits after a fault


class LoopThread:
    """A daemon thread that drives the loop; another one that holds `turning` drives it temporarily."""

    def __init__(self, loop: Loop, turning: threading.RLock, name: str) -> None:
        self._loop = loop
        self._turning = turning
        self._ended = False
        self._turned = threading.Event()  # the last turn is over
        self._suspended = 0  # number of callers that drive the loop themselves
        # The context is copied; otherwise output of the thread would be routed to the cell run last.
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
        """Make no turn until :meth:`unsuspend`; the current turn is finished."""
        self._suspended += 1

    def unsuspend(self) -> None:
        """Continue, once called as often as :meth:`suspend`."""
        self._suspended -= 1
        self._loop.inbox.notify()

    def end(self) -> None:
        """Make no further turn; from any thread."""
        self._ended = True
        self._loop.inbox.notify()

    def finish(self, timeout: float) -> bool:
        """Wait for the last turn and return whether it is over; a thread does not wait for itself."""
        return self._turned.wait(0 if self._thread is threading.current_thread() else timeout)

    def join(self, timeout: float) -> bool:
        """Wait for the end of the thread and return whether it came; a thread does not wait for itself."""
        if self._thread is not threading.current_thread():
            self._thread.join(timeout)
        return not self._thread.is_alive()

    def _run(self) -> None:
        try:
            self._turn()
        finally:
            self._turned.set()
        if self._turning.acquire(blocking=False):  # else another thread is driving the loop
            try:
                self._loop.leave()
            finally:
                self._turning.release()

    def _turn(self) -> None:
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
                    loop.timing.clock.sleep_until(until, wake)
                after = perf_counter()
                if after - before > _YIELD:
                    rested = after
                elif after - rested > _HOLD:  # other threads would wait 5 ms for the interpreter lock
                    time.sleep(_YIELD)
                    rested = perf_counter()
            except Interrupted:  # too late: the block had returned
                pass
            except BaseException as error:  # the thread never ends without a trace
                loop.break_down(error)
                wake.wait(_REST)


class LoopTask:
    """A task of the running event loop that drives the loop, for platforms without threads (Pyodide)."""

    def __init__(self, loop: Loop) -> None:
        self._loop = loop
        self._ended = False
        self._task: asyncio.Task[None] | None = None
        self._thread: int | None = None

    @property
    def ident(self) -> int | None:
        """The identity of the thread that drives the loop, or None."""
        return None if self._task is None or self._task.done() else self._thread

    def start(self) -> None:
        """Create the task; an event loop must be running."""
        wake = TaskEvent()
        self._loop.inbox.notify = wake.set
        self._task = asyncio.get_running_loop().create_task(self._run(wake))
        self._thread = threading.get_ident()

    def suspend(self) -> None:
        """Do nothing: tasks of one thread do not run at the same time."""

    def unsuspend(self) -> None:
        """Make a turn at once."""
        self._loop.inbox.notify()

    def end(self) -> None:
        """Make no further turn; from any thread."""
        self._ended = True
        self._loop.inbox.notify()

    def finish(self, timeout: float) -> bool:
        """Return at once, as :meth:`join` does."""
        return True

    def join(self, timeout: float) -> bool:
        """Return at once: the task ends when the event loop gets to it."""
        self._thread = None
        return True

    async def _run(self, wake: TaskEvent) -> None:
        loop = self._loop
        while not self._ended:
            try:
                wake.clear()
                delay = loop.timing.clock.delay(loop.turn())
                await wake.wait(None if delay == math.inf else delay)
            except Interrupted:  # too late: the block had returned
                pass
            except Exception as error:  # the task never ends without a trace
                loop.break_down(error)
                await asyncio.sleep(_REST)


class Driver:
    """Decides which thread may run a loop; see the module docstring."""

    def __init__(self, loop: Loop, name: str) -> None:
        self.loop = loop
        self.name = name
        self._motor: LoopThread | LoopTask | None = None
        self._monitor: Monitor | SelfMonitor | None = None
        # the monitor of the last run, if the driver had none; it ends without being asked to
        self._spare: Monitor | SelfMonitor | None = None
        self._turning = threading.RLock()
        self._caller: int | None = None  # the thread that temporarily drives the loop itself

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
        return self.loop.ticking is not None and self._thread == threading.get_ident()

    @property
    def _thread(self) -> int | None:
        return self._caller or (self._motor.ident if self._motor is not None else None)

    # -- life ------------------------------------------------------------------------------------

    def start(self, kind: Literal["thread", "asyncio"], hung_after: float, dead_man: float | None) -> None:
        """Start a thread or a task, and its monitor."""
        if kind == "asyncio":
            self._motor = LoopTask(self.loop)
            self._monitor = SelfMonitor(self.loop, hung_after)
        else:
            self._motor = LoopThread(self.loop, self._turning, f"lrp {self.name}")
            self._monitor = Monitor(self.loop, lambda: self._thread, hung_after, dead_man)
        self._motor.start()
        self._monitor.start()

    def leave(self) -> None:
        """Make no further turn; :meth:`end` does the rest."""
        if self._motor is not None:
            self._motor.end()

    def end(self) -> bool:
        """End and join the threads, unless called by a block that they run; return whether they have ended.

        A block that does not return is interrupted. Inside a C call that has no effect, and the thread, a
        daemon, is left running.

        What the program does at its end has time of its own: a block that is in its way is interrupted first.
        """
        motor, monitor = self._motor, self._monitor
        over = True
        self.leave()
        if motor is not None:
            over = self._comes(motor, motor.finish) and self._comes(motor, motor.join)
        for each in (monitor, self._spare):
            if each is not None:
                each.end()
        self._spare = None
        if over:
            self._motor = self._monitor = None
        return over and not self.loop.ticking

    def _comes(self, motor: LoopThread | LoopTask, end: Callable[[float], bool]) -> bool:
        """Wait for an end, interrupting one block after the other if it takes long; return if it came."""
        over, until = end(PATIENCE), monotonic() + PATIENCE
        while not over and motor.ident != threading.get_ident() and monotonic() < until:
            self.interrupt(others=True)
            over = end(AGAIN)
        return over

    def interrupt(self, others: bool = False) -> bool:
        """Interrupt the block that is running; return whether there is one.

        Foreign code is also interrupted if it hangs, or if `others` is true.
        """
        thread, block = self._thread, self._block(others or self.loop.hung is not None)
        if thread is None or block is None:
            return False
        if self._monitor is not None:
            self._monitor.note(block)
        return interrupt(thread, block)

    def leave_program(self) -> None:
        """Have the program do what it does at its end, if no thread has seen to that; see :meth:`Loop.leave`.

        Raises SessionTimeoutError: it did not return, or another thread did not make way.
        """
        with self.exclusive("stop"), self.limited(PATIENCE):
            self.loop.leave()
        self.end()

    @property
    def left_running(self) -> str:
        """A sentence about the block that still runs though the run has ended; empty if there is none."""
        block = self._block() if self._thread != threading.get_ident() else None
        if block is None:
            return ""
        line = f" (line {block.line})" if block.line else ""
        return f"`{block.name}`{line} did not return at the end of the run, and could not be interrupted."

    def _block(self, others: bool = True) -> RunningBlock | None:
        """Return the block or the foreign code that is running on the thread that drives the loop."""
        return None if self.loop.work is None else block_of(self.loop, self._thread, others)

    def seen(self) -> None:
        """Reset the dead man's switch."""
        if self._monitor is not None:
            self._monitor.seen()

    @contextmanager
    def limited(self, seconds: float) -> Iterator[None]:
        """End the run, with a SessionTimeoutError, if a block takes longer than these wall seconds."""
        monitor = self._monitor
        if monitor is None:
            monitor = self._spare
            if monitor is None or monitor.hung_after > seconds or not monitor.stays():
                monitor = Monitor(self.loop, lambda: self._thread, min(2.0, seconds))
                try:
                    monitor.start()
                except RuntimeError:  # there are no threads (Pyodide)
                    monitor = SelfMonitor(self.loop, min(2.0, seconds))
                    monitor.start()
            self._monitor = self._spare = monitor
        monitor.limit = seconds
        try:
            with ending_calls():
                yield
        except KeyboardInterrupt:
            if not monitor.ended_run:
                raise
        finally:
            monitor.limit = math.inf
            if monitor is self._spare:
                self._monitor = None
                monitor.leave()
        ended, monitor.ended_run = monitor.ended_run, ""
        if ended:
            raise SessionTimeoutError(ended)

    @property
    def has_exceeded(self) -> bool:
        """Whether a block has taken longer than :meth:`limited` allows, so that the run is to end."""
        return self._monitor is not None and bool(self._monitor.ended_run)

    # -- commands --------------------------------------------------------------------------------

    def ask(self, command: Command) -> Future[Any]:
        """Queue a command without waiting, and apply it here if nothing else drives the loop."""
        self.check_open()
        answer = self.loop.inbox.put(command)
        if not (self.runs_elsewhere or self._inside_block):
            with suppress(SessionTimeoutError), self.exclusive("ask"):  # a faster thread applies it instead
                self.loop.apply_queued()
        return answer

    def submit(self, command: Command) -> Future[Any]:
        """Queue a command and do not wait."""
        self.check_open()
        return self.loop.inbox.put(command)

    def wait(self, answer: Future[Any], kind: type[Command]) -> Any:
        """Wait for a future of :meth:`ask`; in a block return None, as it is applied after the tick.

        Raises SessionTimeoutError: the command has not been applied yet and stays in the queue; the message
            names what blocks it.
        """
        if self._inside_block:
            return None
        try:
            if not (kind.interrupts and self._monitor is not None):
                return answer.result(PATIENCE)
            return answer.result(PATIENCE + self._monitor.within)
        except FutureTimeout:
            if answer.done():  # the error is the command's own
                raise
            raise self._blocked(re.sub(r"\B(?=[A-Z])", " ", kind.__name__).lower()) from None

    def do(self, command: Command) -> Any:
        """Apply a command, or have it applied, and return its result."""
        return self.wait(self.ask(command), type(command))

    def check_open(self) -> None:
        """Raise SessionClosedError if the session is closed."""
        if self.loop.status == "closed":
            raise SessionClosedError(f"The session `{self.name}` is closed.")

    def refuse_inside(self, what: str) -> None:
        """Raise LRPError if a block of the program, or an observer, is the caller: the tick would not end."""
        if self._inside_block:
            raise LRPError(
                f"`{what}` cannot be called by a block of the program that runs: its tick has not ended. "
                "Use a state, or call it outside the program."
            )

    @contextmanager
    def exclusive(self, what: str) -> Iterator[None]:
        """Drive the loop on the calling thread; raise SessionTimeoutError if another does not make way."""
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
        block, hung = self._block(), self.loop.hung
        if hung is not None:
            return SessionTimeoutError(f"The command `{what}` waits: {hung}")
        why = f"`{block.name}` has not returned" if block and block.line else "the session has been busy"
        return SessionTimeoutError(f"The command `{what}` waits: {why} for {PATIENCE:g} s.")
