"""Snapshots: the whole state of a run as a value, from which any number of independent runs can begin.

Variables are deep-copied together, with the functions that close over them; objects that cannot be copied are
shared, and reported. A snapshot is independent of the run from which it was taken, which can continue.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import CellType, MappingProxyType
from typing import Any, NamedTuple

from lrp_jupyter.interpreter.alone import Alone
from lrp_jupyter.interpreter.cells import Slot, content, put
from lrp_jupyter.interpreter.computed import ComputedName
from lrp_jupyter.interpreter.copies import Packed, pack, unpack
from lrp_jupyter.interpreter.issues import IssueLog
from lrp_jupyter.interpreter.run import Run
from lrp_jupyter.interpreter.tree import Activation, Count, Environment
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Element, Path, Program


class _Variable(NamedTuple):
    """A variable: the number of its cell, and those of the variables that it has captured."""

    name: str
    number: int
    leaked: bool
    computed: float  # s
    captured: tuple[int, ...]


_Own = tuple[_Variable, ...]


class _Machine(NamedTuple):
    """A running machine: its active state, and the numbers of its variables."""

    parent: int | None  # its number in the order of a tick
    place: Path  # of the active state, by definition
    entered: float
    spawn: tuple[str, str] | None
    holding: Mapping[str, float]
    own: _Own
    lost: _Own


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The state of a run between two ticks.

    `own`, `lost`: the global variables, and those that edits have removed.
    """

    source: tuple[str, str] | Program  # text and file name; the program itself if it has no text
    alone: Alone | None
    tick: int
    now: float  # s
    before: float  # s: as in the run
    ended: tuple[int, float]
    started: bool
    pending: frozenset[tuple[str, str]]
    entered: float  # s: when the program started
    own: _Own
    lost: _Own
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
        """Return new copies of the variables, by path as spawned, and of values beside them, by name."""
        cells = [CellType() for _ in range(self.count)]
        values = unpack(self.values, cells, lambda token: token)
        owned: dict[Path, _Own] = {(): self.own}
        paths: list[Path] = []
        for machine in self.machines:
            around = () if machine.parent is None else paths[machine.parent]
            paths.append((*around, *machine.place[-2:]))
            owned[paths[-1][:-1]] = machine.own
        found: dict[Path | str, object] = {
            (*path, each.name): values[each.number] for path, own in owned.items() for each in own
        }
        return found | dict(zip(self.beside, values[self.count :], strict=True))

    @property
    def count(self) -> int:
        """The number of variables, removed ones included."""
        owned = (self.own, self.lost, *(each for machine in self.machines for each in machine[-2:]))
        return 1 + max((each.number for variables in owned for each in variables), default=-1)


def take(
    run: Run, known: Callable[[object], object], beside: Mapping[str, object] = MappingProxyType({})
) -> Snapshot:
    """Take a snapshot of a run, between two ticks, with the values `beside` its variables.

    `known`: returns a token for an object that is specific to each run, such as its robot, else None.
    """
    acts = [*run.walk()]
    owned = [slots for each in (run.globals, *acts) for slots in (each.own, each.lost)]
    cells = {slot: slot.cell for slots in owned for slot in slots.values()}
    places = {slot: place for place, slot in enumerate(cells)}

    def numbered(slots: Mapping[str, Slot]) -> _Own:
        return tuple(
            _Variable(
                name,
                places[slot],
                slot.leaked,
                slot.computed[0],
                tuple(places[each] for each in slot.captured if each in places),
            )
            for name, slot in slots.items()
        )

    own, lost = numbered(run.globals.own), numbered(run.globals.lost)
    numbers = {id(act): number for number, act in enumerate(acts)}
    machines = tuple(
        _Machine(
            numbers.get(id(act.parent)),
            act.place,
            act.entered,
            act.spawn,
            act.holding,
            numbered(act.own),
            numbered(act.lost),
        )
        for act in acts
    )
    run.add_firings()
    values = [content(cell) for cell in cells.values()]
    return Snapshot(
        run.source,
        run.alone,
        run.ticks,
        run.now,
        run.before,
        run.ended,
        run.started,
        run.pending,
        run.globals.entered,
        own,
        lost,
        machines,
        {element: (count.times, count.tick) for element, count in run.counts.items()},
        run.issues.copy(),
        run.unmeant,
        pack(
            [*values, *beside.values()],
            {id(cell): number for number, cell in enumerate(cells.values())},
            lambda value: known(value) if (token := _token(value)) is None else token,
        ),
        tuple(beside),
    )


