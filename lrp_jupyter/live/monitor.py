"""The second thread of a session: it watches the first.

A block that does not return holds up its loop and nothing else: the monitor says which block it
is, stops the robot, and can interrupt it. It also feeds the bridge's watchdog and pauses a robot
that nobody watches any more. It never touches the interpreter.
"""

from __future__ import annotations

import contextvars
import ctypes
import sys
import threading
from collections.abc import Callable
from time import monotonic
from typing import TYPE_CHECKING

from lrp_jupyter.live.commands import Pause
from lrp_jupyter.live.loop import Interrupted, Loop

if TYPE_CHECKING:
    from lrp_jupyter.live.drivers import Driver

__all__ = ["Monitor", "interrupt", "running_block"]

_LOOK = 0.1  # wall seconds between two looks


def running_block(loop: Loop, thread: int | None) -> str:
    """Name the block that a thread is in: ``moving.running``; empty when it is in none."""
    if thread is None or not loop.ticking:
        return ""
    frame = sys._current_frames().get(thread)
    filename = loop.interpreter.program.filename
    name = ""
    while frame is not None:  # the outermost one: a block may have called functions of its own
        if frame.f_code.co_filename == filename:
            name = frame.f_code.co_name
        frame = frame.f_back
    return name


def interrupt(thread: int) -> bool:
    """Raise :class:`Interrupted` in a thread, at its next bytecode; whether there is such a thread.

    Inside a call of C nothing can be raised; it comes when that call returns.
    """
    raised: int = ctypes.pythonapi.PyThreadState_SetAsyncExc(
        ctypes.c_ulong(thread), ctypes.py_object(Interrupted)
    )
    return raised == 1


class Monitor:
    """Watches a loop and its robot.

    Parameters
    ----------
    loop : Loop
    driver : Driver
    changed : callable
        Called when :attr:`hung` has changed.
    hung_after : float
        Wall seconds after which a tick is reported.
    dead_man : float or None
        Wall seconds without :meth:`seen` after which the program is paused; None: never.
    """

    def __init__(
        self,
        loop: Loop,
        driver: Driver,
        changed: Callable[[], None],
        hung_after: float = 2.0,
        dead_man: float | None = None,
    ) -> None:
        self.hung = ""
        """The sentence about a block that does not return; empty while all is well."""
        self.dead_man = dead_man
        self._loop = loop
        self._driver = driver
        self._changed = changed
        self._hung_after = hung_after
        self._seen = monotonic()
        self._tick = (-1, monotonic())  # the tick under way when we looked, and since when
        self._end = threading.Event()
        context = contextvars.copy_context()
        self._thread = threading.Thread(
            target=context.run, args=(self._run,), name="lrp monitor", daemon=True
        )

    def start(self) -> None:
        """Begin to watch."""
        self._thread.start()

    def end(self) -> None:
        """Watch no longer; returns when the thread is gone."""
        self._end.set()
        if self._thread is not threading.current_thread() and self._thread.ident is not None:
            self._thread.join(5)

    def seen(self) -> None:
        """Somebody watches the robot (a view returned a credit)."""
        self._seen = monotonic()

    def _run(self) -> None:
        while not self._end.wait(min(_LOOK, self._hung_after / 4)):
            self.look()

    def look(self) -> None:
        """Look once."""
        loop, wall = self._loop, monotonic()
        tick = loop.interpreter.tick if loop.ticking else -1
        if tick != self._tick[0] or tick == -1:
            self._tick = (tick, wall)
        since = wall - self._tick[1]
        self._report(since if since >= self._hung_after else 0.0)
        if loop.status != "running":
            self._seen = wall
            return
        if loop.bridge.time_step is None:  # where time is the session's own, it stands still too
            loop.bridge.check_watchdog(loop.clock.now())
        if self.dead_man is not None and wall - self._seen > self.dead_man:
            self._seen = wall
            loop.bridge.stop_all()
            loop.inbox.put(Pause(f"nobody has watched the robot for {self.dead_man:g} s"))

    def _report(self, since: float) -> None:
        if not since:
            if self.hung:
                self.hung = ""
                self._changed()
            return
        block = running_block(self._loop, self._driver.thread)
        if block or self._loop.ticking:
            first = not self.hung
            self.hung = f"`{block or 'the robot'}` has run for {since:.0f} s"
            if first:
                self._loop.bridge.stop_all()
            self._changed()
