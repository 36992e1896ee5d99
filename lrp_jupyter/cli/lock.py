"""End the process if one call of C never gives up the interpreter lock.

``sum(range(10**11))`` in a block stops all threads, those that handle signals and limits included. A timer of
the operating system needs no thread: after some seconds of computing without an interruption it has
the stacks of all threads written to stderr, then it ends the process.
"""

from __future__ import annotations

import faulthandler
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial

_INTERVAL = 0.5  # wall seconds between two extensions of the timer


@contextmanager
def watched_lock(seconds: float) -> Iterator[None]:
    """End the process after so many seconds of its computing in which no other thread could run.

    Without such a timer (Windows), seconds of the wall count. Does nothing where stderr is not a file.
    """
    try:
        extend, end = _timer(seconds)
        extend()
    except (OSError, RuntimeError, ValueError):
        yield
        return
    ended = threading.Event()

    def watch() -> None:
        while not ended.is_set():
            extend()
            ended.wait(_INTERVAL)

    thread = threading.Thread(target=watch, name="lrp lock", daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()
        end()


def _timer(seconds: float) -> tuple[Callable[[], object], Callable[[], object]]:
    """Return functions that set, or set again, the timer that ends the process, and that end it."""
    if not hasattr(signal, "setitimer"):
        extend = partial(faulthandler.dump_traceback_later, seconds, exit=True)
        return extend, faulthandler.cancel_dump_traceback_later
    faulthandler.register(signal.SIGVTALRM, chain=True)

    def end() -> None:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        faulthandler.unregister(signal.SIGVTALRM)

    return partial(signal.setitimer, signal.ITIMER_VIRTUAL, seconds), end
