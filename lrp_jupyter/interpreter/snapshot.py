"""Snapshots: the whole state of a run as a value, from which any number of independent runs can begin.

Variables are deep-copied together, with the functions that close over them; objects that cannot be copied are
shared, and reported. A snapshot is independent of the run from which it was taken, which can continue.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import CellType, MappingProxyType
from typing import Any, NamedTuple

from lrp_jupyter.interpreter.cells import Slot, content, put
from lrp_jupyter.interpreter.copies import Packed, pack, unpack
from lrp_jupyter.interpreter.issues import IssueLog
from lrp_jupyter.interpreter.run import Run
from lrp_jupyter.interpreter.tree import Activation, Count, Environment
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Element, Path, Program

_Own = tuple[tuple[str, int, bool], ...]
"""Variables: the name of each, the number of its cell, and whether it leaks."""


class _Machine(NamedTuple):
    """A running machine: its active state, and the numbers of its variables."""

    parent: int | None  # its number in the order of a tick
    place: Path  # of the active state, by definition
    entered: float
    spawn: tuple[str, str] | None
    own: _Own


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The state of a run between two ticks."""

    source: tuple[str, str] | Program  # text and file name; the program itself if it has no text
    tick: int
    now: float  # s
    started: bool
    pending: frozenset[tuple[str, str]]
    own: _Own
    machines: tuple[_Machine, ...]
    counts: Mapping[Element, tuple[int, int]]
    issues: IssueLog
    unmeant: Element | None
    values: Packed  # the contents of the variables, and the values beside them
    beside: tuple[str, ...] = ()  # the names of the latter
    settings: Mapping[str, Any] = field(default_factory=dict)  # attributes of the interpreter

    @property
    def program(self) -> Program:
        """The program that ran, parsed again."""
        return parse(*self.source) if isinstance(self.source, tuple) else self.source

    @property
    def shared(self) -> tuple[str, ...]:
        """The type names of objects that could not be copied."""
        return self.values.uncopied

    def contents(self) -> dict[Path | str, object]:
        """Return new copies of the variables, by path of definition, and of values beside them, by name."""
        cells = [CellType() for _ in range(_count(self))]
        owned = [((), self.own), *((machine.place[:-1], machine.own) for machine in self.machines)]
        names: list[Path | str] = [(*path, name) for path, own in owned for name, _, _ in own]
        values = unpack(self.values, cells, lambda token: token)
        return dict(zip([*names, *self.beside], values, strict=True))


def take(
    run: Run, known: Callable[[object], object], beside: Mapping[str, object] = MappingProxyType({})
) -> Snapshot:
    """Take a snapshot of a run, between two ticks, with the values `beside` its variables.

    `known`: returns a token for an object that is specific to each run, such as its robot, else None.
    """
    cells: list[CellType] = []

    def numbered(environment: Environment) -> _Own:
        first = len(cells)
        cells.extend(slot.cell for slot in environment.own.values())
        items = environment.own.items()
        return tuple((name, first + number, slot.leaked) for number, (name, slot) in enumerate(items))

    own = numbered(run.globals)
    acts = [*run.walk()]
    numbers = {id(act): number for number, act in enumerate(acts)}
    machines = tuple(
        _Machine(numbers.get(id(act.parent)), act.place, act.entered, act.spawn, numbered(act))
        for act in acts
    )
    run.add_firings()
    values = [content(cell) for cell in cells]
    return Snapshot(
        run.source,
        run.ticks,
        run.now,
        run.started,
        run.pending,
        own,
        machines,
        {element: (count.times, count.tick) for element, count in run.counts.items()},
        run.issues.copy(),
        run.unmeant,
        pack([*values, *beside.values()], {id(cell): number for number, cell in enumerate(cells)}, known),
        tuple(beside),
    )


def begin(run: Run, snapshot: Snapshot, find: Callable[[object], object]) -> dict[str, Any]:
    """Continue a new run from a snapshot of its program; return the copies of the values `beside`."""
    cells = [CellType() for _ in range(_count(snapshot))]
    values = unpack(snapshot.values, cells, find)
    for cell, value in zip(cells, values, strict=False):  # the remaining values are those beside
        put(cell, value)
    run.ticks, run.now = snapshot.tick, snapshot.now
    run.started, run.pending = snapshot.started, snapshot.pending
    _fill(run.globals, snapshot.own, cells, run.base)
    acts: list[Activation] = []
    for machine in snapshot.machines:
        plan = run.plan.machines[machine.place[:-1]]
        parent = None if machine.parent is None else acts[machine.parent]
        outer = run.live[plan.outer]
        act = Activation(plan, parent, outer, machine.spawn, plan.states[machine.place[-1]])
        act.entered = machine.entered
        _fill(act, machine.own, cells, outer.visible)
        run.live[plan.path] = act
        acts.append(act)
        if parent is None:
            run.roots += (act,)
        else:
            parent.children += (act,)
    run.counts.update((element, Count(*count)) for element, count in snapshot.counts.items())
    run.issues, run.unmeant = snapshot.issues.copy(), snapshot.unmeant
    owned = (snapshot.own, *(machine.own for machine in snapshot.machines))
    leaking = any(leaked for own in owned for _, _, leaked in own)
    run.leaking = run.watched = leaking
    run.attention = leaking or bool(run.pending)
    run.unordered = run.stale = True
    if run.journal is not None:
        run.journal.begin(run.ticks, run.now)
    for environment in run.live.values():
        environment.sync()
    run.refresh()
    return dict(zip(snapshot.beside, values[len(cells) :], strict=True))


def _count(snapshot: Snapshot) -> int:
    return len(snapshot.own) + sum(len(machine.own) for machine in snapshot.machines)


def _fill(environment: Environment, own: _Own, cells: list[CellType], outer: Mapping[str, Slot]) -> None:
    environment.own, environment.visible = {}, dict(outer)
    for name, number, leaked in own:
        environment.visible[name] = environment.own[name] = Slot(cells[number], leaked=leaked)
