"""The rosbridge back end: JSON over a websocket, without a ROS installation on this side.

An own client of the rosbridge protocol 2.0, for what matters to a robot stands in
`lrp_jupyter.bridges.ros.websocket`: a command is sent now or never.

ROS 1 and ROS 2 differ in the names of types (`pkg/Type`, `pkg/msg/Type`): each gets its own. Time
stamps and rosapi's names of fields differ too, and come with the definitions. ROS 2 was not run.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from lrp_jupyter.bridges.ros.definitions import Definition, canonical, from_rosapi
from lrp_jupyter.bridges.ros.link import RefusedError, Transport
from lrp_jupyter.bridges.ros.setup import Direction
from lrp_jupyter.bridges.ros.websocket import Socket, require_websockets
from lrp_jupyter.errors import BridgeError, ended

__all__ = ["RosbridgeTransport"]

_ANSWER = 2.0  # seconds for the server to answer a question


class RosbridgeTransport(Transport):
    """A rosbridge server.

    Parameters
    ----------
    url : str
        ``ws://host:9090``
    warn : callable
        Called with a sentence for each complaint of the server.
    """

    def __init__(self, url: str, warn: Callable[[str], None]) -> None:
        super().__init__()
        self.place = url
        self._warn = warn
        self._socket: Socket | None = None
        self._has_rosapi: bool | None = None  # None: not known yet
        self._is_ros2 = False
        self._receivers: dict[str, dict[int, Callable[[Any], None]]] = {}  # topic -> handles
        self._ids = itertools.count(1)

    # -- the connection ---------------------------------------------------------------------------

    def connect(self) -> None:
        """Open a websocket.

        Raises
        ------
        BridgeError
            No server answers, or it does not speak websocket; or `websockets` is not installed.
        """
        require_websockets()
        self.disconnect()
        self._receivers = {}
        socket = Socket(self.place, self._receive, self.changed)
        socket.open()
        self._socket = socket
        socket.put(json.dumps({"op": "set_level", "level": "error"}))

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

    def _open_socket(self) -> Socket:
        socket = self._socket
        if socket is None or not socket.is_open:
            why = socket.ended if socket is not None else ""
            raise BridgeError(
                f"The connection to `{self.place}` is lost. {ended(why) if why else ''}".rstrip()
            )
        return socket

    # -- topics -----------------------------------------------------------------------------------

    def topics(self) -> Mapping[str, str]:
        """Ask rosapi; a server without it has no list."""
        if self._has_rosapi is False:
            self._open_socket()
            return {}
        try:
            values = self._ask("/rosapi/topics")
        except RefusedError as error:
            if self._has_rosapi:  # it is still there: its own ROS master is not
                raise BridgeError(f"`{self.place}` answers, but its ROS master does not: {error}") from None
            self._has_rosapi = False
            self._warn(
                f"`{self.place}` has no rosapi: topics are not listed, and only common types are known. "
                "Start rosapi there."
            )
            return {}
        self._has_rosapi = True
        names, types = values.get("topics", []), values.get("types")
        if types is None:  # an old rosapi: one type at a time, for the topics in use
            types = [self._type_of(name) for name in names]
        self._is_ros2 = any("/msg/" in str(type_) for type_ in types)
        return {str(name): canonical(str(type_)) for name, type_ in zip(names, types, strict=False)}

    def _spelled(self, type_: str) -> str:
        """Return the name of a type in the notation of this ROS."""
        return type_.replace("/", "/msg/", 1) if self._is_ros2 else type_

    def _type_of(self, topic: str) -> str:
        return str(self._ask("/rosapi/topic_type", topic=topic).get("type", ""))

    def define(self, type_: str) -> Mapping[str, Definition]:
        """Ask rosapi about a type.

        Raises
        ------
        RefusedError
            The server does not know the type.
        """
        if not self._has_rosapi:
            return {}
        try:
            typedefs = self._ask("/rosapi/message_details", type=self._spelled(type_)).get("typedefs", [])
        except RefusedError:
            return {}
        return from_rosapi(typedefs)

    def taken(self, topic: str) -> bool:
        """Ask who publishes and subscribes."""
        try:
            return any(
                self._ask(f"/rosapi/{who}", topic=topic).get(who) for who in ("publishers", "subscribers")
            )
        except RefusedError:
            return True

    def join(self, topic: str, type_: str, direction: Direction, receive: Callable[[Any], None]) -> object:
        """Subscribe or advertise. A topic is subscribed to once, however many variables read it."""
        socket, number = self._open_socket(), next(self._ids)
        wanted = {"topic": topic, "type": self._spelled(type_)}
        if direction == "publisher":
            socket.put(json.dumps({"op": "advertise", "id": f"p{number}", **wanted}))
            return _Handle(direction, topic, number, socket)
        listeners = self._receivers.get(topic, {})
        self._receivers[topic] = {**listeners, number: receive}
        if not listeners:
            request = {"op": "subscribe", "id": f"s{topic}", **wanted}
            socket.put(json.dumps({**request, "queue_length": 1, "throttle_rate": 0}))  # newest wins
        return _Handle(direction, topic, number, socket)

    def leave(self, handle: object) -> None:
        """Unsubscribe or unadvertise; nothing to do on a connection that is gone."""
        assert isinstance(handle, _Handle)
        socket, topic, number = handle.socket, handle.topic, handle.number
        if socket is not self._socket:
            return
        if handle.direction == "publisher":
            socket.put(json.dumps({"op": "unadvertise", "id": f"p{number}", "topic": topic}))
            return
        listeners = {key: one for key, one in self._receivers.get(topic, {}).items() if key != number}
        self._receivers[topic] = listeners
        if not listeners:
            socket.put(json.dumps({"op": "unsubscribe", "id": f"s{topic}", "topic": topic}))

    def send(self, handle: object, values: Mapping[str, Any], urgent: bool) -> None:
        """Publish.

        Raises
        ------
        BridgeError
            The connection is gone, or the server hangs.
        """
        assert isinstance(handle, _Handle)
        socket, topic = self._open_socket(), handle.topic
        if socket.is_stale and not urgent:
            raise BridgeError(self.trouble())
        text = json.dumps({"op": "publish", "id": f"p{handle.number}", "topic": topic, "msg": values})
        socket.put(text, topic=topic, urgent=urgent)

    # -- services ---------------------------------------------------------------------------------

    def _ask(self, service: str, **arguments: object) -> dict[str, Any]:
        """Call a service.

        Raises
        ------
        RefusedError
            The call failed, or there is no such service.
        BridgeError
            The connection is gone, or nothing came back.
        """
        socket, key = self._open_socket(), f"q{next(self._ids)}"
        answer = socket.expect(key)
        socket.put(json.dumps({"op": "call_service", "id": key, "service": service, "args": arguments}))
        try:
            response = answer.result(_ANSWER)
        except TimeoutError:
            raise BridgeError(f"`{self.place}` did not answer the call of {service}.") from None
        finally:
            socket.forget(key)
        values = response.get("values")
        if response.get("result", True) is False or not isinstance(values, dict):
            raise RefusedError(f"{service}: {values or response.get('msg') or 'no answer'}")
        return values

    def _receive(self, message: Mapping[str, Any]) -> None:
        """Process a message of the server; on the socket's thread."""
        operation = message.get("op")
        if operation == "publish":
            for receive in tuple(self._receivers.get(str(message.get("topic")), {}).values()):
                receive(message.get("msg"))
        elif operation == "status" and message.get("level") in ("error", "warning"):
            self._warn(f"`{self.place}`: {message.get('msg')}")


class _Handle(NamedTuple):
    direction: Direction
    topic: str
    number: int
    socket: Socket
