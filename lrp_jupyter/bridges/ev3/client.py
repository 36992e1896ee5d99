"""The TCP client of a Lego EV3 brick: every call ends in time, with a result or a `BridgeError`.

The brick's own firmware accepts TCP only from a host that has answered its UDP beacon, which it
sends every few seconds. Then it expects an unlocking text, and after that frames
(:mod:`~lrp_jupyter.bridges.ev3.protocol`).

A connection that fails once is lost for good: it is cut, not closed, so that nothing that was
still under way reaches the brick later. Call :func:`connect` again for another one.
"""

from __future__ import annotations

import ipaddress
import re
import socket
import struct
import sys
import threading
import time
from collections.abc import Callable
from contextlib import closing, suppress
from functools import partial
from typing import NamedTuple, NoReturn, TypeVar

from lrp_jupyter.bridges.ev3.protocol import BrickReply, frame, split_replies
from lrp_jupyter.errors import BridgeError

__all__ = [
    "ANSWER_TIME",
    "Beacon",
    "BrickClient",
    "BusyError",
    "NoBrickError",
    "check_address",
    "connect",
    "parse_beacon",
]

ANSWER_TIME = 0.5
"""Seconds in which a brick must answer, or the connection is lost."""

_OPEN_TIME = 1.5  # seconds to connect and to unlock it: a lost first packet is sent again after 1 s
_SLICE = 0.05  # seconds that a socket waits before the time and other events are checked
_UNLOCKED = b"Accept:EV340\r\n\r\n"
_PAUSE = 0.5  # seconds between two attempts at the same address

# Value of SO_LINGER with which closing discards what has not been delivered
_ABORT = struct.pack("hh" if sys.platform == "win32" else "ii", 1, 0)

_Value = TypeVar("_Value")


class NoBrickError(BridgeError):
    """A host answers at an address, but not as a brick does."""


class BusyError(BridgeError):
    """A host accepts a connection and hangs up, as a brick does that serves another client."""


