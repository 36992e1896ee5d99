"""The websockets to a rosbridge server, on one thread.

Two things matter to a robot. A command is sent now or never: what could not leave within half a
second, or was waiting when the connection broke, is dropped; only a stop waits for the network. And a server
that hangs is noticed: it is pinged four times a second, and is called stale until it answers, so that
commands do not pile up in the network and arrive when they are outdated. Anything that arrives is a sign of
life, since a pong waits behind a large message. A link that is slow but steady is given more time, several of
its round trips.
"""

from __future__ import annotations

import asyncio
import contextlib
import math
import ssl
import struct
import threading
import time
from collections import deque
from collections.abc import Callable, Coroutine, Mapping
from concurrent.futures import Future
from socket import SO_LINGER, SOL_SOCKET
from statistics import median
from typing import TYPE_CHECKING, Any

from lrp_jupyter.bridges.ros.frames import Fragments, decode
from lrp_jupyter.errors import BridgeError, NoAnswerError, ended, sentence_of

if TYPE_CHECKING:
    from websockets.asyncio.client import ClientConnection

_CONNECT = 3.0  # seconds to reach the server
_PING = 0.25  # seconds between two pings
_STALE = 0.6  # seconds without a sign of life after which it gets no more commands …
_LOST = 4.0  # … and after which the connection is closed
_STALE_TRIPS, _LOST_TRIPS = 2.5, 6.0  # the same, as multiples of the usual round trip of a slow link
_SLOWEST = 2.0  # seconds of a round trip; a link that is slower gets no more time
_FRESH = 0.5  # seconds that a command may wait for the network
_FLUSH = 0.3  # seconds to send what is queued
_LARGEST = 64 * 2**20  # bytes of a message; images are large


class Bell:
    """Something that a coroutine waits for, and that any thread may ring."""

    def __init__(self) -> None:
        self._was_rung = False
        self._event = asyncio.Event()
        self._loop: asyncio.AbstractEventLoop | None = None

    def ring(self) -> None:
        """Wake the coroutine, now or when it next waits."""
        self._was_rung = True
        if self._loop is not None:
            with contextlib.suppress(RuntimeError):  # the loop has ended
                self._loop.call_soon_threadsafe(self._event.set)

    async def wait(self, seconds: float | None = None) -> None:
        """Wait until it is rung, but no longer than this."""
        self._loop = asyncio.get_running_loop()
        if not self._was_rung:
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(seconds):  # `wait_for` may miss that it is cancelled
                    await self._event.wait()
        self._was_rung = False
        self._event.clear()


