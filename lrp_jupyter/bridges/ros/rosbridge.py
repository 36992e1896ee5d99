"""The rosbridge back end: JSON or CBOR over a websocket, without a ROS installation on this side.

It is a client of its own of the rosbridge protocol 2.0, because a command is sent now or never (`websocket`).
ROS 1 and ROS 2 differ in the names of types (`pkg/Type`, `pkg/msg/Type`) and in time stamps; each gets its
own form.
"""

from __future__ import annotations

import itertools
import json
import threading
import time
from collections import deque
from collections.abc import Callable, Collection, Iterable, Mapping
from functools import partial
from typing import Any, NamedTuple

from lrp_jupyter.bridges.message import moves
from lrp_jupyter.bridges.ros.definitions import (
    CLOCK,
    FLOATS,
    HEADERS,
    KNOWN,
    PRIMITIVES,
    STRINGS,
    Definition,
    FieldType,
)
from lrp_jupyter.bridges.ros.frames import knows_cbor
from lrp_jupyter.bridges.ros.goal_topics import GoalTopics, actions_in
from lrp_jupyter.bridges.ros.kept import LastMessage
from lrp_jupyter.bridges.ros.link import Receive, Transport
from lrp_jupyter.bridges.ros.parameters import ParameterValues
from lrp_jupyter.bridges.ros.ros_request import TaskClient
from lrp_jupyter.bridges.ros.rosapi import Rosapi
from lrp_jupyter.bridges.ros.server_calls import ServerTask
from lrp_jupyter.bridges.ros.setup import Direction
from lrp_jupyter.bridges.ros.types import Types
from lrp_jupyter.bridges.ros.websocket import Socket, require_websockets
from lrp_jupyter.errors import BridgeError, did_you_mean, ended

_QUIET = 1.0  # seconds without a message after which a new publisher is worth another subscription …
_UNPACKED = 3.0  # … and after which arrays are asked for as text
_ANNOUNCED = 100  # messages that wait in the server for a slow subscriber where each of them counts
_CLOCK_PACE = 0.005  # seconds between two messages of the time, at most
_ECHO = 10.0  # seconds after which an own command no longer comes back
_FIGHT = 5.0  # seconds for which another client counts as one that commands


