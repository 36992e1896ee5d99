"""Stepping back: a log of what undoes every change of a run.

Whatever changes a run appends to the log, before it does so, a record that undoes that: a function
and its arguments. The end of a tick is logged as its time, so a tick in which nothing changed costs
one number. What happens between two ticks (an edit, a forced state) is rare and saves everything in
one saved state. Objects changed in place are not recorded: exact replay is a new run from recorded
inputs.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from types import CellType
from typing import Any

from lrp_jupyter.interpreter.cells import content, put

__all__ = ["Journal", "Record", "SavedState"]


Record = tuple[Any, ...] | float
"""``(function, *arguments)``: what undoes a change; or the time at which a tick ended, seconds."""


EDITS = 300
"""Saved states that are kept: each holds on to a whole program, and people type for hours."""


class Journal:
    """What undoes the last `bound` ticks, and no more than the last :data:`EDITS` saved states.

    ``log`` is appended to directly, by whatever changes the run. It begins with the time at which
    the first tick that can be undone began.
    """

    __slots__ = ("_bound", "_first", "_saved", "full", "log")

    def __init__(self, bound: int) -> None:
        self._bound = bound
        self._first = 0  # ticks that can no longer be undone
        self._saved: deque[int] = deque()  # the ticks after which they were made
        self.log: list[Record] = [0.0]
        self.full = 2 * bound
        """The tick at which to :meth:`trim`."""

    def reach(self, tick: int) -> int:
        """Return how many ticks can be undone after `tick` ticks."""
        return min(tick - self._first, self._bound)

    def save(self, ended: int, make: Callable[[], SavedState]) -> None:
        """Log a saved state, unless there is one since the last of `ended` ticks: it undoes all after it."""
        if self._saved and self._saved[-1] == ended:
            return
        self._saved.append(ended)
        self.log.append((make().restore,))
        if len(self._saved) > EDITS:
            self._drop(self._saved[0] + 1)

    def trim(self, tick: int) -> None:
        """Drop what lies further back than `bound` ticks; now and then, as it moves the whole log."""
        self._drop(tick - self._bound)
        self.full = tick + self._bound

    def _drop(self, first: int) -> None:
        """Let `first` be the number of ticks that can no longer be undone, if it is not higher already."""
        first = max(first, self._first)
        ends = (place for place, record in enumerate(self.log) if not isinstance(record, tuple))
        for _ in range(first - self._first):
            next(ends)
        del self.log[: next(ends)]
        self._first = first
        while self._saved and self._saved[0] < first:
            self._saved.popleft()

    def undo(self, tick: int, ticks: int) -> float:
        """Undo what came after the last tick, then `ticks` ticks, then what came before those.

        Parameters
        ----------
        tick : int
            The number of the last tick.
        ticks : int

        Returns
        -------
        float
            The time at which the tick ended that is the last one now.

        Raises
        ------
        ValueError
            If the journal does not reach back so far.
        """
        if not 0 <= ticks <= self.reach(tick):
            raise ValueError(f"the journal holds {self.reach(tick)} ticks: cannot go back {ticks}")
        self._drop(tick - self._bound)
        ends = 0
        while True:
            record = self.log.pop()
            if isinstance(record, tuple):
                record[0](*record[1:])
            elif ends == ticks:
                self.log.append(record)
                break
            else:
                ends += 1
        while self._saved and self._saved[-1] >= tick - ticks:
            self._saved.pop()
        return record


class SavedState:
    """Attributes of objects, and the contents of cells, at one moment.

    Parameters
    ----------
    parts : iterable of (object, names)
        Objects, and which of their attributes to save. A dict is copied.
    cells : iterable of types.CellType
    """

    __slots__ = ("_parts", "_values")

    def __init__(self, parts: Iterable[tuple[object, tuple[str, ...]]], cells: Iterable[CellType]) -> None:
        self._parts = [(part, {name: _copy(getattr(part, name)) for name in names}) for part, names in parts]
        self._values = [(cell, content(cell)) for cell in cells]

    def restore(self) -> None:
        """Set everything back."""
        for part, attributes in self._parts:
            for name, value in attributes.items():
                setattr(part, name, value)
        for cell, value in self._values:
            put(cell, value)


def _copy(value: object) -> object:
    return dict(value) if isinstance(value, dict) else value
