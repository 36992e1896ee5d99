"""The motors and sensors of an EV3 brick, as a program sees them.

Arguments that the brick would refuse or misunderstand raise an error here.

Paper: §7.2.
"""

from __future__ import annotations

import math
from typing import Protocol

from lrp_jupyter.bridges.ev3 import protocol
from lrp_jupyter.bridges.ev3.link import BrickLink
from lrp_jupyter.bridges.ev3.protocol import BrickReading, MotorReading, SensorReading
from lrp_jupyter.bridges.message import real_number
from lrp_jupyter.errors import BridgeError, NoDataYet, did_you_mean

TYPES = {
    1: "NXT touch", 2: "NXT light", 3: "NXT sound", 4: "NXT colour", 5: "NXT ultrasonic",
    6: "NXT temperature", 7: "large motor", 8: "medium motor", 16: "touch", 29: "colour",
    30: "ultrasonic", 32: "gyro", 33: "infrared", 125: "starting", 126: "nothing", 127: "wrong port",
}  # fmt: skip
MODES = {
    16: ("touch", "bumps"),
    29: ("reflected", "ambient", "colour"),
    30: ("centimetres", "inches", "listen"),
    32: ("angle", "rate"),
    33: ("proximity", "seeker", "remote"),
}
UNITS = {(30, 0): "cm", (30, 1): "in", (32, 0): "deg", (32, 1): "deg/s", (29, 0): "%", (29, 1): "%"}
_FRACTIONS = (30, 6)  # ultrasonic, temperature: the others measure in whole numbers
ABSENT = (126, 127)
"""Types of a port in which nothing usable is plugged in."""
_LONGEST = 2**31 - 1  # degrees or milliseconds


class Brick(Protocol):
    """The brick of a motor or sensor; it keeps its identity when the connection is replaced."""

    link: BrickLink

    def seen(self) -> BrickReading:
        """Return the reading of this tick, or the latest between ticks."""


class Motor:
    """A motor of the brick, `robot.motorA` to `robot.motorD`."""

    def __init__(self, brick: Brick, index: int) -> None:
        self._brick, self._index, self._port = brick, index, 1 << index
        self.name = f"motor{'ABCD'[index]}"

    def start_at_speed(self, speed: float) -> None:
        """Turn at a regulated speed (%), -100 to 100, until the next command."""
        percent = self._percent("start_at_speed", "speed", speed)
        self._brick.link.turn({self._index: percent})

    def start_at_power(self, power: float) -> None:
        """Turn with unregulated power (%), -100 to 100, until the next command."""
        percent = self._percent("start_at_power", "power", power)
        self._brick.link.turn({self._index: percent}, regulated=False)

    def stop(self, brake: bool = True) -> None:
        """Stop, and hold the position (brake=True) or run out."""
        self._brick.link.command(protocol.stop(self._port, self._flag("stop", brake)), self._port)

    def run_for(
        self,
        degrees: float | None = None,
        seconds: float | None = None,
        speed: float = 50,
        brake: bool = True,
    ) -> None:
        """Turn by an angle (deg; negative: backwards) or for a time (s), then stop."""
        if (degrees is None) == (seconds is None):
            raise BridgeError(
                f"`{self.name}.run_for` takes an angle or a time: "
                "`run_for(degrees=90)` or `run_for(seconds=1.5)`."
            )
        percent, holds = self._percent("run_for", "speed", speed), self._flag("run_for", brake)
        if not percent:
            raise BridgeError(f"`{self.name}.run_for` would never end at speed {speed!r}.")
        if degrees is not None:
            angle = round(real_number(degrees, f"{self.name}.run_for(degrees=…)"))
            amount = self._amount(abs(angle))
            code = protocol.run_degrees(self._port, percent if angle > 0 else -percent, amount, holds)
        else:
            amount = self._amount(round(1000 * real_number(seconds, f"{self.name}.run_for(seconds=…)")))
            code = protocol.run_milliseconds(self._port, percent, amount, holds)
        if amount:  # nothing to do for 0
            self._brick.link.command(code, self._port)

    def reset_count(self) -> None:
        """Make the present position 0."""
        self._brick.link.reset_count(self._index)

    def count(self) -> int:
        """Return the angle turned since the count was 0."""
        return self.reading().degrees

    def speed(self) -> int:
        """Return the speed that it turns with now."""
        return self.reading().speed

    def type(self) -> str:
        """Return the type of the device."""
        return type_name(self.reading().type)

    def reading(self) -> MotorReading:
        """Return its latest reading."""
        return self._brick.seen().motors[self._index]

    def _percent(self, method: str, what: str, value: object) -> int:
        number = real_number(value, f"{self.name}.{method}({what}=…)")
        if not -100 <= number <= 100:
            raise BridgeError(f"`{self.name}.{method}`: {what} goes from -100 to 100, not {value!r}.")
        self.check_plugged_in()
        return round(number)

    def check_plugged_in(self) -> None:
        """Raise an error where no motor is plugged in."""
        reading = self._brick.link.snapshot.reading
        if reading is not None and reading.motors[self._index].type in ABSENT:
            raise BridgeError(f"`{self.name}`: Nothing is plugged into port {self.name[-1]}.")

    def _amount(self, number: int) -> int:
        if number < 0:
            raise BridgeError(f"`{self.name}.run_for` needs a positive time.")
        if number > _LONGEST:
            raise BridgeError(f"`{self.name}.run_for`: That is further than the brick can count.")
        return number

    def _flag(self, method: str, value: object) -> bool:
        if value not in (True, False):
            raise BridgeError(f"`{self.name}.{method}`: `brake` must be True or False, not {value!r}.")
        return bool(value)


