"""One run of a program: entering, leaving and spawning, faults, counts, and the journal's records.

:class:`Run` is the lower half of the interpreter: everything in it happens within one tick (or one command
between two ticks), and it does not handle edits. Paper: §5.1.
"""

from __future__ import annotations

import builtins
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from operator import itemgetter
from types import CellType, MappingProxyType
from typing import Any, Protocol

from lrp_jupyter.errors import NoDataYet
from lrp_jupyter.interpreter.alone import Alone, linked
from lrp_jupyter.interpreter.cells import Slot, content, parts_of, same, same_parts
from lrp_jupyter.interpreter.debugging import Raised
from lrp_jupyter.interpreter.facts import Discarded, Enabled, Entered, Fact, Faulted, Fired, Spawned
from lrp_jupyter.interpreter.faults import Fault, kind_and_message, line_of, place_of, traceback_of
from lrp_jupyter.interpreter.issues import Issue, IssueKind, IssueLog
from lrp_jupyter.interpreter.journal import Journal, Log, SavedState, note, undo_attribute, undo_write, undoes
from lrp_jupyter.interpreter.linker import (
    Broken,
    EventPlan,
    MachinePlan,
    Site,
    SpawnPlan,
    StatePlan,
    VariablePlan,
    spawn_of,
)
from lrp_jupyter.interpreter.trace_events import UNSET, Observer, TraceEvent
from lrp_jupyter.interpreter.tree import (
    Action,
    Activation,
    Call,
    Context,
    Count,
    Edge,
    Environment,
    Row,
    bind_actions,
    bind_block,
    bind_row,
    chained,
    is_boolean,
    not_boolean,
)
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Element, Path, Program
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.language.successors import Successors

_new = tuple.__new__  # takes a third of the time of a NamedTuple's constructor


class Visits(Protocol):
    """What follows the visits of states: what was begun in a state may have to end with it."""

    def left(self, machine: Path) -> object:
        """Note that a machine, by its path as spawned, has left its active state."""

    def renamed(self, machines: Mapping[Path, Path]) -> object:
        """Note the new paths of running machines, by their old ones."""


