"""The interface of a bridge: the members of ``robot``, and the path of its commands.

It holds the members and the safety, and stops the robot. Connecting, and the beginning and end of
a tick, belong to the :class:`~lrp_jupyter.bridges.bridge.Bridge` on top.

Paper: §7.3.
"""

from __future__ import annotations

import inspect
import math
import os
from collections.abc import Callable, Collection, Mapping
from contextlib import suppress
from functools import partial
from typing import Any, ClassVar, Generic, Self, TypeVar, overload
from weakref import WeakValueDictionary

from lrp_jupyter.bridges.argument_values import kept
from lrp_jupyter.bridges.guarding.guard import UNGUARDED, Guard, Stopper
from lrp_jupyter.bridges.guarding.safety import CommandRecord, Origin, Safety
from lrp_jupyter.bridges.interventions import RobotArmed, RobotCommanded, RobotStopped
from lrp_jupyter.bridges.latched_values import MOST, Arrivals, FedValues
from lrp_jupyter.bridges.member_tree import Limits, Nodes, RobotMethod, RobotVariable, companion_path
from lrp_jupyter.bridges.members import Member
from lrp_jupyter.bridges.message import Message, stands
from lrp_jupyter.bridges.robot import Robot
from lrp_jupyter.bridges.tasks import RobotTask, Task, Tasks, TaskWork, arguments_of
from lrp_jupyter.errors import BridgeError, LRPError, NoDataYet, sentence_of

_STALE_AFTER = 1.0  # s; at walking pace a robot moves half a metre in it

_T = TypeVar("_T")


class part(Generic[_T]):  # noqa: N801  (reads like `property`)
    """An attribute that is made when it is first used: it is there whatever the constructor of a bridge does.

    Of several threads that use it first at the same time, all get the same one; so `make` does nothing else.
    """

    def __init__(self, make: Callable[[Any], _T]) -> None:
        self._make = make

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    @overload
    def __get__(self, bridge: None, owner: type) -> Self: ...
    @overload
    def __get__(self, bridge: object, owner: type) -> _T: ...
    def __get__(self, bridge: object, owner: type) -> Self | _T:
        if bridge is None:
            return self
        made: _T = vars(bridge).setdefault(self._name, self._make(bridge))
        return made


