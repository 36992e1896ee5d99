"""The tree of activations, and the bound rows that a tick follows.

An activation is one running machine: its active state, when that state was entered, one cell per variable,
and the machines that the state spawned. A row is the behaviour of one state of one activation, with its
blocks bound to the cells once, when the state is first entered: a tick follows chains of bound callables
without any lookup. Rows are discarded whenever something about them changes (a patch, a fault that begins or
ends); they are cheap to recreate.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from numbers import Real
from types import CellType, CodeType
from typing import Any, Protocol, TypeVar

from lrp_jupyter.errors import NotAValue
from lrp_jupyter.interpreter.cells import Slot, content, writes_of
from lrp_jupyter.interpreter.computed import ComputedName, owner_of_event
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
    Plan,
    Site,
    SpawnPlan,
    StatePlan,
    VariablePlan,
    spawn_of,
)
from lrp_jupyter.interpreter.rendering import short
from lrp_jupyter.interpreter.trace_events import UNSET
from lrp_jupyter.language.blocks.block import bind
from lrp_jupyter.language.blocks.builtin_names import TIMES, degrees
from lrp_jupyter.language.blocks.computed_names import machine_cell, name_of_cell, value_cell
from lrp_jupyter.language.program import Element, Name, Path, Program, State
from lrp_jupyter.language.resolution import HOLD, resolve
from lrp_jupyter.language.triggers import Condition, Delay, Epsilon, InState, Occurrence, Trigger

Call = Callable[[], object]
Link = TypeVar("Link", "Edge", "Action")


@dataclass(slots=True, eq=False)
class Count:
    """How often a state was entered or a transition fired (`times`), and the tick of the last time."""

    times: int = 0
    tick: int = 0


HELD, FAILED = 1, 2
"""How a condition came out when it was tested: it was True, or it was not."""

_NONE: Mapping[str, Any] = {}
"""Shared, because each object that a spawn makes is one for the garbage collector."""


class Environment:
    """Variables by name: `own` are those of its machine, `visible` are all that its blocks can access.

    It is also the context of its own blocks.
    """

    leaving = False
    __slots__ = ("children", "entered", "lost", "outer", "own", "parent", "path", "place", "visible")

    def __init__(
        self,
        path: Path,
        visible: dict[str, Slot],
        outer: Environment | None = None,
        parent: Activation | None = None,
        place: Path = (),
    ) -> None:
        self.path = path
        self.visible = visible
        self.outer = outer  # the environment around it in the text
        self.parent = parent  # the machine whose active state has spawned it
        self.place = place  # of the active state, by definition: it suits any plan, so the journal keeps it
        self.entered = 0.0  # when that was entered; at the top level, when the program started
        self.children: tuple[Activation, ...] = ()
        self.own: dict[str, Slot] = {}
        self.lost: Mapping[str, Slot] = _NONE  # removed variables: functions may still refer to their cells

    @property
    def home(self) -> Environment:
        """Itself: its own blocks are in its scope."""
        return self

    at = home

    @property
    def defined(self) -> Path:
        """The path of definition of the machine; empty at the top level."""
        return self.place[:-1]

    def around(self, defined: Path) -> Environment:
        """Return itself or what is around it in the text: the one with this path of definition."""
        environment = self
        while environment.outer is not None and environment.defined != defined:
            environment = environment.outer
        return environment

    def around_element(self, element: Element) -> Environment:
        """Return itself or what is around it in the text: the innermost one that contains an element."""
        environment, path = self, element.path
        while environment.outer is not None and path[: len(environment.defined)] != environment.defined:
            environment = environment.outer
        return environment

    def sync(self) -> None:
        """Store the present values for the next comparison."""
        for slot in self.own.values():
            slot.keep(content(slot.cell))


@weightless
class Activation(Environment):
    """One running machine."""

    __slots__ = ("before", "holding", "machine", "next", "row", "rows", "spawn")

    def __init__(
        self,
        machine: MachinePlan,
        parent: Activation | None,
        outer: Environment,
        spawn: tuple[str, str] | None,
        state: StatePlan,
    ) -> None:
        path = (*parent.full_path, machine.name) if parent else (machine.name,)
        super().__init__(path, outer.visible, outer, parent, state.path)
        self.machine = machine
        self.spawn = spawn
        self.row: Row
        self.rows: dict[str, Row] = {}
        self.before = 0.0  # when the state that was left last had been entered
        self.holding: Mapping[str, float] = _NONE  # since when the triggers of transitions hold, by id
        self.next: Activation | None = None  # the next activation in the order of a tick

    @property
    def state(self) -> StatePlan:
        """The active state."""
        return self.machine.states[self.place[-1]]

    @property
    def full_path(self) -> Path:
        """The path of the active state, as spawned."""
        return (*self.path, self.place[-1])

    def settings(self, plan: Plan) -> Mapping[str, VariablePlan] | None:
        """Return the settings with which it is spawned in a plan; None if nothing spawns it."""
        spawns: Sequence[object] = plan.spawns
        if self.parent is not None:
            state = plan.state(self.parent.place)
            spawns = state.onentry if state is not None else ()
        spawn = spawn_of(spawns, self.defined)
        return None if spawn is None else spawn.settings

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
    __slots__ = ("act", "actions", "count", "enabled", "fact", "home", "leaving", "next", "plan", "row",
                 "source", "target", "test")
    # fmt: on

    def __init__(
        self, run: _Host, act: Activation, state: StatePlan, plan: EdgePlan, following: Edge | None
    ) -> None:
        self.plan = plan
        self.act = act
        self.source = state
        self.test = _test(run, act, state, plan)
        self.next = following
        self.leaving: Action | None = None  # its effect, and what leaving the source needs besides
        self.row: Row | None = None  # the row of the destination, once it has fired
        self.actions: Action | None = None  # of its firing: onexit of the source, then onentry of `row`
        self.fact: Fired | None = None  # the fact that the journal keeps when it fires
        self.enabled: Enabled | None = None  # what it keeps if enabled in the tick that entered the source
        home = act.parent if plan.noun.outward else act
        self.home = home or act  # the activation whose state it changes
        self.target = home.machine.states.get(str(plan.noun.destination)) if home else None
        element = plan.site.element
        self.count = run.firing(element, Element("state", self.target.path)) if self.target else Count()
        if plan.noun.trigger.keyword == "on":  # the others are delays, or always true
            self._note_outcomes(run.outcomes.setdefault((element, plan.means(state.name)), [0]))

    def _note_outcomes(self, outcomes: list[int]) -> None:
        """Note how its test comes out, unless it has come out both ways."""
        test = self.test
        if outcomes[0] == HELD | FAILED:
            return

        def noting() -> object:
            value = test()
            if outcomes[0] != HELD | FAILED:
                outcomes[0] |= HELD if value is True or (is_boolean(value) and bool(value)) else FAILED
            return value

        self.test = noting

    @property
    def path(self) -> Path:
        """The path of its machine, as spawned."""
        return self.act.path

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
    home: Environment
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
    departing: Action | None = None
    """What is done besides before it is left, if anything."""
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
    program: Program
    plan: Plan
    issues: IssueLog
    log: Log | None
    event_values: dict[Path, bool | None] | None
    outcomes: dict[tuple[Element, object], list[int]]

    @property
    def roots(self) -> Sequence[Activation]: ...
    def is_around(self, act: Activation) -> bool: ...
    def count(self, element: Element) -> Count: ...
    def firing(self, transition: Element, state: Element) -> Count: ...
    def spawn(self, parent: Activation | None, plan: SpawnPlan) -> Activation | None: ...
    def recovered(self, site: Site, home: Environment, value: object) -> None: ...
    def period(self) -> float: ...
    def bind_event(self, event: EventPlan, owner: Environment, at: Environment, leaving: bool) -> Call: ...
    def hold(self, act: Activation, name: str, since: float | None) -> None: ...
    def fault(
        self, site: Site, error: BaseException, home: Environment, transition: Element | None = None
    ) -> None: ...
    def depart(self, act: Activation) -> None: ...
    def leak(self, slot: Slot) -> None: ...
    def log_cell(self, cell: CellType) -> None: ...


def broken(reason: Broken) -> Call:
    """Return a callable that fails with `reason`."""

    def fail() -> object:
        raise Fault(reason.kind, reason.message)

    return fail


@dataclass(slots=True, eq=False)
class Context:
    """Where a block runs: the machine in whose scope, and the variables that it can access.

    `at`: the machine from whose state `elapsed` counts. `leaving`: whether that state is being left.
    """

    home: Environment
    visible: Mapping[str, Slot]
    at: Environment
    leaving: bool = False


BlockScope = Context | Environment


def bind_code(run: _Host, code: CodeType, scope: BlockScope) -> Call:
    """Bind a compiled block to variables; the cells that it writes are logged before it runs."""
    return _logged(run, *_bind(run, code, scope))


def _bind(run: _Host, code: CodeType, scope: BlockScope) -> tuple[Call, CellType | None]:
    """Bind a compiled block to variables; return it, and a cell that it writes without logging it."""
    visible = scope.visible
    cells = {name: visible[name].cell for name in code.co_freevars if name in visible}
    is_hidden = False
    if len(cells) < len(code.co_freevars):
        cells |= {name: _provided(run, name, scope) for name in code.co_freevars if name not in cells}
        is_hidden = "degrees" not in visible and "degrees" in cells
    call = bind(code, run.namespace, cells)
    if is_hidden:
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


def _provided(run: _Host, name: str, scope: BlockScope) -> CellType:
    """Return the cell of a free variable that is no variable of the program."""
    if not name_of_cell(name):
        return CellType()
    return CellType(ComputedName(run, name, scope.home, scope.at, scope.leaving))


def provided(run: _Host, name: str, scope: BlockScope) -> Call | None:
    """Return the function that computes what a name means in a scope; None if it is no such name."""
    if name in TIMES or owner_of_event(run.plan, scope.home, name) is not None:
        return ComputedName(run, value_cell(name), scope.home, scope.at, scope.leaving)
    if resolve(run.program).by_path[scope.home.defined].machines_called(name):
        return ComputedName(run, machine_cell(name), scope.home, scope.at)
    return None


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


def bind_block(run: _Host, plan: BlockPlan, scope: BlockScope) -> Call:
    """Bind a block outside a state's actions; the cells that it writes are logged before it runs."""
    return _logged(run, *_bind_block(run, plan, scope))


