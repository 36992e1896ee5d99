"""The terminal of a run: single keys, read without waiting; the signals that end the run; and its output.

What commands a robot never waits for an output: a terminal after Ctrl-S, or a pipe that is not read, may
accept nothing for as long as it likes.
"""

from __future__ import annotations

import os
import select
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from queue import SimpleQueue
from typing import Any, Self

try:
    import termios
    import tty
except ImportError:  # pragma: no cover  (Windows: the run is ended by Ctrl-C)
    termios = None  # type: ignore[assignment]

_GONE = (OSError,) if termios is None else (OSError, termios.error)
"""What is raised where the terminal was closed."""
_PATIENCE = 2.0  # s that a person who wants the end waits for the output
_LOOK = 0.1  # s between two looks


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
            with suppress(*_GONE):  # or it is that of another session, whose keys are not for this one
                if os.tcgetpgrp(descriptor) == os.getpgrp():  # in the background it would be stopped
                    self._before = termios.tcgetattr(descriptor)
                    tty.setcbreak(descriptor, termios.TCSANOW)  # else it waits until all output was taken
                    self._descriptor = descriptor
        return self

    def __exit__(self, *_: object) -> None:
        if self._descriptor is not None:
            with suppress(*_GONE):
                termios.tcsetattr(self._descriptor, termios.TCSANOW, self._before)
            self._descriptor = None

    def pressed(self) -> str:
        """Return the keys pressed since the last call."""
        descriptor, keys = self._descriptor, ""
        with suppress(*_GONE):
            while descriptor is not None and select.select([descriptor], [], [], 0)[0]:
                data = os.read(descriptor, 100)
                if not data:
                    break
                keys += data.decode(errors="ignore")
        return keys


class Writer:
    """Makes calls that write, one after the other, on a thread of its own."""

    def __init__(self) -> None:
        self.failure: BaseException | None = None  # of one of them; no later one is made
        self._calls: SimpleQueue[Callable[[], object] | None] = SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="lrp output", daemon=True)

    def __call__(self, call: Callable[..., object], *arguments: object) -> None:
        """Have a call made, after the earlier ones; on one thread."""
        self._calls.put(partial(call, *arguments))
        if self._thread.ident is None:
            self._thread.start()

    @property
    def is_behind(self) -> bool:
        """Whether earlier calls wait."""
        return not self._calls.empty()

    def end(self, hurried: Callable[[], bool]) -> bool:
        """Wait until all calls were made, only a little once `hurried`; return whether they were."""
        self._calls.put(None)
        left = _PATIENCE
        while self._thread.is_alive() and left > 0:
            self._thread.join(_LOOK)
            left -= _LOOK if hurried() else 0.0
        return not self._thread.is_alive()

    def _run(self) -> None:
        while (call := self._calls.get()) is not None:
            if self.failure is None:
                try:
                    call()
                except BaseException as error:
                    self.failure = error


@contextmanager
def recorded_signals(wake: SimpleQueue[None]) -> Iterator[list[int]]:
    """Record the signals that end a run, instead of being killed by them while the robot still moves.

    `wake`: receives an item with each signal; safe in a signal handler, where an Event might deadlock.
    """
    caught: list[int] = []

    def record(number: int, _: object) -> None:
        caught.append(number)
        wake.put(None)

    names = [name for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK") if hasattr(signal, name)]
    before = {getattr(signal, name): signal.getsignal(getattr(signal, name)) for name in names}
    if "SIGHUP" in names and before[signal.SIGHUP] is signal.SIG_IGN:  # by `nohup`
        del before[signal.SIGHUP]
    for number in before:
        signal.signal(number, record)
    try:
        yield caught
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
