"""The tree of activations, and the bound rows that a tick follows.

An activation is one running machine: its active state, when that state was entered, one cell per variable,
and the machines that the state spawned. A row is the behaviour of one state of one activation, with its
blocks bound to the cells once, when the state is first entered: a tick follows chains of bound callables
without any lookup. Rows are discarded whenever something about them changes (a patch, a fault that begins or
ends); they are cheap to recreate.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from numbers import Real
from types import CellType, CodeType
from typing import Any, Protocol, TypeVar

from lrp_jupyter.errors import NotAValue
from lrp_jupyter.interpreter.cells import Slot, content, writes_of
from lrp_jupyter.interpreter.facts import Enabled, Fired
from lrp_jupyter.interpreter.faults import Fault
from lrp_jupyter.interpreter.issues import IssueLog
from lrp_jupyter.interpreter.journal import Log, weightless
from lrp_jupyter.interpreter.linker import (
    BlockPlan,
    Broken,
    EdgePlan,
    EventPlan,
    MachinePlan,
    Site,
    SpawnPlan,
    StatePlan,
)
from lrp_jupyter.interpreter.rendering import short
from lrp_jupyter.interpreter.trace_events import UNSET
from lrp_jupyter.language.blocks.block import bind
from lrp_jupyter.language.blocks.builtin_names import degrees
from lrp_jupyter.language.program import Element, Name, Path, State
from lrp_jupyter.language.triggers import Condition, Delay, Epsilon, Occurrence, Trigger

Call = Callable[[], object]
Link = TypeVar("Link", "Edge", "Action")


@dataclass(slots=True, eq=False)
class Count:
    """How often a state was entered or a transition fired (`times`), and the tick of the last time."""

    times: int = 0
    tick: int = 0


class Environment:
    """Variables by name: `own` are those of its machine, `visible` are all that its blocks can access."""

    __slots__ = ("own", "path", "visible")

    def __init__(self, path: Path, visible: dict[str, Slot]) -> None:
        self.path = path
        self.visible = visible
        self.own: dict[str, Slot] = {}

    def sync(self) -> None:
        """Store the present values for the next comparison."""
        for slot in self.own.values():
            slot.last = content(slot.cell)


@weightless
class Activation(Environment):
    """One running machine."""

    __slots__ = ("children", "entered", "machine", "next", "outer", "parent", "place", "row", "rows", "spawn")

    def __init__(
        self,
        machine: MachinePlan,
        parent: Activation | None,
        outer: Environment,
        spawn: tuple[str, str] | None,
        state: StatePlan,
    ) -> None:
        super().__init__((*parent.full_path, machine.name) if parent else (machine.name,), outer.visible)
        self.machine = machine
        self.parent = parent
        self.outer = outer
        self.spawn = spawn
        self.place = state.path  # of definition: the journal keeps it, because it suits any plan
        self.row: Row
        self.rows: dict[str, Row] = {}
        self.entered = 0.0
        self.next: Activation | None = None  # the next activation in the order of a tick
        self.children: tuple[Activation, ...] = ()

    @property
    def state(self) -> StatePlan:
        """The active state."""
        return self.machine.states[self.place[-1]]

    @property
    def full_path(self) -> Path:
        """The path of the active state, as spawned."""
        return (*self.path, self.place[-1])

    def retire(self) -> None:
        """Drop everything of the current plan, because the journal may keep a discarded activation for long.

        A tick that still reaches it finds nothing to do.
        """
        self.row = _IDLE
        self.unbind()
        self.machine = _NO_MACHINE

    def unbind(self) -> None:
        """Drop all rows and the links between them, which form a cycle if states lead to each other."""
        for row in self.rows.values():
            edge = row.edge
            while edge is not None:
                edge.row = None
                edge = edge.next
        self.rows.clear()

    def walk(self) -> Iterator[Activation]:
        """Yield itself, then the nested activations, in the order of spawning."""
        yield self
        for child in self.children:
            yield from child.walk()


class Edge:
    """A transition, bound to one state of one activation."""

    # fmt: off
    __slots__ = ("actions", "count", "enabled", "fact", "home", "next", "path", "plan", "row", "source",
                 "target", "test")
    # fmt: on

    def __init__(
        self, run: _Host, act: Activation, state: StatePlan, plan: EdgePlan, following: Edge | None
    ) -> None:
        self.plan = plan
        self.path = act.path
        self.source = state
        self.test = _test(run, act, plan)
        self.next = following
        self.row: Row | None = None  # the row of the destination, once it has fired
        self.actions: Action | None = None  # of its firing: onexit of the source, then onentry of `row`
        self.fact: Fired | None = None  # the fact that the journal keeps when it fires
        self.enabled: Enabled | None = None  # what it keeps if enabled in the tick that entered the source
        home = act.parent if plan.noun.outward else act
        self.home = home or act  # the activation whose state it changes
        self.target = home.machine.states.get(str(plan.noun.destination)) if home else None
        element = plan.site.element
        self.count = run.firing(element, Element("state", self.target.path)) if self.target else Count()

    @property
    def site(self) -> Site:
        """The site of the transition itself."""
        return self.plan.site._replace(ordinal=1)  # 0 is its condition or delay

    @property
    def tested(self) -> Site:
        """The site of its test: the condition of an event, or its own condition or delay."""
        test = self.plan.test
        return test.block.site if isinstance(test, EventPlan) else self.plan.site

    @property
    def missing(self) -> str:
        """Why it leads nowhere, if it has no `target`."""
        destination, machine = self.plan.noun.destination, self.home.machine.name
        if self.plan.noun.outward and self.home.path == self.path:
            return f"`exit` cannot lead to `{destination}`: `{machine}` is not nested in a state."
        return f"The machine `{machine}` has no state `{destination}`."


@dataclass(slots=True, eq=False)
class Action:
    """A bound block or a spawn, the site of its faults, and the next action.

    A chain of actions is run by following `next`: most states have one or two actions, and starting a `for`
    loop costs as much as running a block.
    """

    call: Call
    site: Site
    cell: CellType | None
    """A cell that `call` writes without logging it."""
    next: Action | None


@dataclass(slots=True, eq=False)
class Row:
    """The behaviour of one state of an activation: its first transition, its first action of each kind."""

    state: StatePlan
    path: Path
    count: Count
    edge: Edge | None = None
    onentry: Action | None = None
    running: Action | None = None
    onexit: Action | None = None
    place: Path = field(init=False)

    def __post_init__(self) -> None:
        self.place = self.state.path


def chained(link: Link | None) -> Iterator[Link]:
    """Yield an edge or an action, and those after it."""
    while link is not None:
        yield link
        link = link.next


_NO_MACHINE = MachinePlan("", (), ())
_IDLE = Row(StatePlan("", (), State(Name(""))), (), Count())


def is_boolean(value: object) -> bool:
    """Return whether a value is a boolean of Python or numpy; runs no code of its type."""
    kind = type(value)
    if kind is bool:
        return True
    numpy = sys.modules.get("numpy")
    return numpy is not None and kind is getattr(numpy, "bool_", None)


def not_boolean(value: object) -> str:
    """Return a sentence about why a value that is not a boolean cannot be a condition."""
    if issubclass(type(value), NotAValue):
        return str(value._not_a_value())  # type: ignore[attr-defined]
    return f"A condition must be True or False, not {short(value)}. Compare it with something."


class _Host(Protocol):
    """What bound blocks and conditions use of a run."""

    namespace: dict[str, Any]
    now: float
    issues: IssueLog
    log: Log | None
    event_values: dict[Path, bool | None] | None
    live: dict[Path, Environment]

    def count(self, element: Element) -> Count: ...
    def firing(self, transition: Element, state: Element) -> Count: ...
    def spawn(self, parent: Activation | None, plan: SpawnPlan) -> Activation | None: ...
    def recovered(self, site: Site, value: object) -> None: ...
    def leak(self, slot: Slot) -> None: ...
    def log_cell(self, cell: CellType) -> None: ...


def broken(reason: Broken) -> Call:
    """Return a callable that fails with `reason`."""

    def fail() -> object:
        raise Fault(reason.kind, reason.message)

    return fail


def bind_code(run: _Host, code: CodeType, visible: Mapping[str, Slot]) -> Call:
    """Bind a compiled block to variables; the cells that it writes are logged before it runs."""
    return _logged(run, *_bind(run, code, visible))


def _bind(run: _Host, code: CodeType, visible: Mapping[str, Slot]) -> tuple[Call, CellType | None]:
    """Bind a compiled block to variables; return it, and a cell that it writes without logging it."""
    cells = {name: visible[name].cell for name in code.co_freevars if name in visible}
    is_provided = len(cells) < len(code.co_freevars)
    if is_provided:
        cells["degrees"] = CellType()
    call = bind(code, run.namespace, cells)
    if is_provided:
        call = _with_degrees(run.namespace, cells["degrees"], call)
    if run.log is None:
        return call, None
    own, inner = writes_of(code)
    for name in inner:
        run.leak(visible[name])
    cell = None
    for name in own:
        if not visible[name].leaked:
            call = _logged(run, call, cell)
            cell = visible[name].cell
    return call, cell


def _with_degrees(namespace: Mapping[str, Any], cell: CellType, call: Call) -> Call:
    """Give `degrees` to a block, unless the notebook defines this name when the block runs."""

    def block() -> object:
        cell.cell_contents = namespace.get("degrees", degrees)
        return call()

    return block


def _logged(run: _Host, call: Call, cell: CellType | None) -> Call:
    if cell is None:
        return call

    def block() -> object:
        run.log_cell(cell)
        return call()

    return block


def bind_block(run: _Host, plan: BlockPlan, visible: Mapping[str, Slot]) -> Call:
    """Bind a block outside a state's actions; the cells that it writes are logged before it runs."""
    return _logged(run, *_bind_block(run, plan, visible))