class Socket:
    """One websocket, from its opening to its end.

    Owner: the event loop that it was connected in; any thread may call `put` and read the attributes.

    `receive`: given each message of the server; in that loop.
    `changed`: called when the server begins or ceases to hang, and at the end of `open`'s thread.
    """

    def __init__(
        self, url: str, receive: Callable[[Mapping[str, Any]], None], changed: Callable[[], None]
    ) -> None:
        self.ended = ""  # why; empty for no special reason
        self.is_open = False
        self.is_stale = False
        self.round_trip: float | None = None  # recent median of the seconds until a pong
        self._url, self._receive, self._changed = url, receive, changed
        self._outbox: deque[tuple[float, str, str]] = deque()  # since when, topic (or ""), text
        self._posted = Bell()
        self._is_closing = False
        self._opened: Future[None] = Future()
        self._thread: threading.Thread | None = None

    def open(self, beside: Callable[[], Coroutine[Any, Any, None]]) -> None:
        """Connect, on a thread with an event loop in which something else runs beside; bounded."""
        self._thread = threading.Thread(target=self._run, args=(beside,), name="rosbridge", daemon=True)
        self._thread.start()
        try:
            self._opened.result(_CONNECT + 1)
        except TimeoutError:
            self.close()
            raise NoAnswerError(f"`{self._url}` does not answer.") from None

    def close(self) -> None:
        """Send what is queued and end; wait for the thread, in bounded time."""
        self._is_closing = True
        self._posted.ring()
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join(2 * _FLUSH + 0.5)

    def put(self, text: str, topic: str = "", urgent: bool = False) -> None:
        """Send, without waiting; an urgent message replaces those queued for its topic, and never expires."""
        if urgent:
            for entry in [entry for entry in tuple(self._outbox) if entry[1] == topic]:
                try:
                    self._outbox.remove(entry)
                except ValueError:  # it has just left
                    continue
        self._outbox.append((math.inf if urgent else time.monotonic(), topic, text))
        self._posted.ring()

    def run(self, work: Coroutine[Any, Any, None]) -> None:
        """Have something run in its loop beside the rest; it is cancelled at the end. From any thread."""
        try:
            asyncio.run_coroutine_threadsafe(work, self._loop)
        except RuntimeError:  # the loop has ended
            work.close()
            raise BridgeError(f"The connection to `{self._url}` is lost.") from None

    # -- in its loop ------------------------------------------------------------------------------

    def _run(self, beside: Callable[[], Coroutine[Any, Any, None]]) -> None:
        kind = BridgeError
        try:
            asyncio.run(self._live(beside))
        except Exception as error:
            self.ended = sentence_of(error)
            kind = NoAnswerError if isinstance(error, NoAnswerError) else BridgeError
        if not self._opened.done():
            self._opened.set_exception(kind(self.ended or f"`{self._url}` closed the connection."))
        self._changed()

    async def _live(self, beside: Callable[[], Coroutine[Any, Any, None]]) -> None:
        connection, self._loop = await self.connect(), asyncio.get_running_loop()
        self._opened.set_result(None)
        await self.serve(connection, beside())
        others = asyncio.all_tasks() - {asyncio.current_task()}
        if self._is_closing and others:
            await asyncio.wait(others, timeout=_FLUSH)

    async def connect(self) -> ClientConnection:
        """Return the connection for `serve`."""
        began = time.monotonic()
        connection = await _reach(self._url)
        self._trips = deque([(time.monotonic() - began) / 2], maxlen=5)  # connecting takes two, or more
        self.is_open = True
        return connection

    async def serve(self, connection: ClientConnection, *others: Coroutine[Any, Any, None]) -> None:
        """Send, receive and ping until the end, which is that of the other coroutines, too."""
        from websockets.exceptions import ConnectionClosed

        own = (work(connection) for work in (self._listen, self._speak, self._watch))
        tasks = [asyncio.ensure_future(each) for each in (*own, *others)]
        try:
            done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            self.is_open = False
            for task in tasks:
                task.cancel()
            if self._is_closing:
                await connection.close()
            else:
                _cut(connection)  # first: waiting may be cancelled
            await asyncio.gather(*tasks, return_exceptions=True)
        for task in done:
            try:
                task.result()
            except ConnectionClosed as error:
                self.ended = "It was cut."
                if error.rcvd is not None:
                    why = f": {error.rcvd.reason}" if error.rcvd.reason else ""
                    self.ended = ended(f"The server has closed it{why}")
            except (TimeoutError, BridgeError) as error:
                self.ended = str(error)

    async def _listen(self, connection: ClientConnection) -> None:
        fragments = Fragments()
        async for frame in connection:
            message = fragments.join(decode(frame))
            if message is not None:  # else the next one may be one
                self._receive(message)

    async def _speak(self, connection: ClientConnection) -> None:
        while True:
            await self._posted.wait()
            while self._outbox:
                written, topic, text = self._outbox.popleft()
                if not topic or time.monotonic() - written < _FRESH:
                    async with asyncio.timeout(_FLUSH if self._is_closing else _LOST):
                        await connection.send(text)
            if self._is_closing:
                return

    async def _watch(self, connection: ClientConnection) -> None:
        """Ping; a server that does not answer is stale, and then lost."""
        while True:
            pong = asyncio.ensure_future(await connection.ping())
            began = time.monotonic()
            usual = min(median(self._trips), _SLOWEST)
            stale, lost = max(_STALE, _STALE_TRIPS * usual), max(_LOST, _LOST_TRIPS * usual)
            while not pong.done():
                await asyncio.wait([pong], timeout=_STALE / 6)
                silence = time.monotonic() - max(began, connection.heard)  # type: ignore[attr-defined]
                if silence > lost:
                    raise BridgeError(f"The server has not answered for {silence:.0f} s.")
                if silence > stale and not self.is_stale and not pong.done():
                    self.is_stale = True
                    self._changed()
            self._trips.append(pong.result())
            self.round_trip = median(self._trips)
            if self.is_stale:
                self.is_stale = False
                self._changed()
            await asyncio.sleep(_PING)


def require_websockets() -> None:
    """Check that the library is installed, which is imported only where it is needed."""
    try:
        import websockets.asyncio.client  # noqa: F401
    except ImportError:
        raise BridgeError(
            "ROS over rosbridge needs the package `websockets`. Install it with"
            ' `pip install "lrp-jupyter[ros]"`.'
        ) from None


async def _reach(url: str) -> ClientConnection:
    from websockets.asyncio.client import ClientConnection, connect
    from websockets.exceptions import WebSocketException

    class Connection(ClientConnection):
        """One that notes when it last heard of the server: a large message is long under way."""

        heard = 0.0

        def data_received(self, data: bytes) -> None:
            self.heard = time.monotonic()
            super().data_received(data)

    try:
        return await connect(
            url,
            create_connection=Connection,
            open_timeout=_CONNECT,
            close_timeout=_FLUSH,
            ping_interval=None,  # the loop below pings more often
            max_size=_LARGEST,
            compression=None,
            proxy=None,
        )
    except ssl.SSLCertVerificationError as error:
        raise BridgeError(
            f"The certificate of `{url}` is not trusted: {ended(error.verify_message)} If the robot made it"
            " itself, copy it here as a file, and name this in the environment variable `SSL_CERT_FILE`"
            " (in a notebook: `%env SSL_CERT_FILE=robot.pem`)."
        ) from None
    except OSError as error:
        why = error.strerror or str(error) or type(error).__name__
        hint = ", or write `ws://` if it does not encrypt" if url.startswith("wss:") else ""
        raise NoAnswerError(
            f"No rosbridge server answers at `{url}` ({why})."
            " Start it with `roslaunch rosbridge_server rosbridge_websocket.launch` (ROS 1) or"
            " `ros2 launch rosbridge_server rosbridge_websocket_launch.xml` (ROS 2), or name its"
            f" `host`{hint}."
        ) from None
    except (WebSocketException, ValueError) as error:
        raise BridgeError(f"The server at `{url}` is not a rosbridge server: {error}.") from None


def _cut(connection: ClientConnection) -> None:
    """Abort a connection so that nothing queued in it arrives: no stale command."""
    socket = connection.transport.get_extra_info("socket")
    if socket is not None:
        with contextlib.suppress(OSError):
            socket.setsockopt(SOL_SOCKET, SO_LINGER, struct.pack("ii", 1, 0))
    connection.transport.abort()
