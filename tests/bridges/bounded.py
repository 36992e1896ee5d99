"""Limits of time that a loaded machine does not break."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

_SLICE = 0.005  # s


class PatientClock:
    """A clock that stands still while the machine runs something else; in seconds from its start.

    A thread counts how often it slept for 5 ms.
    """

    def __init__(self) -> None:
        self._slices = 0
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._count, name="patient clock", daemon=True)
        self._thread.start()

    def __call__(self) -> float:
        return self._slices * _SLICE

    def close(self) -> None:
        self._over.set()
        self._thread.join()

    def _count(self) -> None:
        while not self._over.wait(_SLICE):
            self._slices += 1


@contextmanager
def bounded(seconds: float) -> Iterator[None]:
    """Assert that a block ends in time, by a patient clock."""
    clock = PatientClock()
    try:
        yield
    finally:
        clock.close()
    took = clock()
    assert took < seconds, f"it took {took:.2f} s of at most {seconds:g} s"