def _bind_block(run: _Host, plan: BlockPlan, visible: Mapping[str, Slot]) -> tuple[Call, CellType | None]:
    """Bind a block to variables; if it has an open issue, the next run without a fault resolves it."""
    if isinstance(plan.code, Broken):
        return broken(plan.code), None
    call, cell = _bind(run, plan.code, visible)
    return watched(run, plan.site, call), cell


def _bind_actions(run: _Host, act: Activation, plans: tuple[BlockPlan | SpawnPlan, ...]) -> Action | None:
    first = None
    for plan in reversed(plans):
        if isinstance(plan, SpawnPlan):
            first = Action(partial(run.spawn, act, plan), plan.site, None, first)
        else:
            call, cell = _bind_block(run, plan, act.visible)
            first = Action(call, plan.site, cell, first)
    return first


def watched(run: _Host, site: Site, call: Call) -> Call:
    """Wrap a call if its site has an open issue: a run without a fault resolves it."""
    if site[:2] not in run.issues.open_blocks:
        return call

    def again() -> object:
        value = call()
        run.recovered(site, value)
        return value

    return again


def bind_row(run: _Host, act: Activation, state: StatePlan) -> Row:
    """Bind the blocks and transitions of `state` to `act`."""
    edge = None
    for plan in reversed(state.edges):
        edge = Edge(run, act, state, plan, edge)
    return Row(
        state,
        (*act.path, state.name),
        run.count(Element("state", state.path)),
        edge,
        _bind_actions(run, act, state.onentry),
        _bind_actions(run, act, state.running),
        _bind_actions(run, act, state.onexit),
    )


