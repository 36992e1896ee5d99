"""Tasks: what a robot is asked for and goes on with by itself, until it is done or no longer wanted.

A request belongs to the visit of the state whose action makes it. Asked for in ``running``, it lives as long
as that visit asks for it in every tick, as a velocity does; asked for in another action, until the state is
left. Then it is cancelled and its outcome forgotten. What was asked for by hand lives until it ends or the
robot is stopped. The same request again is the same task; another one replaces it.

What a program sees is latched per tick, like a reading. All of it is one immutable value,
:attr:`Tasks.moment`, so that a rewind and a fork return to it.

Owner: the interpreter's thread. Any thread may `update` a task and stop all of them.
"""

from __future__ import annotations

import inspect
import threading
from collections.abc import Callable, Collection, Mapping
from copy import copy
from dataclasses import dataclass, field, replace
from functools import partial
from time import monotonic
from types import MappingProxyType
from typing import Any, Literal, NamedTuple, Self

from lrp_jupyter.bridges.argument_values import are_same, kept
from lrp_jupyter.bridges.member_tree import MemberOwner, RobotMethod
from lrp_jupyter.bridges.members import Member, MemberError
from lrp_jupyter.bridges.message import Message
from lrp_jupyter.errors import BridgeError, did_you_mean, ended, sentence_of

TaskStatus = Literal["active", "succeeded", "aborted", "rejected", "cancelled", "lost"]
STATUSES: tuple[TaskStatus, ...] = ("active", "succeeded", "aborted", "rejected", "cancelled", "lost")
FAILURES: tuple[TaskStatus, ...] = ("aborted", "rejected", "lost")

Command = Message | inspect.BoundArguments


class TaskState(NamedTuple):
    """The state of a task, as a program sees it in one tick.

    `status`: None if nothing is asked for.
    `reason`: why it has this status, a sentence; may be empty.
    `at`: when it got this status, in seconds of the run.
    """

    status: TaskStatus | None = None
    feedback: Any = None
    result: Any = None
    reason: str = ""
    at: float = 0.0

    def after(self, told: TaskState) -> TaskState:
        """Return it when another state was told, in which None as feedback or result is nothing new."""
        feedback = self.feedback if told.feedback is None else told.feedback
        return told._replace(feedback=feedback, result=self.result if told.result is None else told.result)

    @property
    def active(self) -> bool:
        """Whether it goes on."""
        return self.status == "active"

    @property
    def succeeded(self) -> bool:
        """Whether it is done."""
        return self.status == "succeeded"

    @property
    def failed(self) -> bool:
        """Whether it was aborted or rejected, or is lost."""
        return self.status in FAILURES

    def __str__(self) -> str:
        """Return the status with its reason; nothing if nothing is asked for."""
        return ": ".join(filter(None, (self.status, self.reason)))


_NOTHING = TaskState()
_CALLING = 0.5  # wall seconds that the calls of the last actions of a run may take together
_PATIENCE = 10.0  # wall seconds that a request waits for the one before it to begin
_MEMBERS = {
    "status": ("str", "None, active, succeeded, aborted, rejected, cancelled or lost"),
    "active": ("bool", "whether it goes on"),
    "succeeded": ("bool", "whether it is done"),
    "failed": ("bool", "whether it was aborted or rejected, or is lost"),
    "feedback": ("", "what it has reported last; None before"),
    "result": ("", "what it has returned; None before"),
    "reason": ("str", "why it has this status, a sentence; may be empty"),
    "since": ("float", "for how many seconds it has this status; 0 without one"),
}
"""What a program can read of a task, by name, with types and descriptions."""

_CANCELS = ("cancel", "stop", "abort", "end")
_CANCELLED = " It is cancelled when the state is left that asked for it, or when `running` no longer asks."


class Asker(NamedTuple):
    """Who asks for a task.

    `machine`: the instance whose state asks, by its path; None: a person.
    `action`: the kind of the action: ``running``, ``onentry``, …
    """

    machine: tuple[str, ...] | None = None
    action: str = ""


@dataclass(frozen=True, slots=True)
class Asked:
    """A request: `number` identifies it, `arguments` are those after limits.

    `stays`: how many times its machine may still leave a state: one, if an effect has asked for it.
    `at`: the time of the tick that asked for it last.
    `is_void`: whether asking again with the same arguments begins another one: it was ended from outside.
    """

    number: int
    arguments: Mapping[str, Any]
    asker: Asker
    stays: int
    at: float
    state: TaskState
    is_void: bool = False
    task: Task | None = field(default=None, repr=False, compare=False)  # of its bridge, if it was begun


