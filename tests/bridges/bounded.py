"""Limits of time that a loaded machine does not break."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

_SLICE = 0.005  # s


@contextmanager
def bounded(seconds: float) -> Iterator[None]:
    """Assert that a block ends in time, by a clock that stands still while the machine runs something else.

    The clock is a second thread that counts how often it slept for 5 ms.
    """
    over, slices = threading.Event(), 0

    def count() -> None:
        nonlocal slices
        while not over.wait(_SLICE):
            slices += 1

    thread = threading.Thread(target=count, daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()
    took = slices * _SLICE
    assert took < seconds, f"it took {took:.2f} s of at most {seconds:g} s"
