"""The journal: an undo log for stepping back.

Code that changes a run first pushes onto the log how to undo the change: values, then a function that pops
them and restores them. The end of a tick is logged as its time, so a tick in which nothing changed costs one
number. Changes between two ticks (an edit, a forced state) are rare, and each saves everything in one saved
state. Objects changed in place are not recorded: exact replay is a new run from recorded inputs.

The log is one flat list. A tuple per record would cost four times as much, because Python's garbage
collector visits each of them.

It keeps the requested number of ticks; by default :data:`TICKS` or those of the last :data:`SECONDS`,
whichever are more. It is also bounded by memory. Weighing every value would cost more than the tick, so a
sample is weighed from time to time; once there are large values, all values are weighed after every tick.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from sys import getsizeof
from types import CellType, FunctionType, NoneType
from typing import Any, TypeVar

from lrp_jupyter.interpreter.cells import content, put

Kind = TypeVar("Kind")

Log = list[Any]  # stacked records: values and the function that pops them; or the end of a tick, in seconds
Undo = Callable[[Log], None]
_VALUES: dict[Undo, int] = {}


def undoes(values: int) -> Callable[[Undo], Undo]:
    """Declare the number of `values` that a function pops from a log to undo a change."""

    def declare(undo: Undo) -> Undo:
        _VALUES[undo] = values
        return undo

    return declare


@undoes(2)
def undo_write(log: Log) -> None:
    """Restore the value of a cell."""
    cell = log.pop()
    put(cell, log.pop())


@undoes(3)
def undo_attribute(log: Log) -> None:
    """Restore an attribute of an object."""
    part, name = log.pop(), log.pop()
    setattr(part, name, log.pop())


@undoes(1)
def note(log: Log) -> None:
    """Drop a fact: it says what happened, and undoing it changes nothing."""
    log.pop()


def values_of(item: object) -> int | None:
    """Return how many values a function pops from a log; None for any other item of a log."""
    return _VALUES.get(item)  # type: ignore[call-overload, no-any-return]


TICKS, SECONDS = 10_000, 600.0  # fewest to keep, unless another number of ticks is requested
EDITS = 3_000  # maximum number of saved states: each holds a whole run, and people type for hours
MOST = 100_000_000  # maximum bytes of values and texts, roughly; beyond it the older half is dropped
LONGEST = 8_000_000  # maximum number of items of the log; beyond it fewer ticks are kept

_TICK = 30  # items of the log that take as much memory as the data that a session keeps of each tick
_MARKS = 8  # places where the log can be cut, if the fewest ticks are kept
_PAUSE = 256  # ticks between two weighings of small values, unless one is requested earlier
_SAMPLE = 16  # items of the log to weigh, in addition to a 64th of the new ones
_HEAVY = 100_000  # bytes above which everything is weighed
_PARTS = 8  # parts of a collection from which the size of the others is inferred
_LIGHT = {id(kind) for kind in (int, float, bool, NoneType, CellType, FunctionType)}  # `==` may be foreign


def weightless(kind: type[Kind]) -> type[Kind]:
    """Declare that the size of objects of a class does not matter."""
    _LIGHT.add(id(kind))
    return kind


class Journal:
    """The undo log of the last ticks, with at most the last :data:`EDITS` saved states.

    Code that changes the run appends to ``log`` directly. The log begins with the time at which the
    first tick that can be undone began.

    `ticks`: the number of ticks that can be undone.
    """

    __slots__ = (
        "_bytes",
        "_gone",
        "_known",
        "_marks",
        "_pause",
        "_saved",
        "_seconds",
        "_stride",
        "_ticks",
        "_weighed",
        "_weights",
        "log",
    )

    def __init__(self, ticks: int | None = None) -> None:
        self._ticks = TICKS if ticks is None else ticks
        self._seconds = SECONDS if ticks is None else 0.0
        self._stride = max(1, self._ticks // _MARKS)
        # Ticks, and the items of the log up to their ends. The first is the last that cannot be undone.
        self._marks: deque[tuple[int, int]] = deque([(0, 0)])
        self._gone = 0  # items of the log that were dropped
        self._saved: deque[int] = deque()  # the ticks after which states were saved
        self._weights: deque[tuple[int, int]] = deque()  # ticks, and the bytes added since the previous one
        self._bytes = 0  # their sum
        self._weighed = 1  # items of the log that are weighed
        self._known: set[int] = set()  # ids of large values in the log: each is weighed once
        self._pause = 1
        self.log: Log = [0.0]

    def begin(self, tick: int, now: float) -> None:
        """Begin after a number of ticks, the last of which ended at a time, in seconds."""
        self._marks, self._gone, self._weighed = deque([(tick, 0)]), 0, 1
        self.log[:] = [now]

    def reach(self, tick: int) -> int:
        """Return the number of ticks that can be undone after `tick` ticks."""
        held = tick - self._marks[0][0]
        return held if self._seconds else min(held, self._ticks)

    def save(self, ended: int, make: Callable[[], SavedState]) -> None:
        """Log a saved state, unless there is one since tick `ended`, which undoes everything after it."""
        if self._saved and self._saved[-1] == ended:
            return
        self._saved.append(ended)
        state = make()
        self.log += (state, _undo_everything)
        self._add(ended, sum(map(self._weight, state.values())))
        if len(self._saved) > EDITS:
            self._drop(self._saved[0] + 1)

    def trim(self, tick: int) -> int:
        """Drop records beyond the bounds; return the number of ticks after which to call this again."""
        marks = self._marks
        if tick - marks[-1][0] >= self._stride:
            marks.append((tick, self._gone + len(self.log) - 1))
            self._drop(next(marked for marked, place in reversed(marks) if self._covers(marked, place, tick)))
        weight = self._weigh()
        self._add(tick, weight)
        self._pause = 1 if weight >= _HEAVY else min(2 * self._pause, _PAUSE)
        if self._bytes > MOST:
            first = 0
            while self._weights and self._bytes > MOST // 2:
                first, weight = self._weights.popleft()
                self._bytes -= weight
            self._drop(min(first + 1, tick))
        return max(1, min(self._pause, marks[-1][0] + self._stride - tick))

    def _covers(self, marked: int, place: int, tick: int) -> bool:
        """Return whether the records after a mark are all that must be kept after `tick` ticks."""
        ticks, items = tick - marked, len(self.log) - (start := place - self._gone)
        if start == 0 or items + ticks * _TICK > LONGEST:
            return True
        return ticks >= self._ticks and self.log[-1] - self.log[start] >= self._seconds

    def _weigh(self) -> int:
        """Return roughly the number of bytes in the log that have not been weighed before."""
        log, new = self.log, len(self.log) - self._weighed
        self._weighed = len(log)
        count = new if self._pause == 1 else min(new, new // 64 + _SAMPLE)
        if count <= 0:
            return 0
        weight = sum([self._weight(item) for item in log[-count:] if id(type(item)) not in _LIGHT])
        return weight * new // count

    def _weight(self, value: object) -> int:
        """Return roughly the bytes of a value, 0 if it is known; contents are followed one level deep."""
        try:
            weight = getsizeof(value)
            kind = type(value)
            if kind is list or kind is tuple or kind is set or kind is dict:
                parts: Any = value.values() if kind is dict else value  # type: ignore[attr-defined]
                first = [getsizeof(part) for part in islice(parts, _PARTS)]
                weight += sum(first) * len(parts) // max(1, len(first))
            elif weight < _HEAVY:
                weight += _inside(value)
        except KeyboardInterrupt:
            raise
        except BaseException:  # `__sizeof__` is foreign code
            return 0
        if weight < _HEAVY // 100:
            return weight
        if id(value) in self._known:
            return 0
        self._known.add(id(value))
        return weight

    def _add(self, tick: int, weight: int) -> None:
        self._weights.append((tick, weight))
        self._bytes += weight

    def _drop(self, first: int) -> None:
        """Raise the number of ticks that can no longer be undone to `first`, unless it is already higher."""
        marks = self._marks
        if first <= marks[0][0]:
            return
        known = [place for tick, place in marks if tick == first]
        place = known[0] if known else self._gone + self.ends()[marks[0][0] - first - 1]
        while marks and marks[0][0] <= first:
            marks.popleft()
        marks.appendleft((first, place))
        cut, self._gone = place - self._gone, place
        del self.log[:cut]
        self._weighed = max(self._weighed - cut, 0)
        self._known.clear()  # other values may reuse the ids of dropped ones
        while self._weights and self._weights[0][0] < first:
            self._bytes -= self._weights.popleft()[1]
        while self._saved and self._saved[0] < first:
            self._saved.popleft()

    def since(self, tick: int) -> Log:
        """Return a copy of the log since the beginning of a tick, or of an earlier one."""
        place = next((place for marked, place in reversed(self._marks) if marked < tick), self._gone)
        return self.log[place - self._gone :]

    def ends(self) -> list[int]:
        """Return the indices in the log at which ticks end, newest first."""
        ends = []
        place = len(self.log) - 1
        while place >= 0:
            values = values_of(self.log[place])
            if values is None:
                ends.append(place)
            place -= 1 + (values or 0)
        return ends

    def undo(self, tick: int, ticks: int) -> float:
        """Undo changes after the last tick, then `ticks` ticks, then the changes right before those.

        Return the time at which the tick that is now the last one ended.

        `tick`: the number of the last tick.
        Raises ValueError: the journal does not reach back that far.
        """
        if not 0 <= ticks <= self.reach(tick):
            raise ValueError(f"Cannot go back {ticks} ticks: the journal holds {self.reach(tick)}.")
        self._drop(tick - self.reach(tick))
        while self._marks[-1][0] > tick - ticks:
            self._marks.pop()
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
        while self._weights and self._weights[-1][0] > tick - ticks:
            self._bytes -= self._weights.pop()[1]
        self._weighed = min(self._weighed, len(log))
        self._known.clear()
        self._pause = 1
        time: float = item
        return time


def _inside(value: object) -> int:
    """Return the bytes of an object's attributes; `getattr` might call its ``__getattr__``."""
    try:
        inner = object.__getattribute__(value, "__dict__")
    except AttributeError:
        return 0
    return sum([getsizeof(part) for part in inner.values()]) if type(inner) is dict else 0


