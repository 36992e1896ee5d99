"""The monitor of a loop where there are no threads: a block that does not return interrupts itself.

In a browser nothing runs beside a block: no monitor, and no message of a page, which could only wait for it.
So Python itself looks at the time whenever the code of a block jumps back, as every loop does, and raises in
it what the monitor would raise. The program is then paused, or its next tick would take as long.

The code of libraries is left alone, and costs nothing; a single call into C cannot be interrupted.
"""

from __future__ import annotations

import math
import sys
import sysconfig
import threading
from time import monotonic
from types import CodeType
from typing import Any

from lrp_jupyter.live.commands import Pause
from lrp_jupyter.live.interruption import Interruption
from lrp_jupyter.live.loop import Loop
from lrp_jupyter.live.monitor import block_of

_TOOL = 4  # of `sys.monitoring`: neither that of a debugger, of coverage, of a profiler nor of an optimizer
_LIBRARIES = tuple({sysconfig.get_path(name) for name in ("stdlib", "purelib", "platlib")})
_watching: list[SelfMonitor] = []

monitoring: Any = getattr(sys, "monitoring", None)


class SelfMonitor:
    """Watches the blocks of a loop from inside. Needs Python 3.12; before, nothing is watched.

    `hung_after`: wall seconds after which a block is interrupted.
    """

    within = 0.0
    """As for :class:`~lrp_jupyter.live.monitor.Monitor`: a command interrupts nothing."""

    def __init__(self, loop: Loop, hung_after: float) -> None:
        self._loop = loop
        self.hung_after = hung_after
        self.limit = math.inf
        """Wall seconds that a block may take in a run that then ends."""
        self.ended_run = ""
        """A sentence about the block that exceeded the limit; empty if none has."""
        self._work: tuple[object, float] = (None, 0.0)  # what is under way, and since when

    def start(self) -> None:
        """Watch from now on."""
        _watching.append(self)
        if len(_watching) == 1:
            _monitor(True)

    def end(self) -> None:
        """Watch no longer."""
        if self in _watching:
            _watching.remove(self)
            if not _watching:
                _monitor(False)

    def leave(self) -> None:
        """Watch no longer: the run that needed it is over."""
        self.end()

    def stays(self) -> bool:
        """Return False: the next run gets another one, which costs nothing here."""
        return False

    def seen(self) -> None:
        """Do nothing: there is no dead man's switch without a thread, and no real robot."""

    def note(self, block: object) -> None:
        """Do nothing."""

    def check(self) -> None:
        """Raise in the block that runs now if it has run for too long."""
        loop, now = self._loop, monotonic()
        work = loop.work
        if work is not self._work[0]:
            self._work = work, now
        since, limit = now - self._work[1], min(self.hung_after, self.limit)
        if work is None or since < limit:
            return
        block = block_of(loop, threading.get_ident())
        if block is None:
            return
        place = f" (line {block.line})" if block.line else ""
        reason = (
            f"`{block.name}`{place} did not return within {limit:g} s and was interrupted. "
            "A block must end at once: use a state with `ontime` instead of waiting in a block."
        )
        if since >= self.limit:
            self.ended_run = reason
        loop.inbox.put(Pause(reason))
        self._work = work, now  # the tick goes on after the block
        raise Interruption(block.frame)


def _monitor(on: bool) -> None:
    if monitoring is None:
        return
    if not on:
        monitoring.set_events(_TOOL, 0)
        monitoring.free_tool_id(_TOOL)
        return
    monitoring.use_tool_id(_TOOL, "lrp")
    monitoring.register_callback(_TOOL, monitoring.events.JUMP, _jumped)
    monitoring.set_events(_TOOL, monitoring.events.JUMP)
    monitoring.restart_events()


def _jumped(code: CodeType, start: int, end: int) -> object:
    """Check the time if code of a block or a notebook jumps; all other code never calls this again."""
    name = code.co_filename
    if name.startswith((*_LIBRARIES, "<frozen ")) or "/lrp_jupyter/" in name:
        return monitoring.DISABLE
    for monitor in _watching:
        monitor.check()
    return None
