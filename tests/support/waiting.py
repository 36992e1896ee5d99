"""Waiting for what another thread or process does."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

_T = TypeVar("_T")


def until(holds: Callable[[], _T], what: str | Callable[[], object] = "", seconds: float = 120.0) -> _T:
    """Wait until a condition holds; return what it returned. The limit only ends a test that hangs."""
    end, tick = time.monotonic() + seconds, threading.Event()
    while not (value := holds()):
        if time.monotonic() > end:
            raise AssertionError((what() if callable(what) else what) or "it did not happen")
        tick.wait(0.005)
    return value


@contextmanager
def no_thread_left(ours: Callable[[threading.Thread], bool] = lambda _: True) -> Iterator[None]:
    """Assert that the threads started in a block have ended, or end soon after it."""
    before = set(threading.enumerate())
    yield
    left = [thread for thread in threading.enumerate() if thread not in before and ours(thread)]
    for thread in left:
        thread.join(120)
    assert not [thread for thread in left if thread.is_alive()]
