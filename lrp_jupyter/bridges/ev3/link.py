"""The connection to a brick: one thread that reads it, detects its loss and reconnects.

The loop of a program never waits for a brick: it uses the latest reading, and its commands are sent
without waiting for an answer. Each reading of the thread detects whether the brick is still there.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from lrp_jupyter.bridges.ev3 import protocol
from lrp_jupyter.bridges.ev3.client import BrickClient
from lrp_jupyter.bridges.ev3.protocol import SAME_MODE, BrickReading
from lrp_jupyter.errors import BridgeError, NoDataYet, ended

__all__ = ["BrickLink", "BrickState"]

_PERIOD = 0.02  # seconds between two readings
_REST = 0.5  # seconds between two searches that failed at once
_STOP_TIME = 0.3  # seconds that sending the runstop may take

Find = Callable[[Callable[[], bool]], BrickClient]
OnStatus = Callable[[str, str], None]


@dataclass(frozen=True, slots=True)
class BrickState:
    """The last known state of the brick.

    Attributes
    ----------
    reading : BrickReading or None
        None before the first one.
    trouble : str
        The reason why it could not be read since then.
    time : float
        When it was read, by `time.monotonic`.
    """

    reading: BrickReading | None = None
    trouble: str = ""
    time: float = 0.0


class BrickLink:
    """The connection to one brick over its losses.

    Owner: any thread may use it; its own one is the only one that reads the brick.

    Parameters
    ----------
    find : callable
        Returns a new connection, like :func:`~lrp_jupyter.bridges.ev3.client.connect`; its argument is
        a function that returns whether to stop searching.
    report : callable
        Called with the state (``connected``, ``stale``, ``lost``, ``disconnected``) and a sentence when
        it changes.
    """

    def __init__(self, find: Find, report: OnStatus) -> None:
        self._find, self._report = find, report
        self.snapshot = BrickState()
        self.name = ""
        self._client: BrickClient | None = None
        self._closing = threading.Event()
        self._latest = threading.Lock()  # held while the snapshot is replaced
        self._resets = [0] * 4  # how often each motor's count was set to zero
        self._modes = [SAME_MODE] * 4
        self._thread = threading.Thread(target=self._run, name="EV3", daemon=True)

    @property
    def client(self) -> BrickClient | None:
        """The connection; None while there is none."""
        return self._client

    def open(self) -> None:
        """Find the brick and read it once; then read it periodically.

        Raises
        ------
        BridgeError
            It was not found, or cannot be read.
        """
        self._adopt(self._find(self._closing.is_set))
        self._thread.start()

    def search(self) -> None:
        """Search for the brick in the background for as long as it takes."""
        self._thread.start()

    def close(self) -> None:
        """End the thread and the connection; idempotent."""
        self._closing.set()
        if self._thread.is_alive() and self._thread is not threading.current_thread():
            self._thread.join(2.0)
        self._disconnect()

    def command(self, code: bytes) -> None:
        """Send a byte code without waiting for the brick to perform it.

        Raises
        ------
        BridgeError
            There is no connection.
        """
        client = self._client
        if client is None:
            raise BridgeError(self.snapshot.trouble or "No brick is connected.")
        client.command(code)

    def stop(self) -> None:
        """Stop all motors in one packet.

        Raises
        ------
        BridgeError
            The brick was lost, so its motors may turn; they are stopped when it is found again.
        """
        client = self._client
        if client is not None:
            client.command(protocol.stop(protocol.ALL_MOTORS, brake=True), _STOP_TIME)
        elif self.snapshot.reading is not None and not self._closing.is_set():
            why = self.snapshot.trouble or "The brick is being reconnected."
            raise BridgeError(f"{why} It is stopped as soon as it is found.")

    def latest(self, snapshot: BrickState | None = None) -> BrickReading:
        """Return the latest reading (or that of a snapshot).

        Raises
        ------
        NoDataYet
            Nothing has arrived yet.
        BridgeError
            The brick was lost, or refuses to be read.
        """
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

    def set_mode(self, sensor: int, mode: int) -> None:
        """Set the mode of a sensor (0 to 3) from the next reading on."""
        self._modes[sensor] = mode

    def wanted_mode(self, sensor: int) -> int:
        """Return the requested mode; -1 for none."""
        return self._modes[sensor]

    def _run(self) -> None:
        while not self._closing.is_set():
            pause = _PERIOD
            try:
                if self._client is None:
                    self._adopt(self._find(self._closing.is_set), again=self.snapshot.reading is not None)
                else:
                    self._read(self._client)
            except BridgeError as error:
                pause = self._handle_trouble(str(error))
            except (
                Exception
            ) as error:  # a fault of this bridge: report it rather than continue with old readings
                self._handle_trouble(ended(f"The EV3 bridge itself failed: {type(error).__name__}: {error}"))
                break
            self._closing.wait(pause)
        self._disconnect()

    def _handle_trouble(self, trouble: str) -> float:
        """Report a trouble, once; return the seconds until the next attempt."""
        if self._closing.is_set():
            return 0.0
        client, known = self._client, self.snapshot.trouble
        refused = client is not None and not client.lost
        with self._latest:
            if refused or not known:
                self.snapshot = replace(self.snapshot, trouble=trouble)
        if not refused:
            self._disconnect()
        if client is not None and trouble != known:
            self._report("stale" if refused else "lost", trouble)
        elif client is None and self.snapshot.reading is None:
            self._report("disconnected", f"{trouble} The search goes on.")
        return _PERIOD if client is not None else _REST

    def _adopt(self, client: BrickClient, again: bool = False) -> None:
        """Adopt a new connection. A brick that was lost may still be driving: it is stopped first."""
        try:
            if again:
                client.command(protocol.stop(protocol.ALL_MOTORS, brake=True))
            self.name = client.request(*protocol.brick_name()).split(b"\0")[0].decode("utf-8", "replace")
            self._read(client)
        except BaseException:
            client.close()
            raise
        self._client = client
        sentence = f"Connected to `{self.name}` at {client.place}."
        if again:
            sentence += " It had been lost, so its motors were stopped: start them again."
        self._report("connected", sentence)

    def _read(self, client: BrickClient) -> None:
        resets, modes = tuple(self._resets), tuple(self._modes)
        reading = protocol.parse_reading(client.request(*protocol.read_everything(modes)))
        with self._latest:
            before = self.snapshot
            zeroed = [motor for motor in range(4) if self._resets[motor] != resets[motor]]
            self.snapshot = BrickState(_with_zero(reading, zeroed), "", time.monotonic())
        for port, sensor in enumerate(reading.sensors):
            if before.reading is not None and before.reading.sensors[port].type != sensor.type:
                self._modes[port] = SAME_MODE  # another sensor: it has other modes
        if before.trouble and client is self._client:
            self._report("connected", f"Connected to `{self.name}` at {client.place}.")

    def _disconnect(self) -> None:
        client, self._client = self._client, None
        if client is not None:
            client.close()


def _with_zero(reading: BrickReading, motors: list[int]) -> BrickReading:
    """Replace counts that were read before they were set to zero."""
    if not motors:
        return reading
    kept = tuple(m._replace(degrees=0) if i in motors else m for i, m in enumerate(reading.motors))
    return reading._replace(motors=kept)
