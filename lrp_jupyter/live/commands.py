"""What a session can be asked to do, as values, and the queue in which they wait.

Commands come from any thread and are carried out by one, between two ticks. Nothing else
crosses from the views to the interpreter.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any, Literal

from lrp_jupyter.language.program import Path, Program

__all__ = [
    "Call",
    "Command",
    "Edit",
    "Force",
    "Inbox",
    "Pause",
    "Rename",
    "Reset",
    "Resume",
    "Rewind",
    "SetPolicy",
    "SetRate",
    "SetSpeed",
    "SetVariable",
    "Step",
]


@dataclass(frozen=True, slots=True)
class Edit:
    """Go on with another program. Of several that wait in a row the newest wins."""

    program: Program


@dataclass(frozen=True, slots=True)
class Force:
    """Go to a state, by transition or by teleport. Paper: §6.4."""

    path: Path
    teleport: bool = False


@dataclass(frozen=True, slots=True)
class SetVariable:
    """Evaluate an expression in a variable's scope and assign it."""

    path: Path
    expression: str


@dataclass(frozen=True, slots=True)
class Rename:
    """Rename an element with all its references, without a restart."""

    kind: str
    path: Path
    new_name: str


@dataclass(frozen=True, slots=True)
class Rewind:
    """Go back by so many ticks."""

    ticks: int


@dataclass(frozen=True, slots=True)
class Reset:
    """Start the program anew at the next tick."""


@dataclass(frozen=True, slots=True)
class Pause:
    """Stand still, for a reason (a sentence, or nothing). Paper: §6.3."""

    reason: str = ""


@dataclass(frozen=True, slots=True)
class Resume:
    """Go on."""


@dataclass(frozen=True, slots=True)
class Step:
    """One tick, and one period of time."""


@dataclass(frozen=True, slots=True)
class SetRate:
    """Ticks per second; 0 is as fast as possible."""

    rate: float


@dataclass(frozen=True, slots=True)
class SetSpeed:
    """Seconds of the session per second of the wall."""

    speed: float


@dataclass(frozen=True, slots=True)
class SetPolicy:
    """Change ``on_active_edit`` or ``on_issue``."""

    name: Literal["on_active_edit", "on_issue"]
    value: str


@dataclass(frozen=True, slots=True, eq=False)
class Call:
    """Call a function between two ticks: the world is dragged, drawn on, reset by these."""

    function: Callable[[], Any]
    name: str = "call"


Command = (
    Edit
    | Force
    | SetVariable
    | Rename
    | Rewind
    | Reset
    | Pause
    | Resume
    | Step
    | SetRate
    | SetSpeed
    | SetPolicy
    | Call
)


class Inbox:
    """Commands that wait, first come first served.

    Any thread puts, the driving thread takes. :attr:`wake` is set by every put, so that a
    sleeping loop looks.
    """

    def __init__(self) -> None:
        self.wake = threading.Event()
        self._waiting: deque[tuple[Command, Future[Any]]] = deque()
        self._lock = threading.Lock()  # between those who put; an edit looks before it leaps

    def put(self, command: Command) -> Future[Any]:
        """Queue a command; the future gets its result, or its error."""
        answer: Future[Any] = Future()
        with self._lock:
            if isinstance(command, Edit) and self._waiting and isinstance(self._waiting[-1][0], Edit):
                _, superseded = self._waiting.pop()
                superseded.cancel()
            self._waiting.append((command, answer))
        self.wake.set()
        return answer

    def take(self) -> tuple[Command, Future[Any]] | None:
        """Return the oldest command and its future, or None."""
        if not self._waiting:  # the common case, at every tick: no lock
            return None
        with self._lock:
            return self._waiting.popleft() if self._waiting else None

    def __len__(self) -> int:
        return len(self._waiting)
