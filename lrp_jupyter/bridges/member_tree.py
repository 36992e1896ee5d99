"""The members of a robot: readings, methods, and the tree of their names.

Owner: the interpreter's thread. Other threads may read: the table of members is never changed in
place, a new one replaces it. They may also add and remove, one after the other.
"""

from __future__ import annotations

import inspect
import keyword
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from types import TracebackType
from typing import NamedTuple, NoReturn, Protocol, Self

from lrp_jupyter.bridges.guarding.safety import Safety
from lrp_jupyter.bridges.members import Member, MemberError, age_text, describe_value, signature_text
from lrp_jupyter.bridges.message import Message, real_number
from lrp_jupyter.errors import BridgeError, LRPError, NoDataYet, NotAValue, StaleData, did_you_mean

_EXAMPLES: Mapping[type, str] = {float: "0.2", int: "1", bool: "True", str: "'text'"}  # in sentences

Limits = Mapping[str, float | tuple[float, float]]


class MemberOwner(Protocol):
    """What members need to know of their bridge; see `Interface`."""

    latch: int
    safety: Safety
    readings: dict[str, object]
    nodes: Nodes

    @property
    def name(self) -> str:
        """Name of the bridge, for messages."""

    @property
    def has_world(self) -> bool:
        """Whether its robot is in a world whose past can be restored."""

    def send(self, method: RobotMethod, command: Message | inspect.BoundArguments) -> object:
        """Pass a command through the safety and, if it allows, perform it."""


class AgeLimit(NamedTuple):
    """The seconds after which a reading is too old to act on; None: never.

    `measured`: how it was found out, and how it is switched off, in sentences; empty if it was given. It
    counts for readings that the program has used.
    """

    seconds: float | None
    measured: str = ""


class RobotVariable:
    """A reading: read at most once in a tick, so that one tick sees one world.

    Owner: the interpreter's thread; other threads may read `value` and `arrived`.

    `limit`: the age from which on it is too old to act on, or what returns that.
    `is_used`: whether a program has read it.
    `lateness`: why the robot must not drive on this reading in the present tick; empty if it may.
    `of`: the path of the reading that it accompanies (``light.new``: ``light.data``); empty if it is one.
    `limits`: its least and greatest value, besides ``inf``; None if they are not known.
    """

    limits: tuple[float, float] | None = None

    def __init__(
        self,
        bridge: MemberOwner,
        path: str,
        getter: Callable[[], object],
        doc: str,
        unit: str,
        type_: type | str | None,
        age: Callable[[], float | None] | None,
        limit: float | Callable[[], AgeLimit] | None = None,
        of: str = "",
    ) -> None:
        if limit is not None and age is None:
            raise ValueError(f"`{path}`: `stale_after` needs an `age`; or `feed` the values.")
        if not (limit is None or callable(limit) or limit > 0):
            raise ValueError(f"`{path}`: `stale_after` is a number of seconds above 0, or None: never.")
        self._bridge, self.path, self.getter, self._age, self.of = bridge, path, getter, age, of
        self.is_timed, self.lateness = limit is not None, ""
        self._limit = limit if callable(limit) else partial(AgeLimit, limit)
        self.is_used = False  # whether a program has read it
        self._waiting_since: float | None = None
        self.doc, self.unit, self.type = doc, unit, type_
        self.value: object = None
        self.arrived: float | None = None
        self._seen = self._judged = -1  # the ticks in which it was read, and judged, last
        self._failure: LRPError | None = None

    def read(self) -> object:
        """Return the reading of this tick; the getter is called at most once in a tick.

        Raises NoDataYet: nothing has arrived yet (the getter raised it, or returned None).
        Raises StaleData: what arrived last is older than `stale_after`.
        Raises BridgeError: the robot could not be read.
        """
        tick = self._bridge.latch
        if tick != self._seen or tick == 0:
            self._seen = tick
            self.is_used |= tick > 0
            self._failure = None
            try:
                value = self.getter()
            except NoDataYet as error:
                value = None
                self._failure = error if str(error) else None
            except BridgeError as error:
                self._failure = error
            except Exception as error:
                self._failure = BridgeError(f"`robot.{self.path}` could not be read: {_sentence(error)}")
                self._failure.__cause__ = error
            if self._failure is None:
                if value is None:
                    self._failure = NoDataYet(f"`robot.{self.path}` has no data yet.")
                elif self.is_timed and (
                    late := self.lateness if tick and tick == self._judged else self.judge()
                ):
                    self._failure = StaleData(late)
                else:
                    self.value, self.arrived = value, self._bridge.safety.now
            if tick:
                self._bridge.readings[self.path] = self.value if self._failure is None else self._failure
        if self._failure is not None:
            raise self._failure.with_traceback(None)
        return self.value

    @property
    def knows_age(self) -> bool:
        """Whether the bridge says how old it is; if not, its age is the time since it was read."""
        return self._age is not None

    @property
    def stale_after(self) -> float | None:
        """The seconds after which a reading is too old to act on, now; None: never."""
        return self._limit().seconds

    @property
    def is_stale(self) -> bool:
        """Whether its last value is too old to act on, now."""
        age, most = self.age(), self.stale_after
        return most is not None and age is not None and age > most

    def judge(self) -> str:
        """Return, and keep for the tick, why the robot must not drive on this reading; empty if it may.

        That the first value is awaited is no reason before it has been for `stale_after` seconds of the run.
        """
        age, (most, measured), now = self.age(), self._limit(), self._bridge.safety.now
        self.lateness = ""
        if measured and not self.is_used:
            return ""
        self._judged = self._bridge.latch
        if most is None:
            return ""
        if age is None:
            if self._waiting_since is None or now < self._waiting_since:  # another run has begun
                self._waiting_since = now
            if now - self._waiting_since > most:
                self.lateness = f"`robot.{self.path}`: nothing has arrived yet."
        else:
            self._waiting_since = None
            if age > most:
                self.lateness = f"`robot.{self.path}` is stale: its value is {age_text(age)} old."
        if self.lateness and measured:
            self.lateness += f" {measured}"
        return self.lateness

    def age(self) -> float | None:
        """Seconds since the reading arrived; None before the first."""
        if self._age is not None:
            return self._age()
        return None if self.arrived is None else max(0.0, self._bridge.safety.now - self.arrived)

    def describe(self) -> Member:
        """Return the description with the last reading, without reading."""
        value, kind = self.value, self.type
        if kind is None:
            kind = "" if value is None else type(value).__name__
        text = kind if isinstance(kind, str) else kind.__name__
        member = Member(
            self.path, "variable", text, self.unit, self.doc, self.age(), value, stale=self.is_stale
        )
        return describe_value(member, self.type)


