"""What names mean in blocks besides variables: events, machines and times, computed where they are used.

An event's name is the value of its block at that moment; a machine's name gives the active state and the
variables of its nearest instance; `elapsed` and `dt` are times in seconds. A name of the notebook hides them.
Paper: §5.1.1.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from operator import attrgetter
from typing import Any, NoReturn, Protocol

from lrp_jupyter.errors import LRPError, NotAValue
from lrp_jupyter.interpreter.cells import Slot, content
from lrp_jupyter.interpreter.linker import EventPlan, Plan
from lrp_jupyter.interpreter.trace_events import UNSET
from lrp_jupyter.language.blocks.computed_names import machine_cell, name_of_cell
from lrp_jupyter.language.program import Path, Program
from lrp_jupyter.language.resolution import resolve

Compute = Callable[[], object]
_DIGITS = 9
"""Digits of a second: sums of periods such as 0.1 s are not exact, and 0.3 must not be just missed."""


class _Home(Protocol):
    """A running machine, or the top level, as the names in a block see it."""

    own: dict[str, Slot]
    path: Path
    entered: float

    @property
    def defined(self) -> Path: ...
    @property
    def outer(self) -> _Home | None: ...
    @property
    def parent(self) -> _Home | None: ...
    @property
    def children(self) -> Sequence[_Home]: ...
    @property
    def place(self) -> Path: ...


class _UsedRun(Protocol):
    """What the names use of a run."""

    namespace: dict[str, Any]
    now: float
    program: Program
    plan: Plan

    @property
    def roots(self) -> Sequence[_Home]: ...
    def period(self) -> float: ...
    def bind_event(self, event: EventPlan, owner: Any, at: Any, leaving: bool) -> Compute: ...


def owner_of_event(plan: Plan, home: _Home | None, name: str) -> tuple[_Home, EventPlan] | None:
    """Return the machine, or the top level, that defines an event in the scope of `home`, and the event."""
    while home is not None:
        scope = plan.machines.get(home.defined) if home.defined else plan
        if scope is not None and name in scope.events:  # a function may outlive its machine
            return home, scope.events[name]
        home = home.outer
    return None


class ComputedName:
    """Computes, when it is called, what a name in a block means.

    `cell`: the free variable that stands for the name.
    `home`: the machine in whose scope the block is; None while a copy of the run is not yet complete.
    `at`: the machine from whose state `elapsed` counts. `leaving`: whether that state is being left.
    """

    __slots__ = ("_bound", "at", "cell", "home", "leaving", "name", "run")

    def __init__(
        self, run: _UsedRun, cell: str, home: _Home | None, at: _Home | None, leaving: bool = False
    ) -> None:
        self.run, self.cell, self.home, self.at, self.leaving = run, cell, home, at, leaving
        self.name = name_of_cell(cell)
        self._bound: tuple[Plan, Compute] | None = None

    def __call__(self) -> object:
        """Return the value; a name of the notebook hides it."""
        run = self.run
        if self.name in run.namespace:
            return run.namespace[self.name]
        if self._bound is None or self._bound[0] is not run.plan:
            self._bound = run.plan, self._bind()
        return self._bound[1]()

    def _bind(self) -> Compute:
        run, home, at, name = self.run, self.home, self.at, self.name
        assert home is not None
        if self.cell == machine_cell(name):
            machine = MachineValue(run, name, home)
            return lambda: machine
        found = owner_of_event(run.plan, home, name)
        if found is not None:
            owner, event = found
            return run.bind_event(event, owner, at, self.leaving)
        if name == "dt":
            return lambda: round(run.period(), _DIGITS)
        if name == "elapsed":
            since = attrgetter("before" if self.leaving else "entered")
            return lambda: round(run.now - since(at), _DIGITS)
        raise NameError(f"`{name}` is not defined.", name=name)  # an edit has removed the event


def nearest(home: _Home, roots: Sequence[_Home], machines: Sequence[Path]) -> _Home | None:
    """Return the instance of one of some machines that a block in the scope of `home` means.

    It is what the active state has spawned, else what an enclosing active state has, and so on outwards.
    """
    around: _Home | None = home
    while around is not None:
        for child in around.children:
            if child.defined in machines:
                return child
        around = around.parent
    return next((root for root in roots if root.defined in machines), None)


class MachineValue(NotAValue):
    """A machine as the blocks of others see it: its active state, and its variables."""

    __slots__ = ("_home", "_known", "_name", "_run")

    def __init__(self, run: _UsedRun, name: str, home: _Home) -> None:
        self._run, self._name, self._home = run, name, home
        self._known: tuple[Program, tuple[Path, ...]] | None = None

    def _instance(self) -> _Home | None:
        run, home, known = self._run, self._home, self._known
        if known is None or known[0] is not run.program:
            names = resolve(run.program)
            scope = names.by_path.get(home.defined, names.top)
            found = tuple(machine.path for machine in scope.machines_called(self._name))
            self._known = known = run.program, found
        return nearest(home, run.roots, known[1])

    @property
    def state(self) -> str | None:
        """The name of its active state; None while it does not run."""
        instance = self._instance()
        return None if instance is None else instance.place[-1]

    def __getattr__(self, name: str) -> object:
        if name.startswith("__"):
            raise AttributeError(name)
        instance = self._instance()
        machine = self._name
        if instance is None:
            raise LRPError(f"`{machine}` is not running, so `{machine}.{name}` has no value.")
        slot = instance.own.get(name)
        if slot is None:
            raise LRPError(f"The machine `{machine}` has no variable `{name}`.")
        value = content(slot.cell)
        if value is UNSET:
            raise LRPError(f"The variable `{name}` of `{machine}` has no value.")
        return value

    def __setattr__(self, name: str, value: object) -> None:
        if name in MachineValue.__slots__:
            object.__setattr__(self, name, value)
        else:
            self._read_only(name)

    def _read_only(self, name: str) -> NoReturn:
        machine = self._name
        raise LRPError(f"`{machine}.{name}` can only be read here. Assign `{name}` inside `{machine}`.")

    def __reduce_ex__(self, protocol: object) -> NoReturn:
        raise TypeError(self._not_a_value())

    def _not_a_value(self) -> str:
        name = self._name
        return (
            f'`{name}` is a machine. Compare its state: `{name}.state == "…"`, or read one of its variables.'
        )

    def __repr__(self) -> str:
        return f"<machine {self._name}, {self.state or 'not running'}>"