class _Told(NamedTuple):
    """What is to be latched about the request with a number."""

    number: int
    state: TaskState
    is_void: bool = False


class TasksMoment(NamedTuple):
    """All requests by the names of their tasks, how many there were, and what is not latched yet."""

    requests: Mapping[str, Asked] = MappingProxyType({})
    asked: int = 0
    told: Mapping[str, _Told] = MappingProxyType({})


class Task:
    """A task under way, for the author of a bridge: `start` and `cancel` are called with it.

    Attributes
    ----------
    name : str
        Of the member.
    number : int
        Identifies the request among those of the bridge.
    replaced : Task or None
        The one that this one replaces, if `start` has to end it: see `add_task`.
    """

    def __init__(self, tasks: Tasks, name: str, number: int, replaced: Task | None) -> None:
        self._tasks, self.name, self.number, self.replaced = tasks, name, number, replaced
        self.has_begun = False  # whether the robot may know of it
        self.is_over = False  # as its bridge has told
        self.thread: threading.Thread | None = None  # that begins it, where `start` may wait

    def belongs_to(self, tasks: Tasks) -> bool:
        """Return whether it is one of these, and not of the robot from which a fork came."""
        return self._tasks is tasks

    @property
    def is_wanted(self) -> bool:
        """Whether it is neither over nor cancelled nor replaced; a `start` that waits looks at it."""
        return self._tasks.is_wanted(self)

    def update(
        self, status: TaskStatus = "active", feedback: object = None, result: object = None, reason: str = ""
    ) -> None:
        """Tell what is known of the task; from any thread.

        Once it is over or not wanted any more, the call does nothing: late and double answers change nothing.

        Parameters
        ----------
        status : {"active", "succeeded", "aborted", "rejected", "cancelled", "lost"}
        feedback, result : object
            Immutable values; None: nothing new.
        reason : str
            For the user: why, a sentence.

        Raises
        ------
        ValueError
            There is no such status.
        """
        if status not in STATUSES:
            raise ValueError(f"A task has no status {status!r}.{did_you_mean(str(status), STATUSES)}")
        self._tasks.tell(self, TaskState(status, feedback, result, reason))


@dataclass(slots=True)
class TaskWork:
    """What a bridge does for a task; see `Interface.add_task`."""

    start: Callable[..., object]
    cancel: Callable[[Task], object] | None
    check: Callable[..., object] | None
    moves: bool
    replaces: bool
    mover: str | None


class RobotTask(RobotMethod):
    """A member that asks the robot for a task, and shows what has become of it."""

    __slots__ = ("tasks", "work")

    tasks: Tasks
    work: TaskWork

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):  # copy, pickle and notebooks ask for these
            raise MemberError(f"A task of `robot` has no `{name}`.")
        state = self.tasks.state(self.path)
        if name == "since":
            return 0.0 if state.status is None else max(0.0, self.tasks.now - state.at)
        if name in _MEMBERS:
            return getattr(state, name)
        listed = ", ".join(f"`{each}`" for each in _MEMBERS)
        hint = _CANCELLED if name in _CANCELS else did_you_mean(name, _MEMBERS)
        error = MemberError(f"`robot.{self.path}` has no `{name}`; it has {listed}.{hint}")
        error.missing = f"{self.path}.{name}"
        raise error

    def __setattr__(self, name: str, value: object) -> None:
        if name in _MEMBERS:
            raise MemberError(f"`robot.{self.path}.{name}` is read from the robot and cannot be assigned.")
        object.__setattr__(self, name, value)

    def __dir__(self) -> list[str]:
        return sorted(_MEMBERS)

    def _not_a_value(self) -> str:
        path = f"robot.{self.path}"
        return f"`{path}` is a task, not a value. Its outcome is `{path}.succeeded` or `{path}.failed`."

    def perform(self, command: Command) -> object:
        """Ask for it; BridgeError: it cannot be asked for now."""
        if self._redirected is not None:
            return self._redirected(command)
        self.tasks.ask(self, command)
        return None

    def inert(self, bridge: MemberOwner) -> Self:
        """Return the same task of another bridge, which can be asked for and never begins."""
        made = super().inert(bridge)
        made.work = replace(self.work, start=lambda *_, **__: None, cancel=None, check=None)
        return made

    def check(self, arguments: Mapping[str, object]) -> None:
        """Raise BridgeError if the bridge refuses what is asked for."""
        if self.work.check is not None:
            try:
                self.work.check(**arguments)
            except ValueError as error:
                raise BridgeError(f"`robot.{self.path}`: {error}") from None

    def begin(self, task: Task, command: Command) -> None:
        """Have the robot begin a task."""
        if isinstance(command, Message):
            self.work.start(task, command)
        else:
            self.work.start(task, *command.args, **command.kwargs)

    def describe(self) -> Member:
        """Return the description, with what can be read of it and its present values."""
        fields = [
            Member(f"{self.path}.{name}", "variable", kind, "", doc, value=getattr(self, name))
            for name, (kind, doc) in _MEMBERS.items()
        ]
        return replace(
            super().describe(), kind="task", value=self.tasks.state(self.path), fields=tuple(fields)
        )


