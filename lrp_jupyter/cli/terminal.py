"""The terminal of a run: single keys, read without waiting, and the signals that end the run."""

from __future__ import annotations

import os
import select
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from queue import SimpleQueue
from types import TracebackType
from typing import Any, Self

try:
    import termios
    import tty
except ImportError:  # pragma: no cover  (Windows: the run is ended by Ctrl-C)
    termios = None  # type: ignore[assignment]


class Keys:
    """A context manager that reads the keyboard key by key; Ctrl-C keeps its meaning."""

    def __init__(self) -> None:
        self._descriptor: int | None = None
        self._before: list[Any] = []

    @property
    def usable(self) -> bool:
        """Whether there is a keyboard, and this process is in its foreground."""
        return self._descriptor is not None

    def __enter__(self) -> Self:
        if termios is not None and sys.stdin is not None and sys.stdin.isatty():
            descriptor = sys.stdin.fileno()
            if os.tcgetpgrp(descriptor) == os.getpgrp():  # in the background it would be stopped
                self._before = termios.tcgetattr(descriptor)
                tty.setcbreak(descriptor)
                self._descriptor = descriptor
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._descriptor is not None:
            termios.tcsetattr(self._descriptor, termios.TCSADRAIN, self._before)
            self._descriptor = None

    def pressed(self) -> str:
        """Return the keys pressed since the last call."""
        descriptor, keys = self._descriptor, ""
        while descriptor is not None and select.select([descriptor], [], [], 0)[0]:
            data = os.read(descriptor, 100)
            if not data:
                break
            keys += data.decode(errors="ignore")
        return keys


@contextmanager
def recorded_signals(wake: SimpleQueue[None]) -> Iterator[list[int]]:
    """Record the signals that end a run, instead of being killed by them while the robot still moves.

    `wake`: receives an item with each signal; safe in a signal handler, where an Event might deadlock.
    """
    caught: list[int] = []

    def record(number: int, _: object) -> None:
        caught.append(number)
        wake.put(None)

    names = [name for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
    before = {getattr(signal, name): signal.getsignal(getattr(signal, name)) for name in names}
    for number in before:
        signal.signal(number, record)
    try:
        yield caught
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
