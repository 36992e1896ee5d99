"""The connection to a brick, which is read periodically and renews what turns.

The loop of a program never waits for a brick: it uses the latest reading, and its commands are sent
without waiting for an answer. Each reading detects whether the brick is still there, and its question carries
the renewals (:mod:`~lrp_jupyter.bridges.ev3.slices`).
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from lrp_jupyter.bridges.ev3 import protocol
from lrp_jupyter.bridges.ev3.client import ANSWER_TIME, BrickClient
from lrp_jupyter.bridges.ev3.protocol import SAME_MODE, BrickReading, MotorReading
from lrp_jupyter.bridges.ev3.slices import SLICE, Slices
from lrp_jupyter.bridges.link import Link
from lrp_jupyter.errors import BridgeError, NoDataYet

Pose = tuple[float, float, float]
"""x and y (metres) and the heading (radians), from where it began."""

NOWHERE: Pose = (0.0, 0.0, 0.0)

_PERIOD = 0.02  # seconds between two readings
_REST = 0.5  # seconds between two searches that failed at once
_STOP_TIME = 0.3  # seconds that sending the runstop may take


@dataclass(frozen=True, slots=True)
class BrickState:
    """The last known state of the brick."""

    reading: BrickReading | None = None
    trouble: str = ""  # why it could not be read since then
    time: float = 0.0  # when it was read, by `time.monotonic`
    pose: Pose = NOWHERE  # where the motors have driven it


@dataclass(frozen=True, slots=True)
class _Connection:
    """A connection with what goes on turning by it: nothing of that is renewed by the next one."""

    client: BrickClient
    slices: Slices


class BrickLink(Link):
    """The connection to one brick, restored after every loss.

    Owner: any thread may use it; only its own thread reads the brick.

    `find`: returns a new connection, like :func:`~lrp_jupyter.bridges.ev3.finding.connect`; its argument is a
        function that returns whether to stop searching.
    `report`: called with the state (``connected``, ``stale``, ``lost``, ``disconnected``) and a sentence when
        it changes; with ``late`` and a sentence when the brick stopped motors which nothing renewed in time.
    `advance`: returns the pose after a pose, when each motor has turned by an angle in degrees.
    `clock`: the time of the slices, in seconds.
    """

    def __init__(
        self,
        find: Callable[[Callable[[], bool]], BrickClient],
        report: Callable[[str, str], None],
        advance: Callable[[Pose, tuple[int, ...]], Pose],
        clock: Callable[[], float],
    ) -> None:
        super().__init__("EV3")
        self._find, self._report = find, report
        self._advance, self._clock = advance, clock
        self.snapshot = BrickState()
        self.name = ""
        self._connection: _Connection | None = None
        self._latest = threading.Lock()  # held while the snapshot is replaced
        self._resets = [0] * 4  # how often each motor's count was set to zero
        self._counted: tuple[int, ...] = (0,) * 4  # … at the last reading
        self.modes = [SAME_MODE] * 4  # that are wanted of the sensors, from the next reading on
        self._usual: tuple[int, ...] = (SAME_MODE,) * 4
        self.noticed: Callable[[], object] = lambda: None  # called after each reading
        self.owner: object = None  # what drives some motors, until another command is for one of them
        self._owned = 0

    @property
    def client(self) -> BrickClient | None:
        """The connection; None while there is none."""
        connection = self._connection
        return connection.client if connection else None

    def own(self, owner: object, motors: int) -> None:
        """Let motors, a bit mask, be driven by one owner, until another command reaches one of them."""
        self.owner, self._owned = owner, motors

    def command(self, code: bytes, motors: int = 0, owner: object = None) -> None:
        """Send a byte code without waiting for the brick to perform it.

        `motors`: bit mask of the motors that it commands: what they were to go on doing is over.
        `owner`: nothing is sent if the motors do not belong to it any more.
        """
        connection = self._connected()

        def compose() -> bytes:
            if not self._may(owner, motors):
                return b""
            connection.slices.release(motors)
            return code

        connection.client.command(compose)

    def turn(self, percents: Mapping[int, int], regulated: bool = True, owner: object = None) -> None:
        """Let motors turn on until another command; see :meth:`Slices.turn` and :meth:`command`."""
        connection, motors = self._connected(), sum(1 << motor for motor in percents)

        def compose() -> bytes:
            return connection.slices.turn(percents, regulated) if self._may(owner, motors) else b""

        connection.client.command(compose)

    def _may(self, owner: object, motors: int) -> bool:
        if owner is None and motors & self._owned:
            self.owner = None
        return owner is None or owner is self.owner

    def stop(self) -> None:
        """Stop all motors in one packet."""
        connection, self.owner = self._connection, None
        if connection is not None:
            _stop(connection, _STOP_TIME)
        elif self.snapshot.reading is not None and not self.is_ended:
            why = self.snapshot.trouble or "The brick is being reconnected."
            raise BridgeError(
                f"{why} What was renewed stops within {SLICE:g} s by itself, and all as soon as it is found."
            )

    def _connected(self) -> _Connection:
        connection = self._connection
        if connection is None:
            raise BridgeError(self.snapshot.trouble or "No brick is connected.")
        return connection

    def latest(self, snapshot: BrickState | None = None) -> BrickReading:
        """Return the latest reading (or that of a snapshot)."""
        seen = self.snapshot if snapshot is None else snapshot
        if seen.trouble:
            raise BridgeError(seen.trouble)
        if seen.reading is None:
            raise NoDataYet("No brick has been found yet.")
        return seen.reading

    def reset_count(self, motor: int) -> None:
        """Set the count of a motor (0 to 3) to zero, on the brick and in the latest reading."""
        with self._latest:
            self.command(protocol.clear_count(1 << motor))
            self._resets[motor] += 1
            seen = self.snapshot
            if seen.reading is not None:
                self.snapshot = replace(seen, reading=_with_zero(seen.reading, [motor]))

    def set_usual_modes(self, modes: tuple[int, ...]) -> None:
        """Set the modes of all sensors, now and whenever another sensor is plugged in; -1: its own."""
        self._usual, self.modes = modes, list(modes)

    def connect(self) -> float:
        """Search for the brick and read it once; one that was lost is stopped first: it may still drive."""
        client, again = self._find(lambda: self.is_ended), self.snapshot.reading is not None
        connection, self.owner = _Connection(client, Slices(self._clock)), None
        try:
            if again:
                _stop(connection)
            self.name = client.request(*protocol.brick_name()).split(b"\0")[0].decode("utf-8", "replace")
            self._read(connection, known=False)
        except BaseException:
            client.close()
            raise
        self._connection = connection
        sentence = self._greeting(client)
        if again:
            sentence += " It had been lost, so its motors were stopped: start them again."
        self._report("connected", sentence)
        return _PERIOD

    def attend(self) -> float:
        """Read the brick; one that refuses it stays connected."""
        connection = self._connected()
        try:
            self._read(connection)
            self.noticed()
        except BridgeError as error:
            if connection.client.lost:
                raise
            if str(error) != self.snapshot.trouble:
                self._set_trouble(str(error))
                self._report("stale", str(error))
        return _PERIOD

    def lose(self, sentence: str) -> float:
        """Report that the brick is lost, or was not found."""
        client = self.client
        if client is None:
            self._set_trouble(self.snapshot.trouble or sentence)
            if self.snapshot.reading is None:
                self._report("disconnected", f"{sentence} The search goes on.")
            return _REST
        client.lost = client.lost or sentence
        self._set_trouble(sentence)
        self.disconnect()
        self._report("lost", sentence)
        return _PERIOD

    def disconnect(self) -> None:
        """Close the connection."""
        connection, self._connection = self._connection, None
        if connection is not None:
            connection.client.close()

    def _set_trouble(self, sentence: str) -> None:
        with self._latest:
            self.snapshot = replace(self.snapshot, trouble=sentence)

    def _greeting(self, client: BrickClient) -> str:
        return f"Connected to `{self.name}` at {client.place}."

    def _read(self, connection: _Connection, known: bool = True) -> None:
        """Ask for everything, and renew what turns; a brick that is not `known` was somewhere else before."""
        client = connection.client
        resets, modes = tuple(self._resets), tuple(self.modes)
        code, size = protocol.read_everything(modes)
        late = 0

        def compose() -> bytes:
            nonlocal late
            renewals, late = connection.slices.renew()
            return renewals + code

        reading = protocol.parse_reading(client.request(compose, size))
        with self._latest:
            before = self.snapshot
            steady = [self._resets[i] == resets[i] == self._counted[i] for i in range(4)]
            self._counted = resets
            zeroed = [i for i in range(4) if self._resets[i] != resets[i]]
            pose = before.pose
            if known and before.reading is not None:
                turned = map(_turned, before.reading.motors, reading.motors, steady)
                pose = self._advance(pose, tuple(turned))
            self.snapshot = BrickState(_with_zero(reading, zeroed), "", time.monotonic(), pose)
        for port, sensor in enumerate(reading.sensors):
            if before.reading is not None and before.reading.sensors[port].type != sensor.type:
                self.modes[port] = self._usual[port]  # another sensor: it has other modes
        if late:
            names = " and ".join(f"`motor{'ABCD'[i]}`" for i in range(4) if late & 1 << i)
            self._report("late", f"{names} stopped: nothing renewed it for {SLICE:g} s. Start it again.")
        if before.trouble and connection is self._connection:
            self._report("connected", self._greeting(client))


def _stop(connection: _Connection, timeout: float = ANSWER_TIME) -> None:
    """Stop all motors of a brick, in one packet."""

    def compose() -> bytes:
        connection.slices.release(protocol.ALL_MOTORS)
        return protocol.stop(protocol.ALL_MOTORS, brake=True)

    connection.client.command(compose, timeout)


def _turned(before: MotorReading, now: MotorReading, steady: bool) -> int:
    """Return the degrees between two readings; 0 where the count began again in between."""
    return now.degrees - before.degrees if steady and before.type == now.type else 0


def _with_zero(reading: BrickReading, motors: list[int]) -> BrickReading:
    """Replace counts that were read before they were set to zero."""
    if not motors:
        return reading
    kept = tuple(m._replace(degrees=0) if i in motors else m for i, m in enumerate(reading.motors))
    return reading._replace(motors=kept)