def _bind_block(run: _Host, plan: BlockPlan, scope: BlockScope) -> tuple[Call, CellType | None]:
    """Bind a block to variables; if it has an open issue, the next run without a fault resolves it."""
    if isinstance(plan.code, Broken):
        return broken(plan.code), None
    call, cell = _bind(run, plan.code, scope)
    return (watched(run, plan.site, scope.at, call) if run.issues.open_blocks else call), cell


def bind_actions(
    run: _Host,
    act: Activation,
    plans: tuple[BlockPlan | SpawnPlan, ...],
    scope: BlockScope,
    following: Action | None = None,
) -> Action | None:
    """Bind actions to an activation, in order before those that follow."""
    first = following
    for plan in reversed(plans):
        if isinstance(plan, SpawnPlan):
            first = Action(partial(run.spawn, act, plan), plan.site, act, None, first)
        else:
            call, cell = _bind_block(run, plan, scope)
            first = Action(call, plan.site, act, cell, first)
    return first


def watched(run: _Host, site: Site, home: Environment, call: Call) -> Call:
    """Wrap a call if its site has an open issue of this instance: a run without a fault resolves it."""
    if not run.issues.open_blocks or not run.issues.is_open(site[:2], home):
        return call

    def again() -> object:
        value = call()
        run.recovered(site, home, value)
        return value

    return again


