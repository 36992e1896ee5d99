"""ROS over rosbridge: a websocket that speaks JSON, so that nothing of ROS is needed on this side.

An own client of the rosbridge protocol 2.0, for two reasons that matter to a robot. A command is
sent now or never: what could not leave within half a second, or was waiting when the connection
broke, is dropped. And a server that hangs is noticed: it is pinged four times a second, and gets no
more commands until it answers, so that they cannot pile up in the network.

ROS 1 and ROS 2 differ in the names of types (`pkg/Type`, `pkg/msg/Type`), which both servers take in
the short form; in time stamps and in rosapi's names of fields, which come with the definitions.
"""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import json
import struct
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from socket import SO_LINGER, SOL_SOCKET
from typing import TYPE_CHECKING, Any, NamedTuple

from lrp_jupyter.bridges.ros_definitions import Definition, canonical, from_rosapi
from lrp_jupyter.bridges.ros_link import RefusedError, Transport
from lrp_jupyter.bridges.ros_setup import Direction
from lrp_jupyter.errors import BridgeError

if TYPE_CHECKING:
    from websockets.asyncio.client import ClientConnection

__all__ = ["RosbridgeTransport"]

_CONNECT = 3.0  # seconds to reach the server
_ANSWER = 2.0  # seconds for it to answer a question
_PING = 0.25  # seconds between two pings
_STALE = 0.6  # seconds without a pong after which it gets no more commands …
_LOST = 4.0  # … and after which the connection is given up
_FRESH = 0.5  # seconds that a command may wait for the network
_FLUSH = 0.3  # seconds for the last words
_LARGEST = 64 * 2**20  # bytes of a message; images are large


class RosbridgeTransport(Transport):
    """A rosbridge server.

    Parameters
    ----------
    url : str
        ``ws://host:9090``
    warn : callable
        Told, in a sentence, what the server complains about.
    """

    def __init__(self, url: str, warn: Callable[[str], None]) -> None:
        super().__init__()
        self.place = url
        self._warn = warn
        self._socket: _Socket | None = None
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
            Nobody answers, or nobody who speaks websocket; or `websockets` is not installed.
        """
        _require_websockets()
        self.disconnect()
        self._receivers = {}
        socket = _Socket(self.place, self._receive, self.changed)
        socket.open()
        self._socket = socket
        socket.put(json.dumps({"op": "set_level", "level": "error"}))

    def disconnect(self) -> None:
        """Close the websocket."""
        socket, self._socket = self._socket, None
        if socket is not None:
            socket.close()

    def trouble(self) -> str:
        """Say that the server hangs."""
        socket = self._socket
        hangs = socket is not None and socket.is_open and socket.is_stale
        return f"`{self.place}` does not answer any more" if hangs else ""

    def _open_socket(self) -> _Socket:
        socket = self._socket
        if socket is None or not socket.is_open:
            why = socket.ended if socket is not None else ""
            raise BridgeError(f"the connection to `{self.place}` is lost{f' ({why})' if why else ''}.")
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
            if self._has_rosapi:  # it is still there: what it asks is not
                raise BridgeError(f"`{self.place}` answers, but its ROS master does not: {error}") from None
            self._has_rosapi = False
            self._warn(
                f"`{self.place}` has no rosapi: topics are not listed, and only the most common types known"
            )
            return {}
        self._has_rosapi = True
        names, types = values.get("topics", []), values.get("types")
        if types is None:  # an old rosapi: a type at a time, for the topics that matter
            types = [self._type_of(name) for name in names]
        self._is_ros2 = any("/msg/" in str(type_) for type_ in types)
        return {str(name): canonical(str(type_)) for name, type_ in zip(names, types, strict=False)}

    def _spelled(self, type_: str) -> str:
        """Write the name of a type as this ROS does."""
        return type_.replace("/", "/msg/", 1) if self._is_ros2 else type_

    def _type_of(self, topic: str) -> str:
        return str(self._ask("/rosapi/topic_type", topic=topic).get("type", ""))

    def define(self, type_: str) -> Mapping[str, Definition]:
        """Ask rosapi about a type.

        Raises
        ------
        RefusedError
            There is none of that name.
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
        """Subscribe or advertise. A topic is subscribed to once, however many listen."""
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
        """Unsubscribe or unadvertise; on a connection that is gone there is nothing to do."""
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
            The server says that it failed, or that there is no such service.
        BridgeError
            The connection is gone, or nothing came back.
        """
        socket, key = self._open_socket(), f"q{next(self._ids)}"
        answer = socket.expect(key)
        socket.put(json.dumps({"op": "call_service", "id": key, "service": service, "args": arguments}))
        try:
            response = answer.result(_ANSWER)
        except TimeoutError:
            raise BridgeError(f"`{self.place}` does not answer what it is asked ({service}).") from None
        finally:
            socket.forget(key)
        values = response.get("values")
        if response.get("result", True) is False or not isinstance(values, dict):
            raise RefusedError(f"{service}: {values or response.get('msg') or 'no answer'}")
        return values

    def _receive(self, message: Mapping[str, Any]) -> None:
        """Take a message of the server; on the socket's thread."""
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
    socket: _Socket


