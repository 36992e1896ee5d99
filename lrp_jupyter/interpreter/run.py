"""One run of a program: the tick, and what entering, leaving and spawning mean.

:class:`Run` is the lower half of the interpreter: everything in it happens inside one tick (or
inside one command between two ticks) and nothing in it knows of edits. Paper: §5.1.
"""

from __future__ import annotations

import builtins
from collections.abc import Callable, Iterable, Mapping
from types import CellType
from typing import Any

from lrp_jupyter.errors import NoDataYet
from lrp_jupyter.interpreter.events import UNSET, Observer, TraceEvent
from lrp_jupyter.interpreter.faults import Fault, kind_and_message, line_of, make_issue
from lrp_jupyter.interpreter.issues import IssueKind, Issues
from lrp_jupyter.interpreter.journal import Journal
from lrp_jupyter.interpreter.linker import (
    Broken,
    MachinePlan,
    Plan,
    Site,
    SpawnPlan,
    StatePlan,
    VariablePlan,
)
from lrp_jupyter.interpreter.tree import (
    Activation,
    Edge,
    Row,
    Scope,
    bind_block,
    bind_row,
    is_boolean,
    short,
)
from lrp_jupyter.language.program import Path, Program

__all__ = ["Run"]

_new = tuple.__new__  # a third of the time that a NamedTuple's own constructor takes


