"""The loop of §5.1 with everything around a tick: commands, time, robot, frames.

There is one loop body, :meth:`Loop.turn`. The driver (a thread, asyncio, the caller)
calls it and then waits until the time that it returns. A turn

1. applies the commands that are queued,
2. advances the time, up to the next tick at most: a simulated world moves by whole physics steps,
   so that it is at the tick's time when the tick reads the sensors,
3. ticks, if a tick is due: latch the sensors, one step of the interpreter, flush the commands,
4. publishes a frame, at most sixty times a second.

*Time.* With a simulated robot the clock only paces: a tick's time is the one it was due at, and if
the host is too slow the clock is set back. With a real robot the clock is the truth: a late tick
has the real time. A tick comes *before* its period: ``run(1)`` at 10 Hz ticks at 0, 0.1, … 0.9
and ends at 1.0, and ten single steps do the same.

*Rewinding.* Before each tick the loop records the time and the bridge's moment. Rewinding restores the
interpreter by its journal, and the world to the moment before the first tick undone; the next step
repeats that tick.

*Status.* :attr:`Loop.status` and :attr:`Loop.hung` are the only record of the state of a run; a
session copies them into its frames.

Owned by the thread that drives it. Other threads use :attr:`Loop.inbox`, call :meth:`Loop.set_hung` (the
monitor) or end the loop (:meth:`Loop.halt`), and read `frame`, `ticking`, `status` and `interpreter.tick`.

Paper: §5.1 (the loop), §6.3 (pause), §6.4 (forcing states).
"""

from __future__ import annotations

import math
import sys
import threading
import traceback
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from dataclasses import replace
from functools import partial
from numbers import Real
from time import perf_counter
from types import FrameType, MappingProxyType
from typing import Any, Literal

from lrp_jupyter.arguments import check_type
from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.nodes import RobotMethod
from lrp_jupyter.bridges.outside import CommandsHeld, RobotArmed, RobotStopped
from lrp_jupyter.bridges.robot import part_name
from lrp_jupyter.bridges.safety import Origin
from lrp_jupyter.errors import BridgeError, LRPError, UnknownElementError, sentence_of
from lrp_jupyter.interpreter.by_path import ByPath
from lrp_jupyter.interpreter.copies import Packed, pack, unpack
from lrp_jupyter.interpreter.faults import Interrupted
from lrp_jupyter.interpreter.frame import Frame, Hit, Hung, Status, is_active
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.issues import Issue
from lrp_jupyter.interpreter.linker import link
from lrp_jupyter.language.program import Element, Path, Program
from lrp_jupyter.live.breakpoints import Breakpoints
from lrp_jupyter.live.checkpoints import COPIED, PLAIN, Checkpoints, SessionCheckpoint, names_of
from lrp_jupyter.live.clock import LAG, Clock
from lrp_jupyter.live.foreign import Foreign, on_main_thread
from lrp_jupyter.live.inbox import Command, Inbox
from lrp_jupyter.live.inputs import Input, Inputs, Paused, Resumed, Rewound, RunEnded
from lrp_jupyter.live.moments import Moments
from lrp_jupyter.live.names import ChangeNames, WatchedNames
from lrp_jupyter.live.randomness import random_module
from lrp_jupyter.live.values import ValueTexts, numbers_of

__all__ = ["FASTEST", "SLOWEST", "STEP", "Loop"]

STEP = 0.01
"""Seconds from tick to tick at rate 0 where time is virtual."""

SLOWEST, FASTEST = 0.01, 1e6
"""The lowest and the highest rate, in ticks per second: a step waits for its period, and time must pass."""

_FREE = 0.0005  # wall seconds that a free-running loop keeps the interpreter lock
_FRAMES = 60.0  # frames per wall second, at most
_PICTURES = 30.0  # of a world that moves between two ticks, per wall second
_ROUNDING = 1e-6  # s
_KEYBOARD = "The run was interrupted from the keyboard."
_RAISED = "The program raised `KeyboardInterrupt`, as Ctrl-C does."


