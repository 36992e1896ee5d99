"""What happened in a run, handed from the interpreter's thread to the one that shows it."""

from __future__ import annotations

import math
import threading
from collections import deque

from lrp_jupyter.interpreter.events import TraceEvent
from lrp_jupyter.interpreter.frame import matches
from lrp_jupyter.language.program import Path
from lrp_jupyter.live.trace import Trace

__all__ = ["Happenings"]

_SHOWN = frozenset({"entered", "fired", "forced", "restarted", "issue", "paused", "resumed"})
_ROUNDING = 1e-6  # s


class Happenings:
    """An observer that only collects; whoever shows it takes from the left.

    Nothing after the end of the run is collected: a clock is not read to the very step.

    Parameters
    ----------
    seconds : float
        Length of the run; may be infinite.
    until : str, optional
        A state that ends the run; :attr:`reached` is set when it is entered.
    traced : bool
        Whether to keep the lines of a trace.

    Attributes
    ----------
    lines : deque of str
        Of the trace.
    news : deque of TraceEvent
        What a person may want to know.
    since : dict of path to float
        When the active states were entered, in seconds.
    """

    def __init__(self, seconds: float = math.inf, until: str | None = None, traced: bool = False) -> None:
        self.lines: deque[str] = deque()
        self.news: deque[TraceEvent] = deque()
        self.since: dict[Path, float] = {}
        self.reached = threading.Event()
        self._seconds = seconds
        self._until = until
        self._last_tick = math.inf
        self._trace = Trace(self.lines.append) if traced else None

    def __call__(self, event: TraceEvent) -> None:
        """Collect one event."""
        kind, path, tick, now, _ = event
        if now >= self._seconds - _ROUNDING or tick > self._last_tick:
            return
        if self._trace is not None:
            self._trace(event)
        if kind == "entered":
            self.since[path] = now
            if self._until is not None and matches(self._until, path):
                self._last_tick = tick
                self.reached.set()
        if kind in _SHOWN:
            self.news.append(event)
