"""End the process if one call of C never gives up the interpreter lock.

``sum(range(10**11))`` in a block stops all threads, those that handle signals and limits included. A timer of
the operating system needs no thread: after some seconds of computing without an interruption it has
the stacks of all threads written to stderr, then it ends the process.
"""

from __future__ import annotations

import faulthandler
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

_INTERVAL = 0.5  # wall seconds between two extensions of the timer


@contextmanager
def watched_lock(seconds: float) -> Iterator[None]:
    """End the process after so many seconds of computing in which no other thread could run.

    Does nothing where there are no such timers (Windows), or where stderr is not a file.

    `seconds`: seconds of computing of the whole process.
    """
    try:
        faulthandler.register(signal.SIGVTALRM, chain=True)
    except (AttributeError, OSError, ValueError):
        yield
        return
    ended = threading.Event()

    def extend() -> None:
        while not ended.is_set():
            signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
            ended.wait(_INTERVAL)

    thread = threading.Thread(target=extend, name="lrp lock", daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        faulthandler.unregister(signal.SIGVTALRM)