class Loop:
    """Runs an interpreter against a clock and a robot; see the head of this module.

    Parameters
    ----------
    interpreter : Interpreter
    bridge : Bridge
        Opened by its owner, not by the loop.
    clock : Clock
    rate : float
        Ticks per second; 0 for as many as possible.
    changed : callable
        Called after every new :attr:`frame`, and whenever :attr:`hung` has changed.
    remembers : bool
        Whether what happened is kept, for as long as the interpreter's journal.
    printed : callable
        Returns the number of lines printed so far.
    """

    def __init__(
        self,
        interpreter: Interpreter,
        bridge: Bridge,
        clock: Clock,
        rate: float,
        changed: Callable[[], None],
        remembers: bool = True,
        printed: Callable[[], int] = lambda: 0,
    ) -> None:
        self.interpreter = interpreter
        self.bridge = bridge
        self.clock = clock
        self.inbox = Inbox()
        self.status: Status = "ready"
        self.reason = ""
        self._hung: tuple[object, Hung | None] = (None, None)  # in which work
        self.foreign: Foreign | None = None
        """The foreign code that runs now between two ticks, for the monitor."""
        self.fault = ""
        """The traceback of the fault that broke the session, or an empty text."""
        self.ticking: object = None
        """What identifies the tick under way; None between two."""
        self._unstarted = False  # whether it was paused before it was started
        self._texts = ValueTexts(self._calling)
        self._step = bridge.time_step  # seconds; None where time passes by itself
        self.changed = changed
        self._printed = printed
        self.moments = Moments(only_last=not remembers)
        self.inputs = Inputs()
        """What came from outside, as far as the run has not gone back behind it."""
        self.checkpoints = Checkpoints()
        self.names = WatchedNames(interpreter.namespace)
        self.names.watch(self.names_used())
        self._remembers = remembers
        self._pending_at = 0.0
        """The time from which on there is something to do before a tick: take a checkpoint, note a stop."""
        self.record: Callable[[Input], object] | None = None
        """Called with every input, those before a rewinding included."""
        self.breakpoints: Breakpoints | None = None
        self.paused_by: Hit | None = None
        self.after_tick: list[Callable[[], object]] = []
        """Called after every tick."""
        self._stops: deque[object] = deque()  # and armings: by other threads, not yet recorded
        self._driven_by = 0  # the thread that made the last turn
        self._replayed = False  # whether what happens now follows from a recorded input
        self._kept: list[object] | None = None  # what of the world was kept while it is rewound
        bridge.outside, bridge.origin = self._from_outside, self._origin
        bridge.safety.recorded = partial(self.emit, "commanded")
        self._steps = 0
        self.now = 0.0
        """Seconds of the run."""
        self.due = 0.0
        """The time at which the next tick is due."""
        self._published = -math.inf  # wall time of the last frame
        self._measured: tuple[float, int, float] | None = None  # wall time, tick, time
        self._achieved = (0.0, 0.0)  # ticks per second, seconds per second
        self.set_rate(rate)
        self.frame = self.make_frame()
        """The newest one published."""

    @property
    def work(self) -> object:
        """What identifies the tick or the foreign code under way; None between two. From any thread."""
        return self.ticking or self.foreign

    @property
    def hung(self) -> Hung | None:
        """The block that does not return, or None; from any thread."""
        work, hung = self._hung
        return hung if work is self.work else None

    def set_hung(self, work: object, hung: Hung | None) -> None:
        """Set the block that does not return, and the :attr:`work` under way; called by the monitor."""
        self._hung = work, hung

    # -- time ------------------------------------------------------------------------------------

    def set_rate(self, rate: float) -> None:
        """Change the rate, in ticks per second; 0 is as fast as possible. Paper: §5.1.

        Raises
        ------
        ValueError
            The rate is negative, too small, too large, or not a number.
        """
        check_type("rate", rate, Real, "a number of ticks per second")
        if not (rate == 0 or SLOWEST <= rate <= FASTEST):
            raise ValueError(
                f"A rate is between {SLOWEST:g} and {FASTEST:,.0f} ticks per second, "
                f"or 0 for as many as possible, not {rate!r}."
            )
        step = self._step
        self.rate = float(rate)
        self.free = rate == 0 and step is None
        """Whether ticks follow each other without waiting."""
        if rate == 0:
            self.period = step or STEP
            """Seconds from one tick to the next."""
        else:
            self.period = 1 / rate if step is None else max(1, round(1 / rate / step)) * step
        self.due = min(self.due, self.now + self.period)
        self._pending_at = 0.0

    def set_speed(self, speed: float) -> None:
        """Change the speed, in seconds of the session per wall second.

        Raises
        ------
        ValueError
            The speed is not above 0, or the robot is a real one.
        """
        if self.bridge.hardware and speed != 1:
            raise ValueError(f"`{self.bridge.name}` is a real robot, whose time passes at speed 1.")
        self.clock.speed = speed

    def advance(self, seconds: float) -> None:
        """Advance the time without a tick; a simulated world moves by whole steps."""
        if self._step is None:
            self.now = round((self.now + seconds) * 1e12) / 1e12  # half the time of round(…, 12)
        elif (steps := math.floor(seconds / self._step + 1e-6)) > 0:
            if self._stops:  # they act before the world moves
                self._note_stops()
            with self._calling("the robot"):
                self.bridge.advance(steps * self._step)
            self._steps += steps
            self.now = round(self._steps * self._step, 9)

    def _catch_up(self) -> None:
        """Advance the time to that of the clock, at most to the next tick."""
        clock = self.clock.now()
        if self._step is None:
            self.now = max(clock, self.now)
            return
        if clock - self.due > LAG * min(self.clock.speed, 1e9):
            clock = self.due  # never a larger or a skipped step: the run becomes slower instead
            self.clock.rebase(clock)
        self.advance(min(clock, self.due) - self.now)

    def _measure(self) -> None:
        """Measure the achieved rate and speed, from tick to tick."""
        wall = perf_counter()
        if self._measured is not None:
            since, tick, time = self._measured
            span = wall - since
            if span < 0.5:
                return
            self._achieved = ((self.interpreter.tick - tick) / span, (self.now - time) / span)
        self._measured = (wall, self.interpreter.tick, self.now)

    # -- the loop body ---------------------------------------------------------------------------

    def turn(self) -> float:
        """Apply commands, advance the time and tick if a tick is due.

        Returns
        -------
        float
            The time (of the clock) until which there is nothing to do unless a command arrives;
            infinite if only a command can change anything.
        """
        self._driven_by = threading.get_ident()
        try:
            if self.inbox.queued:
                self.apply_queued(hurried=True)
            if self.status != "running":
                return math.inf
            self._catch_up()
            if self.free:
                self._tick_freely()
            elif self.now >= self.due - _ROUNDING:
                self.tick()
                self._measure()
            if self.status != "running":  # it paused at an issue, and no later frame would show it
                self.publish()
                return math.inf
            if perf_counter() - self._published >= 1 / _FRAMES:
                self.publish(hurried=True)
            return self._next_turn()
        except Interrupted:  # too late: the block had returned
            return self.now
        except KeyboardInterrupt:
            self.pause(_KEYBOARD if on_main_thread() else _RAISED)
            self.publish()
            if on_main_thread():
                raise
            return math.inf
        except BaseException as error:
            self.break_down(error)
            return math.inf

    def _tick_freely(self) -> None:
        """Tick as often as possible for a moment, without giving up the interpreter lock."""
        end = perf_counter() + _FREE
        while self.status == "running" and not self.inbox.queued and perf_counter() < end:
            self.now = max(self.now, self.clock.now())
            self.tick()
            if self.clock.speed == math.inf:  # no time passes by itself
                self.clock.rebase(self.now + STEP)
        self._measure()

    def _next_turn(self) -> float:
        """Return the time of the next turn: that of the next tick, or of a frame of the world before it."""
        if self.free:
            return self.now
        if self._step is None:
            return self.due
        ahead = self.due - self.now  # in equal parts, so that none ends just before the tick
        parts = math.floor(ahead / max(self._step, self.clock.speed / _PICTURES) + _ROUNDING)
        return self.now + ahead / max(1, parts)

    def tick(self) -> None:
        """Run one tick now; the next one is due a period later."""
        interpreter, bridge, now, step = self.interpreter, self.bridge, self.now, self._step
        self.ticking = object()  # a number would repeat: before the tick has begun, and after a rewind
        try:
            if self.names.values:
                self._note_names()
            if now >= self._pending_at:
                self._prepare()
            moment = None if step is None else bridge.moment()
            bridge.begin_tick(now, self.period)
            self.moments.add((now, moment, bridge.readings if step is None else bridge.sensed()))
            interpreter.step(now)
            hit = None if self.breakpoints is None else self._hit()
            bridge.end_tick(now)
            safety = bridge.safety
            if safety.held or safety.most is not None:
                self._add(CommandsHeld(safety.sent), interpreter.tick - 1)
        finally:
            self.ticking = bridge.safety.most = None
        on_time = step is None and now - self.due <= LAG
        self.due = (self.due if on_time else now) + self.period
        for call in self.after_tick:
            call()
        if hit is not None:
            self._pause_at(hit)
        if interpreter.paused and self.status == "running":
            self._stop_at_issue()

    def settle(self) -> None:
        """Apply what waits to be done to the robot's world."""
        self._picture()

    def checkpoint(self) -> SessionCheckpoint:
        """Return what a copy of this session needs to go on from here; between two ticks."""
        interpreter, namespace = self.interpreter, self.interpreter.namespace
        used = {name: namespace.get(name, self) for name in self.names_used()}
        beside = {name: value for name, value in used.items() if type(value) in COPIED}
        snapshot = interpreter.snapshot(self._token, beside)
        moment = self.bridge.moment()
        return SessionCheckpoint(
            snapshot,
            self.now,
            self.due,
            self.rate,
            self.status == "running",
            self.inputs.count,
            moment,
            random_module(namespace).getstate(),
            self.bridge.safety.armed,
        )

    def _token(self, value: object) -> object:
        """Return what stands for an object that every session has for itself; None for any other."""
        if value is self.interpreter.namespace:
            return "namespace"
        return value.path if isinstance(value, RobotMethod) else part_name(value)

    def _find(self, token: object) -> object:
        """Return the object that a token stands for here."""
        return self.interpreter.namespace if token == "namespace" else self.bridge.nodes.table[str(token)]

    def kept(self, value: object) -> object:
        """Return a value as it is kept: a copy, packed, if it can be changed in place."""
        return value if type(value) in PLAIN else pack([value], {}, self._token)

    def restored(self, value: object) -> object:
        """Return a value that was :meth:`kept`."""
        return unpack(value, [], self._find)[0] if isinstance(value, Packed) else value

    def names_used(self) -> frozenset[str]:
        """Return the global names that the blocks of the program use."""
        return names_of(link(self.interpreter.program))

    def go_to(self, time: float) -> None:
        """Advance the time to that of a recorded entry, without a tick."""
        if self._step is None:
            self.now = max(self.now, time)
        else:
            self.advance(time - self.now)
        self.due = self.now

    def rest(self) -> None:
        """Be paused from now on, though the program is not told."""
        if self.status == "running":
            self.status = "paused"
            self.clock.pause()
            self._note(RunEnded())

    def begin(self, checkpoint: SessionCheckpoint) -> None:
        """Continue from a checkpoint of another session, whose bridge was forked there.

        The objects of the namespace that are copied are put into this one.
        """
        interpreter, bridge = self.interpreter, self.bridge
        self.names.begin(interpreter.begin(checkpoint.snapshot, self._find))
        self.now = checkpoint.time
        if self._step is not None:
            self._steps = round(self.now / self._step)
        self.set_rate(checkpoint.rate)
        self.due = checkpoint.due
        self.clock.rebase(self.now)
        self.checkpoints.clear()
        self._pending_at = 0.0
        bridge.safety.tick(interpreter.now, self.period)
        bridge.safety.armed = checkpoint.armed
        self.status, self._unstarted = "running" if checkpoint.running else "paused", False

    def settle_as(self, checkpoint: SessionCheckpoint) -> None:
        """Take over the settings of a session, and whether it was paused."""
        settings = checkpoint.snapshot.settings
        for name in ("on_active_edit", "on_issue", "paused"):
            setattr(self.interpreter, name, settings[name])
        self.set_rate(checkpoint.rate)
        self.status = "running" if checkpoint.running else "paused"

    def _prepare(self) -> None:
        """Note what other threads have stopped, and take a checkpoint if one is due."""
        self._note_stops()
        if not self._remembers:
            self._pending_at = math.inf
            return
        if self.interpreter.tick >= self.checkpoints.due:
            self.checkpoints.add(self.checkpoint)
            self._forget()
        period = 0.0 if self.free else self.period
        self._pending_at = self.now + (self.checkpoints.due - self.interpreter.tick) * period

    def _forget(self) -> None:
        """Drop what no tick of the journal needs any more: all that is kept is bounded by the journal."""
        tick = self.interpreter.tick
        first = self.checkpoints.begin(tick - self.interpreter.journal)
        if first is None:
            return
        self.moments.drop(first.tick - (tick - len(self.moments)))
        self.inputs.begin(first.inputs)
        self.bridge.safety.begin(first.tick)
        self.bridge.forget(first.moment)

    def _hit(self) -> Hit | None:
        """Return the breakpoint that was hit, if one was."""
        if self.breakpoints is None:
            return None
        with self._calling("a breakpoint"):
            return self.breakpoints.check()

    def _pause_at(self, hit: Hit) -> None:
        """Pause because a breakpoint was hit."""
        if self.status == "running":
            self.pause(str(hit))
        self.reason, self.paused_by = str(hit), hit

    def _stop_at_issue(self) -> None:
        """Pause as the interpreter has done, because of an issue in a tick or a command."""
        issues = self.interpreter.issues
        last = max(issues, key=lambda issue: (issue.last_tick, issue.first_tick), default=None)
        self._stand_still(last.message if last else "")

    def run(self, seconds: float, after_tick: Callable[[], object] | None = None) -> bool:
        """Tick in virtual time, without waiting, for at most this number of seconds.

        Afterwards the loop has its earlier status: running if a driver drives it, else paused, without
        the pause actions.

        Parameters
        ----------
        seconds : float
        after_tick : callable, optional
            Called after every tick; a true result ends the run.

        Returns
        -------
        bool
            Whether `after_tick` ended the run; a pause also ends it. What it raises is raised.
        """
        self._check_whole()
        self._driven_by = threading.get_ident()
        was_running = self.status == "running"
        self.resume()
        step, tick, queued = self._step, self.tick, self.inbox.queued
        if step is not None and seconds < math.inf:  # a world knows whole steps only
            seconds = math.ceil(seconds / step - _ROUNDING) * step
        end = self.now + seconds
        almost = end - _ROUNDING
        asking = False
        try:
            while self.now < almost and self.status == "running":
                if self.due - self.now <= _ROUNDING:
                    self.due = self.now
                    tick()
                    if after_tick is not None:
                        asking = True
                        if after_tick():
                            return True
                        asking = False
                    if queued:
                        self.apply_queued()
                    if self.status != "running":
                        break
                until = self.due if self.due < end else end
                if step is None:  # as `advance` does, for most of the time of a tick without a robot
                    self.now = round(until * 1e12) / 1e12
                else:
                    self.advance(until - self.now)
        except BaseException as error:
            kind = type(error)
            if issubclass(kind, Interrupted):  # too late: the block had returned
                pass
            elif asking or (issubclass(kind, KeyboardInterrupt) and on_main_thread()):
                raise  # it is the caller's own
            elif issubclass(kind, KeyboardInterrupt):
                self.pause(_RAISED)
            else:
                self.break_down(error)
        finally:
            self.clock.rebase(self.now)
            if not was_running:
                self.rest()
            self.publish()
        return False

    # -- frames ----------------------------------------------------------------------------------

    def publish(self, hurried: bool = False) -> None:
        """Publish a frame of the present state; `hurried` as for :meth:`make_frame`."""
        self._published = perf_counter()
        if self.fault:  # the run may be in any condition: nothing of it is read any more
            status, reason = self.status, self.reason
            self.frame = replace(
                self.frame, status=status, reason=reason, achieved_rate=0.0, achieved_speed=0.0
            )
        else:
            self.frame = self.make_frame(hurried)
            self.interpreter.weigh()
        with self._calling("a listener"):
            self.changed()

    def make_frame(self, hurried: bool = False) -> Frame:
        """Make a frame of this moment, between two ticks.

        One that others follow by themselves is made in a hurry: it may show an earlier text of a value whose
        rendering takes long.
        """
        interpreter = self.interpreter
        values = interpreter.variables.pairs()
        over = self.status in ("stopped", "closed")  # nothing may run any more that might not return
        variables = self._texts.of(values, now=not (hurried and self.status == "running"), foreign=not over)
        visits, firings = interpreter.visits, interpreter.firings
        rate, speed = self._achieved if self.status == "running" else (0.0, 0.0)
        return Frame(
            status=self.status,
            reason=self.reason,
            tick=interpreter.tick,
            time=self.now,
            active=interpreter.active,
            values=ByPath(dict(values)),
            variables=ByPath(variables),
            numbers=ByPath(numbers_of(values)),
            visits=MappingProxyType({path: count.times for path, count in visits.items()}),
            visited_at=MappingProxyType({path: count.tick for path, count in visits.items()}),
            fired=MappingProxyType({path: count.times for path, count in firings.items()}),
            fired_at=MappingProxyType({path: count.tick for path, count in firings.items()}),
            events=MappingProxyType(dict(interpreter.event_values)),
            issues=tuple(interpreter.issues),
            restarts=interpreter.restarts,
            restart_reason=interpreter.restart_reason,
            revision=interpreter.revision,
            moved=interpreter.moved,
            patch_reason=interpreter.patch_reason,
            program=interpreter.program,
            readings=self.bridge.readings_of(self.moments[-1][2]) if self.moments else {},
            rate=self.rate,
            achieved_rate=rate,
            speed=self.clock.speed,
            achieved_speed=speed,
            printed=self._printed(),
            bridge=self.bridge.status.sentence,
            robot=self._picture(),
            paused_by=self.paused_by if self.status == "paused" else None,
            breakpoints=() if self.breakpoints is None else self.breakpoints.all,
        )

    def _picture(self) -> object:
        """Return the bridge's picture of its robot; it is foreign code."""
        try:
            with self._calling("the robot"):
                return getattr(self.bridge, "picture", None)
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            self.bridge.lose("picture", error)
            return None

    @contextmanager
    def _calling(self, name: str = "") -> Iterator[None]:
        """Note for the monitor that foreign code of this name runs meanwhile."""
        outer, self.foreign = self.foreign, Foreign(name)
        try:
            yield
        finally:
            self.foreign = outer

    def is_active(self, state: str | Path) -> bool:
        """Return whether a state is active now, at any depth."""
        return is_active(state, self.interpreter.active)

    # -- commands --------------------------------------------------------------------------------

    def apply_queued(self, hurried: bool = False) -> None:
        """Apply the commands that are queued now, each as a whole; then publish, then answer.

        An error that is not the caller's own mistake (:attr:`Command.misuse`) breaks the session.
        """
        answers: list[tuple[Future[Any], Any, BaseException | None]] = []
        try:
            for _ in range(len(self.inbox)):
                entry = self.inbox.get()
                if entry is None:  # a newer edit has replaced it
                    break
                command, answer = entry
                if answer.set_running_or_notify_cancel():
                    answers.append((answer, *self._apply(command)))
                    if isinstance(answers[-1][2], KeyboardInterrupt):
                        raise answers[-1][2]
        finally:
            if answers:
                self.publish(hurried)
            for answer, result, refusal in answers:  # a waiting caller finds the new frame
                if refusal is None:
                    answer.set_result(result)
                else:
                    answer.set_exception(refusal)

    def apply(self, command: Command) -> Any:
        """Apply a command now and return its result; raise what it raises."""
        result, refusal = self._apply(command)
        if refusal is not None:
            raise refusal
        return result

    def _apply(self, command: Command) -> tuple[Any, BaseException | None]:
        """Apply a command; return its result, and what it raised."""
        restarts, program = self.interpreter.restarts, self.interpreter.program
        self._driven_by = threading.get_ident()
        try:
            if not command.mends:
                self._check_whole()
            self._note_names()
            with self._calling(), self._deriving(command.recorded):  # blocks, hooks and code of the caller
                result = command.apply(self)
            if command.recorded:
                self._note(command)
                if not command.undoes and (hit := self._hit()) is not None:
                    self._pause_at(hit)
            if self.interpreter.paused and self.status == "running":
                self._stop_at_issue()
            return result, None
        except BaseException as error:
            kind = type(error)  # `isinstance` may call code of the exception
            if issubclass(kind, KeyboardInterrupt):
                if on_main_thread():
                    return None, error
                self.pause(_RAISED)
            elif not issubclass(kind, (*command.misuse, Interrupted)):
                self.break_down(error)
            if issubclass(kind, Exception):
                return None, error
            return None, LRPError(str(error) if issubclass(kind, Interrupted) else sentence_of(error))
        finally:
            if self.interpreter.program is not program:
                self.names.watch(self.names_used())
            if self.interpreter.restarts != restarts:  # no onexit has run: nothing may keep moving
                self.bridge.stop_all()

    # -- the inputs ------------------------------------------------------------------------------

    def _note(self, what: object) -> None:
        """Record an input, after the stops of other threads."""
        with self.inputs.lock:
            self._note_stops()
            self._add(what)

    def _note_names(self) -> None:
        """Record that names of the namespace have changed since a tick that may have read them."""
        change = self.names.change()
        if change is not None and self.interpreter.tick:
            self._note(change)

    def _note_stops(self) -> None:
        """Record what other threads have stopped."""
        with self.inputs.lock:  # or another thread could take the last one between these two lines
            while self._stops:
                self._add(self._stops.popleft())

    def _add(self, what: object, tick: int | None = None) -> None:
        """Give an input its number, keep it and write it down; it came after a tick, by default the last."""
        with self.inputs.lock:  # from the reading of the tick on, so that ticks and numbers are in order
            entry = self.inputs.next(self.interpreter.tick if tick is None else tick, self.now, what)
            if self._remembers and not (isinstance(what, Command) and what.undoes):
                kept, letters = what.kept(self) if isinstance(what, Command) else (what, 0)
                self.inputs.keep(entry._replace(what=kept), letters)
            if self.record is not None:
                self.record(entry)

    def _from_outside(self, what: object, surely: bool) -> None:
        """Record what was done to the robot, unless the program or a recorded input did it."""
        if isinstance(what, (RobotStopped, RobotArmed)) and threading.get_ident() != self._driven_by:
            self._stops.append(what)
            self._pending_at = 0.0
        elif self._kept is not None:
            self._kept.append(what)
        elif surely or not (self._replayed or self.ticking):
            self._note(what)

    @contextmanager
    def _deriving(self, derived: bool = True) -> Iterator[None]:
        """Note that what happens meanwhile follows from a recorded input."""
        outer, self._replayed = self._replayed, derived or self._replayed
        try:
            yield
        finally:
            self._replayed = outer

    def emit(self, kind: str, data: object) -> None:
        """Tell the observers of the interpreter what happened now, in its order."""
        self.interpreter.emit(kind, data, self.now)

    def _origin(self) -> Origin:
        """Return the block that is calling now, if it is one of the running program."""
        interpreter, frame = self.interpreter, sys._getframe(1)
        filename = interpreter.program.filename
        block: FrameType | None = frame
        while block is not None and block.f_code.co_filename != filename:
            block = block.f_back
        if block is None:
            return Origin(interpreter.tick)
        return Origin(interpreter.tick, block.f_code.co_name, block.f_lineno)

    def _check_whole(self) -> None:
        if self.fault:
            raise LRPError(
                "The session itself failed, not the program. Start it again, or reset it; "
                "its `fault` is the traceback."
            )

    def pause(self, reason: str = "") -> None:
        """Pause program, time and robot; the reason is a sentence, or empty. Paper: §6.3."""
        if self.status == "running":
            with self._deriving():
                self.interpreter.pause(self.now, reason)
                self._stand_still(reason)
            self._note(Paused(reason))
        elif self.status in ("ready", "paused") and reason:
            self.paused_by = None
            self._unstarted = self._unstarted or self.status == "ready"
            self.status, self.reason = "paused", reason

    def _stand_still(self, reason: str) -> None:
        """Pause time and robot; the interpreter has paused already."""
        self.status, self.reason = "paused", reason
        self.clock.pause()
        self._call_hook(self.bridge.on_pause)

    def resume(self) -> None:
        """Start the run, or continue it after a pause; a stopped loop stays stopped."""
        if self.status in ("running", "stopped", "closed"):
            return
        first, self._unstarted = self.status == "ready" or self._unstarted, False
        self.status, self.reason, self.paused_by = "running", "", None
        self.clock.resume()
        self.clock.rebase(self.now)
        self.due = max(self.due, self.now)
        self._measured = None
        with self._deriving():
            self._call_hook(self.bridge.on_start if first else self.bridge.on_resume)
            self.interpreter.resume(self.now)
        self._note(Resumed())

    def step(self) -> None:
        """Run one tick and one period of time; paused before and after. Paper: §6.3."""
        self.pause()
        if self.status == "ready" or self._unstarted:
            self._unstarted = False
            self._call_hook(self.bridge.on_start)
        if self.status != "stopped":
            self.status, self.reason, self.paused_by = "paused", "", None
        self.clock.pause()
        self.due = self.now
        self.tick()
        self.advance(self.period)
        self.clock.rebase(self.now)

    def rewind(self, ticks: int) -> None:
        """Step back by this number of ticks: program, world and time.

        The world returns to the moment before the first undone tick, so that the next step repeats it.

        Raises
        ------
        BridgeError
            A real robot is armed, or the world cannot go back so far.
        ValueError
            Fewer ticks can be undone.
        """
        bridge, interpreter = self.bridge, self.interpreter
        if bridge.hardware and bridge.safety.armed:
            raise BridgeError(f"`{bridge.name}` is armed: a real robot cannot go back. Disarm it first.")
        have = min(interpreter.journal, len(self.moments))
        if not 0 <= ticks <= have:
            many = "1 tick" if ticks == 1 else f"{ticks} ticks"
            raise ValueError(f"Cannot go back {many}: only {have} can be undone.")
        kept: list[object] = []
        if ticks:
            now, moment, _ = self.moments[-ticks]
            self._kept = []
            try:
                bridge.rewind(moment)  # the world may refuse, and then nothing has changed
            finally:
                kept, self._kept = self._kept, None
            self.moments.undo(ticks)
            self.now = now
            if self._step is not None:
                self._steps = round(self.now / self._step)
            self.due = self.now
            self.clock.rebase(self.now)
        interpreter.rewind(ticks)
        if self.paused_by is not None and ticks:
            self.paused_by, self.reason = None, ""  # that tick has not happened
        bridge.safety.forget(interpreter.tick)
        undone = self.inputs.undo(interpreter.tick, _is_of_the_world)
        self.names.undo(entry.what for entry in undone if isinstance(entry.what, ChangeNames))
        self.checkpoints.cut(interpreter.tick)
        self._pending_at = 0.0
        for what in kept:
            self.inputs.keep(self.inputs.next(interpreter.tick, self.now, what))
        self._note_names()  # which stay as they are
        if self._remembers:  # the rate and the policies stay, though their inputs are dropped
            is_first, entry = not self.checkpoints.all, self.inputs.next(interpreter.tick, self.now, None)
            taken = self.checkpoints.add(self.checkpoint, rewound=True)
            if taken is not None and not is_first:  # then a run from before may come to it
                self.inputs.keep(entry._replace(what=Rewound(taken)), len(taken.snapshot.values.data))

    def force(self, path: Path, how: Literal["transition", "teleport"]) -> None:
        """Force a state; one that does not exist is an issue, as it is in a transition. Paper: §6.4."""
        interpreter = self.interpreter
        force = interpreter.teleport_to if how == "teleport" else interpreter.transition_to
        try:
            force(_full_path(interpreter.program, path), self.now)
        except UnknownElementError as error:
            element, tick, message = Element("state", path), interpreter.tick, str(error)
            issue = Issue("unknown state", element, message, 1, 1, first_tick=tick, last_tick=tick)
            interpreter.issues.report((element, 0, "unknown state"), lambda: issue, message, tick)

    # -- the end ---------------------------------------------------------------------------------

    def halt(self, status: Literal["stopped", "closed"]) -> None:
        """Set the status, permanently (``closed``) or until the next start; from any thread."""
        if self.status != "closed":
            self.status = status

    def break_down(self, error: BaseException) -> None:
        """Stop permanently because of a fault that is not the program's; from any thread, never raises."""
        try:
            self.fault = "".join(traceback.format_exception(error))
        except BaseException:  # the last resort: there may be no memory for a traceback
            self.fault = "There is no traceback."
        self.reason = f"The session itself failed, not the program: {sentence_of(error)}"
        if self.status not in ("stopped", "closed"):
            self.status = "broken"
        with suppress(BaseException):
            self.bridge.stop_all()
        with suppress(BaseException):
            self.publish()

    def renew(self, program: Program) -> None:
        """Make a broken session whole: a new run of a program, ready to start; the robot's world stays."""
        self.interpreter.renew(program, self.now)
        self.moments.clear()
        self.inputs.clear()
        self.checkpoints.clear()
        self._pending_at = 0.0
        self.fault = self.reason = ""
        if self.status == "broken":
            self.status = "ready"
        self.clock.pause()
        self.due = self.now

    def _call_hook(self, hook: Callable[[], None]) -> None:
        """Call a hook of the bridge; it is foreign code, and if it fails its robot is stopped."""
        try:
            with self._calling("the robot"):
                hook()
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            self.bridge.lose(hook.__name__, error)
            self.bridge.stop_all()


def _is_of_the_world(what: object) -> bool:
    """Return whether an input was done to the robot or its world, and not to the program or in a tick."""
    return not isinstance(what, (Command, Paused, Resumed, Rewound, RunEnded, CommandsHeld))


def _full_path(program: Program, path: Path) -> Path:
    """Complete a bare name to the path of the only state with this name."""
    if len(path) != 1:
        return path
    found = [
        (*machine, str(state.name))
        for machine, noun in program.walk()
        for state in noun.states
        if state.name == path[0]
    ]
    return found[0] if len(found) == 1 else path
