"""The loop of §5.1 with everything around a tick: commands, time, robot, frames.

There is one loop body, :meth:`Loop.turn`. The driver (a thread, asyncio, the caller) calls it and then waits
until the time that it returns. A turn

1. applies the queued commands,
2. advances the time, at most to the next tick: a simulated world moves by whole physics steps, so that it is
   at the tick's time when the tick reads the sensors,
3. ticks, if a tick is due: latch the sensors, run one step of the interpreter, flush the commands,
4. publishes a frame, at most sixty times a second unless it may be the last one for long.

*Status.* :attr:`Loop.status` and :attr:`Loop.hung` are the only record of the state of a run; a session
copies them into its frames.

A loop belongs to the thread that drives it. Other threads use :attr:`Loop.inbox`, call :meth:`Loop.set_hung`
(the monitor) or end the loop (:meth:`Loop.halt`), and read `frame`, `ticking`, `status` and
`interpreter.tick`.

Paper: §5.1 (the loop), §6.3 (pause), §6.4 (forcing states).
"""

from __future__ import annotations

import math
import threading
import traceback
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from dataclasses import replace
from functools import partial
from time import perf_counter
from types import MappingProxyType
from typing import Any, Literal

from lrp_jupyter.bridges.bridge import Bridge, NullBridge
from lrp_jupyter.bridges.interventions import RobotArmed, RobotStopped
from lrp_jupyter.bridges.members import MemberError
from lrp_jupyter.bridges.tasks import TasksMoment, TaskState
from lrp_jupyter.errors import LRPError, UnknownElementError, sentence_of
from lrp_jupyter.interpreter.by_path import ByPath
from lrp_jupyter.interpreter.faults import Interrupted
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.issues import Issue
from lrp_jupyter.language.lookup import means
from lrp_jupyter.language.program import Element, Path, Program, path_text
from lrp_jupyter.live.clock import Clock
from lrp_jupyter.live.running.breakpoints import Breakpoints
from lrp_jupyter.live.running.checkpoints import SessionCheckpoint
from lrp_jupyter.live.running.foreign_code import Foreign, on_main_thread
from lrp_jupyter.live.running.frame import Frame, Hit, Hung, Status, is_active
from lrp_jupyter.live.running.inbox import Command, Inbox
from lrp_jupyter.live.running.inputs import EndProgram, EndRun, Pause, Resume
from lrp_jupyter.live.running.origins import asker_of, origin_of
from lrp_jupyter.live.running.record import Record
from lrp_jupyter.live.running.timing import ROUNDING, STEP, Timing
from lrp_jupyter.live.running.values import ValueTexts, numbers_of

_FREE = 0.0005  # wall seconds that a free-running loop keeps the interpreter lock
_FRAMES = 60.0  # frames per wall second, at most
_NO_READINGS: dict[str, object] = {}  # of a run without a robot
_NO_TASKS = TasksMoment()
_KEYBOARD = "The run was interrupted from the keyboard."
_RAISED = "The program raised `KeyboardInterrupt`, as Ctrl-C does."


