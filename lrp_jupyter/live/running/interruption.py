"""Interrupt a block that does not return: find it in its thread, and raise an exception in it.

Foreign code called by a loop, such as the ``sense`` method of a bridge or an observer, is interrupted in the
same way if it hangs.

Python can raise an exception in another thread, at its next bytecode. A block may catch it, as a loop around
``try: … except: pass`` does. The exception then returns: when it is caught and when it is discarded, it sets
a trace function that raises another one at the next line of the block or of a function called by it, and so
on until the block has ended. Nor is it lost in a finalizer (``__del__``, the callback of a weak reference),
where Python would discard it at once and report it on standard error.

Nothing can be raised inside a C call before it returns, except on the main thread in a call that Ctrl-C ends
(``time.sleep``): there, a signal ends it. A call that also holds the interpreter lock
(``sum(range(10**11))``) stops all threads of the process, so that nothing here runs.
"""

from __future__ import annotations

import ctypes
import signal
import sys
import threading
from collections.abc import Container, Iterator
from contextlib import contextmanager
from time import sleep
from types import FrameType
from typing import Any, NamedTuple

from lrp_jupyter.interpreter.faults import Interrupted


class RunningBlock(NamedTuple):
    """A block, or foreign code, that a thread is running; its frame identifies this execution of it.

    `line`: the line of the program that is running, from 1; 0 if none of its code is running.
    """

    name: str
    line: int
    frame: FrameType


_CALLERS = ("lrp_jupyter.live.running.values", "lrp_jupyter.live.running.foreign_code")
"""Modules of this package that call foreign code and survive any exception in it."""


def running_block(
    thread: int | None, filenames: Container[str], name: str = "", other: str = ""
) -> RunningBlock | None:
    """Return the block that a thread is running, or else the foreign code that its loop has called, or None.

    `filenames`: those of blocks; no other code has them.
    `name`: the name of foreign code that runs instead of a block, such as ``x.__repr__``.
    `other`: the name to use for unnamed foreign code; if empty, only blocks are returned.
    """
    frame = None if thread is None else sys._current_frames().get(thread)
    line, block, foreign, called = 0, None, None, True
    if frame is not None and _module(frame) in _CALLERS:
        foreign = frame  # a C call has no frame
    while frame is not None:  # a block may have called other functions
        if frame.f_code.co_filename in filenames:
            line, block = line or frame.f_lineno, frame
        called = called and _module(frame) != "lrp_jupyter.live.running.loop"
        if called and not _is_ours(frame):
            foreign = frame
        frame = frame.f_back
    if block is not None and not name:
        return RunningBlock(block.f_code.co_name, line, block)
    if foreign is None or not (name or other):
        return None
    if name:
        return RunningBlock(name, line, foreign)
    caller = foreign.f_back
    by_session = caller is not None and _module(caller) == "lrp_jupyter.live.running.foreign_code"
    return RunningBlock("an observer" if by_session else other, 0, foreign)


def _module(frame: FrameType) -> str:
    return str(frame.f_globals.get("__name__", ""))


def _is_ours(frame: FrameType) -> bool:
    return _module(frame).startswith("lrp_jupyter.")


_LOCKING = ("threading", "queue", "concurrent.futures._base")


def _takes_our_lock(frame: FrameType | None) -> bool:
    """Whether this package is waiting there for a lock that an exception would leave locked forever."""
    locking = False
    while frame is not None and _module(frame) in _LOCKING:
        locking, frame = True, frame.f_back
    return locking and frame is not None and _is_ours(frame)


_ROOM = 20  # frames that raising the exception may take; Python 3.11 aborts at 50 beyond the limit
_SOON = 0.02  # wall seconds in which a thread that runs Python reaches its next bytecode

_requested: dict[int, FrameType] = {}
"""The block to be interrupted, by the thread that runs it; removed when the exception is raised."""