class Run:
    """The mutable state of a run: a tree of activations over an immutable plan."""

    def __init__(
        self,
        program: Program,
        robot: object,
        namespace: dict[str, Any],
        output: Callable[..., object] | None,
        journal: int | None,
        alone: Alone | None = None,
    ) -> None:
        self.alone = alone  # what is started instead of what the program spawns at the top level
        self.program, self.plan = program, linked(program, alone)
        self.namespace = namespace
        self.now = 0.0
        self.before = 0.0  # the time before the last tick: when the one before it ended, or as `ended` says
        self.ended = -1, 0.0  # a tick after which a command advanced the time, and when that tick ended
        self.ticks = 0
        self.issues = IssueLog()
        self.base = {"robot": Slot(CellType(robot)), "print": Slot(CellType(output or builtins.print))}
        self.journal = None if journal == 0 else Journal(journal)
        self.log: Log | None = self.journal.log if self.journal is not None else None
        self.full = 0  # the tick after which the journal is trimmed next
        self.counts: dict[Element, Count] = {}
        self.firings: dict[tuple[Element, Element], Count] = {}
        """How often a transition has led to a state since the last update of `counts`: a firing increases one
        number instead of two."""
        self._undone: tuple[str, str] | Program | None = None  # the restored `source`, not yet parsed
        self.epoch = 0  # the number of times that ticks were undone
        self.kept = sys.maxsize  # the tick up to which nothing was ever undone
        self.observers: list[Observer] = []
        self.acting: Action | None = None  # the last action that was begun
        self.visits: Visits | None = None
        self.events: list[TraceEvent] = []
        self.interrupted: BaseException | None = None
        self.event_values: dict[Path, bool | None] | None = None
        self.outcomes: dict[tuple[Element, object], list[int]] = {}
        """How the condition of a transition, with what it means, came out: HELD, FAILED or both."""
        self.unmeant: Element | None = None  # where the user is typing; its faults are not reported
        self.faulted = False  # whether an issue has occurred, even again, since the last tick or command
        self.stale = False
        self.leaking = False
        self.assigned = 0  # the number of values assigned by hand
        self.watched = False  # whether variables are compared after a tick: they leak, or are observed
        self.attention = False  # whether there is anything to do after a tick besides logging its end
        self.clear()

    def clear(self) -> None:
        """Discard all activations and variables."""
        self.issues.forget_instances()
        self.roots: tuple[Activation, ...] = ()
        self.first: Activation | None = None  # in the order of a tick; the others are linked by `next`
        self.unordered = False
        self.pending: frozenset[tuple[str, str]] = frozenset()
        self.started = False
        self.globals = Environment((), dict(self.base))
        self.live: dict[Path, Environment] = {(): self.globals}  # every environment, by path as spawned

    # ---- the tick ---------------------------------------------------------------------------

    def start(self) -> None:
        """Execute the top-level spawns; the first time, initialise the globals first."""
        self.remember(self.ticks - 1)
        if not self.started:
            self.begin()
        self.spawn_top(None)

    def begin(self) -> None:
        """Start the program: initialise the globals."""
        self.started = True
        self.before, self.ended = self.now, (-1, 0.0)  # what was before is no part of this run
        self.log_attributes(self.globals, "own", "visible", "entered")
        self.globals.entered = self.now
        self.emit("started", ())
        self.initialise(self.globals, self.plan.variables, self.base)

    def spawn_top(self, only: frozenset[tuple[str, str]] | None) -> None:
        """Execute the top-level spawns in order, in a tick: all, or `only` the given ones."""
        self.remember(self.ticks - 1)
        self.pending = frozenset()
        for spawn in self.plan.beginning:
            if only is None or spawn.identity in only:
                act = self.spawn_first(spawn)
                if act is not None:
                    self.tick_entered(act)

    def tick_entered(self, act: Activation) -> None:
        """Tick a machine whose active state was entered in this tick: it acts unless it could be left.

        An enabled transition fires in the next tick, if it is still enabled then. Paper: §5.1, steps 3-5.
        """
        edge = act.row.edge
        while edge is not None:
            try:
                holds = edge.test()
            except BaseException as error:
                self.fault(edge.tested, error, act, edge.plan.site.element)
                holds = False
            if (
                holds is not False
                and (holds is True or self.judge(edge, holds))
                and (edge.row or self.find_destination(edge)) is not None
            ):
                if self.log is not None:
                    self.log += (edge.enabled, note)
                return
            edge = edge.next
        self.do(act.row.running)
        for child in act.children:
            self.tick_entered(child)

    def judge(self, edge: Edge, value: object) -> bool:
        """Return whether a condition that is neither True nor False holds: only numpy's True does."""
        if is_boolean(value):
            return bool(value)
        self.report(edge.tested, "not boolean", not_boolean(value), edge.act, edge.plan.site.element)
        return False

    def find_destination(self, edge: Edge) -> Row | None:
        """Bind the actions of an edge the first time that it fires, or report that it leads nowhere."""
        act, plan = edge.act, edge.plan
        if edge.target is None:
            self.report(edge.site, "unknown state", edge.missing, act, plan.site.element)
            return None
        if self.issues.is_open(edge.site[:2], act):
            self.recovered(edge.site, act, True)
        old, new, element = edge.home.row, self.row(edge.home, edge.target), plan.site.element
        edge.leaving = bind_actions(self, act, plan.effect, act, old.departing)
        label, source = edge.plan.label, edge.source
        edge.fact = Fired(element, label, edge.path, source.name, new.place, new.path)
        edge.enabled = Enabled(element, label, edge.path, source.path)
        edge.actions = new.onentry
        if self.observers:
            fired = ("fired", (*edge.path, element.path[-1]), edge.fact)
            events = ("left", old.path, None), fired, ("entered", new.path, None)
            edge.actions = Action(partial(self._emit_all, events), edge.site, act, None, edge.actions)
        if self.visits is not None:
            edge.actions = Action(
                partial(self.visits.left, edge.home.path), edge.site, act, None, edge.actions
            )
        for action in reversed([*chained(old.onexit)]):
            edge.actions = replace(action, next=edge.actions)
        edge.row = new
        return new

    def period(self) -> float:
        """Return the time since the tick before this one, in seconds; 0 in the first."""
        if self.ticks < 2:
            return 0.0
        tick, ended = self.ended
        return self.now - (ended if tick in (self.ticks - 1, self.ticks) else self.before)

    def bind_event(self, event: EventPlan, owner: Environment, at: Environment, leaving: bool) -> Call:
        """Bind the block of an event, for its value in a block of another machine or state."""
        return bind_block(self, event.block, Context(owner, owner.visible, at, leaving))

    def hold(self, act: Activation, name: str, since: float | None) -> None:
        """Note since when the trigger of a transition holds, or that it does not."""
        self.log_attributes(act, "holding")
        others = {key: value for key, value in act.holding.items() if key != name}
        act.holding = others if since is None else {**others, name: since}

    def depart(self, act: Activation) -> None:
        """Prepare to leave the active state: end the times for which triggers hold, and remember its own."""
        act.before = act.entered
        if act.holding:
            self.log_attributes(act, "holding")
            act.holding = {}

    def _emit_all(self, events: Iterable[tuple[str, Path, object]]) -> None:
        tick, now = self.ticks, self.now
        self.events += [_new(TraceEvent, (kind, path, tick, now, data)) for kind, path, data in events]

    def row(self, act: Activation, state: StatePlan) -> Row:
        """Return the row of a state in this activation; bind it the first time."""
        row = act.rows.get(state.name)
        if row is None:
            row = act.rows[state.name] = bind_row(self, act, state)
        return row

    def enter(self, act: Activation, row: Row) -> None:
        """Make a state active and run its onentry items."""
        act.row = row
        act.place = row.place
        act.entered = self.now
        row.count.times += 1
        row.count.tick = self.ticks
        self.note(Entered(row.place, row.path))
        self.emit("entered", row.path)
        self.do(row.onentry)

    def leave(self, act: Activation) -> None:
        """Leave the active state, innermost states first. Paper: §5.1, step 6."""
        if self.log is not None:
            self.log += (act.children, act.entered, act.place, act, undo_change)
        self.do(act.row.departing)
        if act.children:
            self.discard(act, self.leave)
        self.do(act.row.onexit)
        self.has_left(act)

    def has_left(self, act: Activation) -> None:
        """Tell those who follow the run that a machine has left its active state."""
        self.emit("left", act.row.path)
        if self.visits is not None:
            self.visits.left(act.path)

    def do(self, action: Action | None) -> None:
        """Run actions; a fault of one does not keep the others from running."""
        while action is not None:
            if action.cell is not None:
                self.log_cell(action.cell)
            self.acting = action
            try:
                action.call()
            except BaseException as error:
                self.fault(action.site, error, action.home)
            action = action.next

    def discard(self, act: Activation, leave: Callable[[Activation], None]) -> None:
        """Leave and discard the nested machines, the last one spawned first."""
        for child in reversed(act.children):
            leave(child)
            if self.watched:
                if self.log is not None:  # a function may still write them, no longer compared
                    for slot in child.own.values():
                        if slot.leaked:
                            self.log += (slot.last, slot.cell, undo_write)
                self.settle((child,))
            del self.live[child.path]
            if self.issues.open_blocks and self.issues.forget(child):
                self.stale = True
            self.note(Discarded(child.path, child.machine.path))
            self.emit("discarded", child.path)
            child.retire()
        act.children = ()
        self.unordered = self.attention = True

    # ---- spawning ---------------------------------------------------------------------------

    def spawn(
        self,
        parent: Activation | None,
        plan: SpawnPlan,
        enter: Callable[[Activation, Row], None] | None = None,
    ) -> Activation | None:
        """Execute a spawn and return the machine, or report why it cannot be executed."""
        target, home = plan.target, parent or self.globals
        if isinstance(target, Broken):
            self.report(plan.site, target.kind, target.message, home)
            return None
        machine = self.plan.machines[target]
        start = machine.states.get(plan.start)
        if start is None:
            message = f"The machine `{machine.name}` has no state `{plan.start}`."
            self.report(plan.site, "unknown state", message, home)
        elif self.is_running(machine, parent):
            self.report(
                plan.site, "already running", f"The machine `{machine.name}` is already running.", home
            )
        else:
            if self.issues.open_blocks and self.issues.is_open(plan.site[:2], home):
                self.recovered(plan.site, home, None)
            act = self.create(machine, parent, plan, start)
            (enter or self.enter)(act, self.row(act, start))
            return act
        return None

    def spawn_first(self, spawn: SpawnPlan) -> Activation | None:
        """Execute a spawn with which a run begins; first create the machines around it, which do not run."""
        parent: Activation | None = None
        for end in range(1, len(spawn.inside), 2) if spawn.resolves else ():
            machine = self.plan.machines[resolve(self.program).defined(spawn.inside[:end])]
            items = self.plan.spawns if parent is None else parent.state.onentry
            state = machine.states[spawn.inside[end]]
            parent = self.create(machine, parent, spawn_of(items, machine.path), state)
            parent.row = self.row(parent, state)
        return self.spawn(parent, spawn)

    def is_around(self, machine: Environment) -> bool:
        """Return whether a machine only surrounds the one that is started alone."""
        return self.alone is not None and self.alone.is_inside(machine.path)

    def is_running(self, machine: MachinePlan, parent: Activation | None) -> bool:
        """Return whether a machine runs where it would be spawned: beside, or around itself."""
        beside = self.roots if parent is None else parent.children
        for each in beside:
            if each.machine is machine:
                return True
        while parent is not None and parent.machine is not machine:
            parent = parent.parent
        return parent is not None

    def create(
        self, machine: MachinePlan, parent: Activation | None, plan: SpawnPlan | None, state: StatePlan
    ) -> Activation:
        """Create a machine as a spawn does, if any, and initialise its variables; `state` is entered next."""
        outer = (parent or self.globals).around(machine.outer)
        act = Activation(machine, parent, outer, None if plan is None else plan.identity, state)
        self.live[act.path] = act
        act.entered = self.now
        if parent is None:
            self.log_attributes(self, "roots")
            self.roots += (act,)
        else:
            if self.log is not None:
                self.log += (parent.children, parent.entered, parent.place, parent, undo_change)
            parent.children += (act,)
        self.unordered = self.attention = True
        if not self.is_around(act):
            by = parent.full_path if parent is not None and not self.is_around(parent) else ()
            self.note(Spawned(act.path, by, machine.path))
            self.emit("spawned", act.path)
        settings = {} if plan is None else plan.settings
        for name, setting in settings.items():
            if all(variable.name != name for variable in machine.variables):
                message = f"The machine `{machine.name}` has no variable `{name}`."
                self.report(setting.initial.site, "unknown variable", message, parent or self.globals)
        self.initialise(act, machine.variables, outer.visible, settings)
        return act

    def initialise(
        self,
        environment: Environment,
        variables: tuple[VariablePlan, ...],
        outer: Mapping[str, Slot],
        settings: Mapping[str, VariablePlan] = MappingProxyType({}),
    ) -> None:
        """Initialise variables in the order of the text; each sees those before it, or has a setting."""
        environment.own, environment.visible = {}, dict(outer)  # a saved state may hold the old dicts
        for variable in variables:
            slot = Slot(CellType())
            self.evaluate(environment, settings.get(variable.name), variable, slot)
            environment.visible[variable.name] = environment.own[variable.name] = slot

    def evaluate(
        self, environment: Environment, setting: VariablePlan | None, variable: VariablePlan, slot: Slot
    ) -> bool:
        """Run an initialiser, or a setting instead; if it fails, the variable keeps its value."""
        home = environment if setting is None else environment.parent or self.globals
        source = setting or variable
        initial = source.initial
        try:
            slot.cell.cell_contents = bind_block(self, initial, home)()
        except BaseException as error:
            self.fault(initial.site, error, home)
            slot.captured = meant(initial.reads, home.visible)
            return False
        slot.captured = meant(source.captures, home.visible) if source.captures else ()
        slot.computed = self.now, self.assigned
        return True

    def attempt(self, call: Callable[[], object], site: Site, home: Environment) -> None:
        """Run a block; an exception becomes an issue."""
        self.acting = Action(call, site, home, None, None)
        try:
            call()
        except BaseException as error:
            self.fault(site, error, home)

    # ---- faults -----------------------------------------------------------------------------

    def fault(
        self, site: Site, error: BaseException, home: Environment, transition: Element | None = None
    ) -> None:
        """Record an exception of a block as an issue, or count it, unless it is being typed. Paper: §6.2.

        `home`: the machine that ran the block, or the top level. `transition`: the one that was tested.
        """
        type_ = type(error)  # `isinstance` may call code of the exception
        if issubclass(type_, KeyboardInterrupt):  # raised after the tick, so that it is complete
            self.interrupted = error
            self.attention = True
            return
        if site.element == self.unmeant:
            return
        if issubclass(type_, NoDataYet) and site.element.kind in ("event", "transition"):
            self._note_fault(site, "no data yet", str(error), home, transition)
            return  # without data it just does not occur
        kind, message = kind_and_message(self.program, error)
        self._note_fault(site, kind, message, home, transition)
        program, tick = self.program, self.ticks
        raised = None if issubclass(type_, (Fault, NoDataYet)) else error
        if raised is None:
            error.__traceback__ = None  # the issue keeps the error, whose frames would keep earlier programs

        def make() -> Issue:
            place, trace = place_of(program, site, raised), traceback_of(program, raised)
            return Issue(kind, site.element, message, *place, trace, tick, tick)

        self.stale = self.stale or not self.issues.is_open(site[:2], home)
        key, line = (*site[:2], kind), line_of(program, raised)
        debugged = self._raised(site, error, home)
        shared = home.path if resolve(program).is_shared(home.defined) else None
        issue = self.issues.report(key, make, message, tick, line, debugged, home, shared)
        self.faulted = self.attention = True
        if issue is not None:
            self.stale = True
            self.emit("issue", site.element.path, issue)

    def _raised(self, site: Site, error: BaseException, home: Environment) -> Raised:
        """Return the data about a fault that a debugger needs."""
        element = site.element
        state: Path = ()
        if isinstance(home, Activation):
            is_action = element.kind in ("onentry", "running", "onexit")
            state = (*home.path, element.path[-1] if is_action else home.place[-1])
        return Raised(error, home.around_element(element).visible, state)

    def _note_fault(
        self, site: Site, kind: str, message: str, home: Environment, transition: Element | None
    ) -> None:
        self.note(Faulted(site.element, site.ordinal, kind, message, home.path, transition))

    def report(
        self,
        site: Site,
        kind: IssueKind,
        message: str,
        home: Environment,
        transition: Element | None = None,
    ) -> None:
        """Record a fault of the program that is not an exception of Python."""
        self.fault(site, Fault(kind, message), home, transition)

    def recovered(self, site: Site, home: Environment, value: object) -> None:
        """Resolve the issues of a site, which has run without a fault wherever it had failed, now in `home`.

        `value`: what it returned.
        """
        boolean = is_boolean(value)
        if self.issues.recovered(site[:2], home):
            self.issues.resolve(lambda key, _: key[:2] == site[:2] and (boolean or key[2] != "not boolean"))
        self.stale = self.attention = True

    def rebind(self) -> None:
        """Discard all rows, because the objects they were bound to have changed."""
        self.stale = False
        for act in self.walk():
            act.unbind()
            act.row = act.rows[act.place[-1]] = bind_row(self, act, act.state)

    def walk(self) -> Iterator[Activation]:
        """Yield all activations, outer machines before inner ones, in the order of spawning."""
        for root in self.roots:
            yield from root.walk()

    def refresh(self) -> None:
        """Update the data computed from the tree of activations; called between two ticks."""
        while self.stale:  # binding may reveal that a variable leaks after other blocks were bound to it
            self.rebind()
        if self.unordered:
            self.unordered = False
            following = None
            for act in reversed([*self.walk()]):
                act.next = following
                following = act
            self.first = following

    # ---- counts and observers ---------------------------------------------------------------

    def count(self, element: Element) -> Count:
        """Return the count of a state or transition, by its element of definition."""
        return self.counts.setdefault(element, Count())

    def firing(self, transition: Element, state: Element) -> Count:
        """Return the count of firings of a transition to a state that are not yet in `counts`."""
        return self.firings.setdefault((transition, state), Count())

    def add_firings(self) -> None:
        """Add the new firings to the counts of their transitions and states."""
        new = [(count.tick, elements, count) for elements, count in self.firings.items() if count.times]
        for tick, elements, count in sorted(new, key=itemgetter(0)):
            for element in elements:
                total = self.count(element)
                total.times += count.times
                total.tick = tick
            count.times = 0

    def counted(self, kind: str) -> dict[Path, Count]:
        """Return the counts above 0 of all elements of a kind, by path of definition."""
        self.add_firings()
        return {
            element.path: count
            for element, count in self.counts.items()
            if element.kind == kind and count.times
        }

    def replace_program(self, program: Program, successors: Successors) -> None:
        """Continue with another program: the counts of its elements are kept, the others dropped."""
        self.add_firings()
        self.alone = self.alone and self.alone.after(self.program, successors)
        self.program, self.plan = program, linked(program, self.alone)
        self._set_counts(successors.carry(self.counts))

    def _set_counts(self, counts: Mapping[Element, Count]) -> None:
        self.counts = {element: count for element, count in counts.items() if element in self.plan.places}
        self.firings = {}
        known = self.outcomes
        self.outcomes = {what: known[what] for what in self.plan.tests() if what in known}

    def observe(self, callback: Observer) -> Callable[[], None]:
        """Call `callback` with every event from now on; return a function that ends this."""
        if not self.observers:
            for environment in self.live.values():
                environment.sync()
        self.observers.append(callback)
        self.watched = self.attention = True
        self.rebind()

        def unsubscribe() -> None:
            if callback in self.observers:
                self.observers.remove(callback)
            self.watched = self.leaking or bool(self.observers)
            self.rebind()

        return unsubscribe

    def emit(self, kind: str, path: Path, data: object = None) -> None:
        """Queue an event for the observers, which are called when the tick or command is over."""
        if self.observers:
            self.events.append(_new(TraceEvent, (kind, path, self.ticks, self.now, data)))

    # ---- the journal ------------------------------------------------------------------------

    def remember(self, ended: int | None = None) -> None:
        """Save the whole state before a change outside a tick.

        `ended`: number of completed ticks; all, unless this is called inside a tick.
        """
        if self.journal is not None:
            self.journal.save(self.ticks if ended is None else ended, self.saved_state)
            self.full = 0  # the saved state may be large

    @property
    def source(self) -> tuple[str, str] | Program:
        """How a saved state keeps the program: text and file name, a thousandth of the objects."""
        program = self.program
        return (program.text, program.filename) if program.text else program

    @source.setter
    def source(self, source: tuple[str, str] | Program) -> None:
        self._undone = source

    def saved_state(self) -> SavedState:
        """Return the whole state, as it is now."""
        acts = [*self.walk()]
        return SavedState(
            [
                (self, ("source", "alone", "roots", "pending", "started", "globals", "counts")),
                (self.globals, ("own", "visible", "entered")),
                *((act, _CARRIED) for act in acts),
            ],
            [slot.cell for environment in (self.globals, *acts) for slot in environment.own.values()],
        )

    def trim(self) -> None:
        """Drop the records that are beyond the journal's bounds."""
        if self.journal is not None:
            self.full = self.ticks + self.journal.trim(self.ticks)

    def undo(self, ticks: int) -> None:
        """Return to the end of the tick that was `ticks` before the last one."""
        assert self.journal is not None
        self.add_firings()
        counts = self.counts  # not undone, but the counted elements may have their old names again
        self.now = self.journal.undo(self.ticks, ticks)
        if self._undone is not None and self._undone != self.source:
            self.program = parse(*self._undone) if isinstance(self._undone, tuple) else self._undone
            self.plan = linked(self.program, self.alone)
        self._undone = None
        for act in self.walk():
            act.machine = self.plan.machines[act.place[:-1]]
        self._set_counts(counts | self.counts)
        self.ticks -= ticks
        self.epoch += 1
        self.kept = min(self.kept, self.ticks)
        self.full = 0
        self.ended = -1, 0.0
        self.issues.forget_instances()
        self.live = {(): self.globals, **{act.path: act for act in self.walk()}}
        for environment in self.live.values():
            environment.sync()
            for slot in environment.own.values():
                slot.forget(self.now)
        self.unordered = self.stale = True
        self.refresh()

    def leak(self, slot: Slot) -> None:
        """Start comparing a variable after every tick, because a function inside a block writes it."""
        if not slot.leaked:
            slot.leaked = self.leaking = self.watched = self.attention = self.stale = True
            self.log_cell(slot.cell)  # bound blocks still log it until the end of the tick
            if not self.observers:
                slot.last = content(slot.cell)

    def note(self, fact: Fact) -> None:
        """Log a fact, if there is a journal."""
        if self.log is not None:
            self.log += (fact, note)

    def log_attributes(self, part: object, *names: str) -> None:
        """Log the values of attributes before they are replaced."""
        if self.log is not None:
            for name in names:
                self.log += (getattr(part, name), name, part, undo_attribute)

    def log_cell(self, cell: CellType) -> None:
        """Log the content of a cell before it is written."""
        if self.log is not None:
            self.log += (content(cell), cell, undo_write)

    def settle(self, environments: Iterable[Environment]) -> None:
        """Compare the variables that may have changed undetected, for the journal and the observers."""
        for environment in environments:
            for name, slot in environment.own.items():
                if not (slot.leaked or self.observers):
                    continue
                try:
                    value = slot.cell.cell_contents
                except ValueError:
                    value = UNSET
                old, parts = slot.last, slot.parts
                if value is old and (parts is None or not self.observers):
                    continue
                slot.last = value
                if value is not old and slot.leaked and self.log is not None:
                    self.log += (old, slot.cell, undo_write)
                if self.observers and not same(old, value):
                    slot.parts = parts_of(value)
                    if value is not old or not same_parts(parts, slot.parts):
                        self.emit("changed", (*environment.path, name), value)


_CARRIED = ("path", "outer", "spawn", "own", "visible", "place", "entered", "holding", "children")


@undoes(4)
def undo_change(log: Log) -> None:
    """Undo a change of state; the rows are bound again when all is undone."""
    act: Activation = log.pop()
    act.place, act.entered, act.children = log.pop(), log.pop(), log.pop()


@undoes(5)
def undo_fired(log: Log) -> None:
    """Undo the change of state of a transition that fired, and drop its fact."""
    undo_change(log)
    log.pop()


def meant(names: Iterable[str], visible: Mapping[str, Slot]) -> tuple[Slot, ...]:
    """Return the variables that are meant by names in a scope."""
    return tuple([visible[name] for name in names if name in visible])
