"""The commands of a loop and the queue in which they wait for the thread that drives it."""

from __future__ import annotations

import threading
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, ClassVar

from lrp_jupyter.errors import LRPError


class Command(ABC):
    """A request to a loop: a frozen value, applied as a whole between two ticks.

    Subclasses override these defaults in the class statement: ``class Step(Command, moves=True)``.

    `misuse`: errors of :meth:`apply` that are the caller's mistakes; any other is a fault of this package.
    `recorded`: whether it changes the run, so that a replay of the run must also apply it.
    `undoes`: whether it undoes earlier commands.
    `mends`: whether it can be applied to a broken session.
    `moves`: whether it makes the program run.
    `interrupts`: whether a block that does not return is interrupted for it.
    `urgent`: whether it overtakes all waiting commands, and cancels those that would move the robot.
    `newest_wins`: whether it replaces a command of the same class queued directly before it.
    """

    __slots__ = ()

    misuse: ClassVar[tuple[type[BaseException], ...]] = (LRPError,)
    recorded: ClassVar[bool] = False
    undoes: ClassVar[bool] = False
    mends: ClassVar[bool] = False
    moves: ClassVar[bool] = False
    interrupts: ClassVar[bool] = False
    urgent: ClassVar[bool] = False
    newest_wins: ClassVar[bool] = False

    def __init_subclass__(cls, **traits: Any) -> None:
        for name, value in traits.items():
            setattr(cls, name, value)

    def kept(self, record: Any) -> tuple[Command, int]:
        """Return the form in which a record keeps it for a replay, and the number of characters of that."""
        return self, 0

    @abstractmethod
    def apply(self, loop: Any) -> Any:
        """Apply it to a :class:`~lrp_jupyter.live.running.loop.Loop`, and return its result."""


class Inbox:
    """Queue of commands, first in, first out; an urgent one is first.

    Any thread may call `put`; only the thread that drives the loop calls `get`. Every `put` sets
    :attr:`wake`, so that a sleeping loop wakes up.
    """

    def __init__(self) -> None:
        self.wake = threading.Event()
        self.notify: Callable[[], object] = self.wake.set
        """Called after every put; a driver that does not wait for `wake` sets its own function here."""
        self.queued: deque[tuple[Command, Future[Any]]] = deque()
        """Other code may only test whether it is empty, which needs no lock."""
        self._lock = threading.Lock()  # held by every put, which may replace the last entry

    def put(self, command: Command) -> Future[Any]:
        """Queue a command; the future receives its result or its error."""
        answer: Future[Any] = Future()
        with self._lock:
            if command.newest_wins and self.queued and type(self.queued[-1][0]) is type(command):
                _, superseded = self.queued.pop()
                superseded.cancel()
            if command.urgent:
                overtaken = [entry for entry in self.queued if entry[0].moves]
                for entry in overtaken:
                    self.queued.remove(entry)
                self.queued.appendleft((command, answer))
            else:
                overtaken = []
                self.queued.append((command, answer))
        for _, unanswered in overtaken:
            if unanswered.set_running_or_notify_cancel():
                unanswered.set_exception(LRPError("The program was paused before this was done."))
        self.notify()
        return answer

    def get(self) -> tuple[Command, Future[Any]] | None:
        """Remove and return the oldest command and its future; None if there is none."""
        with self._lock:
            return self.queued.popleft() if self.queued else None

    def interrupts(self) -> bool:
        """Return whether a command is waiting for which a block that does not return is interrupted."""
        with self._lock:
            return any(command.interrupts for command, _ in self.queued)

    def __len__(self) -> int:
        return len(self.queued)
