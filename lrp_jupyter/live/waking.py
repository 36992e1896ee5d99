"""An event for which a task of asyncio waits, and which any thread sets."""

from __future__ import annotations

import asyncio
from contextlib import suppress

__all__ = ["TaskEvent"]


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
        """Wait again from now on."""
        self._event.clear()

    async def wait(self, seconds: float | None = None) -> None:
        """Wait until it is set, at most so long; other tasks run meanwhile in any case."""
        if seconds is not None and seconds <= 0:
            await asyncio.sleep(0)
            return
        with suppress(TimeoutError):
            await asyncio.wait_for(self._event.wait(), seconds)