class SavedState:
    """A copy of attributes of objects and of the contents of cells.

    There may be hundreds, each holding a whole run, so they are flat lists: the garbage collector has less to
    visit.

    `parts`: objects, and the names of the attributes to save. Their values are not copied.
    """

    __slots__ = ("_cells", "_parts", "_values")

    def __init__(self, parts: Iterable[tuple[object, tuple[str, ...]]], cells: Iterable[CellType]) -> None:
        self._parts: list[Any] = []
        for part, names in parts:
            self._parts += (part, names, *[getattr(part, name) for name in names])
        self._cells = list(cells)
        self._values = [content(cell) for cell in self._cells]

    def values(self) -> Iterator[object]:
        """Yield values that may be large: the contents of cells, and texts among the attributes."""
        yield from self._values
        for item in self._parts:
            if type(item) is tuple and item and type(item[0]) is str:
                yield item[0]

    def parts(self) -> Iterator[tuple[object, str, Any]]:
        """Yield every object with the name and the value of each saved attribute."""
        items = iter(self._parts)
        for part in items:
            for name in next(items):
                yield part, name, next(items)

    def cells(self) -> Iterator[tuple[CellType, object]]:
        """Yield every saved cell with its content."""
        return zip(self._cells, self._values, strict=True)

    def restore(self) -> None:
        """Restore everything."""
        for part, name, value in self.parts():
            setattr(part, name, value)
        for cell, value in self.cells():
            put(cell, value)


@undoes(1)
def _undo_everything(log: Log) -> None:
    log.pop().restore()
