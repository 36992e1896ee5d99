"""Signals that end a run: noted, so that the robot is stopped before the process ends."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event

__all__ = ["noted_signals"]


@contextmanager
def noted_signals(wake: Event) -> Iterator[list[int]]:
    """Note a signal that ends the run, instead of dying of it with a robot that still moves."""
    caught: list[int] = []

    def note(number: int, _: object) -> None:
        caught.append(number)
        wake.set()

    names = [name for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
    before = {getattr(signal, name): signal.getsignal(getattr(signal, name)) for name in names}
    for number in before:
        signal.signal(number, note)
    try:
        yield caught
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