class RosbridgeTransport(Transport):
    """A rosbridge server; `warn` is called with a sentence for each of its complaints."""

    def __init__(self, url: str, warn: Callable[[str], None]) -> None:
        super().__init__()
        self.place = url
        self._warn = warn
        self._socket: Socket | None = None
        self._rosapi = Rosapi(url, self.clock, warn, lambda: self.changed())
        self._inputs: dict[str, _Input] = {}
        self._outputs: dict[str, str] = {}  # the types of what was advertised
        self._echoes: dict[str, _Echo] = {}
        self._definitions: dict[str, Definition] = dict(KNOWN)
        self._heard: set[str] = set()  # the topics of which it was asked who hears them
        self._packs: bool | None = None  # whether the server packs arrays; None: not seen yet
        self._ids = itertools.count(1)

    # -- the connection ---------------------------------------------------------------------------

    def connect(self) -> None:
        """Open a websocket."""
        require_websockets()
        self.disconnect()
        self._inputs, self._packs = {}, None
        self._rosapi.reset()
        socket = Socket(self.place, self._receive, self.changed)
        socket.open(beside=self._rosapi.run)
        self._socket = socket

    def disconnect(self) -> None:
        """Close the websocket."""
        socket, self._socket = self._socket, None
        if socket is not None:
            socket.close()

    def trouble(self) -> str:
        """Return a sentence if the server hangs."""
        socket = self._socket
        hangs = socket is not None and socket.is_open and socket.is_stale
        return f"`{self.place}` no longer answers" if hangs else ""

    @property
    def round_trip(self) -> float | None:  # type: ignore[override]
        """Recent median of the seconds until the server answers a ping."""
        socket = self._socket
        return socket.round_trip if socket is not None else None

    def _open_socket(self) -> Socket:
        socket = self._socket
        if socket is None or not socket.is_open:
            why = socket.ended if socket is not None else ""
            raise BridgeError(
                f"The connection to `{self.place}` is lost. {ended(why) if why else ''}".rstrip()
            )
        return socket

    def _socket_for(self, urgent: bool) -> Socket:
        """Return the connection; BridgeError: it is lost, or hangs, when only what is urgent is sent."""
        socket = self._open_socket()
        if socket.is_stale and not urgent:
            raise BridgeError(self.trouble())
        return socket

    @property
    def version(self) -> int:  # type: ignore[override]
        """Of ROS, as rosapi's list of topics shows it; a server without rosapi has none."""
        return 0 if not self._rosapi.topics() else 2 if self._rosapi.is_ros2 else 1

    # -- topics -----------------------------------------------------------------------------------

    def topics(self) -> Mapping[str, str]:
        """Return the list of rosapi as it was a moment ago; a server without rosapi has none."""
        self._open_socket()
        topics = self._rosapi.topics()
        if self._rosapi.trouble:
            raise BridgeError(self._rosapi.trouble)
        return topics

    def has_sim_time(self) -> bool | None:
        """Return what rosapi says of ROS 1; None while it is being asked. In ROS 2, each node has its own."""
        return self._rosapi.has_sim_time

    @property
    def tells_topics(self) -> bool:
        """Whether there is a rosapi."""
        return self._rosapi.exists

    def _spelled(self, type_: str) -> str:
        """Return the name of a type in the notation of this ROS."""
        return type_.replace("/", "/msg/", 1) if self._rosapi.is_ros2 else type_

    def define(self, type_: str) -> Mapping[str, Definition] | None:
        """Return the definitions of a type; the server is asked only for those that are not known here."""
        topics = self._rosapi.topics()
        header = HEADERS[2 if self._rosapi.is_ros2 else 1] if topics or type_ == CLOCK else {}
        found = {} if Types().knows(type_) or type_ in header else self._rosapi.define(type_)
        if found is None:
            return None
        found = {**header, **found}
        self._definitions.update(found)
        return found

    def taken(self, topic: str) -> bool | None:
        """Return whether a node publishes or subscribes, as rosapi knows; None while it is being asked."""
        return self._rosapi.taken(topic)

    def join(
        self, topic: str, type_: str, direction: Direction, receive: Receive, every: bool = False
    ) -> object:
        """Subscribe or advertise; a topic is subscribed to once, however many variables read it."""
        socket, number = self._open_socket(), next(self._ids)
        if direction == "publisher":
            request = {"op": "advertise", "id": f"p{number}", "topic": topic, "type": self._spelled(type_)}
            socket.put(json.dumps(request))
            self._outputs[topic] = type_
            return _Handle(direction, topic, number, socket, every)
        handle = _Handle(direction, topic, number, socket, every)
        known = self._inputs.get(topic)
        if known is None:
            self._inputs[topic] = new = _Input(topic, type_, {number: receive})
            new.heard_by = {number} if every else set()
            self._subscribe(new)
            return handle
        known.receivers = {**known.receivers, number: receive}
        if known.heard is not None:  # it may be long until there is another one
            receive(known.last.raw, known.last.at)
        self.hear(handle, every)
        return handle

    def announce(self, topic: str, type_: str, keeps: int) -> object:
        """Have the server create a publisher that keeps its last messages."""
        socket, number = self._open_socket(), next(self._ids)
        kept = {"latch": True, "queue_size": max(keeps, _ANNOUNCED)}
        request = {"op": "advertise", "id": f"p{number}", "topic": topic, "type": self._spelled(type_)}
        socket.put(json.dumps({**request, **kept}))
        return _Handle("publisher", topic, number, socket, every=True, announced=True)

    def hear(self, handle: object, every: bool) -> None:
        """Subscribe again, without dropping messages or with it, if that changes for the topic."""
        assert isinstance(handle, _Handle)
        one = self._inputs.get(handle.topic)
        if one is None or handle.socket is not self._socket:
            return
        had = bool(one.heard_by)
        one.heard_by = one.heard_by | {handle.number} if every else one.heard_by - {handle.number}
        if bool(one.heard_by) != had:
            self._subscribe(one)

    def leave(self, handle: object) -> None:
        """Unsubscribe or unadvertise; nothing to do on a connection that is gone."""
        assert isinstance(handle, _Handle)
        socket, topic, number = handle.socket, handle.topic, handle.number
        if socket is not self._socket:
            return
        if handle.direction == "publisher":
            socket.put(json.dumps({"op": "unadvertise", "id": f"p{number}", "topic": topic}))
            self._echoes.pop(topic, None)
            self._rosapi.ignore(topic)
            return
        self.hear(handle, False)
        known = self._inputs[topic]
        known.receivers = {key: one for key, one in known.receivers.items() if key != number}
        if not known.receivers:
            del self._inputs[topic]
            socket.put(_unsubscription(topic))

    def send(self, handle: object, values: Mapping[str, Any], urgent: bool) -> None:
        """Publish; to a server that hangs only what is urgent."""
        assert isinstance(handle, _Handle)
        socket, topic = self._socket_for(urgent), handle.topic
        if self.clock.world is not None:  # else the server fills in its own time
            values = self._stamped(values)
        text = json.dumps({"op": "publish", "id": f"p{handle.number}", "topic": topic, "msg": values})
        echo = self._echoes.get(topic)
        if echo is not None:
            echo.sent(values)
        if handle.announced or (urgent and handle.every):
            socket.put(text)  # it replaces nothing, and never expires either
        else:
            socket.put(text, topic=topic, urgent=urgent)

    def _stamped(self, values: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return a message with the time in its header, if that has none."""
        header = values.get("header")
        if not isinstance(header, Mapping) or "stamp" in header:
            return values
        names = ("sec", "nanosec") if self._rosapi.is_ros2 else ("secs", "nsecs")
        stamp = dict(zip(names, divmod(self.clock.time_ns(), 1_000_000_000), strict=True))
        return {**values, "header": {**header, "stamp": stamp}}

    # -- actions and services ---------------------------------------------------------------------

    def offers(self, direction: Direction) -> Mapping[str, str]:
        """Return the actions and services that rosapi knew a moment ago."""
        if direction == "action" and not self._rosapi.is_ros2:
            return actions_in(self._rosapi.topics())
        return self._rosapi.offers(direction)

    def type_of(self, direction: Direction, name: str) -> str | None:
        """Return what rosapi says of the type of an action or service; None while it is being asked."""
        return self.offers(direction).get(name, "") or self._rosapi.type_of(direction, name)

    def client(self, direction: Direction, name: str, type_: str) -> TaskClient:
        """Join the topics of an action of ROS 1, or be ready to ask the server."""
        if direction == "action" and not self._rosapi.is_ros2:
            return GoalTopics(self, name, type_)
        missing = partial(self._missing, direction, name)
        return ServerTask(self.place, direction, name, type_, missing, self._socket_for)

    def parameters(self, wanted: Collection[str]) -> ParameterValues:
        """Return what rosapi, or a node of ROS 2, has said a moment ago."""
        return self._rosapi.parameters(wanted)

    def _missing(self, direction: Direction, name: str) -> str:
        """Return that no node serves an action or a service, as far as that is known, in a sentence."""
        live = self.offers(direction)
        if name in live or not self._rosapi.has_listed(direction):
            return ""
        return f"No node offers the {direction} `{name}`.{did_you_mean(name, live)}"

    def _receive(self, message: Mapping[str, Any]) -> None:
        """Process a message of the server; on the socket's thread."""
        operation = message.get("op")
        if operation == "publish":
            known = self._inputs.get(str(message.get("topic")))
            if known is not None:
                known.heard = time.monotonic()
                raw = message.get("msg")
                if known.last.is_news(raw):
                    for receive in tuple(known.receivers.values()):
                        receive(raw)
        elif operation == "status" and message.get("level") in ("error", "warning"):
            self._warn(f"`{self.place}`: {message.get('msg')}")

    # -- looking after the subscriptions ----------------------------------------------------------

    def tend(self, in_need: bool) -> float:
        """Adapt the subscriptions to the pace of the program, and to publishers that came later."""
        rosapi, now = self._rosapi, time.monotonic()
        quiet = [
            each
            for each in self._inputs.values()
            if (rosapi.is_ros2 or each.heard is None) and now - (each.heard or each.since) > _QUIET
        ]
        heard, self._heard = self._heard, set()
        rosapi.watch([*self._echoes, *(each.topic for each in quiet)], heard, in_need)
        for each in quiet:
            publishers = frozenset(rosapi.publishers.get(each.topic, ()))
            if each.is_packed and each.heard is None and publishers and now - each.since > _UNPACKED:
                if _has_arrays(_fields_in(each.type, self._definitions)):  # else it may just be quiet
                    self._packs = self._packs or False
                each.may_be_packed = False
                self._subscribe(each)
            elif rosapi.is_ros2 and publishers - each.publishers:
                # rosbridge chooses the quality of service when it subscribes, from the publishers there are
                each.publishers = publishers
                self._open_socket().put(_unsubscription(each.topic))
                self._subscribe(each)
        for each in self._inputs.values():
            if each.is_packed and each.heard is not None:
                self._packs = True
            if each.throttle != self._throttle(each):
                self._subscribe(each)
        return super().tend(in_need)

    def _throttle(self, one: _Input) -> int:
        """Milliseconds between two messages of a topic; the newest is sent, unless every one counts."""
        pace = min(self.pace, _CLOCK_PACE) if one.type == CLOCK else self.pace
        return 0 if one.heard_by else int(pace * 1000)

    def _subscribe(self, one: _Input) -> None:
        """Subscribe; a second time with the same id changes how."""
        one.throttle = self._throttle(one)
        one.last.renew()
        one.is_packed = (
            one.may_be_packed
            and self._packs is not False
            and knows_cbor()
            and _is_packed(one.type, self._definitions)
        )
        one.since = time.monotonic()
        request = {"op": "subscribe", "id": f"s{one.topic}", "topic": one.topic}
        request |= {"type": self._spelled(one.type), "compression": "cbor" if one.is_packed else "none"}
        length = 0 if one.heard_by else 1  # … of the messages that wait: all, or the newest
        text = json.dumps({**request, "queue_length": length, "throttle_rate": one.throttle})
        self._open_socket().put(text)

    def hint(self, handle: object) -> str:
        """Return what may be wrong where a topic has a publisher, but no message came."""
        assert isinstance(handle, _Handle)
        one = self._inputs.get(handle.topic) if handle.direction == "subscription" else None
        publishers = self._rosapi.publishers.get(handle.topic, ())
        if one is None or one.heard is not None or time.monotonic() - one.since < _UNPACKED or not publishers:
            return ""
        reason = (
            "another client of this rosbridge subscribed before it was there: restart rosbridge"
            if self._rosapi.is_ros2
            else "see the log of rosbridge"
        )
        return (
            f"`{publishers[0]}` publishes on `{one.topic}`, but nothing has arrived. If it is not just quiet,"
            f" {reason}."
        )

    # -- who else commands ------------------------------------------------------------------------

    def commanders(self, topic: str) -> tuple[str, ...]:
        """Return the other nodes that rosapi knows, or the client of this server whose commands are seen."""
        echo = self._echoes.setdefault(topic, _Echo())
        if echo.has_sent:
            self._rosapi.listen(topic, self._spelled(self._outputs[topic]), echo.receive)
        nodes = self._rosapi.publishers.get(topic, ())
        if not nodes and time.monotonic() - echo.strange < _FIGHT:
            return (f"another client of {self.place}",)
        return nodes

    def listeners(self, topic: str) -> tuple[str, ...] | None:
        """Return the other nodes that rosapi knew a moment ago; the first time, it is asked."""
        self._heard.add(topic)
        return self._rosapi.subscribers.get(topic)


class _Handle(NamedTuple):
    direction: Direction
    topic: str
    number: int
    socket: Socket
    every: bool
    announced: bool = False


class _Input:
    """A topic that is subscribed to."""

    def __init__(self, topic: str, type_: str, receivers: dict[int, Receive]) -> None:
        self.topic, self.type, self.receivers = topic, type_, receivers
        self.since = 0.0
        self.heard: float | None = None
        self.last = LastMessage()
        self.heard_by: set[int] = set()  # for which receivers every message counts
        self.throttle = 0
        self.may_be_packed = True
        self.is_packed = False
        self.publishers: frozenset[str] = frozenset()


class _Echo:
    """The commands on a topic as they come back from the robot: those that are not ours are another's.

    rosapi knows nodes only, and all clients of a rosbridge server are one node.
    """

    def __init__(self) -> None:
        self.has_sent = False
        self.strange = float("-inf")
        self._sent: deque[tuple[float, Mapping[str, Any]]] = deque(maxlen=1000)
        self._lock = threading.Lock()

    def sent(self, values: Mapping[str, Any]) -> None:
        """Note a command of ours."""
        with self._lock:
            self.has_sent = True
            self._sent.append((time.monotonic(), values))

    def receive(self, values: Any) -> None:
        """Compare a command with ours; a stop does not count, because a guard sends it."""
        now = time.monotonic()
        if not moves(values):
            return
        with self._lock:
            if not any(now - when < _ECHO and _is_in(ours, values) for when, ours in reversed(self._sent)):
                self.strange = now


def _is_in(ours: object, theirs: object) -> bool:
    """Whether all that was sent is in what came back; the server may have added a time stamp."""
    if isinstance(ours, Mapping):
        return isinstance(theirs, Mapping) and all(_is_in(ours[key], theirs.get(key)) for key in ours)
    return ours == theirs


def _unsubscription(topic: str) -> str:
    return json.dumps({"op": "unsubscribe", "id": f"s{topic}", "topic": topic})


def _is_packed(type_: str, definitions: Mapping[str, Definition]) -> bool:
    """Whether a message is better packed than written as text, and has nothing that a server fails to pack.

    Arrays take less time, and a number that is infinite or NaN is `null` in a text. rosbridge raises errors
    for arrays of a fixed length (all versions of ROS 1, and of ROS 2 until 2026) and of strings (ROS 1), and
    for the octets of ROS 2.
    """
    fields = _fields_in(type_, definitions)
    if any(each.length > 0 or each.base in ("byte", "wstring") or _is_texts(each) for each in fields):
        return False
    return _has_arrays(fields) or any(each.base in FLOATS for each in fields)


def _is_texts(field: FieldType) -> bool:
    return field.base in STRINGS and field.length == 0


def _has_arrays(fields: Iterable[FieldType]) -> bool:
    return any(each.base in PRIMITIVES and each.length == 0 for each in fields)


def _fields_in(type_: str, definitions: Mapping[str, Definition]) -> list[FieldType]:
    """Return the fields of a type and of those in it; none if one of them is not known."""
    found: list[FieldType] = []
    wanted, seen = [type_], set[str]()
    while wanted:
        definition = definitions.get(wanted.pop())
        if definition is None:
            return []
        seen.add(definition.type)
        fields = definition.fields.values()
        found += fields
        wanted += [each.base for each in fields if each.base not in PRIMITIVES and each.base not in seen]
    return found