class Sensor:
    """A sensor of the brick, `robot.sensor1` to `robot.sensor4`."""

    def __init__(self, brick: Brick, index: int) -> None:
        self._brick, self._index = brick, index
        self.name = f"sensor{index + 1}"

    def read(self) -> float:
        """Return the value: touch 1 or 0, colour %, ultrasonic cm, gyro deg; other modes, other units."""
        reading = self.reading()
        wanted = self._brick.link.modes[self._index]
        if reading.type in ABSENT:
            raise self._nothing()
        if math.isnan(reading.value) or wanted not in (protocol.SAME_MODE, reading.mode):
            raise NoDataYet(f"`robot.{self.name}` has no value yet.")
        return reading.value if reading.type in _FRACTIONS else round(reading.value)

    def set_mode(self, mode: int | str) -> None:
        """Set the mode: its number or its name, such as "ambient"."""
        kind = self.reading().type
        if kind in ABSENT:
            raise self._nothing()
        names = MODES.get(kind, ())
        if isinstance(mode, str) and mode in names:
            number = names.index(mode)
        elif isinstance(mode, int) and not isinstance(mode, bool) and 0 <= mode <= 7:
            number = mode
        else:
            known = ", ".join(f"`{name}`" for name in names) or "0 to 7"
            hint = did_you_mean(mode, names) if isinstance(mode, str) else ""
            raise BridgeError(
                f"`{self.name}` ({type_name(kind)}) has no mode {mode!r}; it has {known}.{hint}"
            )
        self._brick.link.modes[self._index] = number

    def mode(self) -> str:
        """Return the name of its mode."""
        return mode_name(self.reading())

    def type(self) -> str:
        """Return the type of the device."""
        return type_name(self.reading().type)

    def reading(self) -> SensorReading:
        """Return its latest reading."""
        return self._brick.seen().sensors[self._index]

    def _nothing(self) -> BridgeError:
        return BridgeError(f"`{self.name}`: Nothing is plugged into port {self._index + 1}.")


def type_name(number: int) -> str:
    """Return the name of a type of sensor or motor."""
    return TYPES.get(number, f"type {number}")


def mode_name(sensor: SensorReading) -> str:
    """Return the name of a sensor's mode."""
    names = MODES.get(sensor.type, ())
    return names[sensor.mode] if 0 <= sensor.mode < len(names) else f"mode {sensor.mode}"
