"""The recent past of a run: what happened in each tick, and the state after it.

The journal is written to be undone from the end. Read backward without undoing anything, the same records
give every earlier state: each says what a variable, an active state or the tree of machines was *before*. The
history therefore costs a running program nothing until a question is asked.

A value that was changed in place is shown as it is now: the journal contains only its variable. To get its
earlier content, run the tick again.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from operator import itemgetter
from types import CellType
from typing import Any, NamedTuple

from lrp_jupyter.interpreter.cells import Slot, content
from lrp_jupyter.interpreter.countdowns import Countdown, countdowns
from lrp_jupyter.interpreter.facts import Commanded, Fact
from lrp_jupyter.interpreter.journal import Log, SavedState, note, undo_attribute, undo_write, values_of
from lrp_jupyter.interpreter.run import Run, undo_change, undo_fired
from lrp_jupyter.interpreter.trace_events import UNSET
from lrp_jupyter.interpreter.tree import Activation, Environment
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Path, Program

_Record = tuple[Any, list[Any]]  # a function that undoes a change, and its values; or None, and a tick's end
_when = itemgetter(0)


class Dated(NamedTuple):
    """A fact, and when it happened: the number of the tick; between two ticks, the first one plus a half."""

    when: float
    fact: Fact


@dataclass(frozen=True, slots=True)
class PastMachine:
    """A machine that ran."""

    path: Path  # as spawned
    state: Path  # that was active, by path of definition
    entered: float  # s: when the active state was entered
    holding: Mapping[str, float]  # s: since when the triggers of transitions hold, by id
    cells: dict[str, CellType]  # the variables that its blocks can access
    own: tuple[str, ...]  # its own variables among them
    inside: tuple[PastMachine, ...]  # what the active state had spawned, in order
    is_around: bool  # whether it only surrounded a machine that was started alone

    @property
    def full_path(self) -> Path:
        """The path of the active state, as spawned."""
        return (*self.path, self.state[-1])

    def walk(self) -> Iterator[PastMachine]:
        """Yield itself, then the machines inside, in the order of spawning."""
        yield self
        for machine in self.inside:
            yield from machine.walk()


@dataclass(frozen=True, slots=True)
class PastState:
    """The state of a run at one moment: its program, the root machines and the global variables."""

    program: Program
    machines: tuple[PastMachine, ...]
    cells: dict[str, CellType]
    values: dict[int, object] = field(repr=False)  # the values of the cells, by id of the cell

    def value(self, cell: CellType) -> object:
        """Return the value that a cell had, or UNSET."""
        return self.values.get(id(cell), UNSET)

    def machine(self, defined: Path, instance: Path | None = None) -> PastMachine | None:
        """Return a machine that ran, by path of definition, and by path as spawned if there were several.

        None if it only surrounded one that was started alone.
        """
        return next(
            (
                each
                for each in self.walk()
                if not each.is_around
                and each.state[:-1] == defined
                and (instance is None or each.path == instance)
            ),
            None,
        )

    def walk(self) -> Iterator[PastMachine]:
        """Yield all machines in the order of a tick."""
        for root in self.machines:
            yield from root.walk()

    @property
    def active(self) -> tuple[Path, ...]:
        """The paths of the innermost active states, as spawned."""
        return tuple(machine.full_path for machine in self.walk() if not machine.inside)

    @property
    def countdowns(self) -> dict[Path, Countdown]:
        """The transitions that waited for a time, by path as spawned: that of the machine, then the id."""
        found: dict[Path, Countdown] = {}
        for each in self.walk():
            if each.is_around:
                continue
            value = partial(self._value, each)
            found.update(countdowns(self.program, each.path, each.state, each.entered, each.holding, value))
        return found

    def _value(self, machine: PastMachine, name: str) -> object:
        return self.value(machine.cells[name]) if name in machine.cells else None

    @property
    def variables(self) -> dict[Path, object]:
        """The values of the variables, by path as spawned."""
        found: dict[Path, object] = {(name,): self.value(cell) for name, cell in self.cells.items()}
        for machine in self.walk():
            found |= {(*machine.path, name): self.value(machine.cells[name]) for name in machine.own}
        return {path: value for path, value in found.items() if value is not UNSET}


class History:
    """Reads the journal of a run. Used on the thread that ticks, between two ticks."""

    def __init__(self, run: Run) -> None:
        self.run = run
        self._last = 0  # the last tick that was read
        self._times: list[float] = []  # of the ticks that were read, in order
        self._told: list[Dated] = []  # the facts in these ticks and since
        self._seen = run.epoch, 0, 0  # what was available the last time
        self._programs: dict[object, Program] = {}

    @property
    def ticks(self) -> range:
        """The ticks that the journal holds."""
        run = self.run
        reach = run.journal.reach(run.ticks) if run.journal is not None else 0
        return range(run.ticks - reach + 1, run.ticks + 1)

    @property
    def _log(self) -> Log:
        return self.run.journal.log if self.run.journal is not None else []

    def refusal(self, tick: int, first: int = 0) -> str:
        """Return a sentence about why a tick is unknown, and which ticks, starting at `first`, are known."""
        ticks = self.ticks
        if self.run.journal is None:
            return "No tick is remembered, because `journal` is 0."
        if not ticks:
            return "No tick has run yet. Run the program first."
        first, last = max(first, ticks.start), ticks.stop - 1
        known = f"ticks {first} to {last}" if first < last else f"tick {last}"
        return f"Tick {tick} is not remembered. Ask about {known}."

    def time(self, tick: int) -> float:
        """Return the time of a tick, in seconds.

        Raises KeyError: the journal does not hold this tick.
        """
        self._read()
        if tick not in self.ticks:
            raise KeyError(tick)
        return self._times[tick - self._last - 1]

    def told(self, first: float = 0, last: float = math.inf) -> list[Dated]:
        """Return the facts in order: everything in the journal, or from one moment to another."""
        self._read()
        begin, end = bisect_left(self._told, first, key=_when), bisect_right(self._told, last, key=_when)
        return self._told[begin:end]

    def facts(self, when: float) -> list[Fact]:
        """Return the facts in a tick, or between two, in order."""
        return [fact for _, fact in self.told(when, when)]

    def _read(self) -> None:
        """Read new records of the journal, and forget those that it has dropped."""
        run = self.run
        seen, self._seen = self._seen, (run.epoch, run.ticks, len(self._log))
        if self._seen == seen:
            return
        first, last = self.ticks.start, self._last
        if run.epoch != seen[0]:  # ticks were undone, and new ones may have their numbers
            last = min(last, run.kept)
        begun = self._last - len(self._times) + 1
        del self._times[max(0, last + 1 - begun) :]
        del self._times[: max(0, first - begun)]
        self._last = last = last if self._times else first - 1
        del self._told[bisect_right(self._told, last, key=_when) :]
        del self._told[: bisect_left(self._told, first - 0.5, key=_when)]
        tick = run.ticks + 1
        when = tick - 0.5
        times, told = list[float](), list[Dated]()
        for function, values in _backward(self._log):
            if function is None:
                tick -= 1
                when = tick
                if tick == last:
                    break
                times.append(values[0])
            elif function is note or function is undo_fired:
                if type(values[0]) is Commanded:  # preceding facts happened before the tick
                    when = tick - 0.5
                told.append(Dated(when, values[0]))
        self._last = run.ticks
        self._times += reversed(times)
        self._told += reversed(told)

    def written(self, tick: int) -> frozenset[int]:
        """Return the ids of the cells that were written in a tick."""
        view = _View()
        for when in _moments(self._log, self.run.ticks, view):
            if when == tick:
                view.written.clear()
            elif when < tick:
                break
        return frozenset(view.written)

    def state(self, tick: int, *, before: bool = False) -> PastState:
        """Return the state after a tick; or `before` it, when it began.

        Raises ValueError: the journal does not hold this tick.
        """
        ticks = self.ticks
        if not (tick in ticks or (tick == ticks.start - 1 and not before)):
            raise ValueError(self.refusal(tick))
        view, wanted = _View(), tick - 0.5 if before else tick
        for when in _moments(self._log, self.run.ticks, view):
            if when == wanted:
                break
        return self._built(view)

    def followed(self, paths: Iterable[Path], after: int = 0) -> Iterator[tuple[int, dict[Path, object]]]:
        """Return the ticks after a tick, newest first, each with the values of variables at its end.

        Everything that is read of the run is copied now, so that any thread can iterate later.

        `paths`: the variables, by path as spawned; one that did not exist at the time is missing.
        """
        run, first = self.run, max(after + 1, self.ticks.start)
        view = _View()
        view.restore(run.saved_state())
        log = [] if run.journal is None else run.journal.since(first)
        return self._followed(list(paths), view, _moments(log, run.ticks, view), first)

    def _followed(
        self, paths: list[Path], view: _View, moments: Iterator[float], first: int
    ) -> Iterator[tuple[int, dict[Path, object]]]:
        cells: dict[Path, CellType] = {}
        for when in moments:
            if when < first:
                return
            if when != (tick := int(when)):
                continue
            if view.is_other:
                view.is_other = False
                own = {view.get(each, "path"): view.get(each, "own") for each in self._environments(view)}
                slots = {path: own.get(path[:-1], {}).get(path[-1]) for path in paths}
                cells = {path: slot.cell for path, slot in slots.items() if slot is not None}
            found = {path: view.value(cell) for path, cell in cells.items()}
            yield tick, {path: value for path, value in found.items() if value is not UNSET}

    def scopes_before(
        self, tick: int, is_home: Callable[[int, Path], bool]
    ) -> Iterator[tuple[int, Mapping[str, CellType], Callable[[CellType], object]]]:
        """Yield the earlier ticks at whose beginning a machine was running, newest first.

        With each tick come the variables that the blocks of the machine could access, and a function that
        returns the value that a cell held.

        `is_home`: returns whether a path as spawned was that of the machine in a tick; it is empty for the
            top level.
        """
        view = _View()
        cells: Mapping[str, CellType] | None = None
        for when in _moments(self._log, self.run.ticks, view):
            number = int(when + 0.5)
            if when == number or number >= tick:
                continue
            if view.is_other:
                view.is_other = False
                cells = self._visible(view, partial(is_home, number))
            if cells is not None:
                yield number, cells, view.value

    def _environments(self, view: _View) -> Iterator[Environment]:
        """Yield the top level, then the machines that ran."""
        yield view.get(self.run, "globals")
        waiting = list(view.get(self.run, "roots"))
        while waiting:
            act = waiting.pop()
            yield act
            waiting += view.get(act, "children")

    def _visible(self, view: _View, is_home: Callable[[Path], bool]) -> dict[str, CellType] | None:
        """Return the variables in the scope of a machine, or of the top level; None if it did not run."""
        for each in self._environments(view):
            if is_home(view.get(each, "path")):
                return {name: slot.cell for name, slot in view.get(each, "visible").items()}
        return None

    def _built(self, view: _View) -> PastState:
        run, environments = self.run, self._environments(view)
        slots = [slot for each in environments for slot in view.get(each, "visible").values()]
        return PastState(
            self._program(view.get(run, "source")),
            tuple(self._machine(view, act) for act in view.get(run, "roots")),
            {name: slot.cell for name, slot in view.get(view.get(run, "globals"), "own").items()},
            {id(slot.cell): view.value(slot.cell) for slot in slots},
        )

    def _machine(self, view: _View, act: Activation) -> PastMachine:
        visible: dict[str, Slot] = view.get(act, "visible")
        return PastMachine(
            view.get(act, "path"),
            view.get(act, "place"),
            view.get(act, "entered"),
            view.get(act, "holding"),
            {name: slot.cell for name, slot in visible.items()},
            tuple(view.get(act, "own")),
            tuple(self._machine(view, child) for child in view.get(act, "children")),
            (alone := view.get(self.run, "alone")) is not None and alone.is_inside(view.get(act, "path")),
        )

    def _program(self, source: tuple[str, str] | Program) -> Program:
        run = self.run
        if source == run.source:
            return run.program
        if isinstance(source, Program):
            return source
        if source not in self._programs:
            if len(self._programs) > 20:
                self._programs.clear()
            self._programs[source] = parse(*source)
        return self._programs[source]


class _View:
    """The values of attributes and cells at an earlier moment that differ from the current ones."""

    def __init__(self) -> None:
        self._attributes: dict[tuple[int, str], Any] = {}
        self._cells: dict[int, object] = {}
        self.written = set[int]()  # the ids of the cells for which a write was undone
        self.is_other = True  # whether machines or visible variables may have changed since it was False

    def get(self, part: object, name: str) -> Any:
        key = id(part), name
        return self._attributes[key] if key in self._attributes else getattr(part, name)

    def value(self, cell: CellType) -> object:
        return self._cells[id(cell)] if id(cell) in self._cells else content(cell)

    def undo(self, function: object, values: list[Any]) -> None:
        if function is undo_write:
            old, cell = values
            self._cells[id(cell)] = old
            self.written.add(id(cell))
        elif function is undo_change or function is undo_fired:
            *_, children, entered, place, act = values
            key = id(act)
            self.is_other = self.is_other or children is not self.get(act, "children")
            self._attributes[key, "children"] = children
            self._attributes[key, "entered"] = entered
            self._attributes[key, "place"] = place
        elif function is undo_attribute:
            value, name, part = values
            self._attributes[id(part), name] = value
            self.is_other = True
        elif function is not note:
            self.restore(values[0])
            self.is_other = True

    def restore(self, saved: SavedState) -> None:
        for part, name, value in saved.parts():
            self._attributes[id(part), name] = value
        for cell, value in saved.cells():
            self._cells[id(cell)] = value


def _moments(log: Log, ticks: int, view: _View) -> Iterator[float]:
    """Undo a log, which ends after some ticks, in a view; yield each end and each beginning of a tick.

    The end of a tick has its number, and its beginning half less: commands between two ticks precede it.
    """
    tick, has_begun = ticks + 1, True
    for function, values in _backward(log):
        if not has_begun and (function is None or (function is note and type(values[0]) is Commanded)):
            has_begun = True
            yield tick - 0.5
        if function is None:
            tick, has_begun = tick - 1, False
            yield tick
        else:
            view.undo(function, values)


def _backward(log: Log) -> Iterator[_Record]:
    """Yield the records of a log, newest first: a function and its values, or None and a time."""
    place = len(log) - 1
    while place >= 0:
        item = log[place]
        count = values_of(item)
        if count is None:
            yield None, [item]
            place -= 1
        else:
            yield item, log[place - count : place]
            place -= 1 + count
