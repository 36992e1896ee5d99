"""The journal: an undo log for stepping back.

Code that changes a run first pushes onto the log how to undo the change: values, then a function
that pops them and restores them. The end of a tick is logged as its time, so a tick in which nothing
changed costs one number. What happens between two ticks (an edit, a forced state) is rare and saves
everything in one saved state. Objects changed in place are not recorded: exact replay is a new run from
recorded inputs.

The log is one flat list. A tuple per record would cost four times as much, because Python's garbage
collector visits each of them.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from types import CellType
from typing import Any

from lrp_jupyter.interpreter.cells import content, put

__all__ = ["Journal", "Log", "SavedState", "undo_write", "undoes"]


Log = list[Any]
"""A stack of records: values and the function that pops them; or the time at which a tick ended, seconds."""

Undo = Callable[[Log], None]
_VALUES: dict[Undo, int] = {}


def undoes(values: int) -> Callable[[Undo], Undo]:
    """Declare how many `values` a function pops from a log to undo a change."""

    def declare(undo: Undo) -> Undo:
        _VALUES[undo] = values
        return undo

    return declare


@undoes(2)
def undo_write(log: Log) -> None:
    """Restore the value of a cell."""
    cell = log.pop()
    put(cell, log.pop())


EDITS = 300
"""Maximum number of saved states: each keeps a whole program alive, and people type for hours."""


class Journal:
    """The undo log of the last `bound` ticks, with at most the last :data:`EDITS` saved states.

    Code that changes the run appends to ``log`` directly. The log begins with the time at which the
    first tick that can be undone began.
    """

    __slots__ = ("_bound", "_first", "_mark", "_saved", "log")

    def __init__(self, bound: int) -> None:
        self._bound = bound
        self._first = 0  # ticks that can no longer be undone
        self._mark = 0, 0  # a tick, and the index in the log at which it ends
        self._saved: deque[int] = deque()  # the ticks after which they were made
        self.log: Log = [0.0]

    def reach(self, tick: int) -> int:
        """Return how many ticks can be undone after `tick` ticks."""
        return min(tick - self._first, self._bound)

    def save(self, ended: int, make: Callable[[], SavedState]) -> None:
        """Log a saved state, unless there is one since tick `ended`, which undoes everything after it."""
        if self._saved and self._saved[-1] == ended:
            return
        self._saved.append(ended)
        self.log += (make(), _undo_everything)
        if len(self._saved) > EDITS:
            self._drop(self._saved[0] + 1)

    def trim(self, tick: int) -> int:
        """Drop what is older than `bound` ticks; return after how many ticks to call this again."""
        self._drop(tick - self._bound)
        self._mark = tick, len(self.log) - 1  # where to cut the next time
        return self._bound

    def _drop(self, first: int) -> None:
        """Raise the number of ticks that can no longer be undone to `first`, unless it is already higher."""
        first = max(first, self._first)
        marked, place = self._mark
        cut = place if marked == first else self.ends()[self._first - first - 1]
        del self.log[:cut]
        self._mark = marked, place - cut
        self._first = first
        while self._saved and self._saved[0] < first:
            self._saved.popleft()

    def ends(self) -> list[int]:
        """Return the indices in the log at which ticks end, the last one first."""
        ends = []
        place = len(self.log) - 1
        while place >= 0:
            values = _VALUES.get(self.log[place])
            if values is None:
                ends.append(place)
            place -= 1 + (values or 0)
        return ends

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
            The time at which the tick that is now the last one ended.

        Raises
        ------
        ValueError
            If the journal does not reach back that far.
        """
        if not 0 <= ticks <= self.reach(tick):
            raise ValueError(f"Cannot go back {ticks} ticks: the journal holds {self.reach(tick)}.")
        self._drop(tick - self._bound)
        if tick - ticks < self._mark[0]:
            self._mark = -1, 0
        log, ends = self.log, 0
        while True:
            item = log.pop()
            if item in _VALUES:
                item(log)
            elif ends == ticks:
                log.append(item)
                break
            else:
                ends += 1
        while self._saved and self._saved[-1] >= tick - ticks:
            self._saved.pop()
        time: float = item
        return time


class SavedState:
    """A copy of attributes of objects and of the contents of cells.

    There may be hundreds, each of a whole run: flat lists, so that the garbage collector has little to visit.

    Parameters
    ----------
    parts : iterable of (object, names)
        Objects, and the names of the attributes to save. Their values are not copied.
    cells : iterable of types.CellType
    """

    __slots__ = ("_cells", "_parts", "_values")

    def __init__(self, parts: Iterable[tuple[object, tuple[str, ...]]], cells: Iterable[CellType]) -> None:
        self._parts: list[Any] = []
        for part, names in parts:
            self._parts += (part, names, *[getattr(part, name) for name in names])
        self._cells = list(cells)
        self._values = [content(cell) for cell in self._cells]

    def restore(self) -> None:
        """Restore everything."""
        items = iter(self._parts)
        for part in items:
            for name in next(items):
                setattr(part, name, next(items))
        for cell, value in zip(self._cells, self._values, strict=True):
            put(cell, value)


@undoes(1)
def _undo_everything(log: Log) -> None:
    log.pop().restore()