def bind_row(run: _Host, act: Activation, state: StatePlan) -> Row:
    """Bind the blocks and transitions of `state` to `act`; none of a machine around one started alone."""
    if run.is_around(act):
        bare = StatePlan(state.name, state.path, state.noun)
        return Row(bare, (*act.path, state.name), run.count(Element("state", state.path)))
    edge = None
    for plan in reversed(state.edges):
        edge = Edge(run, act, state, plan, edge)
    departing: Action | None = None
    leaving: BlockScope = act
    if state.departs:
        leaving = Context(act, act.visible, act, leaving=True)
        departing = Action(
            partial(run.depart, act), Site(Element("state", state.path), -1, 0), act, None, None
        )
    return Row(
        state,
        (*act.path, state.name),
        run.count(Element("state", state.path)),
        edge,
        bind_actions(run, act, state.onentry, act),
        bind_actions(run, act, state.running, act),
        bind_actions(run, act, state.onexit, leaving),
        departing,
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


def _test(run: _Host, act: Activation, state: StatePlan, edge: EdgePlan) -> Call:
    if isinstance(edge.test, Broken):
        return broken(edge.test)
    call = _TESTS[type(edge.noun.trigger)](run, act, state, edge)
    return call if edge.noun.hold is None else held(run, act, edge, edge.noun.hold, call)


def _occurs(run: _Host, act: Activation, state: StatePlan, edge: EdgePlan) -> Call:
    assert isinstance(edge.test, EventPlan)
    event = edge.test
    owner = act.around(event.owner)
    call = bind_block(run, event.block, act if owner is act else Context(owner, owner.visible, act))
    values = run.event_values
    return call if values is None else noted(values, (*owner.path, event.block.site.element.path[-1]), call)


def _holds(run: _Host, act: Activation, state: StatePlan, edge: EdgePlan) -> Call:
    assert isinstance(edge.test, BlockPlan)
    return bind_block(run, edge.test, act)


def _is_in_state(run: _Host, act: Activation, state: StatePlan, edge: EdgePlan) -> Call:
    trigger, machine = edge.noun.trigger, edge.watched.get(state.name)
    assert isinstance(trigger, InState)
    name = str(trigger.state)

    def is_in_state() -> bool:
        for child in act.children:
            if child.machine.path == machine:
                return child.place[-1] == name
        return False

    return is_in_state


def _is_due(run: _Host, act: Activation, state: StatePlan, edge: EdgePlan) -> Call:
    trigger = edge.noun.trigger
    assert isinstance(trigger, Delay)
    if isinstance(trigger.amount, int):
        milliseconds = trigger.amount
        return lambda: (run.now - act.entered) * 1000.0 + TOLERANCE >= milliseconds
    is_over = _over(run, act, trigger, edge.test)
    return watched(run, edge.site, act, lambda: is_over(act.entered))


def _over(
    run: _Host, act: Activation, delay: Delay, plan: EventPlan | BlockPlan | Broken | None
) -> Callable[[float], bool]:
    """Return a function that returns whether a delay is over, for the time at which it began.

    `plan`: the delay's block, or the reason for the absence of its variable.
    """
    amount = delay.amount
    if isinstance(amount, int):
        milliseconds = amount
        return lambda since: (run.now - since) * 1000.0 + TOLERANCE >= milliseconds
    read: Call
    if isinstance(plan, Broken):
        read = broken(plan)
    elif isinstance(plan, BlockPlan):
        read = broken(plan.code) if isinstance(plan.code, Broken) else bind_code(run, plan.code, act)
    else:
        read = _reader(str(amount), act.visible[str(amount)].cell)

    def over(since: float) -> bool:
        value = read()
        if isinstance(value, bool) or not isinstance(value, Real) or value != value:
            raise Fault("not a delay", f"A delay must be a number of milliseconds, not {short(value)}.")
        return bool((run.now - since) * 1000.0 + TOLERANCE >= value)

    return over


def held(run: _Host, act: Activation, edge: EdgePlan, hold: Delay, test: Call) -> Call:
    """Return a test that is True once another one has been True at every test for a delay."""
    is_over, name = _over(run, act, hold, edge.hold), edge.site.element.path[-1]
    site = edge.site._replace(ordinal=HOLD)

    def is_held() -> object:
        try:
            value = test()
            holds = value is True or (is_boolean(value) and bool(value))
        except BaseException:
            run.hold(act, name, None)
            raise
        if not holds:
            if name in act.holding:
                run.hold(act, name, None)
            return value
        if name not in act.holding:
            run.hold(act, name, run.now)
        try:
            return over()
        except BaseException as error:
            run.fault(site, error, act, edge.site.element)
            return False

    over = watched(run, site, act, lambda: is_over(act.holding[name]))
    return is_held


def _always(run: _Host, act: Activation, state: StatePlan, edge: EdgePlan) -> Call:
    return lambda: True


_TESTS: dict[type[Trigger], Callable[[_Host, Activation, StatePlan, EdgePlan], Call]] = {
    Occurrence: _occurs,
    Condition: _holds,
    InState: _is_in_state,
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
