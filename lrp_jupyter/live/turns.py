"""Whose turn it is: the seam between the thread that turns a loop and everyone else.

A command is carried out by whoever may: by the driver's thread where there is one (the caller
waits, a second at most), by the caller where nothing else turns the loop, and after the tick,
without waiting, where a block of the program itself asks.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeout
from contextlib import contextmanager
from typing import Any, Literal

from lrp_jupyter.errors import SessionTimeoutError
from lrp_jupyter.live.commands import Command
from lrp_jupyter.live.drivers import AsyncioDriver, ThreadDriver
from lrp_jupyter.live.loop import Loop
from lrp_jupyter.live.monitor import Monitor, interrupt, running_block

__all__ = ["PATIENCE", "Turns"]

PATIENCE = 1.0
"""Wall seconds that a call waits for its command."""


class Turns:
    """A loop, its driver, its monitor, and the order among those who want to turn it.

    Parameters
    ----------
    loop : Loop
    name : str
        Of the session, for its threads.
    """

    def __init__(self, loop: Loop, name: str) -> None:
        self.loop = loop
        self.name = name
        self._driver: ThreadDriver | AsyncioDriver | None = None
        self._monitor: Monitor | None = None
        self._turning = threading.RLock()
        self._turned_by: int | None = None  # the thread that turns the loop itself, without a driver

    @property
    def driven(self) -> bool:
        """Whether a driver turns the loop."""
        return self._driver is not None and self._driver.thread is not None

    @property
    def waits_elsewhere(self) -> bool:
        """Whether another thread turns the loop, so that this one may wait for it."""
        return self._thread not in (None, threading.get_ident())

    @property
    def hung(self) -> str:
        """The sentence about a block that does not return, or nothing."""
        return self._monitor.hung if self._monitor is not None else ""

    # -- drivers ---------------------------------------------------------------------------------

    def start(
        self,
        kind: Literal["thread", "asyncio"],
        changed: Callable[[], None],
        hung_after: float,
        dead_man: float | None,
    ) -> None:
        """Start a driver and, where there are threads, the monitor."""
        if kind == "asyncio":
            self._driver = AsyncioDriver(self.loop)
            self._driver.start()
            return
        self._driver = driver = ThreadDriver(self.loop, self._turning, f"lrp {self.name}")
        driver.start()
        self._monitor = Monitor(self.loop, driver, changed, hung_after, dead_man)
        self._monitor.start()

    def end(self) -> bool:
        """End driver and monitor; join them, unless a block of their own asks. Whether all is over.

        A block that does not return is interrupted; inside a call of C that does not help, and the
        thread, a daemon, is left behind.
        """
        driver, monitor = self._driver, self._monitor
        over = True
        if driver is not None:
            driver.end()
            over = driver.join(PATIENCE)
            if not over and driver.thread not in (None, threading.get_ident()):
                interrupt(driver.thread)
                over = driver.join(PATIENCE)
        if monitor is not None:
            monitor.end()
        if over:
            self._driver = self._monitor = None
        return over and not self.loop.ticking

    def interrupt(self) -> bool:
        """Make the running block fail at its next bytecode; whether one runs."""
        thread = self._thread
        return bool(running_block(self.loop, thread)) and thread is not None and interrupt(thread)

    def seen(self) -> None:
        """Somebody watches the robot."""
        if self._monitor is not None:
            self._monitor.seen()

    @property
    def _thread(self) -> int | None:
        return self._turned_by or (self._driver.thread if self._driver is not None else None)

    # -- commands --------------------------------------------------------------------------------

    def submit(self, command: Command) -> Future[Any]:
        """Queue a command and do not wait."""
        answer = self.loop.inbox.put(command)
        if self._driver is not None:
            self._driver.wake()
        return answer

    def do(self, command: Command) -> Any:
        """Have a command carried out and return what it says.

        Raises
        ------
        SessionTimeoutError
            It is not carried out yet; the message says what blocks it. It stays in the queue.
        """
        here, thread = threading.get_ident(), self._thread
        if thread == here and self.loop.ticking:
            self.submit(command)  # asked from inside a block: after this tick
            return None
        name = type(command).__name__
        if thread is None or thread == here:
            with self.own(name):
                self.loop.carry_out_waiting()
                result = self.loop.carry_out(command)
                self.loop.show()
            return result
        answer = self.submit(command)
        try:
            return answer.result(PATIENCE)
        except FutureTimeout:
            if answer.done():  # the command itself failed so
                raise
            raise self._blocked(name) from None

    @contextmanager
    def own(self, what: str) -> Iterator[None]:
        """Turn the loop oneself for a while: the driver's thread stands by.

        Raises
        ------
        SessionTimeoutError
            It does not become free.
        """
        driver = self._driver
        if isinstance(driver, ThreadDriver):
            driver.suspend()
        try:
            if not self._turning.acquire(timeout=PATIENCE):
                raise self._blocked(what)
            before, self._turned_by = self._turned_by, threading.get_ident()
            try:
                yield
            finally:
                self._turned_by = before
                self._turning.release()
        finally:
            if isinstance(driver, ThreadDriver):
                driver.unsuspend()
            elif driver is not None:
                driver.wake()

    def _blocked(self, what: str) -> SessionTimeoutError:
        block = running_block(self.loop, self._thread)
        why = f"`{block}` has not returned" if block else "the session has been busy"
        return SessionTimeoutError(f"{what.lower()} waits: {why} for {PATIENCE:g} s")
