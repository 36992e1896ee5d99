"""What runs: a small tree of activations, and the bound rows that a tick reads.

An activation is one running machine: its active state, when that state was entered, one cell
per variable, and the machines that the state spawned. A row is what one state of one activation
does, its blocks bound to the cells once, when the state is first entered: so a tick walks flat
tuples of callables and looks nothing up. Rows are thrown away whenever something about them
changes (a patch, a fault that begins or ends); they are cheap to make again.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from numbers import Real
from types import CellType, CodeType
from typing import Any, Protocol

from lrp_jupyter.interpreter.cells import Slot, content, put, writes_of
from lrp_jupyter.interpreter.events import UNSET, Firing
from lrp_jupyter.interpreter.faults import Fault
from lrp_jupyter.interpreter.issues import IssueLog
from lrp_jupyter.interpreter.journal import Record
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
from lrp_jupyter.language.blocks import bind
from lrp_jupyter.language.program import Element, Path
from lrp_jupyter.language.triggers import Condition, Delay, Epsilon, Occurrence, Trigger

__all__ = [
    "Activation",
    "Count",
    "Edge",
    "Environment",
    "Host",
    "Row",
    "bind_block",
    "bind_code",
    "bind_row",
    "broken",
    "is_boolean",
    "short",
]

Call = Callable[[], object]


class Count:
    """How often a state was entered or a transition fired: `times`, and the last time in `tick`."""

    __slots__ = ("tick", "times")

    def __init__(self) -> None:
        self.times = 0
        self.tick = 0


class Environment:
    """Variables, by name: `own` are those of its machine, `visible` all that its blocks see."""

    __slots__ = ("own", "path", "visible")

    def __init__(self, path: Path, visible: dict[str, Slot]) -> None:
        self.path = path
        self.visible = visible
        self.own: dict[str, Slot] = {}

    def sync(self) -> None:
        """Store the present values as those that were last compared."""
        for slot in self.own.values():
            slot.last = content(slot.cell)


class Activation(Environment):
    """One running machine."""

    __slots__ = ("children", "entered", "machine", "outer", "parent", "row", "rows", "spawn", "state")

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
        self.state = state
        self.row: Row
        self.rows: dict[str, Row] = {}
        self.entered = 0.0
        self.children: tuple[Activation, ...] = ()

    @property
    def full_path(self) -> Path:
        """Path of the active state, as spawned."""
        return (*self.path, self.state.name)

    def leaves(self) -> Iterator[Path]:
        """Paths of the innermost active states."""
        if not self.children:
            yield self.full_path
        for child in self.children:
            yield from child.leaves()

    def walk(self) -> Iterator[Activation]:
        """Itself, then what runs inside, in the order of spawning."""
        yield self
        for child in self.children:
            yield from child.walk()


class Edge:
    """A transition as one state of one activation sees it."""

    __slots__ = ("count", "data", "home", "missing", "path", "row", "site", "target", "test", "tested", "up")

    def __init__(self, act: Activation, state: StatePlan, plan: EdgePlan, test: Call, count: Count) -> None:
        noun = plan.noun
        self.test = test
        self.count = count
        self.up = noun.outward
        self.row: Row | None = None  # of the destination, once it has been there
        self.home = home = act if not self.up else act.parent  # whose state it changes
        destination = str(noun.destination)
        self.target = home.machine.states.get(destination) if home else None
        self.missing = (
            f"machine `{home.machine.name}` has no state `{destination}`"
            if home
            else f"`exit` cannot lead to `{destination}`: `{act.machine.name}` is not nested in a state"
        )
        self.path = (*act.path, plan.site.element.path[-1])
        self.data = Firing(state.name, destination, plan.label)
        self.site = plan.site._replace(ordinal=1)  # 0 is its condition or delay
        self.tested = plan.test.block.site if isinstance(plan.test, EventPlan) else plan.site


Calls = tuple[Call, ...]


class Row:
    """What one state of one activation does; every spawn of its onentry is a call like a block."""

    __slots__ = ("count", "edges", "onentry", "onexit", "path", "running", "state")

    def __init__(
        self,
        state: StatePlan,
        path: Path,
        count: Count,
        edges: tuple[Edge, ...],
        onentry: Calls,
        running: Calls,
        onexit: Calls,
    ) -> None:
        self.state = state
        self.path = path
        self.count = count
        self.edges = edges
        self.onentry = onentry
        self.running = running
        self.onexit = onexit

    def site_of(self, call: Call) -> Site:
        """Return what a fault of an action is charged to."""
        state = self.state
        actions = ((self.onentry, state.onentry), (self.running, state.running), (self.onexit, state.onexit))
        return next(
            plan.site
            for calls, plans in actions
            for known, plan in zip(calls, plans, strict=True)
            if known is call
        )


def is_boolean(value: object) -> bool:
    """Whether a value is a truth value, Python's or numpy's."""
    kind = type(value)
    return kind is bool or (kind.__module__ == "numpy" and kind.__name__ in ("bool", "bool_"))


def short(value: object) -> str:
    """Write a value in a few characters, for a message."""
    try:
        text = repr(value)
    except (Exception, SystemExit):
        text = f"a {type(value).__name__} that cannot be shown"
    return text if len(text) <= 60 else text[:57] + "…"


class Host(Protocol):
    """What bound blocks and conditions use of the run that they belong to."""

    namespace: dict[str, Any]
    now: float
    issues: IssueLog
    log: list[Record] | None
    event_values: dict[Path, bool | None] | None

    def environment(self, machine: Path) -> Environment:
        """Return the living environment of a machine, by its path of definition."""

    def count(self, element: Element) -> Count:
        """Return the count of a state or transition."""

    def spawn(self, parent: Activation | None, plan: SpawnPlan) -> None:
        """Do a spawn."""

    def recovered(self, site: Site, value: object) -> None:
        """Resolve the issues of a site that just ran without fault."""

    def leak(self, slot: Slot) -> None:
        """Compare a variable after every tick."""


def broken(reason: Broken) -> Call:
    """Make a callable that fails with `reason`."""

    def fail() -> object:
        raise Fault(reason.kind, reason.message)

    return fail


def bind_code(run: Host, code: CodeType, visible: Mapping[str, Slot]) -> Call:
    """Bind a compiled block to variables; what it writes is logged before it runs."""
    call = bind(code, run.namespace, {name: visible[name].cell for name in code.co_freevars})
    log = run.log
    if log is None:
        return call
    own, inner = writes_of(code)
    for name in inner:
        run.leak(visible[name])
    for name in own:
        call = _logged(log, visible[name], call)
    return call


def _logged(log: list[Record], slot: Slot, call: Call) -> Call:
    """Wrap a block that writes a variable: log what the variable held."""
    cell, append = slot.cell, log.append

    def block() -> object:
        if not slot.leaked:
            try:
                append((put, cell, cell.cell_contents))
            except ValueError:
                append((put, cell, UNSET))
        return call()

    return block


def bind_block(run: Host, plan: BlockPlan, visible: Mapping[str, Slot]) -> Call:
    """Bind a block to variables; while it has an open issue, a run without fault resolves that."""
    if isinstance(plan.code, Broken):
        return broken(plan.code)
    call = bind_code(run, plan.code, visible)
    return watched(run, plan.site, call) if plan.site[:2] in run.issues.open_blocks else call


def watched(run: Host, site: Site, call: Call) -> Call:
    """Wrap a call whose site has an open issue: a run without fault resolves it."""

    def again() -> object:
        value = call()
        run.recovered(site, value)
        return value

    return again


def bind_row(run: Host, act: Activation, state: StatePlan) -> Row:
    """Bind everything that `state` does in `act`."""

    def calls(plans: tuple[BlockPlan | SpawnPlan, ...]) -> Calls:
        return tuple(
            [
                partial(run.spawn, act, plan)
                if isinstance(plan, SpawnPlan)
                else bind_block(run, plan, act.visible)
                for plan in plans
            ]
        )

    return Row(
        state,
        (*act.path, state.name),
        run.count(Element("state", state.path)),
        tuple(
            [
                Edge(act, state, plan, _test(run, act, plan), run.count(plan.site.element))
                for plan in state.edges
            ]
        ),
        calls(state.onentry),
        calls(state.running),
        calls(state.onexit),
    )


def noted(values: dict[Path, bool | None], event: Path, call: Call) -> Call:
    """Wrap the condition of an event: note what it was at its last test, None if it had no truth."""

    def test() -> object:
        values[event] = None
        value = call()
        if type(value).__name__ in ("bool", "bool_"):
            values[event] = bool(value)
        return value

    return test


def _test(run: Host, act: Activation, edge: EdgePlan) -> Call:
    """Return the callable that tests whether a transition is enabled."""
    if isinstance(edge.test, Broken):
        return broken(edge.test)
    return _TESTS[type(edge.noun.trigger)](run, act, edge)


def _occurs(run: Host, act: Activation, edge: EdgePlan) -> Call:
    assert isinstance(edge.test, EventPlan)
    event = edge.test
    call = bind_block(run, event.block, run.environment(event.owner).visible)
    values = run.event_values
    return call if values is None else noted(values, event.block.site.element.path, call)


def _holds(run: Host, act: Activation, edge: EdgePlan) -> Call:
    assert isinstance(edge.test, BlockPlan)
    return bind_block(run, edge.test, act.visible)


def _is_due(run: Host, act: Activation, edge: EdgePlan) -> Call:
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
            raise Fault("not a delay", f"a delay is a number of milliseconds, not {short(delay)}")
        return bool((run.now - act.entered) * 1000.0 + TOLERANCE >= delay)

    return (
        watched(run, edge.site, due_when_read) if edge.site[:2] in run.issues.open_blocks else due_when_read
    )


def _always(run: Host, act: Activation, edge: EdgePlan) -> Call:
    return lambda: True


_TESTS: dict[type[Trigger], Callable[[Host, Activation, EdgePlan], Call]] = {
    Occurrence: _occurs,
    Condition: _holds,
    Delay: _is_due,
    Epsilon: _always,
}
"""How each kind of trigger is tested."""


TOLERANCE = 1e-6
"""Milliseconds: sums of periods such as 0.1 s are not exact, and a tick must not be missed for that."""


def _reader(name: str, cell: CellType) -> Call:
    def read() -> object:
        value = content(cell)
        if value is UNSET:
            raise Fault("unknown variable", f"`{name}` has no value")
        return value

    return read