class Run:
    """The mutable half: a tree of activations over an immutable plan."""

    def __init__(
        self,
        plan: Plan,
        robot: object,
        namespace: dict[str, Any],
        output: Callable[..., object] | None,
        journal: int,
    ) -> None:
        self.plan = plan
        self.namespace = namespace
        self.now = 0.0
        self.ticks = 0
        self.issues = Issues()
        self.last_exception: BaseException | None = None
        self.base = {"robot": CellType(robot), "print": CellType(output or builtins.print)}
        self.journal = Journal(journal) if journal > 0 else None
        self.observers: list[Observer] = []
        self.events: list[TraceEvent] = []
        self.interrupted: KeyboardInterrupt | None = None
        self.event_values: dict[Path, bool | None] | None = None
        self.new_issue = False
        self.stale = False
        self.watched = self.attention = self.journal is not None
        self.clear()

    def clear(self) -> None:
        """Let nothing run and no variable live."""
        self.roots: tuple[Activation, ...] = ()
        self.pending: frozenset[tuple[str, str]] = frozenset()
        self.started = False
        self.globals = Scope((), dict(self.base))
        self.live: dict[Path, Scope] = {(): self.globals}

    @property
    def program(self) -> Program:
        """The program that runs."""
        return self.plan.program

    def scope(self, machine: Path) -> Scope:
        """Look up the living scope of a machine, by its path of definition; the empty path: the globals."""
        return self.live[machine]

    # ---- the tick ---------------------------------------------------------------------------

    def start(self) -> None:
        """Spawn what the top level spawns; the first time, initialise the globals before."""
        if not self.started:
            self.begin()
        self.spawn_top(None)

    def begin(self) -> None:
        """Initialise the globals: the program has started."""
        self.remember()
        self.started = True
        self.emit("started", ())
        self.initialise(self.globals, self.plan.variables, self.base)

    def spawn_top(self, only: frozenset[tuple[str, str]] | None) -> None:
        """Do the top-level spawns in order: all, or `only` some of them."""
        self.remember()
        self.pending = frozenset()
        for spawn in self.plan.spawns:
            if only is None or spawn.identity in only:
                self.spawn(None, spawn)

    def tick(self, act: Activation) -> bool:
        """Tick one machine; True if it went up by `exit`, which ends the tick of its parent."""
        row = act.row
        for test, edge in row.tests:
            try:
                holds = test()
            except BaseException as error:
                self.fault(edge.tested, error)
                continue
            if holds is False:
                continue
            if holds is True or self._judge(edge, holds):
                if edge.target is not None:
                    self._fire(act, edge)
                    return edge.up
                self.report(edge.site, "unknown state", edge.missing)
        for call, site in row.running:
            try:
                call()
            except BaseException as error:
                self.fault(site, error)
        for child in act.children:
            if self.tick(child):
                break
        return False

    def _judge(self, edge: Edge, value: object) -> bool:
        """Whether a condition that is neither True nor False holds: only numpy's True does."""
        if is_boolean(value):
            return bool(value)
        self.report(
            edge.tested,
            "not boolean",
            f"a condition is True or False, not {short(value)}; compare with something",
        )
        return False

    def _fire(self, act: Activation, edge: Edge) -> None:
        home = act.parent if edge.up else act
        assert home is not None  # else it would lead nowhere
        row = edge.row
        if row is None:
            row = self._destination(home, edge)
        if self.observers or home.children:
            self.leave(home)
            if self.observers:
                self.events.append(_new(TraceEvent, ("fired", edge.path, self.ticks, self.now, edge.data)))
            self.enter(home, row)
            return
        # Leave and enter where nothing is inside and nobody watches: two calls less, an eighth of
        # the time of a state change.
        if self.journal is not None:
            self.journal.log.append((home, home.state, home.entered, ()))
        for call, site in home.row.onexit:
            try:
                call()
            except BaseException as error:
                self.fault(site, error)
        home.row = row
        home.state = row.state
        home.entered = self.now
        for call, site in row.onentry:
            try:
                call()
            except BaseException as error:
                self.fault(site, error)

    def _destination(self, home: Activation, edge: Edge) -> Row:
        """Look up where an edge leads, the first time that it fires: an issue of its is over."""
        if edge.site[:2] in self.issues.open_blocks:
            self.recovered(edge.site, True)
        assert edge.target is not None
        edge.row = self.row(home, edge.target)
        return edge.row

    def row(self, act: Activation, state: StatePlan) -> Row:
        """Look up what a state does, bound to this activation; bind it the first time."""
        row = act.rows.get(state.name)
        if row is None:
            row = act.rows[state.name] = bind_row(self, act, state)
        return row

    def enter(self, act: Activation, row: Row) -> None:
        """Make a state active and run its onentry items."""
        act.row = row
        act.state = row.state
        act.entered = self.now
        if self.observers:
            self.events.append(_new(TraceEvent, ("entered", row.path, self.ticks, self.now, None)))
        for call, site in row.onentry:
            try:
                call()
            except BaseException as error:
                self.fault(site, error)

    def leave(self, act: Activation) -> None:
        """Leave the active state, what it contains first, innermost first. Paper: §5.1, step 6."""
        if self.journal is not None:
            self.journal.log.append((act, act.state, act.entered, act.children))
        if act.children:
            self.discard(act, self.leave)
        for call, site in act.row.onexit:
            try:
                call()
            except BaseException as error:
                self.fault(site, error)
        if self.observers:
            self.events.append(_new(TraceEvent, ("left", act.row.path, self.ticks, self.now, None)))

    def discard(self, act: Activation, leave: Callable[[Activation], None]) -> None:
        """Leave and discard the machines inside, the last one spawned first."""
        for child in reversed(act.children):
            leave(child)
            if self.watched:
                if self.journal is not None:  # a closure may change them when they are no longer looked at
                    self.journal.log += [(cell, child.last[name]) for name, cell in child.own.items()]
                self.settle((child,))
            del self.live[child.machine.path]
            self.emit("discarded", child.path)
        act.children = ()

    # ---- spawning ---------------------------------------------------------------------------

    def spawn(
        self,
        parent: Activation | None,
        plan: SpawnPlan,
        enter: Callable[[Activation, Row], None] | None = None,
    ) -> None:
        """Do a spawn, or report why it cannot be done."""
        machine = plan.target
        if isinstance(machine, Broken):
            self.report(plan.site, machine.kind, machine.message)
            return
        start = machine.states.get(plan.start)
        if start is None:
            self.report(plan.site, "unknown state", f"machine `{machine.name}` has no state `{plan.start}`")
        elif machine.path in self.live:
            self.report(plan.site, "already running", f"machine `{machine.name}` runs already")
        else:
            if plan.site[:2] in self.issues.open_blocks:
                self.recovered(plan.site, None)
            act = self.create(machine, parent, plan.identity, start)
            (enter or self.enter)(act, self.row(act, start))

    def create(
        self,
        machine: MachinePlan,
        parent: Activation | None,
        spawn: tuple[str, str] | None,
        state: StatePlan,
    ) -> Activation:
        """Create a machine and initialise its variables; `state` is entered next."""
        outer = self.live[machine.outer.path] if machine.outer else self.globals
        act = Activation(machine, parent, outer, spawn, state)
        self.live[machine.path] = act
        if parent is None:
            self.roots += (act,)
        else:
            if self.journal is not None:
                self.journal.log.append((parent, parent.state, parent.entered, parent.children))
            parent.children += (act,)
        self.emit("spawned", act.path)
        self.initialise(act, machine.variables, outer.cells)
        return act

    def initialise(
        self, scope: Scope, variables: tuple[VariablePlan, ...], outer: Mapping[str, CellType]
    ) -> None:
        """Initialise variables in the order of the text; each sees those before it."""
        scope.cells = cells = dict(outer)
        for variable in variables:
            cell = CellType()
            self.evaluate(variable, cells, cell)
            cells[variable.name] = scope.own[variable.name] = cell
            scope.last[variable.name] = UNSET

    def evaluate(self, variable: VariablePlan, cells: dict[str, CellType], cell: CellType) -> None:
        """Run an initialiser; if it fails, the cell keeps what it holds."""
        try:
            cell.cell_contents = bind_block(self, variable.initial, cells)()
        except BaseException as error:
            self.fault(variable.initial.site, error)

    def attempt(self, call: Callable[[], object], site: Site) -> None:
        """Run a block; an exception becomes an issue."""
        try:
            call()
        except BaseException as error:
            self.fault(site, error)

    # ---- faults -----------------------------------------------------------------------------

    def fault(self, site: Site, error: BaseException) -> None:
        """Turn an exception into an issue. Paper: §6.2."""
        if isinstance(error, KeyboardInterrupt):  # raised when the tick is complete, so that it is whole
            self.interrupted = error
            self.attention = True
        elif isinstance(error, Fault):
            self.report(site, error.kind, str(error))
        elif isinstance(error, NoDataYet):
            if site.element.kind not in ("event", "transition"):  # there it just does not occur
                self.report(site, "no data yet", str(error))
        else:
            self.last_exception = error
            self.report(site, *kind_and_message(error), error)

    def report(self, site: Site, kind: IssueKind, message: str, error: BaseException | None = None) -> None:
        """Record or count an issue."""
        issue = self.issues.report(
            (*site[:2], kind),
            lambda: make_issue(self.program, site, kind, message, self.ticks, error),
            message,
            self.ticks,
            line_of(self.program, error),
        )
        if issue is not None:
            self.stale = self.new_issue = self.attention = True
            self.emit("issue", site.element.path, issue)

    def recovered(self, site: Site, value: object) -> None:
        """Resolve the issues of a site that just ran without fault and gave `value`."""
        boolean = is_boolean(value)
        self.issues.resolve(lambda key, _: key[:2] == site[:2] and (boolean or key[2] != "not boolean"))
        self.stale = self.attention = True

    def rebind(self) -> None:
        """Throw all rows away: what they were bound to has changed."""
        for root in self.roots:
            for act in root.walk():
                act.rows.clear()
                act.row = act.rows[act.state.name] = bind_row(self, act, act.state)
        self.stale = False

    # ---- what others are told ---------------------------------------------------------------

    def observe(self, callback: Observer) -> Callable[[], None]:
        """Tell `callback` of every event from now on; return what ends that."""
        if not self.watched:
            for scope in self.live.values():
                scope.sync()
        self.observers.append(callback)
        self.watched = self.attention = True

        def unsubscribe() -> None:
            if callback in self.observers:
                self.observers.remove(callback)
            self.watched = self.journal is not None or bool(self.observers)

        return unsubscribe

    def emit(self, kind: str, path: Path, data: object = None) -> None:
        """Note an event for the observers; they are told when the tick or command is over."""
        if self.observers:
            self.events.append(_new(TraceEvent, (kind, path, self.ticks, self.now, data)))

    def remember(self) -> None:
        """Let the journal take a snapshot, before a change that is not one of a tick."""
        if self.journal is not None:
            self.journal.remember(self)

    def settle(self, scopes: Iterable[Scope]) -> None:
        """Take note of every variable that changed, for the journal and the observers."""
        for scope in scopes:
            if not scope.own:
                continue
            last = scope.last
            for name, cell in scope.own.items():
                try:
                    value = cell.cell_contents
                except ValueError:
                    value = UNSET
                old = last[name]
                if value is not old:
                    last[name] = value
                    if self.journal is not None:
                        self.journal.log.append((cell, old))
                    if self.observers and not _same(old, value):
                        self.emit("changed", (*scope.path, name), value)


def _same(old: object, new: object) -> bool:
    return type(old) is type(new) and type(new) in (int, float, str, bytes, complex) and old == new