def begin(run: Run, snapshot: Snapshot, find: Callable[[object], object]) -> dict[str, Any]:
    """Continue a new run from a snapshot of its program; return the copies of the values `beside`."""
    cells = [CellType() for _ in range(snapshot.count)]
    names: list[tuple[ComputedName, _Name]] = []

    def found(token: Any) -> object:
        if type(token) is not _Name:
            return find(token)
        names.append((name := ComputedName(run, token.cell, None, None, token.leaving), token))
        return name

    values = unpack(snapshot.values, cells, found)
    for cell, value in zip(cells, values, strict=False):  # the remaining values are those beside
        put(cell, value)
    run.ticks, run.now = snapshot.tick, snapshot.now
    run.before, run.ended = snapshot.before, snapshot.ended
    run.started, run.pending = snapshot.started, snapshot.pending
    slots = [Slot(cell) for cell in cells]
    _fill(run.globals, snapshot.own, snapshot.lost, slots, run.base)
    run.globals.entered = snapshot.entered
    acts: list[Activation] = []
    for machine in snapshot.machines:
        plan = run.plan.machines[machine.place[:-1]]
        parent = None if machine.parent is None else acts[machine.parent]
        outer = (parent or run.globals).around(plan.outer)
        act = Activation(plan, parent, outer, machine.spawn, plan.states[machine.place[-1]])
        act.entered, act.holding = machine.entered, dict(machine.holding)
        _fill(act, machine.own, machine.lost, slots, outer.visible)
        run.live[act.path] = act
        acts.append(act)
        if parent is None:
            run.roots += (act,)
        else:
            parent.children += (act,)
    for name, token in names:
        name.home, name.at = (run.live.get(path, run.globals) for path in (token.home, token.at))
    run.counts.update((element, Count(*count)) for element, count in snapshot.counts.items())
    run.issues, run.unmeant = snapshot.issues.copy(), snapshot.unmeant
    base = tuple(run.base.values())
    for slot in slots:
        slot.captured += base
    leaking = any(slot.leaked for environment in run.live.values() for slot in environment.own.values())
    run.leaking = run.watched = leaking
    run.attention = leaking or bool(run.pending)
    run.unordered = run.stale = True
    if run.journal is not None:
        run.journal.begin(run.ticks, run.now)
    for environment in run.live.values():
        environment.sync()
    run.refresh()
    return dict(zip(snapshot.beside, values[len(cells) :], strict=True))


class _Name(NamedTuple):
    """A computed name to which a function in a variable refers, by the paths of its machines as spawned."""

    cell: str
    home: Path
    at: Path
    leaving: bool


def _token(value: object) -> _Name | None:
    if type(value) is not ComputedName or value.home is None or value.at is None:
        return None
    return _Name(value.cell, value.home.path, value.at.path, value.leaving)


def _fill(
    environment: Environment, own: _Own, lost: _Own, slots: list[Slot], outer: Mapping[str, Slot]
) -> None:
    for each in own + lost:
        slot = slots[each.number]
        slot.leaked, slot.computed = each.leaked, (each.computed, 0)
        slot.captured = tuple(slots[number] for number in each.captured)
    environment.own, environment.lost = (
        {each.name: slots[each.number] for each in owned} for owned in (own, lost)
    )
    environment.visible = {**outer, **environment.own}
