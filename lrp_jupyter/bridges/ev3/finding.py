"""Finding a brick, and connecting to it: by USB, by Bluetooth, or by WiFi.

By WiFi the brick's own firmware accepts TCP only from a host that has answered its UDP beacon, which it sends
every few seconds.
"""

from __future__ import annotations

import ipaddress
import re
import socket
import time
from collections.abc import Callable
from contextlib import closing, suppress
from typing import NamedTuple

from lrp_jupyter.bridges.ev3.client import BrickClient
from lrp_jupyter.bridges.ev3.lines import WAIT, BusyError, NoBrickError, open_bluetooth, open_tcp, reason
from lrp_jupyter.bridges.ev3.usb import USB, open_usb, same_serial
from lrp_jupyter.errors import BridgeError, NoAnswerError

_PAUSE = 0.5  # seconds between two attempts at the same address
_BLUETOOTH = re.compile(r"[0-9A-Fa-f]{2}(:?)(?:[0-9A-Fa-f]{2}\1){4}[0-9A-Fa-f]{2}")


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
        self._socket.settimeout(WAIT)
        try:
            self._socket.bind(("", port))
        except OSError as error:
            self.deaf = f"Cannot listen on UDP port {port}: {reason(error)}."

    def hear(self) -> tuple[Beacon, tuple[str, int]] | None:
        """Wait one slice of time for a beacon and its source."""
        if self.deaf:
            time.sleep(WAIT)
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

    By WiFi its beacon is waited for and answered; where an address is given, TCP is tried as well.

    The options are those of `EV3Bridge`; `port` is used for a brick that is found by its address alone.

    `cancelled`: called about ten times a second; returns whether to stop searching.
    """
    host = None if host is None else check_address(host)
    if host == USB:
        return BrickClient(open_usb(serial))
    if host is not None and _BLUETOOTH.fullmatch(host):
        return BrickClient(open_bluetooth(host, cancelled))
    deadline = time.monotonic() + patience
    trouble, busy = "", False
    with closing(_Ear(beacon_port)) as ear:
        if host is None and ear.deaf:
            raise BridgeError(f"No beacon of a brick can be heard. {ear.deaf}")
        tried = found = float("-inf")  # when TCP was tried last, when a beacon was answered last
        address = None if host is None else (host, port)
        while True:
            now = time.monotonic()
            if address is not None and (now - tried >= _PAUSE or now - found < _PAUSE):
                tried = now
                try:
                    return BrickClient(open_tcp(address, serial))
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
                if host in (None, source[0]) and (not serial or same_serial(serial, beacon.serial)):
                    ear.answer(source)
                    address, serial, found = (source[0], beacon.port), beacon.serial, time.monotonic()
    unheard = ear.deaf or f"No beacon of it within {patience:g} s."
    raise NoAnswerError(
        f"No EV3 brick was found. {trouble + ' ' if trouble else ''}{unheard} "
        "Is it switched on, with WiFi, and in this network?"
    )


def check_address(host: str) -> str:
    """Check the address of a brick and return it as it is written elsewhere.

    Names are refused: resolving one may take any time, and a brick has none.
    """
    text = host.strip()
    if text.lower() == USB:
        return USB
    if text == "localhost":
        return "127.0.0.1"
    if _BLUETOOTH.fullmatch(text):
        digits = text.replace(":", "").upper()
        return ":".join(digits[i : i + 2] for i in range(0, 12, 2))
    try:
        return str(ipaddress.IPv4Address(text))
    except ValueError:
        raise BridgeError(
            f"{host!r} is not the address of a brick. Write what it shows under `Brick Info`, four numbers "
            "such as 192.168.1.7 or, for Bluetooth, its ID as 00:16:53:01:02:03; or write `usb`."
        ) from None
