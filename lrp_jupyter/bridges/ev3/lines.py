"""The lines on which bytes travel to a brick and back: WiFi and Bluetooth; `usb` has the third.

The frames are the same on each. A line knows nothing of them, except that USB keeps them apart.
"""

from __future__ import annotations

import errno
import select
import socket
import struct
import sys
import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from contextlib import suppress

from lrp_jupyter.errors import BridgeError

WAIT = 0.05
"""Seconds that a line waits before the time and other events are checked."""

_OPEN_TIME = 1.5  # seconds to connect and to unlock it: a lost first packet is sent again after 1 s
_CALL_TIME = 8.0  # seconds to connect by Bluetooth: a brick that is there answers within 5.12 s
_CHANNEL = 1  # of the brick's serial port
_UNLOCKED = b"Accept:EV340\r\n\r\n"

# Value of SO_LINGER with which closing discards what has not been delivered
_ABORT = struct.pack("hh" if sys.platform == "win32" else "ii", 1, 0)


class NoBrickError(BridgeError):
    """A host answers at an address, but not as a brick does."""


class BusyError(BridgeError):
    """A host accepts a connection and hangs up, as a brick does that serves another client."""


class Line(ABC):
    """An open connection for bytes.

    `place`: where it leads to, as an address of `connect`.
    `serial`: serial number of the brick; empty where it is not known.
    """

    def __init__(self, place: str, serial: str = "") -> None:
        self.place, self.serial = place, serial

    @abstractmethod
    def send(self, data: bytes) -> int:
        """Send what can be sent within a moment; return how many bytes that were.

        Raises TimeoutError: None could.
        Raises OSError: the line is broken.
        """

    @abstractmethod
    def receive(self) -> bytes:
        """Return what has arrived, after a moment at most; empty where the brick has closed the line.

        Raises TimeoutError: nothing arrived.
        Raises OSError: the line is broken.
        """

    def cut(self) -> None:  # noqa: B027  (a line that cannot do it does nothing)
        """Let closing discard what has been sent and has not arrived, where the line can do that."""

    @abstractmethod
    def close(self) -> None:
        """Close the line; idempotent."""


class _SocketLine(Line):
    def __init__(self, connected: socket.socket, place: str, serial: str = "") -> None:
        super().__init__(place, serial)
        self._socket = connected
        self._socket.settimeout(WAIT)

    def send(self, data: bytes) -> int:
        return self._socket.send(data)

    def receive(self) -> bytes:
        return self._socket.recv(4096)

    def cut(self) -> None:
        with suppress(OSError):
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _ABORT)

    def close(self) -> None:
        self._socket.close()


def open_tcp(address: tuple[str, int], serial: str = "") -> Line:
    """Connect by WiFi, and unlock the brick, within 1.5 s."""
    deadline = time.monotonic() + _OPEN_TIME
    try:
        connected = socket.create_connection(address, _OPEN_TIME)
    except OSError as error:
        raise BridgeError(f"No connection to {address[0]}:{address[1]}: {reason(error)}.") from None
    try:
        connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        _unlock(connected, f"{address[0]}:{address[1]}", serial, deadline)
        return _SocketLine(connected, address[0], serial)
    except BaseException:
        connected.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _ABORT)
        connected.close()
        raise


def _unlock(connected: socket.socket, where: str, serial: str, deadline: float) -> None:
    text = f"GET /target?sn={serial} VMTP1.0\r\nProtocol: EV3"
    answer, part = b"", b" "
    try:
        connected.sendall(text.encode())
        while part and len(answer) < len(_UNLOCKED) and _UNLOCKED.startswith(answer):
            connected.settimeout(max(0.001, deadline - time.monotonic()))
            part = connected.recv(len(_UNLOCKED) - len(answer))
            answer += part
    except OSError as error:
        part = b" " if isinstance(error, TimeoutError) else b""
    if answer == _UNLOCKED:
        return
    if not answer and not part:
        raise BusyError(f"{where} hung up. Is another program connected to the brick?")
    how = f"it answers {answer!r}" if part and answer else "it does not answer as one"
    raise NoBrickError(f"{where} is not an EV3 brick: {how}.")


def open_bluetooth(address: str, cancelled: Callable[[], bool] = lambda: False) -> Line:
    """Connect by Bluetooth, within 8 s: the serial port of a brick that this computer is paired with."""
    deadline = time.monotonic() + _CALL_TIME
    called = _rfcomm()
    try:
        called.setblocking(False)
        code = called.connect_ex((address, _CHANNEL))
        while code in (errno.EINPROGRESS, errno.EWOULDBLOCK):
            _, ready, failed = select.select([], [called], [called], WAIT)
            if ready or failed:
                code = called.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
            elif cancelled() or time.monotonic() >= deadline:
                code = errno.ETIMEDOUT
        if code:
            raise BridgeError(f"No connection to the brick {address} by Bluetooth: {_complaint(code)}")
        return _SocketLine(called, address)
    except OSError as error:
        called.close()
        raise BridgeError(f"No connection to the brick {address} by Bluetooth: {reason(error)}.") from None
    except BaseException:
        called.close()
        raise


def _rfcomm() -> socket.socket:
    family = getattr(socket, "AF_BLUETOOTH", None)
    if family is None:
        raise BridgeError(
            "This Python was built without Bluetooth. Use another one, such as that of Debian, Ubuntu or "
            "python.org for Windows; or connect the brick by USB or WiFi."
        )
    try:
        return socket.socket(family, socket.SOCK_STREAM, socket.BTPROTO_RFCOMM)
    except OSError as error:
        raise BridgeError(
            f"This computer has no Bluetooth: {reason(error)}. Connect the brick by USB or WiFi."
        ) from None


def _complaint(code: int) -> str:
    """Return what a failed call by Bluetooth means, and what to do."""
    if code in (errno.EHOSTDOWN, errno.ETIMEDOUT):
        return "It does not answer. Switch it on, with Bluetooth, and bring it near."
    if code in (errno.ECONNREFUSED, errno.EACCES, getattr(errno, "EBADE", errno.EACCES)):
        return "It refuses. Pair it with this computer, and confirm that on its screen."
    if code in (errno.EHOSTUNREACH, errno.ENETUNREACH, errno.ENODEV):
        return "Bluetooth is switched off on this computer. Switch it on."
    return f"{reason(OSError(code, errno.errorcode.get(code, str(code))))}. Is it paired with this computer?"


def reason(error: OSError) -> str:
    """Return what the operating system says about an error."""
    return (error.strerror or str(error)).lower()
