"""Limits of time that a loaded machine does not break."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

_SLICE = 0.005  # s


@contextmanager
def bounded(seconds: float) -> Iterator[None]:
    """Assert that a block ends in time, apart from the time in which the machine ran something else.

    A second thread waits for slices of 5 ms; how much later they end is how long this process was not run.
    """
    over, late = threading.Event(), 0.0

    def measure() -> None:
        nonlocal late
        while not over.is_set():
            begin = time.monotonic()
            over.wait(_SLICE)
            late += max(0.0, time.monotonic() - begin - _SLICE)

    thread = threading.Thread(target=measure, daemon=True)
    begin = time.monotonic()
    thread.start()
    try:
        yield
        took = time.monotonic() - begin
    finally:
        over.set()
        thread.join()
    assert took - late < seconds
