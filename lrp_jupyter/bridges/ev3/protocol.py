"""The protocol of a Lego EV3 brick: direct commands, little endian.

Pure functions. A *byte code* is one or more operations; a *frame* is a byte code with its
header. Motor ports are a bit mask (A = 1 … D = 8) where a command may name several, and a number
(A = 0 … D = 3) where it reads one; sensor ports are numbers (1 is 0), and 16 to 19 are the motors
seen as sensors. The layer is always 0: the brick itself, no chained one.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import NamedTuple

from lrp_jupyter.errors import BridgeError

ALL_MOTORS = 0b1111
NAME_SIZE = 32
SCREEN = 22, 8
"""How many characters a line of the display has in the usual font, and how many lines it has."""

MAXIMUM_FRAME = 1024  # the brick's buffer: a sender that announces more is not a brick

_WITH_REPLY, _WITHOUT_REPLY = 0x00, 0x80
_REPLY_OK, _REPLY_ERROR = 0x02, 0x04


def constant(value: int) -> bytes:
    """Encode a number as the shortest constant that the brick does not read as NaN.

    The smallest number of each size (-128, -32768, …) *is* the brick's NaN, so it needs the next size.
    """
    if -32 <= value <= 31:
        return bytes([value & 0x3F])
    for tag, size in ((0x81, 1), (0x82, 2), (0x83, 4)):
        if abs(value) < 1 << (8 * size - 1):
            return bytes([tag]) + value.to_bytes(size, "little", signed=True)
    raise BridgeError(f"{value} is too large for the brick: 32 bits at most.")


def variable(offset: int) -> bytes:
    """Encode the place of a result: its offset in the globals, which the reply carries."""
    if offset < 32:
        return bytes([0x60 | offset])
    return bytes([0xE1, offset]) if offset < 256 else b"\xe2" + offset.to_bytes(2, "little")


def frame(counter: int, code: bytes, size: int = 0, reply: bool = False) -> bytes:
    """Put a byte code into a frame.

    `counter`: 0 to 65535; the reply repeats it.
    `size`: bytes of globals that the operations write; with any, a reply is asked for that carries them.
    """
    kind = _WITH_REPLY if reply or size else _WITHOUT_REPLY
    return struct.pack("<HHBH", len(code) + 5, counter, kind, size) + code


class BrickReply(NamedTuple):
    """One reply: the counter of its command, whether it was performed, the globals."""

    counter: int
    ok: bool
    data: bytes


def split_replies(buffer: bytes) -> tuple[list[BrickReply], bytes]:
    """Split off the complete replies; the rest is the beginning of the next."""
    replies = []
    while len(buffer) >= 2:
        end = 2 + int.from_bytes(buffer[:2], "little")
        if not 5 <= end <= MAXIMUM_FRAME:
            raise BridgeError(f"The brick sent a frame of {end} bytes, which is not a reply.")
        if len(buffer) < end:
            break
        counter, kind = struct.unpack_from("<HB", buffer, 2)
        if kind not in (_REPLY_OK, _REPLY_ERROR):
            raise BridgeError(f"The brick sent a frame of type 0x{kind:02x}, which is not a reply.")
        replies.append(BrickReply(counter, kind == _REPLY_OK, buffer[5:end]))
        buffer = buffer[end:]
    return replies, buffer


def _operation(*head: int, values: tuple[int, ...] = (), results: tuple[int, ...] = ()) -> bytes:
    return bytes(head) + b"".join(map(constant, values)) + b"".join(map(variable, results))


def _then_start(code: bytes, ports: int) -> bytes:
    return code + _operation(0xA6, values=(0, ports))


def run_degrees(ports: int, speed: int, amount: int, brake: bool) -> bytes:
    """Turn motors by an angle in degrees (at least 0; the direction is the speed's), then stop them."""
    return _then_start(_operation(0xAE, values=(0, ports, speed, 0, amount, 0, brake)), ports)


def run_milliseconds(ports: int, percent: int, amount: int, brake: bool, regulated: bool = True) -> bytes:
    """Turn motors for a time in milliseconds, then stop them.

    Percent are those of a speed that the brick keeps (regulated), or of its power.
    """
    code = 0xAF if regulated else 0xAD
    return _then_start(_operation(code, values=(0, ports, percent, 0, amount, 0, brake)), ports)


def stop(ports: int, brake: bool) -> bytes:
    """Stop motors and hold them (brake), or coast (not brake)."""
    return _operation(0xA3, values=(0, ports, brake))


def clear_count(ports: int) -> bytes:
    """Set the rotation counts of motors to zero."""
    return _operation(0xB2, values=(0, ports))


def beep(volume: int, frequency: int, milliseconds: int) -> bytes:
    """Sound a tone: volume 0 to 100, frequency in Hz."""
    return _operation(0x94, 0x01, values=(volume, frequency, milliseconds))


def show(lines: Sequence[str]) -> bytes:
    """Clear the display and show lines on it, at most `SCREEN` of characters and lines, in its usual font."""
    white, black, usual, height = 0, 1, 0, 12
    code = _operation(0x84, 0x13, values=(white, 0, 0)) + _operation(0x84, 0x11, values=(usual,))
    for number, line in enumerate(lines, 1):
        text = line.encode("ascii", "replace").replace(b"\0", b"?")
        code += _operation(0x84, 0x05, values=(black, 0, height * number)) + b"\x84" + text + b"\0"
    return code + _operation(0x84, 0x00)


def brick_name() -> tuple[bytes, int]:
    """Ask for the brick's name: the byte code and the size of its zero-terminated reply."""
    return _operation(0xD3, 0x0D, values=(NAME_SIZE,), results=(0,)), NAME_SIZE


class MotorReading(NamedTuple):
    """A motor: its rotation count in degrees, speed in percent, type (7 large, 8 medium)."""

    degrees: int
    speed: int
    type: int


class SensorReading(NamedTuple):
    """A sensor: its value in the unit of its mode (NaN: none), type and mode numbers."""

    value: float
    type: int
    mode: int


class BrickReading(NamedTuple):
    """All motors and sensors at one moment; the battery in percent."""

    motors: tuple[MotorReading, ...]
    sensors: tuple[SensorReading, ...]
    battery: int


# Numbers of 32 bits come first: the brick's processor cannot write them at odd places.
_LAYOUT = struct.Struct("<4i4fi4b8b8bB")
_COUNTS, _VALUES, _UNUSED, _SPEEDS, _MOTOR_TYPES, _SENSOR_TYPES, _BATTERY = 0, 16, 32, 36, 40, 48, 56
_SAME_TYPE, SAME_MODE = 0, -1


def read_everything(modes: tuple[int, ...] = (SAME_MODE,) * 4) -> tuple[bytes, int]:
    """Ask for all motors, sensors and the battery in one frame: the byte code, the reply's size.

    It never makes the brick wait for a sensor (a sensor that has just changed its mode reads NaN).

    `modes`: the mode to measure in for each sensor, or -1 for the present one.
    """
    code = b""
    for motor in range(4):
        code += _operation(0xB3, values=(0, motor), results=(_COUNTS + 4 * motor,))
        # READ's own count is another one, which CLR_COUNT does not clear
        code += _operation(0xA8, values=(0, motor), results=(_SPEEDS + motor, _UNUSED))
        place = _MOTOR_TYPES + 2 * motor
        code += _operation(0x99, 0x05, values=(0, 16 + motor), results=(place, place + 1))
    for sensor, mode in enumerate(modes):
        code += _operation(0x9D, values=(0, sensor, _SAME_TYPE, mode), results=(_VALUES + 4 * sensor,))
        place = _SENSOR_TYPES + 2 * sensor
        code += _operation(0x99, 0x05, values=(0, sensor), results=(place, place + 1))
    return code + _operation(0x81, 0x12, results=(_BATTERY,)), _LAYOUT.size


def parse_reading(data: bytes) -> BrickReading:
    """Read the reply to :func:`read_everything`."""
    if len(data) != _LAYOUT.size:
        raise BridgeError(f"The brick answered with {len(data)} bytes instead of {_LAYOUT.size}.")
    numbers = _LAYOUT.unpack(data)
    counts, values, speeds = numbers[0:4], numbers[4:8], numbers[9:13]
    motor_types, sensor_types, sensor_modes = numbers[13:21:2], numbers[21:29:2], numbers[22:29:2]
    return BrickReading(
        tuple(map(MotorReading, counts, speeds, motor_types)),
        tuple(map(SensorReading, values, sensor_types, sensor_modes)),
        numbers[29],
    )
