"""The monitor of a loop: a thread that detects a block that does not return.

Such a block holds up only its loop: the monitor reports which block it is, stops the robot, and interrupts
the block if an edit or another command has been waiting for a second. It also feeds the bridge's watchdog and
pauses a robot that is no longer watched. It never accesses the interpreter.
"""

from __future__ import annotations

import contextvars
import math
import threading
from collections.abc import Callable
from time import monotonic
from types import FrameType

from lrp_jupyter.interpreter.variables import EXPRESSION
from lrp_jupyter.live.running.commands import Pause
from lrp_jupyter.live.running.frame import Hung
from lrp_jupyter.live.running.interruption import RunningBlock, interrupt, interrupt_call, running_block
from lrp_jupyter.live.running.loop import Loop

PATIENCE = 1.0
"""Maximum wall seconds that a call waits for its command, or a command for a block that does not return."""
AGAIN = 0.25
"""Wall seconds until a block, or the next block of the same tick, is interrupted again."""

_INTERVAL = 0.1  # wall seconds between two checks
_REUSED = 1.0  # wall seconds for which a monitor waits for another run


class Monitor:
    """A thread that watches a loop, its robot, and the thread that drives the loop.

    `dead_man`: wall seconds without a call of :meth:`seen` after which the program is paused; None for never.
    """

    def __init__(
        self,
        loop: Loop,
        thread: Callable[[], int | None],
        hung_after: float = 2.0,
        dead_man: float | None = None,
    ) -> None:
        self._loop = loop
        self._driving = thread
        self._hung_after = hung_after
        self._dead_man = dead_man
        now = self._seen = monotonic()
        self._reported = False
        self._work: tuple[object, float] = (None, now)  # the current work, and its start
        self._block: tuple[RunningBlock | None, float] = (None, now)  # the block in it, and its start
        self._waiting: float | None = None  # since when an interrupting command has waited
        self._interrupted: FrameType | None = None
        self._last = -math.inf  # wall time of the last interruption in this work
        self.limit = math.inf
        """Wall seconds after which a block is interrupted, and the program paused."""
        self.ended_run = ""
        """A sentence about the block that exceeded the limit; empty if none has."""
        self._notice: threading.Thread | None = None  # calls the listeners
        self._end = threading.Event()
        self._left = math.inf  # wall time at which the last run was over
        self._leaving = threading.Lock()
        context = contextvars.copy_context()
        self._thread = threading.Thread(
            target=context.run, args=(self._run,), name="lrp monitor", daemon=True
        )

    @property
    def hung_after(self) -> float:
        """Wall seconds after which a tick is reported as hung: at most the limit for a block."""
        return min(self._hung_after, self.limit)

    @property
    def _patience(self) -> float:
        return min(PATIENCE, self.hung_after)

    @property
    def within(self) -> float:
        """Wall seconds within which a block is interrupted for a command; 0 if it may take longer."""
        return self.hung_after + PATIENCE if self.hung_after <= 2 * PATIENCE else 0.0

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def end(self) -> None:
        """End the thread, and wait for it."""
        self._end.set()
        _join(self._thread, 5)
        _join(self._notice, PATIENCE)  # the first thread may just have started it

    def leave(self) -> None:
        """End the thread in a second unless :meth:`stays` is called: another run would also need one."""
        self._left = monotonic()

    def stays(self) -> bool:
        """Keep the thread after all; return whether it has not ended."""
        with self._leaving:
            self._left = math.inf
            return not self._end.is_set()

    def seen(self) -> None:
        """Reset the dead man's switch: a view has answered."""
        self._seen = monotonic()

    def note(self, block: RunningBlock) -> None:
        """Record that a block was interrupted: if it is still running later, it cannot be interrupted."""
        self._interrupted, self._last = block.frame, monotonic()

    def _run(self) -> None:
        while not self._end.wait(min(_INTERVAL, self.hung_after / 4)):
            try:
                self._check()
            except BaseException as error:  # an unwatched robot must not move
                self._loop.break_down(error)
            with self._leaving:
                if monotonic() - self._left > _REUSED:
                    self._end.set()
        self._report(None, 0.0)

    def _check(self) -> None:
        loop, wall = self._loop, monotonic()
        since = self._watch(wall)
        block = self._block[0]
        if since >= self.hung_after:
            self._report(block, since)
            if since >= self.limit:
                self._end_run()
            self._interrupt(wall)
        else:
            self._report(None, 0.0)
        loop.bridge.stop_again()
        if loop.status != "running":
            self._seen = wall
            return
        if loop.bridge.time_step is None:  # simulated time is also standing still
            loop.bridge.check_watchdog(loop.timing.expected())
        if self._dead_man is not None and wall - self._seen > self._dead_man:
            self._seen = wall
            loop.bridge.stop_all()
            loop.inbox.put(Pause(f"The robot has not been watched for {self._dead_man:g} s."))

    def _watch(self, wall: float) -> float:
        """Record what the loop is doing; return for how many wall seconds it has been doing it."""
        loop = self._loop
        work = loop.work
        if work is None or work is not self._work[0]:
            self._work = work, wall
            self._interrupted, self._last = None, -math.inf
        since = wall - self._work[1]
        block = None
        if since >= self._patience / 2:  # nothing to look for in most ticks
            block = block_of(loop, self._driving())
        known, began = self._block
        same = block is not None and known is not None and block.frame is known.frame
        self._block = block, began if same else wall
        in_command = loop.foreign is not None and not _name(loop) and not loop.ticking  # any but a step
        if not ((in_command and block is not None and block.line) or loop.inbox.interrupts()):
            self._waiting = None
        elif self._waiting is None:
            self._waiting = wall
        return since

    def _end_run(self) -> None:
        loop = self._loop
        if not self.ended_run and (hung := loop.hung) is not None:
            place, limit = f" (line {hung.line})" if hung.line else "", round(self.limit, 2)
            self.ended_run = (
                f"`{hung.where}`{place} did not return within {limit:g} s of computing, which ended the "
                "run. A block must end at once: use a state with `ontime` instead of waiting in a block."
            )
            loop.inbox.put(Pause(self.ended_run))
        self._waiting = -math.inf

    def _interrupt(self, wall: float) -> None:
        """Interrupt the block if a command is waiting for it, and again if it keeps running."""
        (block, began), thread = self._block, self._driving()
        if block is None or thread is None or self._waiting is None or wall - self._waiting < self._patience:
            return
        enough = self._patience if self._interrupted is None else min(self._patience, AGAIN)
        if wall - began < enough or wall - self._last < AGAIN:
            return
        if self.ended_run and block.frame is self._interrupted:
            interrupt_call(thread)
        else:
            interrupt(thread, block)
        self.note(block)

    def _report(self, block: RunningBlock | None, since: float) -> None:
        loop = self._loop
        if not since:
            if self._reported:
                self._reported = False
                loop.set_hung(None, None)
                self._notify()
            return
        if block is None:
            hung = Hung(_name(loop) or _other(loop), round(since, 1))
        else:
            held = block.frame is self._interrupted and monotonic() - self._last > AGAIN / 2
            hung = Hung(block.name, round(since, 1), block.line, held)
        loop.set_hung(self._work[0], hung)
        if not self._reported:
            self._reported = True
            loop.bridge.stop_all()
        self._notify()

    def _notify(self) -> None:
        """Call the listeners on a separate thread: one of them may be the code that does not return."""
        if self._notice is None or not self._notice.is_alive():
            context = contextvars.copy_context()
            self._notice = threading.Thread(
                target=context.run, args=(self._loop.changed,), name="lrp notice", daemon=True
            )
            self._notice.start()


def _join(thread: threading.Thread | None, seconds: float) -> None:
    if thread is not None and thread is not threading.current_thread() and thread.ident is not None:
        thread.join(seconds)


def block_of(loop: Loop, thread: int | None, others: bool = True) -> RunningBlock | None:
    """Return the block, expression, ``repr`` of a value or foreign code that a thread is running."""
    files = (loop.interpreter.program.filename, EXPRESSION)
    return running_block(thread, files, _name(loop), _other(loop) if others else "")


def _name(loop: Loop) -> str:
    foreign = loop.foreign
    return "" if foreign is None else foreign.name


def _other(loop: Loop) -> str:
    return "the robot" if loop.ticking else "a command"