class _Socket:
    """One websocket and its thread, from its opening to its end.

    Owner: the thread of its event loop; `put`, `expect` and the attributes are for others.
    """

    def __init__(
        self, url: str, receive: Callable[[Mapping[str, Any]], None], changed: Callable[[], None]
    ) -> None:
        self.ended = ""
        self.is_open = False
        self.is_stale = False
        self._url, self._receive, self._changed = url, receive, changed
        self._waiting: dict[str, Future[Mapping[str, Any]]] = {}
        self._outbox: deque[tuple[float, str, str]] = deque()  # time, topic (or ""), text
        self._loop: asyncio.AbstractEventLoop | None = None
        self._opened: Future[None] = Future()
        self._posted = asyncio.Event()
        self._closing = False
        self._thread = threading.Thread(target=self._run, name="rosbridge", daemon=True)

    def open(self) -> None:
        self._thread.start()
        try:
            self._opened.result(_CONNECT + 1)
        except TimeoutError:
            self.close()
            raise BridgeError(f"`{self._url}` does not answer.") from None

    def close(self) -> None:
        """Send the last words and end; bounded."""
        self._closing = True
        self._post()
        if self._thread is not threading.current_thread():
            self._thread.join(2 * _FLUSH + 0.5)

    def put(self, text: str, topic: str = "", urgent: bool = False) -> None:
        """Send, from any thread, without waiting; an urgent message replaces what its topic had to say."""
        if urgent:
            for entry in [entry for entry in tuple(self._outbox) if entry[1] == topic]:
                try:
                    self._outbox.remove(entry)
                except ValueError:  # it has just left
                    continue
        self._outbox.append((time.monotonic(), topic, text))
        self._post()

    def expect(self, key: str) -> Future[Mapping[str, Any]]:
        """Wait for the answer to a call of a service."""
        answer: Future[Mapping[str, Any]] = Future()
        self._waiting[key] = answer
        if not self.is_open:
            answer.set_exception(BridgeError(f"the connection to `{self._url}` is lost."))
        return answer

    def forget(self, key: str) -> None:
        self._waiting.pop(key, None)

    def _post(self) -> None:
        loop = self._loop
        if loop is not None:
            try:
                loop.call_soon_threadsafe(self._posted.set)
            except RuntimeError:  # the loop has ended
                return

    # -- on its thread ----------------------------------------------------------------------------

    def _run(self) -> None:
        try:
            asyncio.run(self._live())
        except BridgeError as error:
            self.ended = str(error)
        except Exception as error:
            self.ended = f"{type(error).__name__}: {error}"
        self.is_open, self._loop = False, None
        if not self._opened.done():
            self._opened.set_exception(BridgeError(self.ended or f"`{self._url}` closed the connection."))
        for answer in tuple(self._waiting.values()):
            if not answer.done():
                answer.set_exception(BridgeError(f"the connection to `{self._url}` is lost."))
        self._changed()

    async def _live(self) -> None:
        from websockets.exceptions import ConnectionClosed

        self._loop = asyncio.get_running_loop()
        connection = await _reach(self._url)
        self.is_open = True
        self._opened.set_result(None)
        tasks = [asyncio.ensure_future(work(connection)) for work in (self._listen, self._speak, self._watch)]
        done, others = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        self.is_open = False
        for task in others:
            task.cancel()
        await asyncio.gather(*others, return_exceptions=True)
        if self._closing:
            await connection.close()
        else:
            _cut(connection)
        for task in done:
            try:
                task.result()
            except (ConnectionClosed, TimeoutError, BridgeError) as error:
                self.ended = str(error)

    async def _listen(self, connection: ClientConnection) -> None:
        async for frame in connection:
            try:
                message = json.loads(frame)
            except ValueError:
                continue  # what cannot be read is no message; the next one may be
            if not isinstance(message, dict):
                continue
            if message.get("op") == "service_response":
                answer = self._waiting.get(str(message.get("id")))
                if answer is not None and not answer.done():
                    answer.set_result(message)
            else:
                self._receive(message)

    async def _speak(self, connection: ClientConnection) -> None:
        while True:
            await self._posted.wait()
            self._posted.clear()
            while self._outbox:
                written, topic, text = self._outbox.popleft()
                if not topic or time.monotonic() - written < _FRESH:
                    async with asyncio.timeout(_FLUSH if self._closing else _LOST):
                        await connection.send(text)
            if self._closing:
                return

    async def _watch(self, connection: ClientConnection) -> None:
        """Ping; a server that does not answer is stale, and then lost."""
        while True:
            pong = asyncio.ensure_future(await connection.ping())
            began = time.monotonic()
            while not pong.done():
                await asyncio.wait([pong], timeout=_STALE / 6)
                silence = time.monotonic() - began
                if silence > _LOST:
                    raise BridgeError(f"it has not answered for {silence:.0f} s")
                if silence > _STALE and not self.is_stale and not pong.done():
                    self.is_stale = True
                    self._changed()
            if self.is_stale:
                self.is_stale = False
                self._changed()
            await asyncio.sleep(_PING)


