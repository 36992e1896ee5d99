"""The recent past of a run: what happened in each tick, and the state after it.

The journal is written for undoing, from the end. Read backward without undoing anything, the same records
give every earlier state: each says what a variable, an active state or the tree of machines was *before*. So
the past costs a running program nothing until a question is asked.

A value that was changed in place is shown as it is now: only its variable is in the journal. Who needs its
earlier content runs the tick again.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from operator import attrgetter
from types import CellType
from typing import Any

from lrp_jupyter.interpreter.cells import Slot, content
from lrp_jupyter.interpreter.events import UNSET
from lrp_jupyter.interpreter.facts import Commanded, Fact, Fired
from lrp_jupyter.interpreter.journal import Log, SavedState, note, undo_attribute, undo_write, values_of
from lrp_jupyter.interpreter.run import Run, undo_change, undo_fired
from lrp_jupyter.interpreter.tree import Activation
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Path, Program

_Record = tuple[Any, list[Any]]
"""A function that undoes a change, and its values; or None, and the time at which a tick ended."""
_tick = attrgetter("tick")


@dataclass(frozen=True, slots=True)
class TickFacts:
    """What happened in a tick.

    `tick`: the first is 1.
    `now`: seconds.
    `before`: what happened between the tick before and this one.
    `facts`: what happened in it, in order.
    `history`: whose tick it is.
    """

    tick: int
    now: float
    before: tuple[Fact, ...]
    facts: tuple[Fact, ...]
    history: History = field(repr=False, compare=False)

    @property
    def fired(self) -> list[Fired]:
        """The transitions that fired, in order."""
        return [fact for fact in self.facts if type(fact) is Fired]

    @property
    def written(self) -> frozenset[int]:
        """The ids of the cells that were written in it; read from the journal, which must hold it still."""
        return self.history.written(self.tick)


@dataclass(frozen=True, slots=True)
class PastMachine:
    """A machine that ran.

    `path`: as spawned.
    `state`: its active state, by path of definition.
    `entered`: when that was entered, in seconds.
    `cells`: the variables that its blocks can access.
    `own`: those that are its own.
    `inside`: the machines that the active state had spawned, in order.
    """

    path: Path
    state: Path
    entered: float
    cells: dict[str, CellType]
    own: tuple[str, ...]
    inside: tuple[PastMachine, ...]

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
    """The state of a run at one moment.

    `program`: the program that ran.
    `machines`: the root machines.
    `cells`: the global variables.
    """

    program: Program
    machines: tuple[PastMachine, ...]
    cells: dict[str, CellType]
    values: dict[int, object] = field(repr=False)
    """The values of the cells, by id of the cell."""

    def value(self, cell: CellType) -> object:
        """Return the value that a cell had, or UNSET."""
        return self.values.get(id(cell), UNSET)

    def walk(self) -> Iterator[PastMachine]:
        """Yield all machines in the order of a tick."""
        for root in self.machines:
            yield from root.walk()

    @property
    def active(self) -> tuple[Path, ...]:
        """The paths of the innermost active states, as spawned."""
        return tuple(machine.full_path for machine in self.walk() if not machine.inside)

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
        self._told: list[TickFacts] = []  # those of them in which something happened
        self._epoch = run.epoch
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
        """Return a sentence: why a tick is unknown, and which ones from `first` on are known."""
        ticks = self.ticks
        if self.run.journal is None:
            return "No tick is remembered, because `journal` is 0."
        if not ticks:
            return "No tick has run yet. Run the program first."
        first, last = max(first, ticks.start), ticks.stop - 1
        known = f"ticks {first} to {last}" if first < last else f"tick {last}"
        return f"Tick {tick} is not remembered. Ask about {known}."

    def facts(self, tick: int) -> TickFacts:
        """Return what happened in a tick.

        Raises KeyError: the journal does not hold this tick.
        """
        now = self.time(tick)
        place = self._place(tick)
        if place < len(self._told) and self._told[place].tick == tick:
            return self._told[place]
        return TickFacts(tick, now, (), (), self)

    def time(self, tick: int) -> float:
        """Return the time of a tick, in seconds.

        Raises KeyError: the journal does not hold this tick.
        """
        self._read()
        if tick not in self.ticks:
            raise KeyError(tick)
        return self._times[tick - self._last - 1]

    def told(self, first: int = 0) -> list[TickFacts]:
        """Return what happened in the ticks from one on, in order; without those in which nothing did."""
        self._read()
        return self._told[self._place(max(first, self.ticks.start)) :]

    def since(self) -> tuple[Fact, ...]:
        """Return what happened after the last tick."""
        found: list[Fact] = []
        for function, values in _backward(self._log):
            if function is None:
                break
            if function is note or function is undo_fired:
                found.append(values[0])
        return tuple(reversed(found))

    def written(self, tick: int) -> frozenset[int]:
        """Return the ids of the cells that were written in a tick."""
        number, found = self.run.ticks + 1, set()
        for function, values in _backward(self._log):
            if function is None:
                number -= 1
            if number < tick or (number == tick and function is note and type(values[0]) is Commanded):
                break
            if number == tick and function is undo_write:
                found.add(id(values[1]))
        return frozenset(found)

    def _place(self, tick: int) -> int:
        """Return how many of the ticks in which something happened were before a tick."""
        return bisect_left(self._told, tick, key=_tick)

    def _read(self) -> None:
        """Read the ticks that were added to the journal, and forget those that it has dropped."""
        run, ticks = self.run, self.ticks
        if self._epoch != run.epoch:  # it was undone, and other ticks may have the same numbers now
            self._epoch = run.epoch
            self._forget(ticks.start, run.kept)
        if self._last == run.ticks:
            return
        self._forget(ticks.start, self._last)
        tick, times, told = run.ticks, list[float](), list[TickFacts]()
        facts: list[Fact] | None = None
        before: list[Fact] = []
        now = 0.0
        for function, values in _backward(self._log):
            if function is None:
                if facts is not None:
                    times.append(now)
                    if facts or before:
                        told.append(TickFacts(tick, now, tuple(before[::-1]), tuple(facts[::-1]), self))
                    tick -= 1
                if tick < max(self._last + 1, ticks.start):
                    break
                now, facts, before = values[0], [], []
            elif facts is not None and (function is note or function is undo_fired):
                if before or type(values[0]) is Commanded:  # what comes before it happened before the tick
                    before.append(values[0])
                else:
                    facts.append(values[0])
        self._last = run.ticks
        self._times += reversed(times)
        self._told += reversed(told)

    def _forget(self, first: int, last: int) -> None:
        """Forget the ticks before the first and after the last one."""
        begun = self._last - len(self._times) + 1
        del self._times[max(0, last + 1 - begun) :]
        del self._times[: max(0, first - begun)]
        del self._told[self._place(last + 1) :]
        del self._told[: self._place(first)]
        self._last = min(self._last, last) if self._times else first - 1

    def state(self, tick: int, *, before: bool = False) -> PastState:
        """Return the state after a tick; or `before` it, when it began.

        Raises ValueError: the journal does not hold this tick.
        """
        run = self.run
        ticks = self.ticks
        if not (tick in ticks or (tick == ticks.start - 1 and not before)):
            raise ValueError(self.refusal(tick))
        view = _View()
        number = run.ticks + 1
        for function, values in _backward(self._log):
            if function is None:
                number -= 1
                if number == tick and not before:
                    break
                if number < tick:
                    break
                continue
            if before and number == tick and function is note and type(values[0]) is Commanded:
                break  # what comes before it happened before the tick began
            view.undo(function, values)
        return self._built(view)

    def followed(self, paths: Iterable[Path], after: int = 0) -> Iterator[tuple[int, dict[Path, object]]]:
        """Return the ticks after a tick, the last one first, each with the values of variables at its end.

        All that is read of the run is copied now, so that any thread can go through them later.

        `paths`: as spawned; one that did not exist then is missing.
        """
        run, first = self.run, max(after + 1, self.ticks.start)
        view = _View()
        view.restore(run.saved_state())
        log = [] if run.journal is None else run.journal.since(first)
        return self._followed(list(paths), view, log, range(first, run.ticks + 1))

    def _followed(
        self, paths: list[Path], view: _View, log: Log, ticks: range
    ) -> Iterator[tuple[int, dict[Path, object]]]:
        number = ticks.stop - 1
        cells: dict[Path, CellType] | None = self._cells(view, paths)
        begun = False  # what was done since the last tick comes first
        for function, values in _backward(log):
            if function is None:
                if begun:
                    number -= 1
                begun = True
                if number not in ticks:
                    return
                if cells is None:
                    cells = self._cells(view, paths)
                found = {path: view.value(cell) for path, cell in cells.items()}
                yield number, {path: value for path, value in found.items() if value is not UNSET}
                continue
            if view.undo(function, values):
                cells = None

    def _cells(self, view: _View, paths: Iterable[Path]) -> dict[Path, CellType]:
        """Return the cells of those variables that exist in a view."""
        own: dict[Path, dict[str, Slot]] = {(): view.get(view.get(self.run, "globals"), "own")}
        waiting = list(view.get(self.run, "roots"))
        while waiting:
            act = waiting.pop()
            own[view.get(act, "path")] = view.get(act, "own")
            waiting += view.get(act, "children")
        return {path: slots[path[-1]].cell for path in paths if path[-1] in (slots := own.get(path[:-1], {}))}

    def scopes_before(
        self, tick: int, machine_at: Callable[[int], Path]
    ) -> Iterator[tuple[int, Mapping[str, CellType], Callable[[CellType], object]]]:
        """Yield the ticks before a tick in which a machine ran when they began, the last one first.

        Each comes with the variables that the blocks of the machine could access, and with what returns the
        value that a cell held.

        `machine_at`: returns the path of definition that the machine had in a tick; empty for the top level.
        """
        view, number = _View(), self.run.ticks + 1
        passed = True  # whether the beginning of the tick is behind
        cells: Mapping[str, CellType] | None = None
        is_known = False  # whether `cells` are those of the moment
        for function, values in _backward(self._log):
            begins = function is None or (function is note and type(values[0]) is Commanded)
            if begins and not passed:
                passed = True
                if number < tick:
                    if not is_known:
                        cells, is_known = self._visible(view, machine_at(number)), True
                    if cells is not None:
                        yield number, cells, view.value
            if function is None:
                number -= 1
                passed = False
            elif view.undo(function, values):
                is_known = False

    def _visible(self, view: _View, machine: Path) -> dict[str, CellType] | None:
        """Return the variables in the scope of a machine, or of the top level; None if it did not run."""
        scope: object = view.get(self.run, "globals") if not machine else None
        waiting = [] if scope is not None else list(view.get(self.run, "roots"))
        while waiting and scope is None:
            act = waiting.pop()
            if view.get(act, "place")[:-1] == machine:
                scope = act
            waiting += view.get(act, "children")
        if scope is None:
            return None
        slots: dict[str, Slot] = view.get(scope, "visible")
        return {name: slot.cell for name, slot in slots.items()}

    def _built(self, view: _View) -> PastState:
        run = self.run
        source = view.get(run, "source")
        roots = view.get(run, "roots")
        home = view.get(run, "globals")
        own = {name: slot.cell for name, slot in view.get(home, "own").items()}
        machines = tuple(self._machine(view, act) for act in roots)
        cells = {id(cell): cell for cell in own.values()}
        for machine in [each for root in machines for each in root.walk()]:
            cells.update((id(cell), cell) for cell in machine.cells.values())
        values = {key: view.value(cell) for key, cell in cells.items()}
        return PastState(self._program(source), machines, own, values)

    def _machine(self, view: _View, act: Activation) -> PastMachine:
        visible: dict[str, Slot] = view.get(act, "visible")
        return PastMachine(
            view.get(act, "path"),
            view.get(act, "place"),
            view.get(act, "entered"),
            {name: slot.cell for name, slot in visible.items()},
            tuple(view.get(act, "own")),
            tuple(self._machine(view, child) for child in view.get(act, "children")),
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
    """The values of attributes and cells at an earlier moment, where they differ from the present ones."""

    def __init__(self) -> None:
        self._attributes: dict[tuple[int, str], Any] = {}
        self._cells: dict[int, object] = {}

    def get(self, part: object, name: str) -> Any:
        key = id(part), name
        return self._attributes[key] if key in self._attributes else getattr(part, name)

    def value(self, cell: CellType) -> object:
        return self._cells[id(cell)] if id(cell) in self._cells else content(cell)

    def undo(self, function: object, values: list[Any]) -> bool:
        """Undo a change; return whether other machines may have run before it, or seen other variables."""
        if function is undo_write:
            old, cell = values
            self._cells[id(cell)] = old
        elif function is undo_change or function is undo_fired:
            *_, children, entered, place, act = values
            key = id(act)
            is_other = children is not self.get(act, "children")
            self._attributes[key, "children"] = children
            self._attributes[key, "entered"] = entered
            self._attributes[key, "place"] = place
            return is_other
        elif function is undo_attribute:
            value, name, part = values
            self._attributes[id(part), name] = value
            return True
        elif function is not note:
            self.restore(values[0])
            return True
        return False

    def restore(self, saved: SavedState) -> None:
        for part, name, value in saved.parts():
            self._attributes[id(part), name] = value
        for cell, value in saved.cells():
            self._cells[id(cell)] = value


def _backward(log: Log) -> Iterator[_Record]:
    """Yield the records of a log, the last one first: a function and its values, or None and a time."""
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
