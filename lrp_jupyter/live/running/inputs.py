"""The inputs of a session: everything that came from outside, in order, each with its tick and its time.

A run is a function of its program, its robot and these inputs. They are rare, so recording them does not slow
down ticks; the readings of a simulated robot follow from them.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import takewhile
from threading import RLock
from typing import Any, NamedTuple

from lrp_jupyter.live.running.checkpoints import SessionCheckpoint
from lrp_jupyter.live.running.inbox import Command


@dataclass(frozen=True, slots=True)
class Pause(Command, interrupts=True, urgent=True):
    """Pause, for a reason (a sentence, or empty); the loop records this and its own pauses. Paper: §6.3."""

    reason: str = ""

    def apply(self, loop: Any) -> None:
        loop.pause(self.reason)


@dataclass(frozen=True, slots=True)
class Resume(Command, moves=True):
    """Start, or continue after a pause; the loop records it. Paper: §6.3."""

    def apply(self, loop: Any) -> None:
        loop.resume()


@dataclass(frozen=True, slots=True)
class EndRun(Command):
    """Pause without `onpause` because a run in virtual time is over; the loop records it."""

    def apply(self, loop: Any) -> None:
        loop.rest()


@dataclass(frozen=True, slots=True)
class EndProgram(Command, recorded=True):
    """Run the ``onend`` actions, once: the run is over, for good or until it starts again."""

    def apply(self, loop: Any) -> None:
        loop.end_program()


@dataclass(frozen=True, slots=True)
class Rewound:
    """Later ticks were undone; `checkpoint` is the session right after that, with everything not undone."""

    checkpoint: SessionCheckpoint


class Input(NamedTuple):
    """An input of a session: a command, :class:`Rewound`, or an action on the robot or its world.

    `tick`: how many ticks were completed before it.
    """

    number: int
    tick: int
    time: float
    what: object


_MOST = 50_000  # maximum number of inputs
_LETTERS = 8_000_000  # maximum number of characters of their texts


class Inputs:
    """The last inputs, bounded in number and in the size of their texts; in order of their ticks.

    Robots are commanded from any thread: code that adds inputs holds :attr:`lock`.
    """

    def __init__(self) -> None:
        self.lock = RLock()
        self._all: deque[tuple[Input, int]] = deque()
        self._letters = 0
        self.count = 0
        """The number of inputs so far."""
        self.lost = 0
        """The number of the last input that is no longer kept."""

    def __iter__(self) -> Iterator[Input]:
        """Iterate over the inputs that are kept now."""
        with self.lock:
            return iter([entry for entry, _ in self._all])

    def __len__(self) -> int:
        return len(self._all)

    def since(self, tick: int) -> list[Input]:
        """Return the inputs that came after at least this number of ticks, in order."""
        with self.lock:
            found = [entry for entry, _ in takewhile(lambda kept: kept[0].tick >= tick, reversed(self._all))]
        return found[::-1]

    def next(self, tick: int, time: float, what: object) -> Input:
        """Return an input with the next number; it is not kept yet."""
        with self.lock:
            self.count += 1
            return Input(self.count, tick, time, what)

    def keep(self, entry: Input, letters: int = 0) -> None:
        """Keep an input with a text of this number of characters; drop the oldest ones beyond the bounds."""
        with self.lock:
            self._all.append((entry, letters))
            self._letters += letters
            while len(self._all) > _MOST or self._letters > _LETTERS:
                oldest, weight = self._all.popleft()
                self._letters -= weight
                self.lost = oldest.number

    def begin(self, number: int) -> None:
        """Drop the inputs up to the one with this number."""
        with self.lock:
            while self._all and self._all[0][0].number <= number:
                self._letters -= self._all.popleft()[1]

    def undo(self, tick: int, stays: Callable[[object], bool]) -> list[Input]:
        """Drop, and return in order, the inputs after a tick, except those before the next one that stay."""
        kept: list[tuple[Input, int]] = []
        dropped = []
        with self.lock:
            while self._all and self._all[-1][0].tick >= tick:
                entry, letters = self._all.pop()
                if entry.tick == tick and stays(entry.what):
                    kept.append((entry, letters))
                else:
                    self._letters -= letters
                    dropped.append(entry)
            self._all.extend(reversed(kept))
        return dropped[::-1]

    def clear(self) -> None:
        """Drop all."""
        with self.lock:
            self._all.clear()
            self._letters = 0
