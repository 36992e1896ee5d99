"""The interpreter: runs a program that can be changed while it runs.

*A program is a value, an edit is a diff of two values, a tick is a function of time.* There is no clock, no
thread and no input or output here: :meth:`Interpreter.step` is exactly the loop of §5.1 of the paper. The
caller decides when to call it, and passes the time.

It is built from three parts:

- a **plan** (``linker``): the program with its names resolved and its blocks compiled. It is
  immutable; every accepted edit links a new one.
- a **tree of activations** (``tree``): one activation per running machine, with its
  active state, the time it was entered, and one cell per variable. Blocks are bound to cells as
  closures are, so a variable is as fast as a local variable of Python.
- a **run** (``run``): the tick over that tree, with entering, leaving, spawning and faults.

A tick walks from the roots down. In each machine the transitions that leave the active state are tested in
the order of the text; the first that is enabled and leads somewhere fires: the active state is left
(innermost first) and the destination is entered. The transitions of the destination are tested in the same
tick, but an enabled one fires in the next tick at the earliest. If none is enabled, the ``running`` actions
run and the machines inside are ticked.

An edit (``patching``) is applied between two ticks: link, decide, swap. Activations are carried over
by path; only what §6.1 calls an undefined situation restarts. A ``journal`` records how to undo
each tick. Faults of the program become issues and never raise.

Every command takes effect between ticks, before the call returns. An interpreter belongs to one thread.
"""

from __future__ import annotations

import builtins
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from types import MappingProxyType, NoneType, TracebackType
from typing import Any, Literal

from lrp_jupyter.arguments import A_PROGRAM, check_choice, check_number, check_type
from lrp_jupyter.errors import LRPError
from lrp_jupyter.interpreter.alone import alone, linked
from lrp_jupyter.interpreter.cells import Slot, content
from lrp_jupyter.interpreter.countdowns import Countdown, countdowns
from lrp_jupyter.interpreter.debugging import scoped_traceback
from lrp_jupyter.interpreter.facts import Commanded
from lrp_jupyter.interpreter.forcing import How, find_edge, find_state, force
from lrp_jupyter.interpreter.history import History
from lrp_jupyter.interpreter.issues import Issue, IssueLog
from lrp_jupyter.interpreter.journal import EDITS, note, undo_write
from lrp_jupyter.interpreter.linker import BlockPlan, show_in_tracebacks
from lrp_jupyter.interpreter.patching import Decision, Patch, adopt, carry_issues, decide
from lrp_jupyter.interpreter.run import Run, Visits, undo_fired
from lrp_jupyter.interpreter.snapshot import Snapshot, begin, take
from lrp_jupyter.interpreter.trace_events import UNSET, Observer, TraceEvent
from lrp_jupyter.interpreter.tree import FAILED, HELD, Activation, Count, Edge, bind_block, chained
from lrp_jupyter.interpreter.variables import BlockTest, Outdated, VariableMapping, assign, evaluate, outdated
from lrp_jupyter.interpreter.watched_test import watch
from lrp_jupyter.language.blocks.expressions import Evaluation
from lrp_jupyter.language.blocks.names_in_blocks import as_path
from lrp_jupyter.language.diff import diff
from lrp_jupyter.language.edits.rename import rename as renamed_text
from lrp_jupyter.language.half_typed import Unmeant, waits_for
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.program import Element, Path, Program, path_text
from lrp_jupyter.language.resolution import resolve
from lrp_jupyter.language.successors import Successors, after_rename, after_undo


def nothing(_: object) -> None:
    """Return None: no object is represented by another."""


_KEPT = 20  # number of recent edits whose maps are kept
_CARRIED = (
    *("on_active_edit", "on_issue", "paused", "ended"),
    *("patch_reason", "restarts", "restart_reason", "revision"),
)
"""The attributes of an interpreter that a snapshot contains besides its run."""

_POLICIES = {"on_active_edit": ("restart", "keep"), "on_issue": ("record", "pause")}