class Interface:
    """Members and commands of one robot.

    There is no constructor that a subclass would have to call: what begins with a fixed value is an attribute
    of the class, everything else a `part`.
    """

    name: ClassVar[str]
    hardware: ClassVar[bool] = True
    stop_timeout: ClassVar[float | None] = 1.0
    time_step: ClassVar[float | None] = None

    latch = 0  # number of the tick that readings are latched for; 0 between ticks
    origin: Callable[[], Origin] = Origin  # returns that of a command that is given now
    is_closed = False
    """Whether it was closed, or not opened after all; what arrives then is of a connection that is gone."""
    _is_open = False
    messages_taken: frozenset[str] = frozenset()
    """The readings of messages that the program uses, such as ``light.new``."""
    unstopped = False
    """Whether the last `stop_all` has failed: it is tried again until it does not, or a tick comes."""

    nodes = part(lambda bridge: Nodes(lambda path: Robot(bridge, f"{path}.")))
    fed = part(
        lambda bridge: FedValues(
            None if bridge.time_step is None else lambda: bridge.safety.now, lambda: bool(bridge.latch)
        )
    )
    safety = part(lambda bridge: Safety(armed=not type(bridge).hardware))
    robot = part(Robot)
    requested = part(Tasks)
    readings = part[dict[str, object]](lambda bridge: {})  # of this tick, by path; the error where one failed
    answers = part[dict[str, list[object]]](lambda bridge: {})  # to the calls of this tick, by path
    outside = part[Callable[[object, bool], object]](lambda bridge: lambda what, surely: None)
    """Called with what is done to the robot and its world, as values of `lrp_jupyter.bridges.interventions`
    or inputs of a simulated world, and with whether it was certainly not the program that did it."""
    _guard = part(Guard)

    @property
    def has_world(self) -> bool:
        """Whether its robot is in a world whose past can be restored."""
        return self.time_step is not None

    @property
    def is_open(self) -> bool:
        """Whether `open` succeeded and `close` was not called since."""
        return self._is_open

    # -- members ----------------------------------------------------------------------------------

    def add_variable(
        self,
        name: str,
        getter: Callable[[], object],
        doc: str = "",
        unit: str = "",
        *,
        type: type | str | None = None,  # noqa: A002  (what a view calls it)
        age: Callable[[], float | None] | None = None,
        stale_after: float | None = None,
        limits: tuple[float, float] | None = None,
    ) -> None:
        """Register a reading as ``robot.<name>``; a second one of that name replaces the first.

        Beside ``light.data``, a program also finds ``light.age``, in seconds, and ``light.new``, the values
        since the last tick: here the one that is read in the tick, and all that arrived where they are fed. A
        member of such a name that is added is preferred.

        Parameters
        ----------
        name : str
            May be dotted: ``"light.data"`` is ``robot.light.data``.
        getter : callable
            Called at most once in a tick. `NoDataYet`, or None as value, means that nothing has
            arrived yet.
        doc, unit : str
        type : type or str, optional
            Known before the first reading arrives; a class shows its annotated fields.
        age : callable, optional
            Seconds since the reading arrived, where the bridge knows better than "when it was read"; None
            before the first.
        stale_after : float, optional
            Seconds after which a reading is too old to drive on: then reading it raises
            :class:`~lrp_jupyter.errors.StaleData`, the robot is stopped, and no velocity is sent until a new
            one arrives. Needs `age`. Default: never.
        limits : (float, float), optional
            The least and the greatest value, besides ``inf``: the checks report a comparison with a number
            beyond them.

        Raises
        ------
        ValueError
            The name cannot be written after ``robot.``, or `stale_after` is not a positive number or lacks
            an `age`.

        See Also
        --------
        feed : For values that arrive by themselves.
        """
        text = doc or _doc_of(getter)
        reading = RobotVariable(self, name, getter, text, unit, type, age, stale_after)
        reading.limits = limits
        self._add_reading(reading)

    def _add_reading(
        self,
        reading: RobotVariable,
        new: Callable[[], tuple[object, ...]] | None = None,
        own: Collection[str] = (),
    ) -> None:
        """Add a reading with its companions: beside it if its name ends in ``.data``, else none or below it.

        `new`: returns its messages since the last tick; by default, it is read.
        `own`: names of fields of its value, which are preferred to companions below it.
        """
        path = reading.path
        companions = []
        if path.endswith(".data") or new is not None:
            kinds: tuple[tuple[str, Callable[[], object], str, str, type], ...] = (
                ("new", new or partial(read_now, reading), "", _NEW, tuple),
                ("age", partial(_age_of, reading), "s", _AGE, float),
            )
            companions = [
                RobotVariable(self, companion_path(path, word), getter, doc, unit, kind, None, None, path)
                for word, getter, unit, doc, kind in kinds
                if path.endswith(".data") or word not in own
            ]
        self.nodes.add(reading, companions)

    def take_messages(self, readings: Collection[str]) -> None:
        """Keep every message for these readings, such as ``light.new``, from now on; for no others.

        Called on the interpreter's thread, with what the blocks of the program name.
        """
        self.messages_taken = frozenset(readings)
        self.fed.hear([f"{each.removesuffix('.new')}.data" for each in self.messages_taken])

    def _new_messages(self, path: str, arrivals: Arrivals[Any]) -> tuple[Any, ...]:
        """Return the messages of a reading in this tick."""
        name = companion_path(path, "new")
        if not arrivals.is_heard:  # a function of the notebook asks, and no block of the program
            self.take_messages(self.messages_taken | {name})
            return ()
        if self.latch and arrivals.dropped:
            lost = "1 message was" if arrivals.dropped == 1 else f"{arrivals.dropped:,} messages were"
            text = f"`robot.{name}`: {lost} dropped, since a tick takes at most the last {MOST:,}."
            self.safety.notice("dropped", text, name, renews=True)
        return arrivals.messages(bool(self.latch))

    def feed(
        self,
        name: str,
        value: object = None,
        *,
        doc: str = "",
        unit: str = "",
        type: type | str | None = None,  # noqa: A002  (as for add_variable)
        stamp: float | None = None,
        stale_after: float | None = _STALE_AFTER,
    ) -> None:
        """Set the value of the reading ``robot.<name>``; on any thread, whenever one has arrived.

        The first call adds the variable; without a value it only declares it, in `add_members` or
        `open_interface`, so that it is known before anything arrives. A tick sees what had arrived when it
        began: the last value and, in ``robot.light.new``, all since the last tick. When no new value comes
        for `stale_after` seconds, reading it raises :class:`~lrp_jupyter.errors.StaleData`, the robot is
        stopped, and no velocity is sent until a new one arrives (see `add_method`). After `close` the call
        does nothing.

        Parameters
        ----------
        name : str
            May be dotted: ``"light.data"`` is ``robot.light.data``.
        value : object
            A new object each time, not the last one changed; one object for what belongs together, such as
            x and y. None: declare the variable only.
        doc, unit, type
            As for `add_variable`; what is given in one call holds for all later ones.
        stamp : float, optional
            When the value was measured, in seconds of `time.time`, by a clock that agrees with this
            computer's. Default: now.
        stale_after : float or None
            Seconds, 1 unless given; None: it never becomes stale, as the charge of a battery does not.

        Raises
        ------
        ValueError
            The name cannot be written after ``robot.``, or `stale_after` is not a positive number.
        """
        if self.is_closed:
            return
        known = self.nodes.table.get(name)
        if not (isinstance(known, RobotVariable) and known.getter is self.fed.getter(name)):
            self._add_fed(name, doc, unit, type, stale_after)
        elif (
            doc not in ("", known.doc)
            or unit not in ("", known.unit)
            or type not in (None, known.type)
            or stale_after not in (_STALE_AFTER, known.stale_after)
        ):
            late = known.stale_after if stale_after == _STALE_AFTER else stale_after
            self._add_fed(name, doc or known.doc, unit or known.unit, type or known.type, late)
        if value is not None:
            self.fed.put(name, value, stamp)

    def _add_fed(
        self, name: str, doc: str, unit: str, kind: type | str | None, stale_after: float | None
    ) -> None:
        getter, age = self.fed.getter(name), partial(self.fed.age, name)
        reading = RobotVariable(self, name, getter, doc, unit, kind, age, stale_after)
        new = partial(self._new_messages, name, self.fed.of(name)) if name.endswith(".data") else None
        self._add_reading(reading, new)

    def add_method(
        self,
        name: str,
        function: Callable[..., object],
        doc: str = "",
        *,
        message: type[Message] | None = None,
        command: bool = True,
        velocity: bool | None = None,
        limits: Limits | None = None,
        mover: str = "",
    ) -> None:
        """Register a function as ``robot.<name>(...)``.

        Parameters
        ----------
        name : str
            May be dotted: ``"motorA.stop"``.
        function : callable
            Called with the program's arguments or, where `message` is given, with one message.
        doc : str
        message : Message class, optional
            ``message=Twist``: the program may fill it in any of the ways of `lrp_jupyter.bridges.message`.
        command : bool
            Whether the robot acts: such a call is not sent while disarmed. False for a mere query.
        velocity : bool, optional
            Whether the command watchdog applies, which stops the robot if the program does not keep
            commanding; and whether it is held back while data are stale. Default: True for ``move``.
        limits : mapping of str to float or (float, float), optional
            ``{"linear": 0.5}``: larger numbers are clamped to -0.5 ... 0.5, and that is shown.
        mover : str
            Which one of several robots it moves, or which motor, until another command does. The watchdog
            watches each of them, if it is a velocity.
        """
        is_velocity = name.rpartition(".")[2] == "move" if velocity is None else velocity
        text = doc or _doc_of(function)
        self.nodes.add(
            RobotMethod(self, name, function, text, message, command, is_velocity, limits or {}, mover)
        )

    def add_task(
        self,
        name: str,
        start: Callable[..., object],
        cancel: Callable[[Task], object] | None = None,
        doc: str = "",
        *,
        message: type[Message] | None = None,
        limits: Limits | None = None,
        likely: Mapping[str, tuple[float, float]] | None = None,
        units: Mapping[str, str] | None = None,
        check: Callable[..., object] | None = None,
        moves: bool = True,
        replaces: bool = False,
        mover: str | None = None,
    ) -> None:
        """Register a task as ``robot.<name>(...)``: what the robot is asked for, and goes on with by itself.

        A program asks for it in an action and reads ``robot.<name>.status``, ``.succeeded``, ``.failed``, …
        For how long it is wanted, `lrp_jupyter.bridges.tasks` decides, as for every bridge.

        Parameters
        ----------
        name : str
            May be dotted.
        start : callable
            Called with a `Task` and the program's arguments or, where `message` is given, with a `Task` and
            one message; on a thread of its own, so that it may wait, or, if the bridge has a world of its
            own, on the interpreter's thread. The task is active until `Task.update` says otherwise. What it
            raises aborts the task. The next request of the same member begins when it has returned; one that
            has waited for ten seconds is aborted.
        cancel : callable, optional
            Called with the `Task` when it is not wanted any more, on any thread: it ends it on the robot's
            side and does not wait. If `start` has not returned then, it is called again when that has. None:
            it cannot be cancelled, and ends soon, as a service does.
        doc : str
        message, limits
            As for `add_method`.
        likely : mapping of str to (float, float), optional
            Between which numbers an argument probably is: the checks warn of a number beyond them.
        units : mapping of str to str, optional
            The units of the arguments, for these warnings: ``{"radians": "rad"}``.
        check : callable, optional
            Called first, with all arguments by name: what it raises, a ValueError with a sentence, is an
            error at the line of the program, and nothing is asked for.
        moves : bool
            Whether something moves by it: then it is not begun while data are stale, and the guard process
            stops the robot if this program dies meanwhile.
        replaces : bool
            Whether `start` itself ends `Task.replaced`, so that the robot does not stop in between. If not,
            `cancel` is called for it first.
        mover : str, optional
            The robot that it moves, as in `add_method`, if beginning it ends a velocity by which that moves:
            the command watchdog then waits for no other one. Default: velocities go on beside it.

        Raises
        ------
        ValueError
            The name cannot be written after ``robot.``.
        """
        text = doc or _doc_of(start)
        task = RobotTask(self, name, partial(start, None), text, message, True, False, limits or {})
        task.tasks = self.requested
        task.likely, task.units = likely or {}, units or task.units
        task.work = TaskWork(start, cancel, check, moves, replaces, mover)
        self.nodes.add(task)

    def remove_member(self, name: str) -> None:
        """Remove a member, or a part with all its members.

        Raises
        ------
        MemberError
            There is no such member.
        """
        self.nodes.remove(name)

    def members(self) -> tuple[Member, ...]:
        """Return every member with its last reading, without reading; on any thread.

        Without what accompanies a reading, ``light.new`` and ``light.age``; `describe` knows these, too.
        """
        return tuple(node.describe() for node in self.nodes.members() if not _is_companion(node))

    def describe(self, path: str) -> Member:
        """Describe one member, a part (``light``) or a field of a reading (``odom.x``).

        Raises
        ------
        MemberError
            There is no such member or field.
        """
        return self.nodes.describe(path.removeprefix("robot."))

    def refresh(self) -> None:
        """Read every variable once, so that views show what no program reads.

        Between ticks, on the interpreter's thread. Failing readings stay as they were.
        """
        if self.safety.blind:  # there may be no tick that would find it over
            self.judge_ages()
        for node in self.nodes.members():
            if isinstance(node, RobotVariable) and not node.of:
                try:
                    node.read()
                except (BridgeError, NoDataYet):
                    continue

    def judge_ages(self) -> None:
        """Find out whether the readings are too old to drive on."""

    # -- commands and safety ----------------------------------------------------------------------

    def arm(self) -> None:
        """Arm the bridge: commands are sent from now on, and a guard watches this process.

        It waits until the guard has reached the robot, at most ten seconds; nothing is sent before.
        """
        if not self.safety.armed:
            self._begin_guarding()
            self.safety.armed = True
            self.outside(RobotArmed(True), False)
            who = f"`{self.name}` is armed: commands move the robot. {self.failsafe}"
            self.safety.notice("armed", who.rstrip())
        self.safety.go_on()

    def disarm(self) -> None:
        """Stop the robot and disarm the bridge: commands are recorded and shown, not sent."""
        if self.safety.armed:
            self.safety.armed = False  # first: a tick that begins while the robot is stopped sends nothing
            self._guard.end(self.stop_all() or not self.in_motion)
            self.outside(RobotArmed(False), False)
            self.safety.notice("disarmed", f"`{self.name}` is disarmed: commands are shown, not sent.")

    def stopper(self) -> Stopper | None:
        """Return how another process can stop the robot when this one is dead or suspended. Default: None.

        Asked ten times a second while the bridge is open and armed, on a thread of its own: it returns at
        once. The process connects to the robot when it is asked first, and again when another `Stopper` is
        returned.
        """
        return None

    @property
    def failsafe(self) -> str:
        """Who stops the robot when this program or this computer dies: a sentence; empty for a simulation."""
        if not self.hardware:
            return ""
        try:
            guarded, trouble = self.stopper() is not None, self._guard.trouble
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            guarded, trouble = True, sentence_of(error)
        if trouble:
            return f"{UNGUARDED.removesuffix('.')}. The robot is not guarded: {trouble}"
        return self.guarded_by if guarded else UNGUARDED

    about_options: ClassVar[str] = ""
    """What ``lrp bridges NAME`` prints below the options."""

    guarded_by: ClassVar[str] = (
        "If this program dies or hangs, a guard process stops the robot. If this computer sleeps or is cut"
        " off, nothing does, unless the robot stops by itself."
    )

    @property
    def in_motion(self) -> bool:
        """Whether the robot may move by a command that was sent since the last stop."""
        return bool(self.safety.driven)

    def drives(self, method: RobotMethod, arguments: dict[str, object]) -> bool:
        """Return whether the robot may move by a command. Default: by any but a velocity of zero.

        Parameters
        ----------
        method : RobotMethod
        arguments : dict of str to object
            With the defaults of those that were not given.
        """
        if isinstance(method, RobotTask):
            return method.work.moves
        return not (method.velocity and _stands(method.path, arguments))

    def lapse(self, what: Callable[[], str]) -> None:
        """Stop the robot and hold commands: this process was suspended, as `what` says after the stop."""
        self.safety.suspend()
        self.stop_all()
        self.safety.suspend(what())
        self.safety.notice("guard", self.safety.suspended)

    def unguarded(self, why: str) -> None:
        """Disarm a robot whose promised guard is missing; a lost one stays armed: nothing is sent to it."""
        if not self.safety.lost:
            self.disarm()
            told = f"The robot was disarmed, because it is not guarded any more. {why}"
            self.safety.notice("guard", f"{told} Arm it to go on.")

    def _begin_guarding(self) -> None:
        if self.hardware:
            _armed[id(self)] = self
            try:
                self._guard.start()
            except BaseException:  # Ctrl-C, while it waits for the process: nothing is promised
                self._guard.end()
                raise

    def stop(self) -> None:
        """Stop the robot. Called on any thread, at any time, also while disarmed.

        A program reaches it as ``robot.stop()``, unless the bridge adds a `stop` of its own.

        Default: send a velocity of zero through every velocity method, also where one of them fails.
        """
        failures: list[BaseException] = []
        for node in self.nodes.members():
            if isinstance(node, RobotMethod) and node.velocity:
                try:
                    node.perform(node.standstill())
                except BaseException as error:
                    failures.append(error)
        if failures:
            raise failures[0]

    def stop_all(self) -> bool:
        """Stop the robot: from any thread, in bounded time, armed or not. Its own failures raise nothing.

        While a loop ticks, further commands of the present tick are not sent.

        Returns
        -------
        bool
            Whether the robot was stopped; if not, a notice contains the reason.
        """
        safety, moving = self.safety, self.safety.motion
        entered = {name: (name, math.inf) for name in self.requested.entered()}
        safety.stopped()
        try:
            stopped = self._stop_now()
            self.unstopped = not stopped
            if stopped:
                safety.halted = {**safety.halted, **moving, **entered}
            return stopped
        finally:  # a recording that fails does not keep the robot moving
            self.outside(RobotStopped(), False)

    def offer_stop(self) -> None:
        """Add ``robot.stop()``, unless the bridge has a member of that name.

        It stops the robot in bounded time, and does not hold back the later commands of the tick.
        """
        if "stop" not in self.nodes.table:
            self.add_method("stop", self._stop_or_raise, "stop the robot")

    def _stop_or_raise(self) -> None:
        self.safety.halted = {}  # the program itself has it stand
        if not self._stop_now():
            raise BridgeError(self.safety.notices[-1].text)

    def stop_mover(self, mover: str) -> None:
        """Stop one of several robots, for which the program gives no more velocities. Default: stop all.

        Tasks are no velocities, and go on.
        """
        self.safety.run_stop(self.stop, self.stop_timeout, self._guard.stop)
        for name in self.requested.moving():
            self.safety.drive(name, True)

    def _stop_now(self) -> bool:
        return self.safety.run_stop(self._stop_everything, self.stop_timeout, self._guard.stop)

    def _stop_everything(self) -> None:
        """Cancel all tasks, and stop the robot even if that fails."""
        try:
            self.requested.stop()
        finally:
            self.stop()

    def send(self, method: RobotMethod, command: Message | inspect.BoundArguments) -> object:
        """Clamp a command to its limits, record it and, if allowed, perform it.

        Every call of a method of the robot comes through here; return its result.
        """
        safety, guard = self.safety, self._guard
        if method.command and safety.only_looks:
            raise BridgeError(f"`robot.{method.path}` is a command, and a breakpoint only looks at the run.")
        if not method.command or safety.is_stopping:  # what stops the robot is never held back
            return method.perform(command)
        if safety.blind and not self.latch:
            self.judge_ages()
        origin = self.origin()
        task = method if isinstance(method, RobotTask) else None
        asked = {} if task is None else arguments_of(command)
        clamped = method.clamp(command)
        for name, sentence in clamped.items():
            safety.notice("limited", sentence, f"{method.path} {name} {origin.line}", origin)
        if guard.is_on:
            guard.check()
        arguments = command.as_dict() if isinstance(command, Message) else kept(dict(command.arguments))
        judged = arguments if isinstance(command, Message) else arguments_of(command)
        moves = method.sets_in_motion and not _stands(method.path, judged)
        speeds = method.velocity and moves
        stops = safety.stops
        hindrance = safety.hindrance(speeds or (task is not None and task.work.moves))
        limited = tuple(clamped.values())
        safety.record(CommandRecord(method.path, arguments, safety.now, hindrance is None, limited, origin))
        if task is not None:
            task.check(asked)
        self.outside(RobotCommanded(method.path, arguments), False)
        if hindrance == "lost":
            if task is not None:
                self.requested.ask(task, command, lost=safety.why)
                return None
            raise BridgeError(f"`robot.{method.path}` was not sent: {safety.why}")
        if hindrance == "held":
            why = safety.suspended or safety.blind or "the robot was stopped in this tick."
            safety.notice("held", f"`{method.path}` was not sent: {why[0].lower()}{why[1:]}")
        if hindrance == "disarmed":
            safety.notice("disarmed", f"`{method.path}` was not sent: the robot is disarmed.")
        if hindrance is not None:  # a notice about stale data was logged when they became stale
            return None
        drives = guard.is_on and self.drives(method, judged)
        if speeds:
            safety.may_move(method.path, method.mover)
        if drives:
            stood = not safety.driven
            safety.drive(method.path, True)
            if stood:
                guard.moves()  # first: this process may die right after the command
        try:
            result = method.perform(command)
            # what did not return was no command: nothing is known of the robot that was not known before
            if guard.is_on:
                safety.drive(method.path, drives and (task is None or task.active))
            if task is not None and task.work.mover is not None:
                safety.moving(method.path, False, task.work.mover)
            if method.sets_in_motion:
                safety.moving(method.path, moves, method.mover, method.velocity)
            return result
        finally:
            if safety.stops != stops:  # on another thread, while this was performed: the stop comes last
                self._stop_now()


