"""The vehicle that a brick is built into: two wheels, and what its sensors are for.

With it a program drives a brick as it drives the simulated robot: in m/s and rad/s.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace

from lrp_jupyter.bridges.ev3.devices import ABSENT, MODES, type_name
from lrp_jupyter.bridges.ev3.link import Pose
from lrp_jupyter.bridges.ev3.protocol import SAME_MODE, BrickReading
from lrp_jupyter.bridges.message import real_number
from lrp_jupyter.errors import BridgeError, NoDataYet

WHEELS = ("A", "B", "C", "D", "-A", "-B", "-C", "-D")
PORTS = ("1", "2", "3", "4", "none")
SENSES: Mapping[str, tuple[str, tuple[int, ...]]] = {
    "light": ("a colour sensor", (29,)),
    "bumper": ("a touch sensor", (16,)),
    "distance": ("an ultrasonic or infrared sensor", (30, 33)),
}
"""What a program reads, with the sensors that measure it, each in its mode 0."""

_STARTING, _INFRARED = 125, 33
# Degrees a second for each percent of speed: a large motor turns with 168 rpm at most, a medium one with 265.
# From the counts of the firmware's regulator: 33 MHz / 256 / 12800, and / 8100.
_PACES = {7: 10.07, 8: 15.91}
_FARTHEST = {30: 2.55, 33: 0.7}  # m: what these sensors report where nothing is in reach


@dataclass(frozen=True, slots=True)
class Vehicle:
    """How a vehicle is built.

    `left`, `right`: ports of the motors that drive the wheels, ``A`` to ``D``; ``-B`` for a motor built in
        the other way round, which drives backwards when it turns forwards.
    `wheel`, `track`: diameter of the wheels, and the distance between them, in mm.
    `light`, `bumper`, `distance`: ports of the sensors, ``1`` to ``4``, or ``none``.
    """

    left: str = "B"
    right: str = "C"
    wheel: float = 56.0
    track: float = 120.0
    light: str = "3"
    bumper: str = "1"
    distance: str = "4"

    @classmethod
    def of(cls, options: Mapping[str, object]) -> Vehicle:
        """Return the vehicle that options describe: values, or texts as a person types them."""
        values: dict[str, str | float] = {}
        for name, value in options.items():
            text = str(value).strip()
            if name in ("wheel", "track"):
                values[name] = _length(name, value)
            elif name in ("left", "right"):
                values[name] = _one_of(name, text.upper(), WHEELS, "a motor port, A to D, or -A to -D")
            else:
                port = "none" if value is None or not text else text.lower()
                values[name] = _one_of(name, port, PORTS, "a sensor port, 1 to 4, or none")
        vehicle = replace(cls(), **values)  # type: ignore[arg-type]
        vehicle._check_ports()
        return vehicle

    def options(self) -> dict[str, object]:
        """Return the options that describe it."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def _check_ports(self) -> None:
        taken: dict[str, str] = {}
        for name in ("left", "right", *SENSES):
            port = getattr(self, name).removeprefix("-")
            if port != "none" and port in taken:
                raise BridgeError(f"`{taken[port]}` and `{name}` are both in port {port}. Name another one.")
            taken[port] = name

    # -- wheels -----------------------------------------------------------------------------------

    @property
    def motors(self) -> tuple[int, int]:
        """The left and the right motor, 0 to 3."""
        return _motor(self.left), _motor(self.right)

    @property
    def limits(self) -> dict[str, float]:
        """The greatest speeds of large motors: ``linear`` in m/s, ``angular`` in rad/s."""
        linear = math.floor(1000 * self._way(100 * _PACES[7])) / 1000
        return {"linear": linear, "angular": math.floor(1e6 * linear / (self.track / 2)) / 1000}

    def percents(
        self, linear: float, angular: float, reading: BrickReading | None
    ) -> tuple[dict[int, int], float]:
        """Return the speed of each motor in percent, and by what they had to be divided to be at most 100.

        `linear`, `angular`: m/s and rad/s, counter-clockwise.
        `reading`: says whether the motors are large or medium ones.
        """
        share = angular * self.track / 2000
        wanted = {}
        for name, speed in ((self.left, linear - share), (self.right, linear + share)):
            motor = _motor(name)
            kind = 7 if reading is None else reading.motors[motor].type
            wanted[motor] = _sign(name) * speed / self._way(_PACES.get(kind, _PACES[7]))
        excess = max(1.0, *(abs(percent) / 100 for percent in wanted.values()))
        return {motor: round(percent / excess) for motor, percent in wanted.items()}, excess

    def advanced(self, pose: Pose, degrees: tuple[int, ...]) -> Pose:
        """Return the pose after the motors have turned by angles: dead reckoning."""
        left, right = (_sign(name) * self._way(degrees[_motor(name)]) for name in (self.left, self.right))
        x, y, theta = pose
        turn = (right - left) * 1000 / self.track
        way, heading = (left + right) / 2, theta + turn / 2
        return x + way * math.cos(heading), y + way * math.sin(heading), theta + turn

    def degrees(self, left: float, right: float) -> dict[int, float]:
        """Return by how much each motor turns while the wheels roll so far, in metres."""
        ways = {self.left: left, self.right: right}
        return {_motor(name): _sign(name) * way / self._way(1.0) for name, way in ways.items()}

    def _way(self, degrees: float) -> float:
        """Return how far a wheel rolls while its motor turns, in metres."""
        return degrees / 360 * math.pi * self.wheel / 1000

    # -- sensors ----------------------------------------------------------------------------------

    @property
    def modes(self) -> tuple[int, ...]:
        """The modes of the four sensors: 0 where one is used, -1 elsewhere."""
        used = {getattr(self, name) for name in SENSES}
        return tuple(0 if port in used else SAME_MODE for port in PORTS[:4])

    def sense(self, name: str, reading: BrickReading, modes: tuple[int, ...]) -> object:
        """Return what a program reads, a key of `SENSES`, as the simulated robot measures it."""
        what, kinds = SENSES[name]
        port = getattr(self, name)
        if port == "none":
            raise BridgeError(f"`robot.{name}`: No port is named for it. Set `{name}` to that of {what}.")
        seen = reading.sensors[int(port) - 1]
        if seen.type not in (*kinds, _STARTING):
            there = "nothing in it" if seen.type in ABSENT else f"another sensor ({type_name(seen.type)})"
            others = [str(i) for i, other in enumerate(reading.sensors, 1) if other.type in kinds]
            remedy = f"Set `{name}` to {others[0]}, where one is." if others else "Plug one in."
            raise BridgeError(f"`robot.{name}`: Port {port} has {there}, and not {what}. {remedy}")
        if modes[int(port) - 1] > 0:
            raise BridgeError(
                f"`robot.{name}`: The program has set sensor {port} to another mode. Set it back: "
                f'`robot.sensor{port}.set_mode("{MODES[seen.type][0]}")`.'
            )
        if seen.type == _STARTING or seen.mode != 0 or math.isnan(seen.value):
            raise NoDataYet(f"`robot.{name}` has no value yet.")
        if name == "light":
            return round(seen.value * 2.55)
        if name == "bumper":
            return bool(seen.value)
        metres = seen.value * 0.007 if seen.type == _INFRARED else seen.value / 100
        return math.inf if metres >= _FARTHEST[seen.type] - 1e-9 else metres


def _motor(name: str) -> int:
    return "ABCD".index(name[-1])


def _sign(name: str) -> int:
    return -1 if name.startswith("-") else 1


def _one_of(name: str, text: str, allowed: tuple[str, ...], what: str) -> str:
    if text not in allowed:
        raise BridgeError(f"`{name}` is {what}, not {text!r}.")
    return text


def _length(name: str, value: object) -> float:
    try:
        number = float(value.replace(",", ".")) if isinstance(value, str) else value
    except ValueError:
        number = value
    length = real_number(number, name)
    if not 1 <= length <= 2000:
        raise BridgeError(f"`{name}` is a length in mm, from 1 to 2000, not {length:g}.")
    return length