def interrupt(thread: int, block: RunningBlock) -> bool:
    """Make a block raise :class:`~lrp_jupyter.interpreter.faults.Interrupted` at its next bytecode.

    Return whether it will: not if the thread no longer runs this block, or if this package is waiting for a
    lock in it.
    """
    frame = sys._current_frames().get(thread)
    if _takes_our_lock(frame):
        return False
    while frame is not None and frame is not block.frame:
        frame = frame.f_back
    if frame is None:
        return False
    _requested[thread] = block.frame
    _do_not_report_in_finalizers()
    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(limit + _ROOM)  # a block at the limit would raise a RecursionError instead
    try:
        raised: int = ctypes.pythonapi.PyThreadState_SetAsyncExc(
            ctypes.c_ulong(thread), ctypes.py_object(Interruption)
        )
        if thread != threading.get_ident():
            sleep(_SOON)
    finally:
        sys.setrecursionlimit(limit)
    return raised == 1


def _do_not_report_in_finalizers() -> None:
    report = sys.unraisablehook
    if getattr(report, "passes_interruptions", False):
        return

    def unless_it_returns(unraisable: sys.UnraisableHookArgs) -> None:
        if not issubclass(unraisable.exc_type, Interruption):
            report(unraisable)

    unless_it_returns.passes_interruptions = True  # type: ignore[attr-defined]
    sys.unraisablehook = unless_it_returns  # never reset: the thread may raise it much later


@contextmanager
def ending_calls() -> Iterator[None]:
    """Let :func:`interrupt_call` end C calls in this context, on the main thread of a POSIX system."""
    if threading.current_thread() is not threading.main_thread() or not hasattr(signal, "pthread_kill"):
        yield
        return

    before = signal.signal(signal.SIGURG, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGURG, signal.SIG_DFL if before is None else before)


def interrupt_call(thread: int) -> None:
    """End a C call by a KeyboardInterrupt, in :func:`ending_calls`; elsewhere do nothing."""
    if not hasattr(signal, "pthread_kill"):
        return
    if thread == threading.main_thread().ident and callable(signal.getsignal(signal.SIGURG)):
        ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), None)  # not both of them
        _requested.pop(thread, None)
        _settle()
        signal.pthread_kill(thread, signal.SIGURG)  # SIGINT is ignored in the background of a shell


def _settle() -> None:
    """Raise something here, in the place of what was called off: until then, Python looks for that.

    That costs time; and in Python 3.11 nothing would run that is traced or profiled, debuggers included.
    """
    try:
        me = threading.get_ident()
        ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(me), ctypes.py_object(_CalledOff))
        while True:
            pass
    except _CalledOff:
        pass


class _CalledOff(BaseException):
    """What is raised when nothing is to be raised any more."""


class Interruption(Interrupted):
    """An exception that returns when it is caught, until the block has ended."""

    _block: FrameType | None = None

    def __init__(self, block: FrameType | None = None) -> None:
        super().__init__()
        self._block = _requested.pop(threading.get_ident(), None) if block is None else block
        self._return(sys._getframe().f_back)

    def __del__(self) -> None:
        """Return, if the block has caught and discarded it."""
        self._return(sys._getframe().f_back)

    def _return(self, frame: FrameType | None) -> None:
        """Raise another one at the next line, if `frame` belongs to the block or was called by it."""
        block, frames = self._block, []
        while frame is not None and frame is not block:
            frames.append(frame)
            frame = frame.f_back
        if block is None or frame is None or _is_ours(block):  # it has ended, or has no frame
            return
        # A library may be cleaning up, for example releasing a lock.
        frames = [block, *(each for each in frames if each.f_globals is block.f_globals)]
        before = sys.gettrace()

        def trace(frame: FrameType, event: str, _: object) -> Any:
            if event == "line":
                raise Interruption(block)  # which ends the tracing
            if event == "return" and frame is block:
                sys.settrace(before)
                for each in frames:
                    each.f_trace = None
                frames.clear()
            return trace

        sys.settrace(lambda *_: None)
        for each in frames:
            each.f_trace = trace
