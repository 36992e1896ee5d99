"""An event for which a task of asyncio waits, and which any thread sets."""

from __future__ import annotations

import asyncio


class TaskEvent:
    """Created inside the event loop whose task waits for it."""

    def __init__(self) -> None:
        self._home = asyncio.get_running_loop()
        self._event = asyncio.Event()

    def set(self) -> None:
        """Wake the task; from any thread."""
        if not self._home.is_closed():
            self._home.call_soon_threadsafe(self._event.set)

    def clear(self) -> None:
        """Make further calls of :meth:`wait` block."""
        self._event.clear()

    async def wait(self, seconds: float | None = None) -> None:
        """Wait until it is set, at most this long; other tasks get a chance to run in any case."""
        if self._event.is_set() or (seconds is not None and seconds <= 0):
            await asyncio.sleep(0)
        elif seconds is None:
            await self._event.wait()
        else:  # `wait_for` schedules a time of the clock, which Pyodide refuses once it has passed
            timer = self._home.call_later(seconds, self._event.set)
            try:
                await self._event.wait()
            finally:
                timer.cancel()