def _require_websockets() -> None:
    try:
        import websockets.asyncio.client  # noqa: F401  (nothing of it is imported before it is needed)
    except ImportError:
        raise BridgeError(
            "ROS over rosbridge needs the package `websockets`: install it with"
            ' `pip install "lrp-jupyter[ros]"`.'
        ) from None


async def _reach(url: str) -> ClientConnection:
    from websockets.asyncio.client import connect
    from websockets.exceptions import WebSocketException

    try:
        return await connect(
            url,
            open_timeout=_CONNECT,
            close_timeout=_FLUSH,
            ping_interval=None,  # we ask ourselves, more often
            max_size=_LARGEST,
            compression=None,
            proxy=None,
        )
    except OSError as error:
        raise BridgeError(
            f"No rosbridge server answers at `{url}` ({error.strerror or error or 'no answer'})."
            " Start it with `roslaunch rosbridge_server rosbridge_websocket.launch` (ROS 1) or"
            " `ros2 launch rosbridge_server rosbridge_websocket_launch.xml` (ROS 2), or name its `host`."
        ) from None
    except (WebSocketException, ValueError) as error:
        raise BridgeError(f"What answers at `{url}` is no rosbridge server: {error}.") from None


def _cut(connection: ClientConnection) -> None:
    """End a connection so that nothing that still waits in it arrives: no stale command."""
    socket = connection.transport.get_extra_info("socket")
    if socket is not None:
        with contextlib.suppress(OSError):
            socket.setsockopt(SOL_SOCKET, SO_LINGER, struct.pack("ii", 1, 0))
    connection.transport.abort()
