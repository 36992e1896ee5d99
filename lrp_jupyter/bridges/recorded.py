"""A robot that only repeats what another one read.

A run with a real robot cannot be repeated: its past is what was recorded. This bridge has the members of the
other one; its readings and the answers to its calls are those that it is given tick by tick, and its commands
are logged and go nowhere.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from inspect import Parameter, Signature
from typing import Any

from lrp_jupyter.bridges.argument_values import answer_to, is_told, kept
from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.member_tree import RobotMethod, RobotVariable
from lrp_jupyter.bridges.message import Message, Plain, real_number
from lrp_jupyter.bridges.tasks import Command, RobotTask, TaskState, arguments_of
from lrp_jupyter.errors import NoDataYet


class RecordedBridge(Bridge, offered=False):
    """A robot made of recorded readings."""

    name = "recorded"
    hardware = False
    has_world = True  # what is known of it can be restored
    stop_timeout = None

    def __init__(self, members: Iterable[RobotVariable | RobotMethod]) -> None:
        self.given: Mapping[str, object] = {}  # by path, for the next tick; an error where a reading failed
        self._recorded = tuple(members)
        self.requested.recorded = self._state

    def offer_stop(self) -> None:
        """Offer nothing that the recorded robot did not."""

    def add_members(self) -> None:
        """Add the members of the recorded robot."""
        for node in self._recorded:
            if isinstance(node, RobotVariable):
                read = partial(self._read, node.path)
                reading = RobotVariable(
                    self, node.path, read, node.doc, node.unit, node.type, None, None, node.of
                )
                self.nodes.add(reading)
            else:
                self._add_inert(node)

    def _add_inert(self, method: RobotMethod) -> None:
        made = method.inert(self)
        if isinstance(made, RobotTask):
            made.tasks = self.requested
        made.redirect(partial(self._answer, made))
        self.nodes.add(made)

    def become(self, members: Iterable[RobotVariable | RobotMethod]) -> None:
        """Have other members, as the recorded robot has them from now on."""
        self._recorded = tuple(members)
        self.nodes.clear()
        self.add_members()

    def open_interface(self) -> None:
        """Connect nothing."""

    def _state(self, path: str) -> TaskState | None:
        state = self.given.get(path)
        if state is None or isinstance(state, TaskState):
            return state
        return TaskState(*(getattr(state, name) for name in TaskState._fields))

    def _answer(self, method: RobotMethod, command: Command) -> object:
        given = self.given.get(f"{method.path}()") if self.latch else None
        number = len(self.answers.get(method.path, ()))
        answers = given if isinstance(given, list) else []
        first = answers[number : number + 1]
        told = answer_to(arguments_of(command), first if method.command else [*first, *answers])
        alone = (each for each in first if not is_told(each))  # an edited program may ask for other things
        answer = told[1] if told is not None else next(alone, None)
        if isinstance(answer, Exception):
            raise answer.with_traceback(None)
        if isinstance(method, RobotTask):
            self.requested.ask(method, command)
        return kept(answer)

    def _read(self, path: str) -> object:
        value = self.given.get(path)
        if isinstance(value, Exception):
            raise value
        if value is None:
            raise NoDataYet(f"`robot.{path}` was not read in this tick, so its value was not recorded.")
        return value


def recorded_members(
    descriptions: Iterable[Mapping[str, Any]], value_of: Callable[[Any], object]
) -> Iterator[RobotVariable | RobotMethod]:
    """Yield the members of a recorded robot; `value_of` reads recorded defaults of parameters and fields."""
    source = RecordedBridge(())  # only makes the members
    for each in descriptions:
        if each["kind"] == "variable":
            of = each.get("of", "")
            reading = RobotVariable(
                source, each["name"], lambda: None, each["doc"], each["unit"], None, None, None, of
            )
            source.nodes.add(reading)
            continue
        name, parameters = each["name"], each.get("parameters", _ANY)
        takes: dict[str, Any] = {
            "doc": each["doc"],
            "message": _message(each["message"], value_of) if each["message"] else None,
            "limits": {name: tuple(limit) for name, limit in each["limits"].items()},
        }
        if each["kind"] == "task":
            function = _function((_TASK, *parameters), value_of)
            source.add_task(name, function, moves=each["moves"], **takes)
        else:
            function = _function(parameters, value_of)
            source.add_method(name, function, command=each["command"], velocity=each["velocity"], **takes)
    yield from source.nodes.members()


_TASK = {"name": "task", "kind": "POSITIONAL_ONLY"}
_ANY = ({"name": "arguments", "kind": "VAR_POSITIONAL"}, {"name": "named", "kind": "VAR_KEYWORD"})


def _message(described: Mapping[str, Any], value_of: Callable[[Any], object]) -> type[Message]:
    """Return a class of messages, by its description."""
    fields = {
        name: _message(part, value_of)
        if "fields" in part
        else _plain(part["type"], value_of(part["default"]))
        for name, part in described["fields"].items()
    }
    members = {"__slots__": (), "FIELDS": fields, "WORDS": dict(described["words"])}
    members["OPTIONAL"] = tuple(described.get("optional", ()))
    return type(described["name"], (Message,), members)


def _plain(name: str, default: object) -> Plain:
    """Return a kind of field; what it makes of a value is known only by its default value."""

    def check(value: object, path: str) -> object:
        if isinstance(default, (int, float)) and not isinstance(default, bool):
            return type(default)(real_number(value, path))
        return tuple(value) if isinstance(default, tuple) and isinstance(value, list) else value

    return Plain(name, default, check)


def _function(
    parameters: Iterable[Mapping[str, Any]], value_of: Callable[[Any], object]
) -> Callable[..., object]:
    """Return a function that does nothing, with these parameters."""

    def function(*_arguments: object, **_named: object) -> None: ...

    made = [
        Parameter(
            each["name"],
            getattr(Parameter, each["kind"]),
            default=value_of(each["default"]) if "default" in each else Parameter.empty,
        )
        for each in parameters
    ]
    function.__signature__ = Signature(made)  # type: ignore[attr-defined]
    return function