def noted(values: dict[Path, bool | None], event: Path, call: Call) -> Call:
    """Wrap the condition of an event to record the result of its last test, None if it was not a boolean."""

    def test() -> object:
        values[event] = None
        value = call()
        if is_boolean(value):
            values[event] = bool(value)
        return value

    return test


def _test(run: _Host, act: Activation, edge: EdgePlan) -> Call:
    if isinstance(edge.test, Broken):
        return broken(edge.test)
    return _TESTS[type(edge.noun.trigger)](run, act, edge)


def _occurs(run: _Host, act: Activation, edge: EdgePlan) -> Call:
    assert isinstance(edge.test, EventPlan)
    event = edge.test
    call = bind_block(run, event.block, run.live[event.owner].visible)
    values = run.event_values
    return call if values is None else noted(values, event.block.site.element.path, call)


def _holds(run: _Host, act: Activation, edge: EdgePlan) -> Call:
    assert isinstance(edge.test, BlockPlan)
    return bind_block(run, edge.test, act.visible)


def _is_due(run: _Host, act: Activation, edge: EdgePlan) -> Call:
    trigger = edge.noun.trigger
    assert isinstance(trigger, Delay)
    amount = trigger.amount
    if isinstance(amount, int):
        milliseconds = amount

        def due() -> bool:
            return (run.now - act.entered) * 1000.0 + TOLERANCE >= milliseconds

        return due
    read: Call
    if isinstance(edge.test, BlockPlan):
        code = edge.test.code
        read = broken(code) if isinstance(code, Broken) else bind_code(run, code, act.visible)
    else:
        read = _reader(str(amount), act.visible[str(amount)].cell)

    def due_when_read() -> bool:
        delay = read()
        if isinstance(delay, bool) or not isinstance(delay, Real) or delay != delay:
            raise Fault("not a delay", f"A delay must be a number of milliseconds, not {short(delay)}.")
        return bool((run.now - act.entered) * 1000.0 + TOLERANCE >= delay)

    return watched(run, edge.site, due_when_read)


def _always(run: _Host, act: Activation, edge: EdgePlan) -> Call:
    return lambda: True


_TESTS: dict[type[Trigger], Callable[[_Host, Activation, EdgePlan], Call]] = {
    Occurrence: _occurs,
    Condition: _holds,
    Delay: _is_due,
    Epsilon: _always,
}
"""The function that binds the test of each kind of trigger."""


TOLERANCE = 1e-6
"""Milliseconds: sums of periods such as 0.1 s are not exact, which must not delay a transition by a tick."""


def _reader(name: str, cell: CellType) -> Call:
    def read() -> object:
        value = content(cell)
        if value is UNSET:
            raise Fault("unknown variable", f"`{name}` has no value. Assign one first.")
        return value

    return read