class Interpreter:
    """Run a program, tick by tick.

    Parameters
    ----------
    program : Program
    robot : object, optional
        The value of ``robot`` in blocks.
    namespace : dict, optional
        Names that blocks can read (a notebook's); never written, except for `__builtins__`, as by ``exec``.
    on_active_edit : {"restart", "keep"}
        The effect of a change to the actions of an active state.
    on_issue : {"record", "pause"}
        ``pause``: complete the tick, then pause, whenever an issue occurs, for the first time or again.
    journal : int, optional
        How many ticks :meth:`rewind` can go back, by default 10,000 or those of 10 minutes, whichever are
        more; fewer if they take more than about 100 MB. 0 keeps no journal.
    output : callable, optional
        The function that blocks call as ``print``.
    start : str or path, optional
        A machine, as spawned, that runs instead of those that the program spawns at the top level; or one of
        its states, by default that in which the program spawns it. The machines around it do not run, but
        their variables exist.

    Raises
    ------
    UnknownElementError
        There is no such machine or state to `start`, or there are several.
    LRPError
        It is not known in which state to `start` it.

    Attributes
    ----------
    paused : bool
    ended : bool
        Whether the run has ended, until the program restarts.
    restarts : int
        How often the program was restarted; `restart_reason` says why the last time.
    revision : int
        How many edits, renames and rewinds have taken effect.
    moved : tuple of (int, Successors)
        The last edits and renames that changed paths: for each the revision that it led to, and the map
        from old elements to new ones.
    patch_reason : str
        A sentence about the last edit, for example why it is not applied yet; may be empty.

    Examples
    --------
    >>> interpreter = Interpreter(parse("(machine m (state a) (state b) (ontime 300 a -> b)) (spawn m a)"))
    >>> for tick in range(4):
    ...     interpreter.step(tick / 10)
    >>> interpreter.active
    (('m', 'b'),)

    Paper: §5.1, §6.
    """

    def __init__(
        self,
        program: Program,
        robot: object = None,
        namespace: dict[str, Any] | None = None,
        on_active_edit: Literal["restart", "keep"] = "restart",
        on_issue: Literal["record", "pause"] = "record",
        *,
        journal: int | None = None,
        output: Callable[..., object] | None = None,
        start: str | Path | None = None,
    ) -> None:
        check_type("program", program, Program, A_PROGRAM)
        check_type("namespace", namespace, (dict, NoneType), "a dict")
        check_type("start", start, (str, tuple, NoneType), "the path of a machine or a state")
        if journal is not None:
            check_type("journal", journal, int, "a number of ticks")
            check_number("journal", journal, "a number of ticks", least=0)
        self.on_active_edit = on_active_edit
        self.on_issue = on_issue
        self.paused = False
        self.ended = False
        self.restarts = 0
        self.restart_reason = ""
        self.revision = 0
        self.moved: tuple[tuple[int, Successors], ...] = ()
        self.moves: deque[tuple[int, Successors]] = deque(maxlen=EDITS)
        """The edits and renames that changed the path of an element: the tick before each, and the map."""
        self.patch_reason = ""
        self._robot = robot
        self.namespace: dict[str, Any] = {} if namespace is None else namespace
        """Names that blocks can read."""
        self.namespace.setdefault("__builtins__", builtins)  # C code such as numpy's imports with it
        self._new_run = partial(Run, robot=robot, namespace=self.namespace, output=output, journal=journal)
        self._run = self._new_run(program, alone=None if start is None else alone(program, start))
        self._history = History(self._run)
        show_in_tracebacks(program)
        self.report_duplicates()

    def __repr__(self) -> str:
        active = ", ".join(map(path_text, self.active)) or "nothing"
        return f"<Interpreter: tick {self.tick}, {active} active>"

    def __setattr__(self, name: str, value: object) -> None:
        if name in _POLICIES:
            check_choice(name, value, _POLICIES[name])
        super().__setattr__(name, value)

    # ---- state ------------------------------------------------------------------------------

    @property
    def program(self) -> Program:
        """The program that runs."""
        return self._run.program

    @property
    def start(self) -> Path | None:
        """The path of the machine or state that is started instead of what the program spawns."""
        return None if self._run.alone is None else self._run.alone.path

    @property
    def active(self) -> tuple[Path, ...]:
        """The paths of the innermost active states, as spawned."""
        return tuple(act.full_path for act in self._run.walk() if not act.children)

    @property
    def variables(self) -> VariableMapping:
        """The existing variables and their values."""
        return VariableMapping(self._run)

    @property
    def outdated(self) -> dict[Path, Outdated]:
        """The variables whose source has been assigned by hand since they were computed.

        Only an edit recomputes them. Paper: §4.
        """
        return outdated(self._run)

    @property
    def issues(self) -> IssueLog:
        """The faults of the program so far, each once. Paper: §6.2."""
        return self._run.issues

    @property
    def tick(self) -> int:
        """The number of ticks so far, which is also the number of the last tick."""
        return self._run.ticks

    @property
    def now(self) -> float:
        """The time of the last tick or command, in seconds."""
        return self._run.now

    @property
    def journal(self) -> int:
        """The number of ticks that :meth:`rewind` can go back now."""
        return len(self.history.ticks)

    @property
    def history(self) -> History:
        """The ticks that the journal holds: what happened in them, and the state after each."""
        if self._history.run is not self._run:
            self._history = History(self._run)
        return self._history

    def resolve_issues(self, is_over: Callable[[BaseException], bool]) -> None:
        """Resolve, between two ticks, the issues for whose last exception `is_over` is true."""
        issues = self._run.issues
        issues.resolve(
            lambda _, issue: (raised := issues.raised(issue)) is not None and is_over(raised.error)
        )
        self._run.rebind()

    def traceback_of(self, issue: Issue, assign: Callable[[Path, object], object]) -> TracebackType | None:
        """Return the traceback of an issue's last occurrence, with all that is in scope; None if unknown.

        `assign`: assigns a value to the variable of a path.
        """
        run = self._run
        raised = run.issues.raised(issue)

        def assign_slot(name: str, slot: Slot, value: object) -> None:
            for environment in run.live.values():
                if environment.own.get(name) is slot:
                    assign((*environment.path, name), value)
                    return
            raise LRPError(f"`{name}` is not a variable that exists now, so it cannot be assigned.")

        if raised is None:
            return None
        return scoped_traceback(run.program, issue, raised, run.namespace, assign_slot)

    def entered(self, path: Path | str) -> float | None:
        """Return when the active state with this path (as spawned) was entered, in seconds, or None."""
        wanted = as_path(path)
        return next((act.entered for act in self._run.walk() if act.full_path == wanted), None)

    @property
    def visits(self) -> dict[Path, Count]:
        """How often each state was entered and in which tick last, by path of definition."""
        return self._run.counted("state")

    @property
    def firings(self) -> dict[Path, Count]:
        """How often each transition fired and in which tick last, by path of definition."""
        return self._run.counted("transition")

    @property
    def is_started(self) -> bool:
        """Whether the program has begun: not before its first tick, nor between a reset and the next tick."""
        return self._run.started

    @property
    def outcomes(self) -> dict[Path, tuple[bool, bool]]:
        """Whether the condition of each transition ever was True when it was tested, and ever was not.

        By path of definition; since the condition was edited last. Delays are not among them.
        """
        run, found = self._run, dict[Path, int]()
        for element, means in run.plan.tests():
            found[element.path] = found.get(element.path, 0) | run.outcomes.get((element, means), [0])[0]
        return {path: (bool(bits & HELD), bool(bits & FAILED)) for path, bits in found.items() if bits}

    @property
    def event_values(self) -> Mapping[Path, bool | None]:
        """The result of the last test of each event of what runs, by path as spawned; see `watch_events`."""
        run = self._run
        return {path: value for path, value in (run.event_values or {}).items() if path[:-1] in run.live}

    @property
    def countdowns(self) -> dict[Path, Countdown]:
        """The transitions that wait for a time, by path as spawned: that of the machine, then the id."""
        found: dict[Path, Countdown] = {}
        for act in self._run.walk():
            if act.row.state.waits:
                value = partial(self._content, act)
                found.update(countdowns(self.program, act.path, act.place, act.entered, act.holding, value))
        return found

    @staticmethod
    def _content(act: Activation, name: str) -> object:
        slot = act.visible.get(name)
        return None if slot is None else content(slot.cell)

    def watch_events(self) -> None:
        """Start recording the result of each event's test, for views; this has a small cost."""
        if self._run.event_values is None:
            self._run.event_values = {}
            self._run.rebind()

    def test(self, block: BlockTest) -> dict[Path, bool | BaseException]:
        """Return whether a block is True now in each instance: see :meth:`BlockTest.results`."""
        return block.results(self._run)

    def watch_test(
        self, element: Element, machine: Path, seen: Callable[[Evaluation | Exception], object]
    ) -> None:
        """Evaluate the test of a transition part by part in the next tick, and call `seen` with each result.

        A test is watched only if it is a single expression.

        `machine`: the machine of the transition, by path as spawned.
        """
        for act in self._run.walk():
            for edge in chained(act.row.edge):
                if edge.plan.site.element == element and act.path == machine:
                    watch(self._run, edge, seen)

    def observe(self, callback: Observer) -> Callable[[], None]:
        """Call `callback` with every :class:`TraceEvent`; return a function that ends this.

        Observers are called in order when a tick or a command is over, on the interpreter's thread.
        """
        return self._run.observe(callback)

    def follow_visits(self, visits: Visits) -> None:
        """Tell `visits` of every state that is left from now on, in the middle of the tick."""
        self._run.visits = visits
        self._run.rebind()

    @property
    def acting(self) -> tuple[Path, str]:
        """The machine for whose state an action was begun last, as spawned, and the kind of the action."""
        action = self._run.acting
        if action is None:
            return (), ""
        element, home = action.site.element, action.home
        arrow = resolve(self.program).arrow(Element("transition", element.path))
        if element.kind == "effect" and arrow is not None and arrow.noun.outward:
            home = home.parent or home  # it leads to a state of the machine around
        return home.path, element.kind

    def emit(self, kind: str, data: object, now: float, ticks: int = 0) -> None:
        """Notify the observers, in order with other events, of an event that the owner has detected.

        Parameters
        ----------
        kind : str
        data : object
        now : float
            Seconds; between two ticks it is later than :attr:`now`.
        ticks : int
            How many ticks later than the last one it belongs to.
        """
        run = self._run
        if run.observers:
            run.events.append(TraceEvent(kind, (), run.ticks + ticks, now, data))

    # ---- the tick ---------------------------------------------------------------------------

    def step(self, now: float) -> None:
        """Run one tick.

        Parameters
        ----------
        now : float
            Seconds; never less than the last time.

        Paper: §5.1. Deviation: the delay of the loop is not waited for between leaving a state (step 7) and
        entering the next one (step 2), so that a robot has no gap between onexit and onentry.
        """
        # Not split into functions: in Python a call costs as much as a block of a program.
        run = self._run
        before = run.now
        if not now >= before:
            self._advance(now)
        run.before = before
        run.now = now
        run.ticks += 1
        log = run.log
        act = run.first
        if act is None:
            run.start()
        left: Activation  # the machine whose transition has fired
        entered = None  # the machine whose state was then entered
        while act is not None:
            edge = act.row.edge
            while edge is not None:
                test = edge.test  # a local name is faster to call than an attribute
                try:
                    holds = test()
                except BaseException as error:
                    run.fault(edge.tested, error, act, edge.plan.site.element)
                    holds = False
                if holds is not False and (holds is True or run.judge(edge, holds)):
                    row = edge.row or run.find_destination(edge)
                    if row is not None:
                        if entered is None:  # it fires
                            left, act = act, edge.home
                            if log is not None:
                                log += (edge.fact, act.children, act.entered, act.place, act, undo_fired)
                            if edge.leaving is not None:
                                run.do(edge.leaving)
                            if act.children:
                                run.discard(act, run.leave)
                            act.row = row
                            act.place = row.place
                            act.entered = now
                            count = edge.count
                            count.times += 1
                            count.tick = run.ticks
                            action = edge.actions
                            entered = act  # it is ticked next
                        else:  # not in the tick of the entry: the state does not act
                            if log is not None:
                                log += (edge.enabled, note)
                            action = entered = None
                            act = left
                        break
                edge = edge.next
            else:
                action = act.row.running
            while action is not None:
                run.acting = action
                cell = action.cell
                if cell is not None and log is not None:
                    try:
                        log += (cell.cell_contents, cell, undo_write)
                    except ValueError:
                        log += (UNSET, cell, undo_write)
                call = action.call
                try:
                    call()
                except BaseException as error:
                    run.fault(action.site, error, action.home)
                action = action.next
            if entered is None:
                act = act.next
            elif edge is None:
                for child in entered.children:
                    run.tick_entered(child)
                act, entered = left.next, None
        if run.attention:
            if run.pending:
                run.spawn_top(run.pending)
            self._done(ticked=True)
        elif log is not None:
            log.append(now)
            if run.ticks >= run.full:
                run.trim()

    def _advance(self, now: float | None) -> None:
        if now is None:
            return
        if not now >= self._run.now:
            raise ValueError(f"Time cannot go back: {now!r} is before {self._run.now!r}.")
        run = self._run
        if run.ended[0] != run.ticks:
            run.ended = run.ticks, run.now
        run.now = now

    def _done(self, command: Commanded | None = None, *, ticked: bool = False) -> None:
        """End a command, which is logged unless the previous one was the same, or a tick."""
        run = self._run
        if run.watched:
            run.settle(run.live.values())
        log = run.log
        if command and log is not None and not (len(log) > 2 and log[-1] is note and log[-2] == command):
            log += (command, note)
        if ticked and log is not None:
            log.append(run.now)
            if run.ticks >= run.full:
                run.trim()
        run.refresh()
        run.attention = run.watched or bool(run.pending)
        if run.faulted:
            run.faulted = False
            if self.on_issue == "pause" and not (self.paused or self.ended):
                self.pause()
        if run.events:
            events, run.events = run.events, []
            for observer in tuple(run.observers):
                for event in events:
                    observer(event)
        if run.interrupted is not None:
            interrupted, run.interrupted = run.interrupted, None
            raise interrupted

    def weigh(self) -> None:
        """Have the journal weigh its values after the next tick; loops call this a few times a second."""
        self._run.full = 0

    # ---- changes ----------------------------------------------------------------------------

    def patch(self, program: Program, now: float | None = None, unmeant: Unmeant | None = None) -> Patch:
        """Change the running program.

        Parameters
        ----------
        program : Program
        now : float, optional
            Seconds; by default the last time.
        unmeant : Unmeant, optional
            The part of the program that is still being typed: the program without it runs instead if this
            part would disturb active states.

        Returns
        -------
        Patch
            What changed, whether it was applied, whether the program restarts, and why.

        Paper: §6.1.
        """
        run = self._run
        self._advance(now)
        before = run.program
        waiting = None if unmeant is None else self._waiting(program, unmeant)
        if unmeant is not None and waiting is not None:
            program = unmeant.instead
        changes = diff(before, program)
        plan = linked(program, run.alone and run.alone.after(before, changes.successors))
        decision = decide(run, plan, self.on_active_edit) if run.roots else Decision()
        run.unmeant = unmeant.element if unmeant and (unmeant.always or waiting is None) else None
        if decision.apply:
            run.remember()
            show_in_tracebacks(program)
            carry_issues(run.issues, before, program, changes.successors, changes.changed)
            if decision.restart:
                run.replace_program(program, changes.successors)
                self._restart(decision.reason or "")
            else:
                adopt(run, program, changes.successors)
            self.report_duplicates()
            self._count_revision(changes.successors)
        reason = decision.reason if waiting is None else waiting
        self.patch_reason = reason or ""
        patch = Patch(changes, decision.apply and waiting is None, decision.restart, reason)
        run.emit("patched", (), patch)
        kind = "restarted" if decision.restart else "patched"
        self._done(Commanded(kind, decision.reason or "") if decision.apply else None)
        return patch

    def _waiting(self, program: Program, unmeant: Unmeant) -> str | None:
        """Return why the part that is still being typed waits; None if it does not."""
        if unmeant.always:
            return unmeant.reason
        disturbed = decide(self._run, linked(program, self._run.alone), "restart").reason
        return None if disturbed is None else unmeant.reason or waits_for(disturbed)

    def rename(self, kind: str, path: Path | str, new_name: str, now: float | None = None) -> str:
        """Rename an element and every reference to it; nothing restarts.

        Parameters
        ----------
        kind : {"state", "machine", "event", "variable", "transition"}
        path : tuple of str or str
            Path of definition.
        new_name : str

        Returns
        -------
        str
            The new text.

        Raises
        ------
        UnknownElementError
            If there is no such element.
        ValueError
            If the name is taken, illegal, or captured by a local name of a block.
        """
        run = self._run
        where = as_path(path)
        program = parse(renamed_text(self.program, kind, where, new_name), self.program.filename)
        self._advance(now)
        before = run.program
        successors = after_rename(before, program)
        changes = replace(diff(before, program), successors=successors)
        run.remember()
        carry_issues(run.issues, before, program, successors)
        show_in_tracebacks(program)
        adopt(run, program, successors, renamed=True)
        self._count_revision(successors)
        self.patch_reason = ""
        run.emit("patched", (), Patch(changes, True))
        self._done(Commanded("renamed", f"{kind} {path_text(where)} {new_name}"))
        return program.text

    def set_variable(self, path: Path | str, expression: str, now: float | None = None) -> None:
        """Assign the value of a Python expression, evaluated in the variable's scope.

        Raises
        ------
        UnknownElementError
            If there is no such variable now.
        Exception
            Whatever the expression raises; the variable keeps its value.
        """
        value = evaluate(self._run, path, expression)
        self.assign(path, value, now)  # not before: a failure of the expression is not part of the run

    def assign(self, path: Path | str, value: object, now: float | None = None) -> None:
        """Assign a value to a variable.

        Raises
        ------
        UnknownElementError
            If there is no such variable now.
        """
        self._advance(now)
        assign(self._run, path, value)
        self._done(Commanded("assigned", path_text(as_path(path))))

    def transition_to(self, path: Path | str, now: float | None = None) -> None:
        """Leave the active state and enter another one, with their actions. Paper: §6.4.

        Raises
        ------
        UnknownElementError
            If there is no such state; nothing changes.
        """
        self._force("transition", find_state(self._run, path), now=now)

    def teleport_to(self, path: Path | str, now: float | None = None) -> None:
        """Make a state active without running any action; its spawns are executed. Paper: §6.4.

        Raises
        ------
        UnknownElementError
            If there is no such state; nothing changes.
        """
        self._force("teleport", find_state(self._run, path), now=now)

    def fire(self, path: Path | str, now: float | None = None) -> None:
        """Follow a transition, with the actions on the way, regardless of its condition. Paper: §6.4.

        The destination is forced: the transition is not counted as one that the program has fired.

        Parameters
        ----------
        path : tuple of str or str
            Path of definition, or as spawned: that of the machine, then the id of the transition.

        Raises
        ------
        UnknownElementError
            If there is no such transition; nothing changes.
        ValueError
            If none of its source states is active, or it leads nowhere; nothing changes.
        """
        self._force("fire", *find_edge(self._run, path), now=now)

    def _force(self, how: How, where: Path, edge: Edge | None = None, *, now: float | None) -> None:
        self._advance(now)
        target = force(self._run, where, how, edge)
        self._done(Commanded("forced", how, target.path))

    def reset(self, now: float | None = None) -> None:
        """End the run, and restart the program: nothing is active until the next tick."""
        self.end(now)
        self._run.remember()
        self._restart("reset")
        self._done(Commanded("restarted", "reset"))

    def snapshot(
        self, known: Callable[[object], object] = nothing, beside: Mapping[str, object] = MappingProxyType({})
    ) -> Snapshot:
        """Take a snapshot of the run, from which :meth:`fork` begins.

        Parameters
        ----------
        known : callable
            Returns a token for an object that is specific to each run, such as its robot; None for any other
            object, which is copied.
        beside : mapping of str to object
            Values that are copied together with the variables.
        """
        taken = take(self._run, lambda value: "robot" if value is self._robot else known(value), beside)
        return replace(taken, settings={name: getattr(self, name) for name in _CARRIED})

    def begin(self, snapshot: Snapshot, find: Callable[[object], object] = nothing) -> dict[str, Any]:
        """Continue from a snapshot instead of the current run.

        Parameters
        ----------
        snapshot : Snapshot
        find : callable
            Returns the object of this run for a token that `known` returned.

        Returns
        -------
        dict
            The copies of the values that were `beside`.
        """
        before = self._run
        program = before.program if before.source == snapshot.source else snapshot.program
        self._run = run = self._new_run(program, alone=snapshot.alone)
        run.observers, run.visits = before.observers, before.visits
        beside = begin(run, snapshot, lambda token: self._robot if token == "robot" else find(token))
        run.watched = run.watched or bool(run.observers)
        run.attention = run.attention or run.watched
        for name, value in snapshot.settings.items():
            setattr(self, name, value)
        self.moves.clear()
        show_in_tracebacks(program)
        return beside

    def renew(self, program: Program, now: float) -> None:
        """Start afresh with a program, whatever the condition of the current run.

        Issues, counts and the journal are reset; settings and observers are kept. The next tick starts the
        program.
        """
        before, self._run = self._run, self._new_run(program, alone=self._run.alone)
        run = self._run
        run.now = now
        run.epoch = before.epoch + 1
        run.observers, run.visits = before.observers, before.visits
        run.watched = run.attention = bool(run.observers)
        if before.event_values is not None:
            run.event_values = {}
        self.paused = False
        self.moves.clear()
        self.patch_reason = ""
        self.revision += 1
        show_in_tracebacks(program)
        self._restart("reset")
        self.report_duplicates()
        self._done()

    def pause(self, now: float | None = None, reason: str = "") -> None:
        """Run the ``onpause`` actions, if anything is active. Paper: §6.3.

        A paused interpreter still steps when :meth:`step` is called: the caller decides. The reason, a
        sentence, is recorded.
        """
        self._advance(now)
        was_paused, self.paused = self.paused, True
        if not was_paused:
            self._between(self._run.plan.hooks["onpause"])
            self._run.emit("paused", ())
        self._done(None if was_paused else Commanded("paused", reason))

    def resume(self, now: float | None = None) -> None:
        """Run the ``onresume`` actions, if anything is active."""
        self._advance(now)
        was_paused, self.paused = self.paused, False
        if was_paused:
            self._between(self._run.plan.hooks["onresume"])
            self._run.emit("resumed", ())
        self._done(Commanded("resumed") if was_paused else None)

    @property
    def must_end(self) -> bool:
        """Whether :meth:`end` would run an action."""
        return bool(self._run.plan.hooks["onend"] and self._run.roots and not self.ended)

    def end(self, now: float | None = None) -> None:
        """Run the ``onend`` actions, once in each run, if anything is active."""
        self._advance(now)
        is_over, self.ended = not self.must_end, True
        if not is_over:
            self._between(self._run.plan.hooks["onend"])
            self._run.emit("ended", ())
        self._done(None if is_over else Commanded("ended"))

    def rewind(self, ticks: int) -> None:
        """Return to the moment right after the tick that was `ticks` before the last one.

        Active states, their timers, variables and patches are restored; everything since then is
        undone, changes between ticks included. With no tick left, nothing is active. Objects that were
        changed in place stay as they are, and so do issues, unless their element is gone.

        Raises
        ------
        ValueError
            If the journal does not reach back that far.
        """
        run = self._run
        if run.journal is None:
            raise ValueError(
                "This interpreter keeps no journal, so it cannot go back. Create it with `journal`."
            )
        after = run.program
        run.undo(ticks)
        undone = []
        while self.moves and self.moves[-1][0] >= run.ticks:
            undone.append(self.moves.pop()[1])
        back = after_undo(after, undone)
        if run.program is not after:
            carry_issues(run.issues, after, run.program, back)
        self.revision += 1
        self._note_moved(back)
        show_in_tracebacks(self.program)

    # ---- inside -----------------------------------------------------------------------------

    def _count_revision(self, successors: Successors) -> None:
        self.revision += 1
        if self._note_moved(successors):
            self.moves.append((self._run.ticks, successors))

    def _note_moved(self, successors: Successors) -> bool:
        """Publish the map of the newest revision and return True if the path of any element has changed."""
        moved = any(old != new for old, new in successors.moved.items())  # not only labels
        if moved:
            self.moved = (*self.moved, (self.revision, successors))[-_KEPT:]
        return moved

    def _restart(self, reason: str) -> None:
        """Restart without any onexit, since no transition fires; issues stay. Paper: §6.1."""
        self.restarts += 1
        self.restart_reason = reason
        self.ended = False
        self._run.clear()
        self._run.emit("restarted", (), reason)

    def _between(self, blocks: tuple[BlockPlan, ...]) -> None:
        run = self._run
        for block in blocks if run.roots else ():
            run.attempt(bind_block(run, block, run.globals), block.site, run.globals)

    def report_duplicates(self) -> None:
        """Report what is defined twice, unless it is known: a program that begins has such issues already."""
        run = self._run
        for site in run.plan.duplicates:
            if run.issues.is_open(site[:2], run.globals):
                continue
            name = site.element.path[-1]
            message = (
                f"The {site.element.kind} `{name}` is defined twice here, and only the first definition "
                "counts. Rename or remove the other one."
            )
            run.report(site, "defined twice", message, run.globals)
