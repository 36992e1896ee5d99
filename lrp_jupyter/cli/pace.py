"""How a run advances: in real time, or as fast as possible.

Both advance the run on a thread of their own, so that the main thread can draw and handle signals.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace
from queue import SimpleQueue
from time import perf_counter

from lrp_jupyter.errors import LRPError, SessionTimeoutError
from lrp_jupyter.live.commands import EndAt, Pause, Resume
from lrp_jupyter.live.frame import Frame
from lrp_jupyter.live.session import Session

LIMIT = 10.0
"""Wall seconds that a block may take in a run of limited length."""

_PATIENCE = 1.0  # wall seconds for a block to return
_SLICE = 1.0  # seconds of the run between two checks for pause and end
_ROUNDING = 1e-6  # s


class Pace:
    """Advances a session in wall time, at the session's speed; ends at the exact time, or after the tick.

    `seconds`: length of the run, in its own time; may be infinite.
    `over`: returns whether the run has ended for another reason.
    """

    def __init__(self, session: Session, seconds: float, over: Callable[[], bool]) -> None:
        self._session = session
        self._seconds = seconds
        self._over = over

    def start(self) -> None:
        """Start the run."""
        session = self._session
        session.ask(EndAt(self._seconds))
        session.on_tick(self._end_if_over)
        session.start()

    def _end_if_over(self) -> None:
        if self._over():
            self._session.submit(EndAt(0.0))

    def is_over(self) -> bool:
        """Return whether the time is up or the run has ended by itself."""
        frame = self._session.frame
        over = frame.time >= self._seconds - _ROUNDING or self._over()
        return over or frame.status in ("broken", "closed", "stopped")

    def exceeded(self) -> str:
        """Return a sentence about the block that exceeds the :data:`LIMIT`; empty if none does."""
        hung = self._session.frame.hung
        return "" if hung is None or hung.seconds < LIMIT else f"{hung} It ended the run."

    def is_paused(self) -> bool:
        """Return whether the run is paused."""
        return self._session.status == "paused" and not self.is_over()

    def pause(self) -> None:
        """Pause the run."""
        self._session.ask(Pause())

    def resume(self) -> None:
        """Resume the run."""
        self._session.ask(Resume())

    def displayed(self, frame: Frame) -> Frame:
        """Return the frame to display for a frame of the session."""
        return frame

    def end(self) -> None:
        """Stop the robot and the thread that advances the run."""
        self._session.stop()


class Racing(Pace):
    """Advances a session without waiting, in slices of virtual time; ends at the exact step.

    `seconds`: length of the run; may be infinite.
    `until`: the state that ends the run.
    `wake`: gets an item when the run is over.
    """

    def __init__(self, session: Session, seconds: float, until: str | None, wake: SimpleQueue[None]) -> None:
        self._done = threading.Event()
        super().__init__(session, seconds, self._done.is_set)
        self._until = until
        self._wake = wake
        self._began = 0.0  # wall time
        self._going = threading.Event()
        self._stopping = False
        self._exceeded = ""
        self._thread = threading.Thread(target=self._run, name="race", daemon=True)

    def start(self) -> None:
        """Start the run."""
        self._began = perf_counter()
        self._going.set()
        self._thread.start()

    def _run(self) -> None:
        session = self._session
        try:
            while not self._stopping:
                self._going.wait()
                before = session.frame.time
                span = min(self._seconds - before, _SLICE)
                if self._stopping or span <= _ROUNDING or session.fault:
                    break
                try:
                    reached = session.run(span, until=self._until, limit=LIMIT)
                except SessionTimeoutError as error:  # a block did not return, which paused the run
                    self._exceeded = str(error)
                    self._going.clear()
                    self._wake.put(None)
                    continue
                if reached and self._until is not None:
                    break
                if session.frame.time < before + span - _ROUNDING:  # paused at an issue
                    self._going.clear()
        except LRPError:  # the session was closed during the run
            pass
        finally:
            self._done.set()
            self._wake.put(None)

    def is_over(self) -> bool:
        """See :class:`Pace`."""
        return self._over()

    def exceeded(self) -> str:
        """See :class:`Pace`."""
        return self._exceeded or super().exceeded()

    def is_paused(self) -> bool:
        """See :class:`Pace`."""
        return not self._going.is_set()

    def pause(self) -> None:
        """See :class:`Pace`."""
        self._going.clear()

    def resume(self) -> None:
        """See :class:`Pace`."""
        self._exceeded = ""
        self._going.set()

    def displayed(self, frame: Frame) -> Frame:
        """Return the frame with the status `running` between two slices, where the session is paused."""
        if frame.status not in ("paused", "running") or self.is_paused():
            return frame
        wall = perf_counter() - self._began
        return replace(frame, status="running", reason="", achieved_speed=frame.time / max(wall, 1e-3))

    def end(self) -> None:
        """See :class:`Pace`."""
        self._stopping = True
        self._going.set()
        if self._thread.is_alive():
            self._thread.join(_PATIENCE)
            if self._thread.is_alive() and self._session.interrupt():
                self._thread.join(_PATIENCE)
        super().end()
