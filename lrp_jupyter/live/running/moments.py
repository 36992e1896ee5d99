"""The moments of a session: when each remembered tick began, and the state of the robot then."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from itertools import islice
from typing import Any, NamedTuple


class Moment(NamedTuple):
    """The beginning of a tick: its time in seconds, the bridge's moment, and its token for the readings."""

    time: float
    world: object
    sensed: object


class Moments:
    """The moments of the last ticks, in order; or of the last tick only.

    `flat`: their parts in one list: the garbage collector would have to visit a tuple for each tick.
    """

    def __init__(self, *, only_last: bool = False) -> None:
        self.flat: list[Any] | deque[Any] = deque(maxlen=3) if only_last else []
        self.add = self.flat.extend

    def __len__(self) -> int:
        return len(self.flat) // 3

    def __getitem__(self, index: int) -> Moment:
        flat, place = self.flat, 3 * index
        return Moment(flat[place], flat[place + 1], flat[place + 2])

    def __iter__(self) -> Iterator[Moment]:
        parts = iter(self.flat)
        return map(Moment, parts, parts, parts)

    def last(self, ticks: int) -> Iterator[Moment]:
        """Return the moments of at most this number of ticks, newest first; copied now, for any thread."""
        parts = iter([*islice(reversed(self.flat), 3 * ticks)])
        return (Moment(time, world, sensed) for sensed, world, time in zip(parts, parts, parts, strict=True))

    def drop(self, ticks: int) -> None:
        """Drop the first moments."""
        if ticks > 0:
            del self.flat[: 3 * ticks]  # type: ignore[arg-type]

    def undo(self, ticks: int) -> None:
        """Drop the last moments."""
        if ticks > 0:
            del self.flat[-3 * ticks :]  # type: ignore[arg-type]

    def clear(self) -> None:
        """Drop all."""
        self.flat.clear()
