r"""A base for bridges with a connection of their own that is read by waiting: a socket, a serial line.

The author writes what is done once, and nothing about threads::

    class MyBot(ReconnectingBridge):
        name = "mybot"

        def __init__(self, port: str = "/dev/ttyUSB0"):
            self.port = port

        def add_members(self):
            self.feed("light.data", doc="0 dark ... 255 bright", type=int)
            self.add_method("move", self.move, "drive, in m/s", limits={"linear": 0.5})

        def connect(self):
            self.line = serial.Serial(self.port, timeout=0.5)

        def receive(self):
            if text := self.line.readline():
                self.feed("light.data", int(text))

        def disconnect(self):
            self.line.close()

        def move(self, linear=0.0):
            self.line.write(b"v %.2f\n" % linear)

A library that calls back on a thread of its own needs no other base than `Bridge`: feed in the callback, and
set the status where the library reports its connection::

    def open_interface(self):
        self.client.on_message = lambda client, data, message: self.feed("light.data", int(message.payload))
        self.client.on_disconnect = lambda *_: self.set_status("lost", "The broker does not answer.")
        self.client.on_connect = lambda *_: self.set_status("connected")
        self.client.connect(self.host)
        self.client.loop_start()

    def close_interface(self):
        self.client.disconnect()
        self.client.loop_stop()
"""

from __future__ import annotations

import threading
from abc import abstractmethod
from collections.abc import Iterator
from concurrent.futures import Future, wait
from typing import ClassVar

from lrp_jupyter.bridges.bridge import Bridge, ConnectionState
from lrp_jupyter.bridges.interface import part
from lrp_jupyter.bridges.panel import Panel
from lrp_jupyter.errors import BridgeError, ended, sentence_of

_CALM = 0.3  # s that `receive` has to return before its connection is closed under it
_JOIN = 0.7  # s that it has then
_IDLE = 0.001  # s of rest after a `receive` that fed nothing: it may not have waited
_LONGEST = 16  # times `retry_after`


class ReconnectingBridge(Bridge, offered=False):
    """A bridge whose connection is read on a thread of the base, and made again whenever it is lost.

    A subclass writes `connect`, `receive` and `disconnect`, and adds its members in `add_members`. Whatever
    `receive` raises is a loss with a sentence, never a thread that died unseen: the robot is stopped, its
    commands are refused, and `connect` is tried again until it succeeds. Then the robot is stopped before
    anything else is sent.

    Attributes
    ----------
    connect_within : float
        Seconds that the first `connect` may take before opening is given up.
    retry_after : float
        Seconds from a loss to the first attempt to connect again; the waits between later ones double.
    """

    connect_within: ClassVar[float] = 8.0
    retry_after: ClassVar[float] = 0.5

    _thread: threading.Thread | None = None
    _connected = False
    """Whether there is a connection that has to be closed."""

    _ending = part(lambda bridge: threading.Event())
    _disconnecting = part(lambda bridge: threading.Lock())

    # -- what the author of a bridge writes -------------------------------------------------------

    @abstractmethod
    def connect(self) -> None:
        """Connect to the robot, in bounded time; called again after each loss.

        It may set a status with a sentence of its own: ``self.set_status("connected", "Connected to …")``.

        Raises
        ------
        BridgeError, OSError
            The robot cannot be reached; the message of a BridgeError says what to do.
        """

    @abstractmethod
    def receive(self) -> None:
        """Wait for data, and `feed` what has come; return at once then, and otherwise within a second.

        Called again and again while there is a connection, on the thread of the base.

        Raises
        ------
        BridgeError, OSError
            The connection is lost. So it is after any other exception.
        """

    def disconnect(self) -> None:
        """Close the connection; called once for each that was made, also while `receive` waits."""

    # ---------------------------------------------------------------------------------------------

    def open_interface(self) -> Panel | None:
        """Connect, and keep the connection up on a thread until the bridge is closed.

        Raises
        ------
        BridgeError
            The robot did not answer in time.
        """
        if self._thread is not None:  # of an earlier connection whose `connect` or `receive` has not returned
            self._thread.join(self.connect_within)
            if self._thread.is_alive():
                raise BridgeError(f"The last connection of `{self.name}` has not ended yet. Try again later.")
        self._ending, first = threading.Event(), Future[None]()
        self._thread = threading.Thread(
            target=self._run, args=(self._ending, first), name=f"bridge {self.name}", daemon=True
        )
        self._thread.start()
        if not wait([first], self.connect_within).done:
            self._ending.set()
            raise BridgeError(f"`{self.name}` did not connect within {self.connect_within:g} s.")
        first.result()
        return None

    def close_interface(self) -> None:
        """End the thread and the connection."""
        self._ending.set()
        if self._thread is None or self._thread is threading.current_thread():
            return
        self._thread.join(_CALM)
        self._disconnect()  # ends a `receive` that still waits
        self._thread.join(_JOIN)

    def _run(self, ending: threading.Event, first: Future[None]) -> None:
        waits = _waits(self.retry_after)
        while not ending.is_set():
            try:
                self.connect()
                self._connected = True
                waits = _waits(self.retry_after)
                if self.safety.lost and not ending.is_set():
                    self.set_status(ConnectionState.CONNECTED)  # unless `connect` has said so itself
                if not first.done():
                    first.set_result(None)
                self._receive(ending)
            except BaseException as error:
                sentence = self._sentence("receive" if self._connected else "connect", error)
                if not first.done():
                    first.set_exception(BridgeError(sentence))
                    return
                if not ending.is_set():
                    self.set_status(ConnectionState.LOST, f"{sentence} It is tried again.")
                    self._disconnect()
                    ending.wait(next(waits))
        self._disconnect()

    def _receive(self, ending: threading.Event) -> None:
        while not ending.is_set():
            fed = self.fed.count
            self.receive()
            if self.fed.count == fed:
                ending.wait(_IDLE)

    def _sentence(self, hook: str, error: BaseException) -> str:
        if isinstance(error, BridgeError):
            return str(error)
        if isinstance(error, (OSError, EOFError)):
            what = "cannot be reached" if hook == "connect" else "no longer answers"
            return ended(f"`{self.name}` {what}: {getattr(error, 'strerror', None) or sentence_of(error)}")
        return f"`{hook}` raised {sentence_of(error)}"

    def _disconnect(self) -> None:
        """Close the connection, once."""
        with self._disconnecting:
            was_connected, self._connected = self._connected, False
        if was_connected:
            try:
                self.disconnect()
            except Exception as error:  # it is gone in any case
                self.safety.notice("fault", f"Disconnecting `{self.name}` failed: {sentence_of(error)}")


def _waits(first: float) -> Iterator[float]:
    """Yield the seconds between attempts to connect."""
    factor = 1
    while True:
        yield first * factor
        factor = min(2 * factor, _LONGEST)
