"""A brick at a USB port, through Linux's `hidraw`: no driver and no library is needed.

The brick is a HID device. Each frame travels in a report of 1024 bytes, padded with zeros.
"""

from __future__ import annotations

import os
import select
import time
from contextlib import suppress
from io import FileIO
from pathlib import Path

from lrp_jupyter.bridges.ev3.lines import WAIT, Line, reason
from lrp_jupyter.errors import BridgeError

USB = "usb"
"""The address of a brick at a USB port."""

REPORT = 1024  # bytes
_LEGO, _EV3 = 0x0694, 0x0005  # numbers of the vendor and the product
_LISTED = Path("/sys/class/hidraw")
_DEVICES = Path("/dev")
_LEFT_OVER = 0.1  # seconds in which a report that was meant for another program would arrive
_LONGEST = 1.0  # … and that may all take

_RULE = (
    '`SUBSYSTEM=="hidraw", ATTRS{idVendor}=="0694", ATTRS{idProduct}=="0005", TAG+="uaccess"`'
    " into a new file `/etc/udev/rules.d/70-ev3.rules`"
)


class _UsbLine(Line):
    """Reports; a write waits for the brick, and the system gives up after 5 s if it takes nothing."""

    def __init__(self, device: FileIO, serial: str = "") -> None:
        super().__init__(USB, serial)
        self._device = device
        deadline = time.monotonic() + _LONGEST
        while self._arrives(_LEFT_OVER) and time.monotonic() < deadline:
            os.read(device.fileno(), REPORT)

    def send(self, data: bytes) -> int:
        """Send one frame in one report, after the number of the report, 0, which does not travel."""
        os.write(self._number(), b"\0" + data.ljust(REPORT, b"\0"))
        return len(data)

    def receive(self) -> bytes:
        if not self._arrives(WAIT):
            raise TimeoutError
        report = os.read(self._number(), REPORT)
        return report[: 2 + int.from_bytes(report[:2], "little")]

    def close(self) -> None:
        with suppress(OSError):
            self._device.close()

    def _arrives(self, seconds: float) -> bool:
        return bool(select.select([self._number()], [], [], seconds)[0])

    def _number(self) -> int:
        if self._device.closed:
            raise OSError("The device was closed.")
        return self._device.fileno()


def open_usb(serial: str = "") -> Line:
    """Open the brick that is plugged in, or of several the one with a serial number."""
    if not _LISTED.is_dir():
        raise BridgeError("A brick at a USB port is found on Linux only. Connect it by WiFi or Bluetooth.")
    plugged = _plugged()
    found = {each: device for each, device in plugged.items() if not serial or same_serial(each, serial)}
    if not found:
        others = f" Plugged in: {', '.join(plugged)}." if plugged else ""
        which = f" with the serial number {serial}" if serial else ""
        raise BridgeError(
            f"No EV3 brick{which} is plugged in by USB. Plug it in (its port is marked PC), and switch it on."
            f"{others}"
        )
    if len(found) > 1:
        raise BridgeError(
            f"{len(found)} EV3 bricks are plugged in. Choose one by its serial number, as in "
            f"`serial={min(found)}`; there are {', '.join(found)}."
        )
    [(number, device)] = found.items()
    try:
        opened = _open(device)
    except PermissionError:
        raise BridgeError(
            f"This user may not open {device}, the brick. As the administrator write {_RULE}, "
            "then plug the brick in again."
        ) from None
    except OSError as error:
        raise BridgeError(f"The brick at {device} cannot be opened: {reason(error)}.") from None
    try:
        return _UsbLine(opened, number)
    except OSError as error:
        opened.close()
        raise BridgeError(f"The brick at {device} cannot be read: {reason(error)}.") from None


def _open(device: Path) -> FileIO:
    return FileIO(device, "r+")


def _plugged() -> dict[str, Path]:
    """Return the devices of the bricks that are plugged in, by their serial numbers."""
    found = {}
    for listed in sorted(_LISTED.iterdir()):
        try:
            lines = (listed / "device" / "uevent").read_text(encoding="utf-8", errors="replace").splitlines()
        except OSError:  # unplugged meanwhile
            continue
        facts = dict(line.split("=", 1) for line in lines if "=" in line)
        with suppress(ValueError):
            _bus, vendor, product = (int(part, 16) for part in facts.get("HID_ID", "").split(":"))
            if (vendor, product) == (_LEGO, _EV3):
                found[facts.get("HID_UNIQ") or listed.name] = _DEVICES / listed.name
    return found


def same_serial(one: str, other: str) -> bool:
    """Compare serial numbers, which people write with colons."""
    return one.replace(":", "").lower() == other.replace(":", "").lower()
