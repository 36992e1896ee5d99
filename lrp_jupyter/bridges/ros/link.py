"""The connections of a set-up, kept up by one thread over every loss of the robot.

The set-up lists the wanted connections; the link's thread compares them with the actual ones periodically.
All calls that may block happen on that thread: a dead master or server does not delay a program's loop. A
`Transport` communicates with ROS.

Paper: §7.1 (subscriptions are the bridge's, not the program's, so a restart makes no second one).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterable, Mapping
from contextlib import suppress
from typing import Any

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.link import Link
from lrp_jupyter.bridges.ros.channel import Channel
from lrp_jupyter.bridges.ros.clock import RobotClock, Stamps
from lrp_jupyter.bridges.ros.definitions import Definition, canonical, messages_of
from lrp_jupyter.bridges.ros.names import GraphNames
from lrp_jupyter.bridges.ros.outlets import Outlet
from lrp_jupyter.bridges.ros.parameters import ParameterValues
from lrp_jupyter.bridges.ros.ros_request import RosRequest, TaskClient
from lrp_jupyter.bridges.ros.setup import TASKS, Direction, article
from lrp_jupyter.bridges.ros.types import VELOCITIES, RosMessage, Types
from lrp_jupyter.errors import BridgeError, LRPError, NoAnswerError, did_you_mean, ended, most_similar

GUARD_NODE = "lrp_guard"
"""Name of the nodes that only stop a robot."""

SIM_TIME = "/use_sim_time"
"""Name of the parameter of ROS 1 that says that the time of all nodes is that of `/clock`."""

SLOW = 0.3
"""Round trip in seconds above which the link is reported as slow."""

_AGAIN = 0.5  # seconds until a connection that was lost, or a topic that is missing, is tried again
_ALIKE = 5  # topics that are looked at, where no node hears a velocity
_FAST = 0.2  # seconds of a round trip below which a link is no longer slow


Receive = Callable[..., None]
"""Takes a raw message, and when it arrived unless that is now."""


class RefusedError(BridgeError):
    """One topic cannot be connected; the others are not affected."""


class Transport(ABC):
    """A way to communicate with ROS: one connection at a time.

    All methods are called on the link's thread and may block, for a bounded time; `send` is called on any
    thread and must not block. A failure raises `BridgeError`, and `RefusedError` where only one topic is
    affected. What a back end cannot know (who else commands, the round trip, a hint) or do (actions and
    services) has a default.
    """

    place: str = ""  # address of the robot, for messages
    version: int = 2  # of ROS; 0 while it is not known
    has_tasks: bool = True  # whether it can reach actions, services and parameters
    period: float = 2.0  # seconds between two comparisons with the robot
    pace: float = 0.02  # seconds between two readings that the program can use; more of them may be dropped
    round_trip: float | None = None  # recent median of the seconds until a pong; None: it is not measured

    def __init__(self) -> None:
        self.names = GraphNames()  # of the node on this side, where there is one
        self.changed: Callable[[], None] = lambda: None  # to be called, on any thread, to compare at once
        self.ending: Callable[[str], None] = lambda _why: None  # … before the connection ends for good
        self.clock = RobotClock()  # learns from the time stamps of messages, and tells their age

    @property
    def log_name(self) -> str:
        """The name of the node, for the log."""
        return self.names.full if self.version == 1 else self.names.full.strip("/").replace("/", ".")

    @abstractmethod
    def connect(self) -> None:
        """Connect or reconnect; an earlier connection is closed."""

    @abstractmethod
    def disconnect(self) -> None:
        """Close the connection; messages sent before are still delivered."""

    def silence(self) -> str:
        """Return why no robot answers, a sentence, or an empty text if one does; nothing stays connected."""
        try:
            self.connect()
        except NoAnswerError as error:
            return str(error)
        finally:
            self.disconnect()
        return ""

    def trouble(self) -> str:
        """Return a sentence if the robot does not answer, else an empty text, the default; does not block."""
        return ""

    @property
    def tells_topics(self) -> bool:
        """Whether the robot says which topics there are. Default: True."""
        return True

    @abstractmethod
    def topics(self) -> Mapping[str, str]:
        """Return the live topics with their types, maybe as they were a moment ago."""

    def has_sim_time(self) -> bool | None:
        """Return whether ROS says that the time is simulated; None while that is not known. Default: no."""
        return False

    @abstractmethod
    def define(self, type_: str) -> Mapping[str, Definition] | None:
        """Return the known definitions of a type and of those in it.

        None while the robot is being asked; `changed` is called when it has answered.
        """

    @abstractmethod
    def taken(self, topic: str) -> bool | None:
        """Return whether another node uses a topic; a type may outlive its topic. None as in `define`."""

    def offers(self, direction: Direction) -> Mapping[str, str]:
        """Return the live actions, or services, with their types as far as they are known. Default: none."""
        return {}

    def type_of(self, direction: Direction, name: str) -> str | None:
        """Return the type of a live action or service; empty: it cannot be known; None as in `define`."""
        return self.offers(direction).get(name, "")

    @abstractmethod
    def join(
        self, topic: str, type_: str, direction: Direction, receive: Receive, every: bool = False
    ) -> object:
        """Subscribe or advertise; return the handle for the others.

        `receive`: to be called with each raw message and, if it is an earlier one, when that arrived, in
            seconds of `time.monotonic`.
        `every`: whether every message is to be delivered, or only the last ones.
        """

    @abstractmethod
    def announce(self, topic: str, type_: str, keeps: int) -> object:
        """Advertise a topic of which each message counts; return the handle for `send` and `leave`.

        `keeps`: how many of the last messages a later subscriber gets, where the back end can do that; at
            least the last one.
        """

    @abstractmethod
    def leave(self, handle: object) -> None:
        """End a subscription or an advertisement."""

    @abstractmethod
    def send(self, handle: object, values: Mapping[str, Any], urgent: bool) -> None:
        """Publish; only a message that is `urgent` (a stop) goes to a robot that does not answer.

        The time stamp of a header that the program did not set is missing: it becomes the time of sending.
        """

    @abstractmethod
    def hear(self, handle: object, every: bool) -> None:
        """Have every message of a subscription delivered from now on, or only the last ones."""

    def client(self, direction: Direction, name: str, type_: str) -> TaskClient:
        """Join an action or a service."""
        raise NotImplementedError  # where `has_tasks` is False

    def parameters(self, wanted: Collection[str]) -> ParameterValues:
        """Return what is known of parameters, maybe as it was a moment ago."""
        raise NotImplementedError  # where `has_tasks` is False

    def tend(self, in_need: bool) -> float:
        """Look after what is joined; return the seconds until the next comparison, fewer if `in_need`."""
        return min(self.period, _AGAIN) if in_need else self.period

    def commanders(self, topic: str) -> tuple[str, ...]:
        """Return the other nodes that publish on a topic now. Default: none is known."""
        return ()

    def listeners(self, topic: str) -> tuple[str, ...] | None:
        """Return the other nodes that subscribe to a topic now. Default: None, it is not known."""
        return None

    def hint(self, handle: object) -> str:
        """Return why nothing arrives in a subscription, in a sentence. Default: it is not known."""
        return ""


class TopicLink(Link):
    """The connections of a set-up.

    `find`: returns the transport, which is not connected yet; called once, on the link's thread. It may ask
        who answers, in bounded time, and raises `BridgeError` if no robot does.
    `place`: address of the robot, for messages before that.
    `channels`: returns the wanted ones.
    `report`: called with the state and a sentence when they change; on the link's thread.
    `learned`: called with a channel whose type has become known; on the link's thread.
    `warn`: called with a sentence about a robot that can be used, but not as expected; on the link's thread.
    `outlets`: the topics on which the bridge itself publishes.
    """

    def __init__(
        self,
        find: Callable[[], Transport],
        place: str,
        channels: Callable[[], tuple[Channel, ...]],
        report: Callable[[ConnectionState, str], None],
        learned: Callable[[Channel], None],
        warn: Callable[[str], None],
        outlets: Collection[Outlet] = (),
    ) -> None:
        super().__init__("ROS")
        self._outlets = outlets
        self._find = find
        self.place = place
        self._transport: Transport | None = None
        self.types = Types()
        self.live: Mapping[str, Mapping[str, str]] = {}  # topics, actions and services with types, by kind
        self.connected = False
        self.has_sim_time: bool | None = None  # whether time is simulated: as was said, or as ROS says
        self._wanted, self._report, self._learned, self._warn = channels, report, learned, warn
        self._is_slow = False
        self._last_status: tuple[ConnectionState, str] | None = None
        self._channels: tuple[Channel, ...] = ()  # that may be connected
        self._described: set[str] = set()
        self._unclear: set[Channel] = set()  # about which it was said
        self._parameters = ParameterValues()  # those that channels follow

    @property
    def transport(self) -> Transport:
        """The way to the robot, once it is found."""
        assert self._transport is not None
        return self._transport

    # -- from any thread --------------------------------------------------------------------------

    def send(self, channel: Channel, message: RosMessage | None, urgent: bool = False) -> None:
        """Publish at once, or raise a BridgeError and keep nothing; a stop (`urgent`) is always tried."""
        handle = self._handle(channel, urgent)
        if message is None:
            raise self._not_sent(channel)
        self.transport.send(handle, message.as_dict(), urgent)
        channel.sent(message)

    def ask(self, channel: Channel, message: RosMessage, request: RosRequest) -> None:
        """Ask for a goal or a call; it may take a moment. BridgeError: it was not sent."""
        client = self._handle(channel, urgent=False)
        channel.sent(message)
        client.ask(message.as_dict(), request)

    def cancel(self, channel: Channel, request: RosRequest | None) -> None:
        """Cancel a goal at once, or (None) all goals; BridgeError: that was not sent."""
        self._handle(channel, urgent=True).cancel(request)

    def _handle(self, channel: Channel, urgent: bool) -> Any:
        handle = channel.handle
        if handle is None or not (urgent or (self.connected and not channel.problem)):
            raise self._not_sent(channel)
        return handle

    def _not_sent(self, channel: Channel) -> BridgeError:
        why = channel.problem or channel.waiting
        if not self.connected:
            why = self._failure or f"{self.place} is not connected yet"
        return BridgeError(f"`robot.{channel.wire.variable}` was not sent: {ended(why)}")

    # -- on its own thread ------------------------------------------------------------------------

    def connect(self) -> float:
        """Connect, and make the connections of all channels."""
        if self._transport is None:
            self._transport = self._find()
            self._transport.changed = self.hurry
            self.place = f"`{self._transport.place}`"
        self._transport.connect()
        self._described.clear()
        for channel in self._wanted():
            channel.problem = ""  # of the connection that was lost
        for channel in self._channels:
            self._leave(channel)
        for outlet in self._outlets:
            outlet.leave()
        return self.attend()

    def attend(self) -> float:
        """Make the actual connections match the wanted ones; return the seconds until the next time."""
        trouble = self.transport.trouble()
        if trouble:
            for channel in self._channels:
                channel.interrupt()
            self._report_change(ConnectionState.STALE, trouble)
            return self.transport.period
        topics = self.transport.topics()
        if self.has_sim_time is None:
            self.has_sim_time = self.transport.has_sim_time()
        self.live = {"topic": topics, **{task: self.transport.offers(task) for task in TASKS}}
        before, self._channels = self._channels, self._wanted()
        for channel in before:
            if channel not in self._channels:
                self._leave(channel)
        followed = {each.wire.topic for each in self._channels if each.wire.direction == "parameter"}
        if followed and self.transport.has_tasks:
            self._parameters = self.transport.parameters(followed)
        for channel in self._channels:
            try:
                self._connect_channel(channel)
            except RefusedError as error:
                self._leave(channel)
                channel.problem = str(error)
        self.connected = True
        for channel in self._channels:
            channel.has_worked |= channel.works
            if isinstance(channel.handle, TaskClient):
                channel.handle.look()
        for outlet in self._outlets:
            outlet.join(self.transport)
            if complaint := outlet.complaint():
                self._warn(complaint)
        self._look_around()
        self._report_change(*self._summary())
        for channel in self._channels:  # last: who waited for the answer finds the status that belongs to it
            if not channel.is_asked_for:
                channel.answered.set()
        in_need = any(channel.waiting or channel.problem or channel.expects for channel in self._channels)
        return self.transport.tend(in_need)

    def _look_around(self) -> None:
        """Note who else commands, and how slow the link is."""
        for channel in self._channels:
            if channel.handle is not None and channel.is_velocity:
                before, others = channel.commanders, self.transport.commanders(channel.wire.topic)
                channel.commanders = tuple(other for other in others if GUARD_NODE not in other)
                for other in channel.commanders:
                    if other not in before:
                        self._warn(
                            f"`{other}` publishes on `{channel.wire.topic}`, too: the robot obeys whoever was"
                            " last. Let only one of you command it."
                        )
            if channel.is_unclear and channel not in self._unclear:
                self._unclear.add(channel)
                self._warn(
                    f"A number on `{channel.wire.topic}` is infinite or not a number. rosbridge does not say"
                    " which, so it is `nan` here: test it with `math.isfinite`."
                )
        trip = self.transport.round_trip
        if trip is not None and not self._is_slow and trip > SLOW:
            self._is_slow = True
            self._warn(
                f"The link to `{self.transport.place}` is slow: a round trip takes {trip:.1f} s. Readings and"
                " commands are late by half of that each."
            )
        elif trip is not None and trip < _FAST:
            self._is_slow = False

    def _connect_channel(self, channel: Channel) -> None:
        wire, channel.clock = channel.wire, self.transport.clock
        if wire.kind != "topic" and not self.transport.has_tasks:
            raise RefusedError(
                f"`{wire.topic}` cannot be connected: this back end has topics only. Use `rosbridge` for"
                f" {article(wire.kind)} {wire.kind}, with rosbridge_server on the robot."
            )
        if wire.direction == "parameter":
            self._follow(channel)
            return
        live = self._live_type(channel)
        if live is None:
            return
        type_ = wire.type or live or channel.type
        if live and live != type_ and self._is_taken(channel, live, type_):
            return
        if channel.handle is not None:
            if channel.type == type_:
                channel.waiting = self._hint(channel, channel.handle)
                if wire.direction == "subscription":
                    self.transport.hear(channel.handle, channel.takes_all)
                return
            self._leave(channel)
        if not type_:
            channel.waiting = self._missing(channel)
            return
        channel.take_type(type_)
        messages = messages_of(wire.direction, type_)
        known = [self._describe(channel, message) for message in messages]  # all are asked for at once
        channel.is_asked_for = not all(known)
        if channel.is_asked_for:
            channel.waiting = f"`{self.transport.place}` is asked for the type `{type_}`"
            return
        channel.learn(self.types, messages)
        check_sent(channel)
        self._learned(channel)
        channel.stamps = Stamps(channel.clock)
        channel.live = True  # before joining: a latched message arrives while we do
        if wire.direction in TASKS:
            handle: object = self.transport.client(wire.direction, wire.topic, type_)
        else:
            every = channel.takes_all
            handle = self.transport.join(wire.topic, type_, wire.direction, channel.receive, every)
        if channel.owes_stop:
            self._pay_stop(channel, handle)
        channel.problem, channel.waiting = "", self._hint(channel, handle)
        channel.handle = handle

    def _follow(self, channel: Channel) -> None:
        """Take the value of a parameter, or note why there is none."""
        name, told = channel.wire.topic, self._parameters
        channel.problem, channel.waiting = "", told.missing.get(name, "")
        channel.is_asked_for = not channel.waiting and name not in told.values
        if name in told.values:
            channel.take(told.values[name])
        else:
            channel.arrivals.last = None
            channel.waiting = channel.waiting or f"`{self.transport.place}` is asked for `{name}`"

    def _hint(self, channel: Channel, handle: object) -> str:
        hint = handle.hint() if isinstance(handle, TaskClient) else self.transport.hint(handle)
        channel.unheard = (hint or self._unheard(channel)) if channel.is_velocity else ""
        return hint or channel.unheard

    def _unheard(self, channel: Channel) -> str:
        """Return that no node hears the velocities of a channel, in a sentence, or an empty text."""
        topic, topics = channel.wire.topic, self.live["topic"]
        if self._listeners(topic) != ():
            return ""
        name = topic.rpartition("/")[2]
        alike = [each for each in topics if each != topic and each.rpartition("/")[2] == name]
        if channel.type in VELOCITIES:  # a number may be anything
            alike += [each for each in topics if topics[each] == channel.type and each not in (topic, *alike)]
        heard = ((each, self._listeners(each)) for each in alike[:_ALIKE])
        found = next(((each, nodes[0]) for each, nodes in heard if nodes), None)
        hint = "" if found is None else ". Did you mean `{}`, to which `{}` subscribes?".format(*found)
        return f"no other node subscribes to `{topic}`{hint}"

    def _listeners(self, topic: str) -> tuple[str, ...] | None:
        nodes = self.transport.listeners(topic)
        return nodes and tuple(node for node in nodes if GUARD_NODE not in node)

    def _live_type(self, channel: Channel) -> str | None:
        """Return the type of what is live there; empty: there is nothing; None while it is asked for."""
        wire, offered = channel.wire, self.live[channel.wire.kind]
        live: str | None = offered.get(wire.topic, "")
        if wire.direction in TASKS and not (live or wire.type) and wire.topic in offered:
            live = self.transport.type_of(wire.direction, wire.topic)
        channel.is_asked_for = live is None
        if live is None:
            channel.waiting = f"`{self.transport.place}` is asked for the type of `{wire.topic}`"
            return None
        return canonical(live)

    def _is_taken(self, channel: Channel, live: str, type_: str) -> bool:
        """Return whether it is being asked who uses a name; RefusedError: it is used with another type."""
        name, is_topic = channel.wire.topic, channel.wire.kind == "topic"
        taken = self.transport.taken(name) if is_topic else True
        channel.is_asked_for = taken is None
        if taken is None:
            channel.waiting = f"`{self.transport.place}` is asked who uses `{name}`"
        if taken:
            raise RefusedError(
                f"`{name}` {'carries' if is_topic else 'has the type'} `{live}`, not `{type_}`."
            )
        return taken is None

    def _missing(self, channel: Channel) -> str:
        """Return why the type of what a channel is wired to cannot be found."""
        name, wanted = channel.wire.topic, channel.wire.kind
        for kind in (wanted, *self.live):
            if name in self.live[kind]:
                if kind == wanted:
                    return f"the robot does not tell the type of the {kind} `{name}`. Name it"
                return f"`{name}` is {article(kind)} {kind}. Connect it as one"
        if not self.transport.tells_topics:
            return (
                f"`{self.transport.place}` does not tell which {wanted}s there are. Name the type of `{name}`"
            )
        hint = _meant(name, self.live[wanted])
        return f"`{name}` does not exist yet, and its type is not known.{hint}"

    def _pay_stop(self, channel: Channel, handle: Any) -> None:
        """Stop at last what may have gone on while the robot was lost."""
        channel.owes_stop = channel.has_moved = False
        for request in channel.unfinished:
            handle.cancel(request)
        stop = channel.stop_message()
        if stop is not None:
            self.transport.send(handle, stop.as_dict(), True)
            channel.sent(stop)

    def _describe(self, channel: Channel, type_: str) -> bool:
        """Make a type of messages known; return whether it is, and not only asked for."""
        if type_ not in self._described:
            definitions = self.transport.define(type_)
            if definitions is None:
                return False
            self.types.add(definitions)
            self._described.add(type_)
        if not self.types.knows(type_):
            self._described.discard(type_)
            kind = channel.wire.kind
            known = set(map(canonical, self.live[kind].values()))
            if kind == "topic":
                kind, known = "message", known | set(self.types.names())
            hint = did_you_mean(channel.type, known - {channel.type, ""})
            raise RefusedError(f"`{self.transport.place}` knows no {kind} type `{channel.type}`.{hint}")
        return True

    def _leave(self, channel: Channel) -> None:
        handle, channel.handle = channel.handle, None
        channel.forget()
        if isinstance(handle, TaskClient):
            handle.leave()
        elif handle is not None:
            self.transport.leave(handle)

    def lose(self, sentence: str) -> float:
        """Report that the robot is lost, and forget what is known of it."""
        self.connected, self.live = False, {}
        for outlet in self._outlets:
            outlet.wait()
        for channel in self._wanted():
            channel.forget()
            channel.problem, channel.commanders, channel.unheard = sentence, (), ""
            channel.owes_stop |= channel.has_moved
            for request in channel.unfinished:
                channel.owes_stop = True
                request.tell("lost", reason=sentence)
        state = ConnectionState.CONNECTING if self.is_opening else ConnectionState.LOST
        self._report_change(state, sentence)  # the transport may still send a stop
        return _AGAIN

    def _run(self) -> None:
        super()._run()
        for channel in self._channels:
            with suppress(Exception):  # of a library: most leave all channels when they disconnect
                self._leave(channel)
        for outlet in self._outlets:
            with suppress(Exception):
                outlet.leave()

    def disconnect(self) -> None:
        """Close the connection."""
        if self._transport is not None:
            self._transport.disconnect()

    def _summary(self) -> tuple[ConnectionState, str]:
        for channel in self._channels:
            if why := channel.lack():
                return ConnectionState.WAITING, why
        inputs = [channel for channel in self._channels if channel.wire.direction == "subscription"]
        empty = [f"`{channel.wire.topic}`" for channel in inputs if channel.expects]
        if empty:
            return ConnectionState.WAITING, f"{', '.join(empty)}: nothing has arrived yet."
        remarks = "".join(channel.remark() for channel in self._channels)
        if not self._channels:
            remarks = " No topic is connected: name some in a set-up (`setup=robot.json`) or in the panel."
        return ConnectionState.CONNECTED, f"Connected to {self.transport.place}.{remarks}"

    def _report_change(self, state: ConnectionState, sentence: str) -> None:
        if self._last_status != (state, sentence) and not self.is_ended:
            self._last_status = (state, sentence)
            self._report(state, sentence)


def _meant(name: str, names: Iterable[str]) -> str:
    """Return what may be meant, as `did_you_mean` does: the last part of a name counts first."""
    inner = name.rpartition("/")[2]
    known = {each: each.rpartition("/")[2] for each in names}
    near = {inner} & set(known.values()) or set(most_similar(inner, known.values()))
    return did_you_mean(name, [each for each in known if known[each] in near], 0.0)


def check_sent(channel: Channel) -> None:
    """Raise RefusedError for limits of fields that do not exist or are not numbers, and for a wrong stop."""
    wire = channel.wire
    if channel.message is None:
        return
    if channel.is_velocity and channel.lists and wire.at_stop is None:
        example = ", ".join(f'"{name}": [0, 0]' for name in channel.lists)
        raise RefusedError(
            f"A `{channel.type}` with nothing in `{next(iter(channel.lists))}` stops no robot. Say what is"
            f' sent at a stop: `"stop": {{"{wire.variable}": {{{example}}}}}` in the set-up,'
            f" `at_stop={{{example}}}` in Python."
        )
    for name in channel.wire.limits:
        try:
            value = channel.message().get(name)
        except (AttributeError, KeyError):
            value = None
        if type(value) not in (int, float):
            paths = [*channel.message.WORDS, *channel.message.paths()]
            hint = did_you_mean(name, paths)
            raise RefusedError(f"`{channel.type}` has no number `{name}` that could have a limit.{hint}")
    for when, message in {"at a stop": channel.stop_message, "in a tick": channel.tick_message}.items():
        try:
            message()
        except LRPError as error:
            raise RefusedError(f"What is to be sent {when}: {error}") from None