class BrickClient:
    """One connection to a brick. Any thread may call any method.

    Parameters
    ----------
    address : tuple of str and int
        Where the brick is: IP address and TCP port.
    serial : str
        Its serial number, as in its beacon; may be empty.

    Attributes
    ----------
    lost : str
        Why the connection is lost, a sentence; empty while connected.

    Raises
    ------
    BridgeError
        Nothing answers there within 1.5 s, or not as a brick does.
    """

    def __init__(self, address: tuple[str, int], serial: str = "") -> None:
        self.address = address
        self.serial = serial
        self.lost = ""
        self._sending = threading.Lock()  # held while the bytes of one frame go out
        self._asking = threading.Lock()  # held from a question to its answer
        self._counter = 0
        self._received = b""
        deadline = time.monotonic() + _OPEN_TIME
        try:
            self._socket = socket.create_connection(address, _OPEN_TIME)
        except OSError as error:
            raise BridgeError(f"No connection to {address[0]}:{address[1]}: {_reason(error)}.") from None
        try:
            self._socket.settimeout(_SLICE)
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._unlock(deadline)
        except BaseException:
            self.close()
            raise

    def _unlock(self, deadline: float) -> None:
        text = f"GET /target?sn={self.serial} VMTP1.0\r\nProtocol: EV3"
        where, answer = f"{self.address[0]}:{self.address[1]}", b""
        try:
            self._send_bytes(text.encode(), deadline)
            while len(answer) < len(_UNLOCKED) and _UNLOCKED.startswith(answer):
                answer += self._receive_bytes(len(_UNLOCKED) - len(answer), deadline)
        except BridgeError:
            if not answer and time.monotonic() < deadline:
                busy = f"{where} hung up. Is another program connected to the brick?"
                raise BusyError(busy) from None
            raise NoBrickError(f"{where} is not an EV3 brick: it does not answer as one.") from None
        if answer != _UNLOCKED:
            raise NoBrickError(f"{where} is not an EV3 brick: it answers {answer!r}.")

    def command(self, code: bytes, timeout: float = ANSWER_TIME) -> None:
        """Send a byte code without waiting for the brick to perform it.

        Raises
        ------
        BridgeError
            The connection is lost, or does not accept the frame within `timeout` seconds.
        """
        self._send(code, 0, False, time.monotonic() + timeout)

    def request(self, code: bytes, size: int, timeout: float = ANSWER_TIME) -> bytes:
        """Send a byte code and wait for its answer.

        Parameters
        ----------
        code : bytes
        size : int
            Bytes that the answer has.
        timeout : float
            Seconds that all of it may take.

        Raises
        ------
        BridgeError
            The brick refuses the command (and stays connected), or the connection is lost.
        """
        deadline = time.monotonic() + timeout
        if not self._asking.acquire(timeout=timeout):
            raise BridgeError("The brick is still busy with another request.")
        try:
            counter = self._send(code, size, True, deadline)
            while True:
                for reply in self._receive(deadline):
                    if reply.counter == counter:  # others were given up
                        if not reply.ok:
                            raise BridgeError("The brick refused a command.")
                        return reply.data
        finally:
            self._asking.release()

    def lose(self, why: str) -> NoReturn:
        """Mark the connection as lost and raise; all waiting callers get the same error.

        Raises
        ------
        BridgeError
            Always.
        """
        self.lost = self.lost or why
        with suppress(OSError):
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _ABORT)
        raise BridgeError(self.lost)

    def close(self) -> None:
        """Close the socket. What was sent still arrives, unless the connection was lost."""
        self.lost = self.lost or "The connection is closed."
        free = self._sending.acquire(timeout=ANSWER_TIME)
        self._socket.close()
        if free:
            self._sending.release()

    def _send(self, code: bytes, size: int, reply: bool, deadline: float) -> int:
        if not self._sending.acquire(timeout=max(0.0, deadline - time.monotonic())):
            self.lose("The brick accepts no more commands.")
        try:
            self._counter = self._counter % 0xFFFF + 1
            self._send_bytes(frame(self._counter, code, size, reply), deadline)
            return self._counter
        finally:
            self._sending.release()

    def _send_bytes(self, data: bytes, deadline: float) -> None:
        while data:
            sent = self._wait(partial(self._socket.send, data), deadline, "accepts no commands")
            data = data[sent:]

    def _receive(self, deadline: float) -> list[BrickReply]:
        while True:
            try:
                replies, self._received = split_replies(self._received)
            except BridgeError as error:
                self.lose(str(error))
            if replies:
                return replies
            self._received += self._receive_bytes(4096, deadline)

    def _receive_bytes(self, size: int, deadline: float) -> bytes:
        data = self._wait(partial(self._socket.recv, size), deadline, "does not answer")
        if not data:
            self.lose("The brick closed the connection.")
        return data

    def _wait(self, act: Callable[[], _Value], deadline: float, complaint: str) -> _Value:
        while True:
            if self.lost:
                raise BridgeError(self.lost)
            try:
                return act()
            except TimeoutError:
                if time.monotonic() >= deadline:
                    self.lose(f"The brick {complaint}.")
            except OSError as error:
                self.lose(f"The connection to the brick broke: {_reason(error)}.")


class Beacon(NamedTuple):
    """The beacon of a brick: its address and serial number."""

    serial: str
    port: int
    name: str


def parse_beacon(data: bytes) -> Beacon | None:
    """Parse a datagram; return None if it is not a brick's beacon."""
    fields = dict(re.findall(r"([\w-]+): *([^\r\n]*?) *[\r\n]", data.decode("utf-8", "replace")))
    port = int(fields["Port"]) if re.fullmatch(r"[0-9]{1,5}", fields.get("Port", "")) else 0
    serial = fields.get("Serial-Number", "")
    if fields.get("Protocol") != "EV3" or not 0 < port < 65536 or not re.fullmatch(r"\w+", serial):
        return None
    return Beacon(serial, port, fields.get("Name", ""))