_armed: WeakValueDictionary[int, Interface] = WeakValueDictionary()
"""Bridges to hardware that were armed in this process."""


def _disarm_copies() -> None:
    """Have the copy of this process that `os.fork` makes command nothing: no guard watches it."""
    for bridge in list(_armed.values()):
        bridge.safety.armed = bridge._guard.is_on = False


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_disarm_copies)


def _stands(path: str, arguments: dict[str, object]) -> bool:
    """Whether a velocity command lets the robot stand: a ``stop``, or nothing but zeros."""
    return path.rpartition(".")[2] == "stop" or stands(arguments)


_NEW = "the values that have arrived since the last tick, oldest first"
_AGE = "seconds since the last value arrived; inf: none has"


def _is_companion(node: RobotVariable | RobotMethod) -> bool:
    return isinstance(node, RobotVariable) and bool(node.of)


def read_now(reading: RobotVariable) -> tuple[object, ...]:
    """Return what a reading that is asked for has in this tick."""
    try:
        return (reading.read(),)
    except NoDataYet:
        return ()


def _age_of(reading: RobotVariable) -> float:
    if not reading.knows_age:  # it is as old as what was read last
        with suppress(LRPError):
            reading.read()
    age = reading.age()
    return math.inf if age is None else age


def _doc_of(function: Callable[..., object]) -> str:
    return (inspect.getdoc(function) or "").partition("\n")[0] if inspect.isroutine(function) else ""
