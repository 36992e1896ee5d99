"""Signals that end a run: noted, so that the robot is stopped before the process ends."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from queue import SimpleQueue

__all__ = ["noted_signals"]


@contextmanager
def noted_signals(wake: SimpleQueue[None]) -> Iterator[list[int]]:
    """Note signals that end a run, instead of dying of them with a robot that still moves.

    Parameters
    ----------
    wake : SimpleQueue
        Gets an item with each signal; it may be filled by a handler, where an Event might deadlock.
    """
    caught: list[int] = []

    def note(number: int, _: object) -> None:
        caught.append(number)
        wake.put(None)

    names = [name for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
    before = {getattr(signal, name): signal.getsignal(getattr(signal, name)) for name in names}
    for number in before:
        signal.signal(number, note)
    try:
        yield caught
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