class RobotMethod(NotAValue):
    """A method of the robot. A command among them passes the bridge's safety.

    ``robot.move(...)`` sends; ``with robot.move as msg:`` fills a message and sends it at the end,
    unless the block fails.
    """

    # fmt: off
    __slots__ = ("_bridge", "_filling", "_function", "_parameters", "_redirected", "command", "doc", "likely",
                 "limits", "message", "mover", "path", "signature", "units", "velocity")
    # fmt: on

    def __init__(
        self,
        bridge: MemberOwner,
        path: str,
        function: Callable[..., object],
        doc: str,
        message: type[Message] | None,
        command: bool,
        velocity: bool,
        limits: Limits,
        mover: str = "",
    ) -> None:
        self._bridge, self.path, self._function = bridge, path, function
        self.doc = doc
        self.message, self.command, self.velocity, self.mover = message, command, velocity, mover
        self.limits = {name: _range(limit) for name, limit in limits.items()}
        self.likely: Mapping[str, tuple[float, float]] = {}  # where a number beyond is probably a mistake
        self.units: Mapping[str, str] = message.UNITS if message is not None else {}
        self._parameters = _signature(function)
        if message is not None:
            self.signature = f"({', '.join(f'{name}=0.0' for name in message.WORDS or message.FIELDS)})"
        else:
            self.signature = signature_text(self._parameters)
        self._filling: list[Message] = []
        self._redirected: Callable[[Message | inspect.BoundArguments], object] | None = None

    def __call__(self, *args: object, **kwargs: object) -> object:
        """Check the arguments, and send them if the bridge's safety allows it."""
        if self.message is not None:
            return self._bridge.send(self, self._fill(self.message, args, kwargs))
        return self._bridge.send(self, self.bind(args, kwargs))

    def __enter__(self) -> Message:
        if self.message is None:
            raise BridgeError(
                f"`robot.{self.path}` does not accept a message. "
                f"Call it as `robot.{self.path}{self.signature}`."
            )
        self._filling.append(self.message())
        return self._filling[-1]

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        message = self._filling.pop()
        if kind is None:
            self._bridge.send(self, message)

    def _not_a_value(self) -> str:
        path = f"robot.{self.path}"
        return f"`{path}` is a method, not a value. Call it as `{path}{self.signature}`."

    def __getattr__(self, name: str) -> NoReturn:
        if name.startswith("_"):  # copy, pickle and notebooks ask for these
            raise MemberError(f"A method of `robot` has no `{name}`.")
        path = f"robot.{self.path}"
        raise MemberError(f"`{path}` is a method and has no `{name}`. Call it as `{path}{self.signature}`.")

    def __copy__(self) -> RobotMethod:
        return self

    def __deepcopy__(self, memo: object) -> RobotMethod:
        return self

    def __setattr__(self, name: str, value: object) -> None:
        if name not in RobotMethod.__slots__:
            self.__getattr__(name)
        object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        return f"<robot.{self.path}{self.signature}>"

    @property
    def sets_in_motion(self) -> bool:
        """Whether it is a command by which something moves until another one, or a stop."""
        return self.velocity or bool(self.mover)

    @property
    def parameters(self) -> tuple[inspect.Parameter, ...]:
        """The parameters of its function."""
        return tuple(self._parameters.parameters.values())

    def perform(self, command: Message | inspect.BoundArguments) -> object:
        """Perform a command that the safety allowed; raise its faults as BridgeError."""
        if self._redirected is not None:
            return self._redirected(command)
        try:
            if isinstance(command, Message):
                return self._function(command)
            return self._function(*command.args, **command.kwargs)
        except LRPError:
            raise
        except Exception as error:
            raise BridgeError(f"`robot.{self.path}` failed: {_sentence(error)}") from error

    def inert(self, bridge: MemberOwner) -> Self:
        """Return the same method of another bridge, which performs nothing."""
        made = object.__new__(type(self))
        for name in (name for kind in type(self).__mro__ for name in getattr(kind, "__slots__", ())):
            object.__setattr__(made, name, getattr(self, name))
        made._bridge, made._redirected, made._filling = bridge, lambda _: None, []
        return made

    def redirect(self, receive: Callable[[Message | inspect.BoundArguments], object]) -> None:
        """Redirect all later commands to `receive` instead of the robot (for tests)."""
        self._redirected = receive

    def standstill(self) -> Message | inspect.BoundArguments:
        """Return the command that stops: a message of zeros, or 0 for every argument without default."""
        if self.message is not None:
            return self.message()
        still = self._parameters.bind_partial()
        for parameter in self._parameters.parameters.values():
            is_variadic = parameter.kind in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD)
            if parameter.default is parameter.empty and not is_variadic:
                still.arguments[parameter.name] = 0.0
        return still

    def _fill(self, kind: type[Message], args: tuple[object, ...], kwargs: dict[str, object]) -> Message:
        message = kind()
        if len(args) > 1 or (args and kwargs):
            raise BridgeError(
                f"`robot.{self.path}` takes one block or message, or keyword arguments, "
                f"as in {self._example()}."
            )
        if args and isinstance(args[0], kind):
            for name in kind.FIELDS:
                setattr(message, name, getattr(args[0], name))
        elif args and callable(args[0]) and not isinstance(args[0], Message):
            args[0](message)
        elif args:
            raise BridgeError(
                f"`robot.{self.path}` does not accept {args[0]!r}. Call it like {self._example()}."
            )
        return message(**kwargs)

    def bind(self, args: tuple[object, ...], kwargs: dict[str, object]) -> inspect.BoundArguments:
        """Return arguments by the names of the parameters; BridgeError: they do not fit."""
        try:
            return self._parameters.bind(*args, **kwargs)
        except TypeError as error:
            names = self._parameters.parameters
            unknown = next((name for name in kwargs if name not in names), "")
            hint = did_you_mean(unknown, names) if unknown else ""
            raise BridgeError(f"`robot.{self.path}{self.signature}`: {error}.{hint}") from None

    def _example(self) -> str:
        """Return a call with a field that it has: one with a limit or a short form, or the first."""
        assert self.message is not None
        paths = sorted(self.message.paths(), key=lambda path: "header" in path)
        name = next(iter((*self.limits, *self.message.WORDS, *paths)), None)
        if name is None:
            return f"`robot.{self.path}()`"
        value = _EXAMPLES.get(type(self.message().get(name)), "[]")
        return f"`robot.{self.path}({name.replace('.', '_')}={value})`"

    def describe(self) -> Member:
        """Return the description."""
        arguments = self.message.describe(self.path) if self.message is not None else ()
        return Member(self.path, "method", doc=self.doc, signature=self.signature, arguments=arguments)

    def clamp(self, command: Message | inspect.BoundArguments) -> dict[str, str]:
        """Clamp a command to the limits in place; return a sentence for each number that was clamped.

        They are found by the name of the number and its limit.
        """
        sentences = {}
        for name, (low, high) in self.limits.items():
            if isinstance(command, Message):
                value = command.get(name)
            elif name in command.arguments:
                value = real_number(command.arguments[name], f"{self.path}({name}=…)")
            else:
                continue
            allowed = min(max(value, low), high)
            if allowed == value:
                continue
            if isinstance(command, Message):
                command.set(name, allowed)
            else:
                command.arguments[name] = allowed
            sentences[f"{name} {allowed:g}"] = f"`{self.path}`: {name} {value:g} limited to {allowed:g}."
        return sentences