class Loop:
    """Runs an interpreter against a clock and a robot; see the module docstring.

    `bridge`: opened by its owner, not by the loop.
    `changed`: called after every new :attr:`frame`, and whenever :attr:`hung` has changed.
    `printed`: returns the number of lines printed so far.
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
        self.timing = Timing(clock, bridge, rate, self._move)
        self.record = Record(interpreter, bridge, self.timing, remembers)
        self.inbox = Inbox()
        self.status: Status = "ready"
        self.reason = ""
        self._hung: tuple[object, Hung | None] = (None, None)  # and in which work
        self.foreign: Foreign | None = None
        """The foreign code that is running between two ticks, for the monitor."""
        self.fault = ""
        """The traceback of the fault that broke the session, or an empty text."""
        self.ticking: object = None
        """Identifies the current tick; None between two ticks."""
        self.is_copy = False
        """Whether it repeats or tries out a run, whose end is not its own."""
        self._unstarted = False  # whether it was paused before it was started
        self._texts = ValueTexts(self._calling)
        self.changed = changed
        self._printed = printed
        self._has_robot = type(bridge) is not NullBridge
        if self._has_robot:
            interpreter.follow_visits(bridge.requested)
        self._members = bridge.nodes.table
        self.breakpoints: Breakpoints | None = None
        self.paused_by: Hit | Issue | None = None
        self.after_tick: list[Callable[[], object]] = []
        """Called after every tick."""
        self._driven_by = 0  # the thread that made the last turn
        bridge.outside, bridge.origin = self._from_outside, partial(origin_of, interpreter)
        bridge.safety.recorded = partial(self.emit, "commanded")
        bridge.requested.asker = partial(asker_of, interpreter)
        bridge.requested.changed = self._task_changed
        self._published = -math.inf  # wall time of the last frame
        self.frame = self.make_frame()
        """The newest published frame."""

    @property
    def work(self) -> object:
        """Identifies the current tick or foreign code; None if there is neither. From any thread."""
        return self.ticking or self.foreign

    @property
    def hung(self) -> Hung | None:
        """The block that does not return, or None; from any thread."""
        work, hung = self._hung
        return hung if work is self.work else None

    def set_hung(self, work: object, hung: Hung | None) -> None:
        """Set the block that does not return, and the current :attr:`work`; called by the monitor."""
        self._hung = work, hung

    def set_rate(self, rate: float) -> None:
        """Change the rate; see :meth:`Timing.set_rate`."""
        self.timing.set_rate(rate)
        self.record.pending_at = 0.0  # it was computed at the old rate

    def _move(self, seconds: float) -> None:
        self.record.note_stops()  # they take effect before the world moves
        with self._calling("the robot"):
            self.bridge.advance(seconds)

    # -- the loop body ---------------------------------------------------------------------------

    def turn(self) -> float:
        """Apply commands, advance the time and tick if a tick is due.

        Return the time (of the clock) until which there is nothing to do unless a command arrives; infinite
        if only a command can change anything.
        """
        self._driven_by = threading.get_ident()
        try:
            if self.inbox.queued:
                self.apply_queued(hurried=True)
            if self.status != "running":
                return math.inf
            self.timing.catch_up()
            if self.timing.over:
                self.rest()
            elif self.timing.free:
                self._tick_freely()
            elif self.timing.is_due:
                self.tick()
                self.timing.measure(self.interpreter.tick)
            if self.status != "running":  # it paused at an issue, and no later frame would show it
                self.publish()
                return math.inf
            if self.timing.may_stand or perf_counter() - self._published >= 1 / _FRAMES:
                self.publish(hurried=True)
            return self.timing.next_turn()
        except Interrupted:  # too late: the block had returned
            return self.timing.now
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
        timing, end = self.timing, perf_counter() + _FREE
        while self.status == "running" and not self.inbox.queued and perf_counter() < end:
            timing.catch_up()
            if timing.over:
                break
            self.tick()
            if timing.clock.speed == math.inf:  # the clock does not advance
                timing.clock.rebase(timing.now + STEP)
        timing.measure(self.interpreter.tick)

    def tick(self) -> None:
        """Run one tick now; the next one is due a period later."""
        interpreter, bridge, timing, record = self.interpreter, self.bridge, self.timing, self.record
        now, safety = timing.now, bridge.safety
        self.ticking = object()  # a number would repeat: before the tick has begun, and after a rewind
        try:
            if record.names.values:
                record.note_names()
            if now >= record.pending_at:
                record.prepare(self.status == "running")
            record.moments.add(self._sense(now) if self._has_robot else (now, None, _NO_READINGS, _NO_TASKS))
            interpreter.step(now)
            hit = None if self.breakpoints is None else self._hit()
            if self._has_robot:
                self._act(now)
        finally:
            self.ticking = safety.again = None
        timing.set_due(now)
        for call in self.after_tick:
            call()
        if bridge.nodes.table is not self._members:
            self._members = bridge.nodes.table
            interpreter.resolve_issues(self._has_come)
        if hit is not None:
            self._pause_at(hit)
        if interpreter.paused and self.status == "running":
            self._stop_at_issue()
        if safety.suspended:
            self.pause(safety.suspended)

    def _sense(self, now: float) -> tuple[float, object, object, TasksMoment]:
        """Begin the tick of the robot; return the parts of its :class:`Moment`."""
        bridge, step = self.bridge, self.timing.step
        moment, tasks = bridge.moment(), bridge.requested.moment
        bridge.begin_tick(now, self.timing.period)
        world = None if step is None else bridge.simulated
        return now, moment, bridge.readings if world is None else world.sensed(), tasks

    def _act(self, now: float) -> None:
        """End the tick of the robot, and note which commands it did not get."""
        bridge, safety = self.bridge, self.bridge.safety
        bridge.end_tick(now)
        if (held := safety.hindered()) is not None:
            self.record.add(held, self.interpreter.tick - 1)
        elif safety.halted and safety.armed:
            self._tell_halted()

    def _tell_halted(self) -> None:
        """Add a notice about motions started only by an `onentry` that a stop of the robot has ended."""
        visits, program = self.interpreter.visits.items(), self.interpreter.program
        for name, origin in ((each.name, each.origin) for each in self.bridge.safety.left_halted()):
            state, _, action = origin.block.rpartition(".")
            entered = any(means(program, state, path) and count.tick == origin.tick for path, count in visits)
            if action == "onentry" and entered and self.is_active(state):
                text = (
                    f"`{name}` ended when the robot was stopped, for instance by a pause, and `onentry` of"
                    f" `{state}` does not run again. Put `{name}` into `running`, or into `onresume` to"
                    " repeat it after a pause."
                )
                self.bridge.safety.notice("stopped", text, f"{name} {origin.line}", origin)

    def _has_come(self, error: BaseException) -> bool:
        """Return whether an error reported a missing member of the robot that the robot now has."""
        missing = getattr(error, "missing", "") if issubclass(type(error), MemberError) else ""
        return bool(missing) and any(f"{path}.".startswith(f"{missing}.") for path in self._members)

    def settle(self) -> None:
        """Apply pending changes to the robot's world."""
        self._picture()

    def rest(self) -> None:
        """Pause without running the pause actions of the program."""
        if self.status == "running":
            self.status = "paused"
            self.timing.clock.pause()
            self.record.note(EndRun())

    def begin(self, checkpoint: SessionCheckpoint) -> None:
        """Continue from a checkpoint of another session; see :meth:`Record.begin`."""
        self.is_copy = True
        self.record.begin(checkpoint)
        self.status, self._unstarted = "running" if checkpoint.running else "paused", False

    def settle_as(self, checkpoint: SessionCheckpoint) -> None:
        """Adopt the settings of a session, and whether it was paused."""
        settings = checkpoint.snapshot.settings
        for name in ("on_active_edit", "on_issue", "paused"):
            setattr(self.interpreter, name, settings[name])
        self.set_rate(checkpoint.rate)
        self.status = "running" if checkpoint.running else "paused"

    def _hit(self) -> Hit | None:
        if self.breakpoints is None:
            return None
        with self._calling("a breakpoint"), self.bridge.safety.looking():
            return self.breakpoints.check()

    def _pause_at(self, hit: Hit) -> None:
        if self.status == "running":
            self.pause(str(hit))
        self.reason, self.paused_by = str(hit), hit

    def _stop_at_issue(self) -> None:
        """Pause because the interpreter has paused at an issue in a tick or a command."""
        last = self.interpreter.issues.newest
        where = f"In `{path_text(last.instances[-1])}`: " if last and last.instances else ""
        self._stand_still(where + last.message if last else "")
        self.paused_by = last

    def run(self, seconds: float, after_tick: Callable[[], object] | None = None) -> bool:
        """Tick in virtual time, without waiting, for at most this number of seconds.

        Return whether `after_tick` ended the run by a true result; its exceptions are raised. A pause also
        ends it. Afterwards the loop has its earlier status: running if a driver drives it, otherwise paused,
        without running the pause actions.
        """
        self._check_whole()
        self._driven_by = threading.get_ident()
        was_running = self.status == "running"
        self.resume()
        timing, tick, queued = self.timing, self.tick, self.inbox.queued
        step = timing.step
        if step is not None and seconds < math.inf:  # a world knows whole steps only
            seconds = math.ceil(seconds / step - ROUNDING) * step
        end = timing.now + seconds
        almost = end - ROUNDING
        asking = False
        try:
            while timing.now < almost and self.status == "running":
                if timing.due - timing.now <= ROUNDING:
                    timing.due = timing.now
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
                until = timing.due if timing.due < end else end
                if step is None:  # as `advance` does, for most of the time of a tick without a robot
                    timing.now = round(until * 1e12) / 1e12
                else:
                    timing.advance(until - timing.now)
        except BaseException as error:
            kind = type(error)
            if issubclass(kind, Interrupted):  # too late: the block had returned
                pass
            elif asking or (issubclass(kind, KeyboardInterrupt) and on_main_thread()):
                raise  # it comes from the caller
            elif issubclass(kind, KeyboardInterrupt):
                self.pause(_RAISED)
            else:
                self.break_down(error)
        finally:
            timing.clock.rebase(timing.now)
            if not was_running:
                self.rest()
            self.publish()
        return False

    # -- frames ----------------------------------------------------------------------------------

    def publish(self, hurried: bool = False) -> None:
        """Publish a frame of the current state; `hurried` as for :meth:`make_frame`."""
        self._published = perf_counter()
        if self.fault:  # the run may be in any condition, so it is no longer read
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
        """Make a frame of the current state, between two ticks.

        `hurried`: whether further frames will follow anyway, so that this one may show an earlier text of a
            value that is slow to render.
        """
        interpreter, timing = self.interpreter, self.timing
        values = interpreter.variables.pairs()
        over = self.status in ("stopped", "closed")  # code that might not return must not run now
        variables = self._texts.of(values, now=not (hurried and self.status == "running"), foreign=not over)
        visits, firings = interpreter.visits, interpreter.firings
        rate, speed = timing.achieved if self.status == "running" else (0.0, 0.0)
        return Frame(
            status=self.status,
            reason=self.reason,
            tick=interpreter.tick,
            time=timing.now,
            active=interpreter.active,
            values=ByPath(dict(values), interpreter.program),
            variables=ByPath(variables, interpreter.program),
            numbers=ByPath(numbers_of(values), interpreter.program),
            outdated=MappingProxyType(interpreter.outdated),
            visits=MappingProxyType({path: count.times for path, count in visits.items()}),
            visited_at=MappingProxyType({path: count.tick for path, count in visits.items()}),
            fired=MappingProxyType({path: count.times for path, count in firings.items()}),
            fired_at=MappingProxyType({path: count.tick for path, count in firings.items()}),
            events=MappingProxyType(dict(interpreter.event_values)),
            countdowns=MappingProxyType(interpreter.countdowns),
            issues=tuple(interpreter.issues),
            restarts=interpreter.restarts,
            restart_reason=interpreter.restart_reason,
            revision=interpreter.revision,
            moved=interpreter.moved,
            patch_reason=interpreter.patch_reason,
            program=interpreter.program,
            readings=self.record.readings,
            rate=timing.rate,
            achieved_rate=rate,
            speed=timing.clock.speed,
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
                return None if (world := self.bridge.simulated) is None else world.picture
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            self.bridge.lose("picture", error)
            return None

    @contextmanager
    def _calling(self, name: str = "") -> Iterator[None]:
        """Mark for the monitor that foreign code of this name is running in this context."""
        outer, self.foreign = self.foreign, Foreign(name)
        try:
            yield
        finally:
            self.foreign = outer

    def is_active(self, state: str | Path) -> bool:
        """Return whether a state is active now, at any depth."""
        return is_active(state, self.interpreter.active, self.interpreter.program)

    # -- commands --------------------------------------------------------------------------------

    def apply_queued(self, hurried: bool = False) -> None:
        """Apply the commands that are queued now, each as a whole; then publish, then answer.

        An error that is not a mistake of the caller (:attr:`Command.misuse`) breaks the session.
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
        """Apply a command now and return its result, or raise its exception."""
        result, refusal = self._apply(command)
        if refusal is not None:
            raise refusal
        return result

    def _apply(self, command: Command) -> tuple[Any, BaseException | None]:
        restarts, program = self.interpreter.restarts, self.interpreter.program
        self._driven_by = threading.get_ident()
        record = self.record
        try:
            if not command.mends:
                self._check_whole()
            record.note_names()
            with self._calling(), record.deriving(command.recorded):  # blocks, hooks and code of the caller
                result = command.apply(self)
            if command.recorded:
                record.note(command)
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
                record.watch()
            if self.interpreter.restarts != restarts:  # no onexit has run, so everything must stop
                self.bridge.stop_all()
                self.bridge.requested.drop()
                record.pending_at = 0.0  # the program begins at the next tick

    def _check_whole(self) -> None:
        if self.fault:
            raise LRPError(
                "The session itself failed, not the program. Start it again, or reset it; "
                "its `fault` is the traceback."
            )

    # -- robot and observers ---------------------------------------------------------------------

    def _from_outside(self, what: object, surely: bool) -> None:
        """Record an action on the robot, unless it came from the program or a recorded input."""
        if isinstance(what, (RobotStopped, RobotArmed)) and threading.get_ident() != self._driven_by:
            self.record.note_later(what)
        elif surely or not self.ticking:
            self.record.note_outside(what, surely)

    def emit(self, kind: str, data: object) -> None:
        """Notify the observers of the interpreter of an event now, in order with its own events."""
        self.interpreter.emit(kind, data, self.timing.now)

    def _task_changed(self, name: str, state: TaskState) -> None:
        self.interpreter.emit("task", (name, state), self.timing.now, ticks=1)  # of the tick that begins

    # -- what commands do ------------------------------------------------------------------------

    def pause(self, reason: str = "") -> None:
        """Pause program, time and robot; the reason is a sentence, or empty. Paper: §6.3."""
        if self.status == "running":
            with self.record.deriving():
                self.interpreter.pause(self.timing.now, reason)
                self._stand_still(reason)
            self.record.note(Pause(reason))
        elif self.status in ("ready", "paused") and reason:
            self.paused_by = None
            self._unstarted = self._unstarted or self.status == "ready"
            self.status, self.reason = "paused", reason

    def _stand_still(self, reason: str) -> None:
        """Pause time and robot; the interpreter has paused already."""
        self.status, self.reason = "paused", reason
        self.timing.clock.pause()
        self._call_hook(self.bridge.stop_all)  # first, whatever `on_pause` does
        self._call_hook(self.bridge.on_pause)
        self.bridge.safety.rest()  # commands held back by the stop belonged to the previous tick

    def resume(self) -> None:
        """Start the run, or continue it after a pause; a stopped loop stays stopped."""
        if self.status in ("running", "stopped", "closed"):
            return
        first, self._unstarted = self.status == "ready" or self._unstarted, False
        self.status, self.reason, self.paused_by = "running", "", None
        self.bridge.safety.go_on()
        self.timing.resume()
        with self.record.deriving():
            self._call_hook(self.bridge.on_start if first else self.bridge.on_resume)
            self.interpreter.resume(self.timing.now)
        self.record.note(Resume())

    def step(self) -> None:
        """Run one tick and one period of time; paused before and after. Paper: §6.3."""
        timing = self.timing
        self.pause()
        self.bridge.safety.go_on()
        if self.status == "ready" or self._unstarted:
            self._unstarted = False
            self._call_hook(self.bridge.on_start)
        if self.status != "stopped":
            self.status, self.reason, self.paused_by = "paused", "", None
        timing.clock.pause()
        timing.due = timing.now
        self.tick()
        timing.advance(timing.period)
        timing.clock.rebase(timing.now)

    def rewind(self, ticks: int) -> None:
        """Step back by this number of ticks; see :meth:`Record.rewind`."""
        self.record.rewind(ticks, self.status == "running")
        if self.paused_by is not None and ticks:
            self.paused_by, self.reason = None, ""  # that tick has not happened

    def force(self, path: Path, teleport: bool) -> None:
        """Force a state; if it does not exist, this is an issue, as in a transition. Paper: §6.4."""
        interpreter = self.interpreter
        force = interpreter.teleport_to if teleport else interpreter.transition_to
        try:
            force(path, self.timing.now)
        except UnknownElementError as error:
            element, tick, message = Element("state", path), interpreter.tick, str(error)
            issue = Issue("unknown state", element, message, 1, 1, first_tick=tick, last_tick=tick)
            interpreter.issues.report((element, 0, "unknown state"), lambda: issue, message, tick)

    # -- the end ---------------------------------------------------------------------------------

    @property
    def must_end(self) -> bool:
        """Whether the program has something to do at the end of this run."""
        return self.interpreter.must_end and self.bridge.is_open and not (self.fault or self.is_copy)

    def leave(self) -> None:
        """Have the program do what it does at the end of a run; after the last turn, never raises."""
        if self.must_end:
            self.rest()
            self._apply(EndProgram())

    def end_program(self) -> None:
        """Run the ``onend`` actions, unless the run has ended; the robot is stopped before and after that."""
        if not self.interpreter.must_end:
            return
        safety = self.bridge.safety
        try:
            self._call_hook(self.bridge.stop_all)
            safety.tick(self.timing.now, self.timing.period)  # commands held back were those of the last tick
            self.interpreter.end(self.timing.now)
            self.bridge.requested.finish_calls()
        finally:
            self._call_hook(self.bridge.stop_all)

    def reset(self) -> None:
        """End the run, and restart the program at the next tick."""
        self.end_program()
        self.interpreter.reset(self.timing.now)

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
        """Repair a broken session: a new run of a program, ready to start; the robot's world is unchanged."""
        self.interpreter.renew(program, self.timing.now)
        self.record.clear()
        self.fault = self.reason = ""
        if self.status == "broken":
            self.status = "ready"
        self.timing.clock.pause()
        self.timing.due = self.timing.now

    def _call_hook(self, hook: Callable[[], object]) -> None:
        """Call a hook of the bridge, which is foreign code; if it fails, the robot is stopped."""
        try:
            with self._calling("the robot"):
                hook()
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            self.bridge.lose(hook.__name__, error)
            self.bridge.stop_all()