class _Ear:
    """Listens for beacons; deaf where another program holds the port."""

    def __init__(self, port: int) -> None:
        self.deaf = ""
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.settimeout(_SLICE)
        try:
            self._socket.bind(("", port))
        except OSError as error:
            self.deaf = f"Cannot listen on UDP port {port}: {_reason(error)}."

    def hear(self) -> tuple[Beacon, tuple[str, int]] | None:
        """Wait one slice of time for a beacon and its source."""
        if self.deaf:
            time.sleep(_SLICE)
            return None
        try:
            data, source = self._socket.recvfrom(1024)
        except OSError:  # nothing came, or an earlier answer was rejected
            return None
        beacon = parse_beacon(data)
        return beacon and (beacon, source)

    def answer(self, source: tuple[str, int]) -> None:
        """Answer a beacon, so that the brick accepts a connection."""
        with suppress(OSError):
            self._socket.sendto(b" ", source)

    def close(self) -> None:
        self._socket.close()


def connect(
    host: str | None = None,
    *,
    port: int = 5555,
    serial: str = "",
    patience: float = 12.0,
    beacon_port: int = 3015,
    cancelled: Callable[[], bool] = lambda: False,
) -> BrickClient:
    """Find a brick and open a connection to it.

    Its beacon is waited for and answered; where an address is given, TCP is tried as well.

    Parameters
    ----------
    host : str or None
        Its IP address; None for the first brick whose beacon is heard.
    port : int
        TCP port for a brick that is found by its address alone.
    serial : str
        Only the brick with this serial number; empty for any.
    patience : float
        Seconds to wait for a beacon.
    beacon_port : int
        UDP port that bricks send their beacons to.
    cancelled : callable
        Called about ten times a second; returns whether to stop searching.

    Raises
    ------
    BridgeError
        No brick was found, or the host is not a brick (then at once).
    """
    deadline = time.monotonic() + patience
    trouble, busy = "", False
    with closing(_Ear(beacon_port)) as ear:
        if host is not None:
            host = check_address(host)
        elif ear.deaf:
            raise BridgeError(f"No beacon of a brick can be heard. {ear.deaf}")
        tried = found = float("-inf")  # when TCP was tried last, when a beacon was answered last
        address = None if host is None else (host, port)
        while True:
            now = time.monotonic()
            if address is not None and (now - tried >= _PAUSE or now - found < _PAUSE):
                tried = now
                try:
                    return BrickClient(address, serial)
                except NoBrickError:
                    raise
                except BridgeError as error:
                    if isinstance(error, BusyError) and busy:
                        raise
                    busy, trouble = isinstance(error, BusyError), str(error)
            if cancelled() or time.monotonic() >= deadline:
                break
            if heard := ear.hear():
                beacon, source = heard
                if host in (None, source[0]) and (not serial or _same_serial(serial, beacon.serial)):
                    ear.answer(source)
                    address, serial, found = (source[0], beacon.port), beacon.serial, time.monotonic()
    unheard = ear.deaf or f"No beacon of it within {patience:g} s."
    raise BridgeError(
        f"No EV3 brick was found. {trouble + ' ' if trouble else ''}{unheard} "
        "Is it switched on, with WiFi, and in this network?"
    )


def check_address(host: str) -> str:
    """Check an IP address and return it.

    Names are refused: resolving one may take any time, and a brick has none.

    Raises
    ------
    BridgeError
        It is not an address.
    """
    if host == "localhost":
        return "127.0.0.1"
    try:
        return str(ipaddress.IPv4Address(host.strip()))
    except ValueError:
        raise BridgeError(
            f"{host!r} is not the address of a brick. Write four numbers such as 192.168.1.7, "
            "which the brick shows under `Brick Info`."
        ) from None


def _same_serial(one: str, other: str) -> bool:
    """Compare serial numbers, which people write with colons."""
    return one.replace(":", "").lower() == other.replace(":", "").lower()


def _reason(error: OSError) -> str:
    return (error.strerror or str(error)).lower()