class Nodes:
    """The members of a bridge by their dotted names; parts (``light``) come and go with them.

    `make_part`: returns the object that a program gets for a name with members of its own.
    """

    def __init__(self, make_part: Callable[[str], object]) -> None:
        self._make_part = make_part
        self._changing = threading.RLock()
        self.table: Mapping[str, object] = {}  # members and parts, by their paths
        self.timed: tuple[RobotVariable, ...] = ()  # the readings that can become stale

    def add(self, node: RobotVariable | RobotMethod, companions: Iterable[RobotVariable] = ()) -> None:
        """Add a member; one of the same name is replaced. Other members are preferred to its companions."""
        name = node.path
        for word in name.split("."):
            if not word.isidentifier() or keyword.iskeyword(word) or word.startswith("_"):
                raise ValueError(f"`{name}` is not a valid name for a member of `robot`.")
        with self._changing:
            table = {path: each for path, each in self.table.items() if _accompanied(each) != name}
            if not isinstance(table.get(name, node), (RobotVariable, RobotMethod)):
                raise ValueError(f"`{name}` has members of its own and cannot be a member itself.")
            parts = [name[:i] for i, character in enumerate(name) if character == "."]
            for part in () if _accompanied(node) else parts:  # a companion may be below its reading
                if part not in table or _accompanied(table[part]):
                    table[part] = self._make_part(part)
                elif isinstance(table[part], (RobotVariable, RobotMethod)):
                    raise ValueError(f"`{part}` is already a member and cannot have members of its own.")
            table[name] = node
            for each in companions:
                table.setdefault(each.path, each)
            self._replace(table)

    def accompany(self, name: str, companion: RobotVariable) -> None:
        """Add what is known of a member beside it."""
        with self._changing:
            self._replace({**self.table, companion.path: companion})

    def _replace(self, table: Mapping[str, object]) -> None:
        nodes = table.values()
        self.timed = tuple(node for node in nodes if isinstance(node, RobotVariable) and node.is_timed)
        self.table = table

    def remove(self, name: str) -> None:
        """Remove a member, or a part with all its members."""
        with self._changing:
            if name not in self.table:
                raise MemberError(f"There is no member `{name}` to remove.{did_you_mean(name, self.table)}")
            gone = f"{name}."
            left = [
                f"{node.path}."
                for node in self.members()
                if not (f"{node.path}.".startswith(gone) or f"{_accompanied(node)}.".startswith(gone))
            ]
            kept = [path for path in self.table if any(each.startswith(f"{path}.") for each in left)]
            self._replace({path: self.table[path] for path in kept})

    def clear(self) -> None:
        """Remove all members."""
        with self._changing:
            self._replace({})

    def members(self) -> Iterator[RobotVariable | RobotMethod]:
        """Iterate over the members in the order of their registration."""
        return (node for node in self.table.values() if isinstance(node, (RobotVariable, RobotMethod)))

    def describe(self, path: str) -> Member:
        """Describe a member, a part, or a field of a reading."""
        node = self.table.get(path)
        if isinstance(node, (RobotVariable, RobotMethod)):
            beside = (each for each in self.members() if _accompanied(each) == path)
            below = [each.describe() for each in beside if each.path.startswith(f"{path}.")]
            member = node.describe()
            return replace(member, fields=(*member.fields, *below)) if below else member
        if node is not None:
            inside = (member for member in self.members() if member.path.startswith(f"{path}."))
            return Member(path, "part", fields=tuple(member.describe() for member in inside))
        parent, _, name = path.rpartition(".")
        fields = self.describe(parent).fields if parent else ()
        for field in fields:
            if field.name == path:
                return field
        known = [field.name.rpartition(".")[2] for field in fields] if parent else list(self.table)
        what = f"robot.{parent}".rstrip(".")
        raise MemberError(f"`{what}` has no `{name}`.{did_you_mean(name, known)}")


def companion_path(path: str, word: str) -> str:
    """Return the path of a companion of a reading: ``light.new`` for ``light.data``, else below its own."""
    return f"{path.removesuffix('.data')}.{word}"


def _accompanied(node: object) -> str:
    return node.of if isinstance(node, RobotVariable) else ""


def _range(limit: float | tuple[float, float]) -> tuple[float, float]:
    low, high = limit if isinstance(limit, tuple) else (-limit, limit)
    if not low <= high:
        raise ValueError(f"A limit goes from the smaller to the larger number, not {limit!r}.")
    return low, high


def _signature(function: Callable[..., object]) -> inspect.Signature:
    try:
        return inspect.signature(function)
    except (TypeError, ValueError):  # some callables written in C have none
        return inspect.signature(lambda *args, **kwargs: None)


def _sentence(error: BaseException) -> str:
    return f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