class Tasks:
    """The requests of one robot.

    `asker`: returns who is asking.
    `changed`: called with the name of each task that has another status in the tick that begins, and its
        state.
    `recorded`: returns what was recorded of a task for the tick that begins; None: nothing is recorded.
    """

    def __init__(self, owner: MemberOwner) -> None:
        self._owner = owner
        self._changing = threading.RLock()
        self._changed = threading.Condition(self._changing)  # what is wanted, or whose turn it is to begin
        self._moment = TasksMoment()
        self._under_way: dict[str, tuple[RobotTask, Task]] = {}
        self._turns: dict[str, list[Task]] = {}  # of each member: the one that begins, then those that wait
        self.asker: Callable[[], Asker] = Asker
        self.changed: Callable[[str, TaskState], object] = lambda name, state: None
        self.recorded: Callable[[str], TaskState | None] | None = None

    @property
    def now(self) -> float:
        """The time of the tick, in seconds of the run."""
        return self._owner.safety.now

    @property
    def moment(self) -> TasksMoment:
        """All that is known of the requests; setting it returns to what was known then."""
        return self._moment

    @moment.setter
    def moment(self, moment: TasksMoment) -> None:
        with self._changing:
            self._moment, self._under_way = moment, {}
            self._changed.notify_all()
            for name, asked in moment.requests.items():
                member = self._owner.nodes.table.get(name)
                if asked.state.active and isinstance(member, RobotTask):
                    task = asked.task
                    if task is None or not task.belongs_to(self):
                        task = Task(self, name, asked.number, None)
                    task.has_begun, task.is_over = True, False
                    self._under_way[name] = member, task

    def go_back(self, moment: TasksMoment) -> None:
        """Return to what was known then, if the robot's world has; else cancel and forget everything."""
        if self._owner.has_world:
            self.moment = moment
        else:
            self.drop()

    @property
    def states(self) -> dict[str, TaskState]:
        """The states of all that is asked for, by the names of the tasks."""
        requests = self._moment.requests
        return {name: asked.state for name, asked in requests.items()} if requests else {}

    def state(self, name: str) -> TaskState:
        """Return the state of a task."""
        asked = self._moment.requests.get(name)
        return _NOTHING if asked is None else asked.state

    # -- asking, on the interpreter's thread ------------------------------------------------------

    def ask(self, member: RobotTask, command: Command, lost: str = "") -> None:
        """Ask for a task; `lost`: why the robot cannot be reached."""
        asker = self.asker()
        arguments = arguments_of(command)
        name, now, before = member.path, self.now, self._asked(member.path)
        stays = int(asker.action == "effect")
        if before is not None:
            first, is_active = before.asker.machine, before.state.active
            is_old = (first, before.stays) == (asker.machine, stays)
            goes_on = is_active or (first is not None and not before.is_void)
            if is_old and goes_on and are_same(before.arguments, arguments):
                self._put(name, replace(before, asker=asker, at=now))
                return
            is_new = before.state.at == now and not before.is_void  # for the machine that waits for it
            if first is not None and asker.machine not in (None, first) and (is_active or is_new):
                how, who = "is under way" if is_active else "has ended in this tick", "/".join(first)
                raise BridgeError(f"`robot.{name}` {how} for `{who}`, which asked for it first.")
            if is_active and not is_old:  # of another visit or person: it is not that one with another goal
                self._cancel(name)
        state = TaskState("lost", reason=lost, at=now) if lost else TaskState("active", at=now)
        number = self._moment.asked + 1
        if isinstance(command, Message):
            command = copy(command)
        else:
            command = inspect.BoundArguments(command.signature, kept(command.arguments))
        asked = Asked(number, arguments_of(command), asker, stays, now, state, is_void=bool(lost))
        if lost:
            self._cancel(name)
            self._put(name, asked)
        else:
            self._start(member, command, asked)

    def _asked(self, name: str) -> Asked | None:
        """Return the request of a name: one that a stop has ended is void before the next tick says so."""
        with self._changing:
            asked, told = self._moment.requests.get(name), self._moment.told.get(name)
        return asked if asked is None or told is None or not told.is_void else self._known(asked, told)

    def _known(self, asked: Asked, told: _Told) -> Asked:
        """Return a request when what was told of it is known."""
        if told.number != asked.number or not asked.state.active:
            return asked
        at = asked.state.at if told.state.active else self.now
        state = asked.state.after(told.state)._replace(at=at)
        return replace(asked, state=state, is_void=told.is_void)

    def _start(self, member: RobotTask, command: Command, asked: Asked) -> None:
        name, old = member.path, self._under_way.get(member.path)
        if old is not None and not member.work.replaces:
            self._cancel(name)
            old = None
        task = Task(self, name, asked.number, None if old is None else old[1])
        with self._changing:
            self._put(name, replace(asked, task=task))
            self._under_way = {**self._under_way, name: (member, task)}
            self._turns.setdefault(name, []).append(task)
            self._changed.notify_all()
        begin = partial(self._begin, member, task, command)
        if self._owner.has_world:
            begin()
        else:
            task.thread = threading.Thread(target=begin, name=f"task {name}", daemon=True)
            task.thread.start()

    def _begin(self, member: RobotTask, task: Task, command: Command) -> None:
        is_call, turns = member.work.cancel is None, self._turns[task.name]

        def is_due() -> bool:  # a call is made, whoever waits for it
            return is_call or task.is_wanted

        with self._changed:  # what the one before begins, or its second end, comes before this
            self._changed.wait_for(lambda: turns[0] is task or not is_due(), _PATIENCE)
            task.has_begun, is_late = is_due() and turns[0] is task, is_due() and turns[0] is not task
        try:
            if task.has_begun:
                member.begin(task, command)
            elif is_late:
                raise BridgeError(f"The bridge was still beginning the one before it after {_PATIENCE:g} s.")
        except BaseException as error:  # of a library
            task.update("aborted", reason=ended(sentence_of(error)))
            if task.is_over:
                task.has_begun = False
            if self._owner.has_world and not isinstance(error, Exception):
                raise  # it is the interpreter's thread that is interrupted
        finally:
            # the robot may have heard the end before the beginning, and goes on with what is not replaced
            if not (task.has_begun and (task.is_wanted or task.is_over)):
                self._end_or_say(member, task)
            task.replaced = None
            with self._changed:
                turns.remove(task)
                self._changed.notify_all()

    def _put(self, name: str, asked: Asked) -> None:
        with self._changing:
            requests, count = {**self._moment.requests, name: asked}, max(self._moment.asked, asked.number)
            self._moment = self._moment._replace(requests=requests, asked=count)

    # -- what becomes of it -----------------------------------------------------------------------

    def is_wanted(self, task: Task) -> bool:
        """Return whether a task is neither over nor cancelled nor replaced."""
        under_way = self._under_way.get(task.name)
        return under_way is not None and under_way[1] is task

    def tell(self, task: Task, state: TaskState) -> None:
        """Note what is known of a task; from any thread."""
        with self._changing:
            if self.is_wanted(task):
                if not state.active:
                    task.is_over = True
                    self._forget(task.name)
                self._tell(task.name, _Told(task.number, state))

    def _tell(self, name: str, told: _Told) -> None:
        with self._changing:
            before = self._moment.told.get(name)
            if before is not None and before.number == told.number:
                if not before.state.active:  # the first end counts
                    return
                told = told._replace(state=before.state.after(told.state))
            self._moment = self._moment._replace(told={**self._moment.told, name: told})

    def _forget(self, name: str) -> None:
        with self._changing:  # and never while the robot is told: what it answers waits for this lock
            self._under_way = {other: each for other, each in self._under_way.items() if other != name}
            self._changed.notify_all()
        self._owner.safety.drive(name, False)

    def latch(self) -> Mapping[str, TaskState]:
        """Let the tick that begins see what is known; return the states of all requests by their names."""
        if not (self._moment.requests or self._moment.told):
            return {}
        with self._changing:
            before, _, told = self._moment
            self._moment = self._moment._replace(told={})
        for name, each in told.items():
            if (asked := before.get(name)) is not None:
                self._put(name, self._known(asked, each))
        if self.recorded is not None:
            for name, asked in self._moment.requests.items():
                if (recorded := self.recorded(name)) is not None:
                    self._put(name, replace(asked, state=recorded))
        states = self.states
        for name, state in states.items():
            if state.status != before[name].state.status:
                self.changed(name, state)
        return states

    # -- the end of requests ----------------------------------------------------------------------

    def left(self, machine: tuple[str, ...]) -> None:
        """Cancel and forget what the state asked for that a machine has left, and outcomes by hand."""
        for name, asked in self._moment.requests.items():
            if asked.asker.machine is None and not asked.state.active:
                self._drop(name)  # the state that is entered may ask for the same
            elif asked.asker.machine == machine:
                if asked.stays:
                    self._put(name, replace(asked, stays=asked.stays - 1))
                else:
                    self._drop(name)

    def renamed(self, machines: Mapping[tuple[str, ...], tuple[str, ...]]) -> None:
        """Follow machines to their new paths."""
        for name, asked in self._moment.requests.items():
            if (now := machines.get(asked.asker.machine or ())) is not None:
                self._put(name, replace(asked, asker=asked.asker._replace(machine=now)))

    def end_tick(self) -> None:
        """Cancel what was asked for in every tick and is not in this one; the next tick sees that."""
        for name, asked in self._moment.requests.items():
            if asked.asker.action == "running" and asked.state.active and asked.at != self.now:
                self._cancel(name)
                state = TaskState("cancelled", reason="It is no longer asked for.")
                self._tell(name, _Told(asked.number, state, is_void=True))

    def finish_calls(self) -> None:
        """Wait, for a moment, until what cannot be cancelled has reached the robot: the run ends."""
        until = monotonic() + _CALLING
        for member, task in tuple(self._under_way.values()):
            if member.work.cancel is None and task.thread is not None:
                task.thread.join(max(0.0, until - monotonic()))

    def drop(self) -> None:
        """Cancel and forget everything: the program begins again, or the robot is gone."""
        for name in tuple(self._moment.requests):
            self._drop(name)

    def stop(self, only: Collection[str] | None = None) -> None:
        """Cancel all tasks, or those of some names; the next tick sees that. From any thread.

        Raises what `cancel` raises, when all are cancelled.
        """
        why, failures = self._owner.safety.lost, []
        over = (
            TaskState("lost", reason=why) if why else TaskState("cancelled", reason="The robot was stopped.")
        )
        with self._changing:
            before = self._under_way
            under_way = {name: each for name, each in before.items() if only is None or name in only}
            self._under_way = {name: each for name, each in before.items() if name not in under_way}
            self._changed.notify_all()
            for name, asked in self._moment.requests.items():
                if asked.state.active and (only is None or name in only):
                    self._tell(name, _Told(asked.number, over, is_void=True))
        for member, task in under_way.values():
            try:
                self._end(member, task)
            except Exception as error:  # of a library: the others are to be cancelled all the same
                failures.append(error)
        if failures:
            raise failures[0]

    def entered(self) -> dict[str, str]:
        """Return the tasks under way that no tick asks for again, for the log of what a stop has ended."""
        return {
            name: asked.asker.action
            for name, asked in self._moment.requests.items()
            if asked.state.active and asked.asker.action not in ("running", "")
        }

    @property
    def under_way(self) -> tuple[Task, ...]:
        """The tasks that are not over."""
        return tuple(task for _, task in self._under_way.values())

    def moving(self) -> tuple[str, ...]:
        """Return the tasks under way by which something moves."""
        return tuple(name for name, (member, _) in self._under_way.items() if member.work.moves)

    def _drop(self, name: str) -> None:
        self._cancel(name)
        with self._changing:
            others = {other: each for other, each in self._moment.requests.items() if other != name}
            self._moment = self._moment._replace(requests=others)

    def _cancel(self, name: str) -> None:
        under_way = self._under_way.get(name)
        if under_way is None:
            return
        self._forget(name)
        self._end_or_say(*under_way)

    def _end_or_say(self, member: RobotTask, task: Task) -> None:
        try:
            self._end(member, task)
        except Exception as error:
            self._owner.safety.notice("fault", f"`robot.{task.name}` may go on: {sentence_of(error)}")

    def _end(self, member: RobotTask, task: Task) -> None:
        if member.work.cancel is None:
            return
        if task.has_begun:
            member.work.cancel(task)
        elif task.replaced is not None:  # it goes on: what would have ended it will not begin
            replaced, task.replaced = task.replaced, None
            self._end(member, replaced)


def arguments_of(command: Command) -> dict[str, Any]:
    """Return the arguments of a command, with the defaults of those that were not given."""
    if isinstance(command, Message):
        return command.as_dict()
    complete = inspect.BoundArguments(command.signature, command.arguments.copy())
    complete.apply_defaults()
    return dict(complete.arguments)
