"""A robot for tests, with the members of another one and nothing behind them.

What it reads is set by the test, now or by a table over time; what it is commanded is kept.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from inspect import isroutine
from types import SimpleNamespace
from typing import Any, NamedTuple, Self

from lrp_jupyter.arguments import check_choice, check_number
from lrp_jupyter.bridges.argument_values import are_same
from lrp_jupyter.bridges.bridge import Bridge, MemberError
from lrp_jupyter.bridges.discovery import make_bridge
from lrp_jupyter.bridges.interface import read_now
from lrp_jupyter.bridges.member_tree import RobotMethod, RobotVariable, companion_path
from lrp_jupyter.bridges.recorded import RecordedBridge
from lrp_jupyter.bridges.tasks import STATUSES, Command, RobotTask, TaskStatus, arguments_of
from lrp_jupyter.errors import BridgeError, did_you_mean, ended
from lrp_jupyter.interpreter.rendering import short
from lrp_jupyter.live.why.wording import call_text, given_arguments, number_text

_ROUNDING = 1e-9  # s; 15 periods of 0.1 s are 1.5 s
Rows = Iterable[tuple[float, object]]


@dataclass(frozen=True, slots=True, repr=False)
class StubCommand:
    """A command that reached the robot; repeats in a row count as one.

    Parameters
    ----------
    time : float
        Seconds of the run, when it came first.
    name : str
        That of the method, such as ``"move"``.
    arguments : dict of str to object
        After limits; of a velocity those that are not 0, by their short names.
    last : float
        When it was repeated last.
    """

    time: float
    name: str
    arguments: dict[str, Any]
    last: float

    @property
    def call(self) -> str:
        """The call, as a program has it: ``robot.move(linear=0.2)``."""
        return call_text(self.name, self.arguments).strip("`")

    def __repr__(self) -> str:
        times = dict.fromkeys([self.time, self.last])
        return f"{' to '.join(f'{number_text(each)} s' for each in times)}: {self.call}"


class _End(NamedTuple):
    status: TaskStatus
    after: float
    result: object
    reason: str


class RobotStub(RecordedBridge, offered=False):
    """A robot with the members of another one, without hardware, network or world, for tests.

    Its readings are those that the test sets: ``robot["light.data"] = 20``. A reading that was not set has no
    data yet. What is set may be a value, a function of the time of the run in seconds, or an exception that
    reading it raises, such as :class:`~lrp_jupyter.errors.StaleData`; None takes the value away again. A
    message of ROS is given by its fields, ``{"ranges": [0.4]}``; the others are 0.

    Examples
    --------
    >>> robot = RobotStub.of("sim")
    >>> robot["bumper.data"] = True
    >>> robot["bumper.date"] = True
    Traceback (most recent call last):
    lrp_jupyter.bridges.members.MemberError: There is no reading `bumper.date`. Did you mean `bumper.data`?
    """

    name = "stub"

    def __init__(self, members: Iterable[RobotVariable | RobotMethod]) -> None:
        super().__init__(members)
        self.requested.recorded = None
        self.fed.clock = lambda: self.safety.now
        nodes = {node.path: node for node in self._recorded}
        self._methods = {path: node for path, node in nodes.items() if isinstance(node, RobotMethod)}
        self._variables = {path: node for path, node in nodes.items() if isinstance(node, RobotVariable)}
        self._settable = {
            path: node for path, node in self._variables.items() if node.of not in self._variables
        }
        self._sources: dict[str, Callable[[float, float], Iterable[object]]] = {}
        self._sensed = -math.inf  # s: the time of the last tick
        self._returns: dict[str, object] = {}
        self._ends: dict[str, _End] = {}
        self._commands: list[StubCommand] = []

    @classmethod
    def of(cls, bridge: str | type[Bridge] | Bridge, **options: Any) -> Self:
        """Return a robot with the members of a bridge, as far as they are known without a connection.

        Parameters
        ----------
        bridge : str, Bridge or subclass of Bridge
            As for a session: ``"sim"``, ``"ros"``, ``"ev3"``, …
        **options
            For the bridge: ``world="maze"``, ``setup="robot.json"``.

        Raises
        ------
        BridgeError
            There is no such bridge, it does not take these options, or it knows no member.
        """
        made = make_bridge(bridge, **options)
        made.alone = True
        complete = made.check_set_up()
        if not made.nodes.table:
            made.add_members()
        members = [*made.nodes.members()]
        if not members:
            raise BridgeError(
                f"The bridge `{made.name}` knows no member of `robot` without a connection. Pass an option "
                'that names them, such as `setup="robot.json"`. A bridge of your own adds them in '
                "`add_members`."
            )
        stub = cls(members)
        stub.complete = complete  # type: ignore[misc]
        return stub

    def __repr__(self) -> str:
        count = len(self._commands)
        return f"<{type(self).__name__}: {len(self._settable)} readings, {count} command{'s' * (count != 1)}>"

    # -- what the test says -----------------------------------------------------------------------

    def __setitem__(self, name: str, value: object) -> None:
        """Set a reading, from the next tick on."""
        path = self._reading(name).path
        self._sources.pop(path, None)
        if isroutine(value):
            self._sources[path] = lambda _, now: (self._made(name, value(now)),)
        else:
            self.fed.put(path, self._made(name, value), None)

    def set(self, readings: Mapping[str, object] | None = None, /, **named: object) -> None:
        """Set several readings, as ``robot[name] = value`` sets one."""
        for name, value in {**(readings or {}), **named}.items():
            self[name] = value

    def table(self, readings: Mapping[str, Rows]) -> None:
        """Set readings over time: each row is a second of the run and the value from then on.

        Several values between two ticks are several messages: ``robot.order.new`` has them all.
        """
        for name, rows in readings.items():
            path = self._reading(name).path
            for at, _ in (made := sorted(rows, key=lambda row: row[0])):
                check_number("seconds", at, "a number of seconds", least=0)
            values = [(at, self._made(name, value)) for at, value in made]
            self._sources[path] = partial(_rows, values)

    def returns(self, name: str, value: object) -> None:
        """Let a method return a value, or what a function of its arguments returns, or raise an exception."""
        self._method(name)
        self._returns[name] = value

    def ends(
        self,
        name: str,
        status: TaskStatus = "succeeded",
        *,
        after: float = 0.0,
        result: object = None,
        reason: str = "",
    ) -> None:
        """Let a task end whenever it is asked for; otherwise it goes on.

        Parameters
        ----------
        name : str
        status : {"succeeded", "aborted", "rejected", "cancelled", "lost"}
        after : float
            How many seconds after it was asked for; in the next tick at the earliest.
        result : object
        reason : str
        """
        if not isinstance(self._method(name), RobotTask):
            raise MemberError(f"`{name}` is a method that ends at once, not a task. Use `returns`.")
        check_choice("status", status, STATUSES)
        check_number("after", after, "a number of seconds", least=0)
        self._ends[name] = _End(status, after, result, reason)

    # -- what the robot was told ------------------------------------------------------------------

    @property
    def commands(self) -> list[StubCommand]:
        """What the robot was commanded, in order; what is repeated in a row is listed once."""
        return list(self._commands)

    def last(self, name: str) -> StubCommand | None:
        """Return the last command of a name; None if there was none."""
        self._method(name)
        return next((each for each in reversed(self._commands) if each.name == name), None)

    # -- inside -----------------------------------------------------------------------------------

    def _reading(self, name: str) -> RobotVariable:
        """Return the reading of a name, or the message of which it names a field."""
        if name in self._variables and name not in self._settable:
            of = self._variables[name].of
            raise MemberError(f"`{name}` follows from `{of}`. Set `{of}`.")
        for path, node in self._settable.items():
            if name == path or (name.startswith(f"{path}.") and _maker(node) is not None):
                return node
        if name in self._methods:
            raise MemberError(f"`{name}` is a method, not a reading. Use `returns` for what it returns.")
        raise MemberError(f"There is no reading `{name}`.{did_you_mean(name, self._settable)}")

    def _made(self, name: str, value: object) -> object:
        """Return the value of a reading; a message is given by its fields."""
        node = self._reading(name)
        for field in reversed(name.removeprefix(node.path).split(".")[1:]):
            value = {field: value}
        make = _maker(node)
        if make is None or not isinstance(value, Mapping):
            return value
        try:
            return make(value)
        except (AttributeError, TypeError, ValueError) as error:
            raise MemberError(f"`{node.path}` cannot be {short(value)}. {ended(str(error))}") from None

    def _method(self, name: str) -> RobotMethod | None:
        if name not in self._methods and name != "stop":  # which every robot has
            raise MemberError(f"There is no method `{name}`.{did_you_mean(name, self._methods)}")
        return self._methods.get(name)

    def add_members(self) -> None:
        """Add the members of the other robot."""
        for node in self._recorded:
            if isinstance(node, RobotMethod):
                self._add_inert(node)
            elif node.path in self._settable:
                self._add_settable(node)

    def _add_settable(self, node: RobotVariable) -> None:
        path, fed = node.path, node.knows_age
        age = partial(self.fed.age, path) if fed else None
        made = RobotVariable(
            self, path, partial(self._read, path), node.doc, node.unit, node.type, age, None, node.of
        )
        made.limits = node.limits
        if node.of:
            self.nodes.accompany(node.of, made)
            return
        words = [word for word in ("new", "age") if companion_path(path, word) in self._variables]
        new = partial(self._messages, path) if fed else partial(read_now, made)
        self._add_reading(made, new if "new" in words else None, {"new", "age"}.difference(words))

    def offer_stop(self) -> None:
        """Offer ``robot.stop()``, unless the other robot has its own."""
        super(RecordedBridge, self).offer_stop()

    def take_messages(self, readings: Iterable[str]) -> None:
        """Keep every message of these readings."""
        self.messages_taken = frozenset(readings)
        variables = self._variables.items()
        self.fed.hear([node.of for path, node in variables if path in self.messages_taken])

    def _messages(self, path: str) -> tuple[object, ...]:
        messages = self._new_messages(path, self.fed.of(path))
        return tuple(getattr(message, "_content", message) for message in messages)

    def _read(self, path: str) -> object:
        value = self.fed.value(path)
        if isinstance(value, Exception):
            raise value.with_traceback(None)
        return value

    def sense(self, now: float) -> None:
        """Let the readings of a tick arrive, and end the tasks that are due."""
        since = self._sensed if self._sensed <= now else -math.inf  # the run has begun again
        self._sensed = now
        for path, source in self._sources.items():
            for value in source(since, now):
                self.fed.put(path, value, None)
        for task in self.requested.under_way:
            end = self._ends.get(task.name)
            if end is not None and now >= self.requested.state(task.name).at + end.after - _ROUNDING:
                task.update(end.status, result=end.result, reason=end.reason)

    def stop(self) -> None:
        """Stop nothing: nothing moves."""

    def _stop_or_raise(self) -> None:
        self._note("stop", {})
        super()._stop_or_raise()

    def _answer(self, method: RobotMethod, command: Command) -> object:
        arguments = arguments_of(command)
        if method.command:
            self._note(method.path, given_arguments(arguments))
        owner, _, word = method.path.rpartition(".")
        if word == "stop":
            moving = self.requested.moving()
            self.requested.stop([each for each in moving if each.rpartition(".")[0] == owner])
        if isinstance(method, RobotTask):
            self.requested.ask(method, command)
        value = self._returns.get(method.path)
        if isinstance(value, Exception):
            raise value.with_traceback(None)
        return value(**arguments) if isroutine(value) else value

    def _note(self, name: str, arguments: dict[str, Any]) -> None:
        now, last = self.safety.now, self._commands[-1] if self._commands else None
        if last is not None and last.name == name and are_same(last.arguments, arguments):
            self._commands[-1] = StubCommand(last.time, name, arguments, now)
        else:
            self._commands.append(StubCommand(now, name, arguments, now))


def _maker(reading: RobotVariable) -> Callable[[Mapping[str, Any]], object] | None:
    """Return what makes a message of its fields; None if it is not a message."""
    is_unknown = isinstance(reading.type, str) and "/" in reading.type
    found: Callable[[Mapping[str, Any]], object] | None = getattr(reading.type, "_of_fields", None)
    return _namespace if is_unknown else found


def _namespace(fields: Mapping[str, Any]) -> SimpleNamespace:
    """Return a message of a type that is not known on this computer: with the fields that are given."""
    inside = {name: _namespace(each) if isinstance(each, Mapping) else each for name, each in fields.items()}
    return SimpleNamespace(**inside)


def _rows(rows: list[tuple[float, object]], since: float, now: float) -> Iterable[object]:
    """Return the values of the rows after a time, up to another one."""
    return [value for at, value in rows if since + _ROUNDING < at <= now + _ROUNDING]
