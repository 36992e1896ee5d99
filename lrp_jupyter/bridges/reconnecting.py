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

from abc import abstractmethod
from typing import ClassVar

from lrp_jupyter.bridges.bridge import Bridge, ConnectionState
from lrp_jupyter.bridges.link import Link
from lrp_jupyter.bridges.panel import Panel
from lrp_jupyter.errors import BridgeError, ended, sentence_of

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

    _kept_link: Link | None = None  # an unusual name: an author's class has attributes, too

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
        if self._kept_link is not None and not self._kept_link.has_ended(self.connect_within):
            raise BridgeError(f"The last connection of `{self.name}` has not ended yet. Try again later.")
        self._kept_link = _AuthorsLink(self)
        if not self._kept_link.open(self.connect_within):
            raise BridgeError(f"`{self.name}` did not connect within {self.connect_within:g} s.")
        return None

    def close_interface(self) -> None:
        """End the thread and the connection."""
        if self._kept_link is not None:
            self._kept_link.close()


class _AuthorsLink(Link):
    """The connection that the author of a bridge has written."""

    def __init__(self, bridge: ReconnectingBridge) -> None:
        super().__init__(f"bridge {bridge.name}")
        self._bridge = bridge
        self._wait = bridge.retry_after
        self._is_made = False  # and has to be closed

    def connect(self) -> float:
        bridge = self._bridge
        bridge.connect()
        self._is_made, self._wait = True, bridge.retry_after
        if bridge.safety.lost and not self.is_ended:
            bridge.set_status(ConnectionState.CONNECTED)  # unless `connect` has said so itself
        return 0.0

    def attend(self) -> float:
        fed = self._bridge.fed.count
        self._bridge.receive()
        return _IDLE if self._bridge.fed.count == fed else 0.0

    def lose(self, sentence: str) -> float:
        self._bridge.set_status(ConnectionState.LOST, f"{sentence} It is tried again.")
        wait, self._wait = self._wait, min(2 * self._wait, _LONGEST * self._bridge.retry_after)
        return wait

    def disconnect(self) -> None:
        with self._changed:
            was_made, self._is_made = self._is_made, False
        if was_made:
            bridge = self._bridge
            try:
                bridge.disconnect()
            except Exception as error:  # it is gone in any case
                bridge.safety.notice("fault", f"Disconnecting `{bridge.name}` failed: {sentence_of(error)}")

    def explain(self, error: BaseException) -> str:
        if isinstance(error, BridgeError):
            return str(error)
        if isinstance(error, (OSError, EOFError)):
            what = "no longer answers" if self._is_made else "cannot be reached"
            why = getattr(error, "strerror", None) or sentence_of(error)
            return ended(f"`{self._bridge.name}` {what}: {why}")
        return f"`{'receive' if self._is_made else 'connect'}` raised {sentence_of(error)}"
