"""Who turns the loop: a thread, or asyncio.

The third driver is the caller, in ``Session.run``. Every driver does the same: a turn, then
waiting as long as the turn says. They differ in how they wait.
"""

from __future__ import annotations

import asyncio
import contextvars
import math
import threading
import time
from time import perf_counter
from typing import Protocol

from lrp_jupyter.live.loop import Loop

__all__ = ["AsyncioDriver", "Driver", "ThreadDriver"]

_HOLD = 0.0005  # wall seconds for which a loop that never waits may keep others from running …
_YIELD = 0.00005  # … and those for which it then sleeps


class Driver(Protocol):
    """What a session needs of a driver."""

    @property
    def thread(self) -> int | None:
        """Identity of the thread that turns the loop; None when nothing does."""

    def start(self) -> None:
        """Begin to turn."""

    def wake(self) -> None:
        """Look at the inbox, at once; from any thread."""

    def end(self) -> None:
        """Make no further turn; from any thread."""

    def join(self, timeout: float) -> bool:
        """Wait for the last turn; whether it is over."""


class ThreadDriver:
    """A daemon thread that turns the loop.

    Parameters
    ----------
    loop : Loop
    turning : RLock
        Held during each turn: whoever else drives for a while (``Session.run``) takes it.
    name : str
        The thread's name.
    """

    def __init__(self, loop: Loop, turning: threading.RLock, name: str) -> None:
        self._loop = loop
        self._turning = turning
        self._ended = False
        self._suspended = 0  # by so many callers who turn the loop themselves
        # The context is copied, or output of the thread would be routed to the cell run last.
        context = contextvars.copy_context()
        self._thread = threading.Thread(target=context.run, args=(self._run,), name=name, daemon=True)

    @property
    def thread(self) -> int | None:
        """See :class:`Driver`."""
        return self._thread.ident if self._thread.is_alive() else None

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def suspend(self) -> None:
        """Make no turn until :meth:`unsuspend`; the turn under way is finished."""
        self._suspended += 1

    def unsuspend(self) -> None:
        """Turn again, once as often as it was suspended."""
        self._suspended -= 1
        self.wake()

    def wake(self) -> None:
        """See :class:`Driver`."""
        self._loop.inbox.wake.set()

    def end(self) -> None:
        """See :class:`Driver`."""
        self._ended = True
        self.wake()

    def join(self, timeout: float) -> bool:
        """See :class:`Driver`."""
        if self._thread is not threading.current_thread():
            self._thread.join(timeout)
        return not self._thread.is_alive()

    def _run(self) -> None:
        loop, wake = self._loop, self._loop.inbox.wake
        rested = perf_counter()
        while not self._ended:
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


class AsyncioDriver:
    """A task of the running event loop: for places without threads, such as Pyodide."""

    def __init__(self, loop: Loop) -> None:
        self._loop = loop
        self._ended = False
        self._task: asyncio.Task[None] | None = None
        self._wake = asyncio.Event()
        self._home: asyncio.AbstractEventLoop | None = None
        self.thread: int | None = None

    def start(self) -> None:
        """Make the task; an event loop must be running."""
        self._home = asyncio.get_running_loop()
        self._task = self._home.create_task(self._run())
        self.thread = threading.get_ident()

    def wake(self) -> None:
        """See :class:`Driver`."""
        if self._home is not None and not self._home.is_closed():
            self._home.call_soon_threadsafe(self._wake.set)

    def end(self) -> None:
        """See :class:`Driver`."""
        self._ended = True
        self.wake()

    def join(self, timeout: float) -> bool:
        """Return at once: the task ends when the event loop gets to it."""
        self.thread = None
        return True

    async def _run(self) -> None:
        loop = self._loop
        while not self._ended:
            self._wake.clear()
            delay = loop.clock.delay(loop.turn())
            if delay == math.inf:
                await self._wake.wait()
            else:
                try:
                    await asyncio.wait_for(self._wake.wait(), max(delay, 0.0))
                except TimeoutError:
                    await asyncio.sleep(0)  # a wait of 0 gives nobody else a turn
