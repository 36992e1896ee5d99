"""The monitor of a loop on platforms without threads: a block that does not return interrupts itself.

In a browser nothing runs alongside a block: neither a monitor nor a message from the page. Python therefore
checks the time whenever the code of a block jumps backward, as every loop does, and raises in it the
exception that the monitor would raise. The program is then paused, since its next tick would take just as
long. Library code is not monitored and has no overhead; a single C call cannot be interrupted.
"""

from __future__ import annotations

import math
import sys
import sysconfig
import threading
from time import monotonic
from types import CodeType
from typing import Any

from lrp_jupyter.live.running.commands import Pause
from lrp_jupyter.live.running.interruption import Interruption
from lrp_jupyter.live.running.loop import Loop
from lrp_jupyter.live.running.monitor import block_of

_TOOL = 4  # id for `sys.monitoring` that is not reserved for debuggers, coverage, profilers or optimizers
_LIBRARIES = tuple({sysconfig.get_path(name) for name in ("stdlib", "purelib", "platlib")})
_watching: list[SelfMonitor] = []

monitoring: Any = getattr(sys, "monitoring", None)


class SelfMonitor:
    """Watches the blocks of a loop from inside; before Python 3.12 nothing is watched."""

    within = 0.0
    """See :class:`~lrp_jupyter.live.running.monitor.Monitor`; here a command interrupts nothing."""

    def __init__(self, loop: Loop, hung_after: float) -> None:
        self._loop = loop
        self.hung_after = hung_after
        self.limit = math.inf
        """Wall seconds that a block may take before the run is ended."""
        self.ended_run = ""
        """A sentence about the block that exceeded the limit; empty if none has."""
        self._work: tuple[object, float] = (None, 0.0)  # the current work, and its start

    def start(self) -> None:
        """Start watching."""
        _watching.append(self)
        if len(_watching) == 1:
            _monitor(True)

    def end(self) -> None:
        """Stop watching."""
        if self in _watching:
            _watching.remove(self)
            if not _watching:
                _monitor(False)

    def leave(self) -> None:
        """Stop watching: the run that needed it is over."""
        self.end()

    def stays(self) -> bool:
        """Return False: another run gets a new monitor, which costs nothing here."""
        return False

    def seen(self) -> None:
        """Do nothing: there is no dead man's switch without a thread, and no real robot."""

    def note(self, block: object) -> None:
        """Do nothing."""

    def check(self) -> None:
        """Raise an exception in the running block if it has been running for too long."""
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
        self._work = work, now  # the tick continues after the block
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
    """Check the time if code of a block or a notebook jumps; disable the event for all other code."""
    name = code.co_filename
    if name.startswith((*_LIBRARIES, "<frozen ")) or "/lrp_jupyter/" in name:
        return monitoring.DISABLE
    for monitor in _watching:
        monitor.check()
    return None
