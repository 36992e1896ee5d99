"""The bridge to a Lego Mindstorms EV3 brick with its own firmware, over WiFi, Bluetooth or USB.

A program drives it as it drives the simulated robot, or turns its motors and reads its sensors one by one.
The connection is the bridge's::

    (running [robot.move(linear=0.2)])
    (event dark [robot.light.data < 100])

    (onentry [robot.motorA.start_at_speed(30)])
    (event bump [robot.sensor1.read() == 1])

Readings are the latest that arrived, the same for a whole tick; commands do not wait for the brick
to perform them. A command or reading that is not possible raises a `BridgeError` with the reason.

Paper: §7.2.
Deviation: §7.2 asks for the address in a dialog whenever the interpreter is started; here it is
asked once, and a brick is also found by the beacon that it sends.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from textwrap import wrap
from typing import Any

from lrp_jupyter.bridges.bridge import Bridge, ConnectionState
from lrp_jupyter.bridges.ev3 import protocol
from lrp_jupyter.bridges.ev3.client import BrickClient
from lrp_jupyter.bridges.ev3.devices import ABSENT, MODES, UNITS, Motor, Sensor, mode_name, type_name
from lrp_jupyter.bridges.ev3.finding import check_address, connect
from lrp_jupyter.bridges.ev3.link import BrickLink, BrickState
from lrp_jupyter.bridges.ev3.protocol import BrickReading, SensorReading
from lrp_jupyter.bridges.ev3.slices import SLICE
from lrp_jupyter.bridges.ev3.vehicle import PORTS, WHEELS, Vehicle
from lrp_jupyter.bridges.ev3.wheel_driver import WheelDriver
from lrp_jupyter.bridges.message import Message, Twist, real_number
from lrp_jupyter.bridges.panel import STOP, Button, Field, Panel, Question, Table, number_in
from lrp_jupyter.bridges.scans import RayScan
from lrp_jupyter.bridges.tasks import Task
from lrp_jupyter.bridges.wheel_tasks import add_errands
from lrp_jupyter.errors import BridgeError, NoDataYet
from lrp_jupyter.sim.errands import Speech, spoken
from lrp_jupyter.sim.world_inputs import ByItself, Say


class EV3Bridge(Bridge):
    """A Lego EV3 brick as `robot`.

    Parameters
    ----------
    host : str or None
        Its IP address, its Bluetooth address, or ``"usb"``; None: the first brick whose beacon is heard by
        WiFi, and the panel asks.
    serial : str
        Only the brick with this serial number.
    port, beacon_port : int
        TCP port of the brick; UDP port of its beacon.
    patience : float
        Seconds to wait for a brick's beacon where an address is given.
    left, right : str
        Ports of the motors of the wheels; ``"-B"`` for a motor that is built in the other way round.
    wheel, track : float
        Diameter of the wheels and distance between them, in mm.
    light, bumper, distance : int, str or None
        Ports of the colour sensor, the touch sensor, and the ultrasonic or infrared one; None or ``"none"``:
        there is none.

    Raises
    ------
    BridgeError
        An option has a mistake.
    """

    name = "ev3"
    complete = True
    stop_timeout = 0.8
    stops_when_found = True  # in the first packet to a brick that was lost
    clock = staticmethod(time.monotonic)  # of the slices; tests have one of their own

    def __init__(
        self,
        host: str | None = None,
        serial: str = "",
        port: int = 5555,
        beacon_port: int = 3015,
        patience: float = 12.0,
        left: str = "B",
        right: str = "C",
        wheel: float = 56.0,
        track: float = 120.0,
        light: int | str | None = "3",
        bumper: int | str | None = "1",
        distance: int | str | None = "4",
    ) -> None:
        super().__init__()
        wheels = {"left": left, "right": right, "wheel": wheel, "track": track}
        self.vehicle = Vehicle.of({**wheels, "light": light, "bumper": bumper, "distance": distance})
        self.host = check_address(host) if host else None
        self.serial, self.port = serial, port
        self._beacon_port, self._patience = beacon_port, patience
        self._latched: BrickState | None = None  # the reading of this tick
        self._speeches: dict[Task, Speech] = {}  # the texts that were displayed, until they are read
        self.motors = tuple(Motor(self, i) for i in range(4))
        self.sensors = tuple(Sensor(self, i) for i in range(4))
        self.link = self._new_link()

    def _new_link(self) -> BrickLink:
        host, serial = self.host, self.serial

        def find(cancelled: Callable[[], bool]) -> BrickClient:
            nonlocal serial
            client = connect(
                host,
                port=self.port,
                serial=serial,
                patience=self._patience,
                beacon_port=self._beacon_port,
                cancelled=cancelled,
            )
            serial = client.serial  # after a loss, search for this brick, not any other
            return client

        link = BrickLink(find, self._report, lambda *turned: self.vehicle.advanced(*turned), self.clock)
        link.set_usual_modes(self.vehicle.modes)
        self._driver = WheelDriver(link, lambda: self.vehicle, self.clock)
        link.noticed = self._go_on
        return link

    def _report(self, state: str, sentence: str) -> None:
        if state != "late":
            self.set_status(state, sentence)
        if state in ("stale", "late"):
            self.safety.notice("fault", sentence)

    @property
    def failsafe(self) -> str:
        """Who stops the motors when this computer or this process dies, in a sentence."""
        ends = f"{SLICE:g} s after the last renewal, and at the end of a `run_for`"
        return f"The brick itself stops its motors: {ends}."

    def open_interface(self) -> Panel:
        """Connect where an address is known, else search for a brick in the background and ask.

        Raises BridgeError: there is no brick at the address.
        """
        self.link = self._new_link()
        if self.host is None:
            self.set_status(ConnectionState.WAITING, "Waiting for the beacon of a brick, or for its address.")
            self.link.search()
        else:
            self.link.open()
        return self.panel()

    def close_interface(self) -> None:
        """End the connection."""
        self.link.close()

    def stop(self) -> None:
        """Stop all motors, in one packet."""
        self.link.stop()

    def sense(self, now: float) -> None:
        """Latch the latest reading: a tick sees one world."""
        self._latched = self.link.snapshot

    def seen(self) -> BrickReading:
        """Return the latched reading within a tick, else the latest.

        Raises NoDataYet: nothing has arrived yet.
        Raises BridgeError: the brick was lost, or refuses to be read.
        """
        return self.link.latest(self._latched if self.latch else None)

    def _age(self) -> float | None:
        snapshot = self.link.snapshot
        return None if snapshot.reading is None else time.monotonic() - snapshot.time

    def add_members(self) -> None:
        """Add the motors, the sensors and what the brick itself offers."""
        add = partial(self.add_variable, age=self._age)
        for motor in self.motors:
            for command in (motor.start_at_speed, motor.start_at_power, motor.stop):
                self.add_method(f"{motor.name}.{command.__name__}", command, mover=motor.name)
            self.add_method(f"{motor.name}.run_for", motor.run_for)
            self.add_method(f"{motor.name}.reset_count", motor.reset_count)
            add(f"{motor.name}.count", motor.count, "angle turned since the count was 0", "deg", type=int)
            add(f"{motor.name}.speed", motor.speed, "speed that it turns with now", "%", type=int)
            add(f"{motor.name}.type", motor.type, "what is plugged in", type=str)
        for sensor in self.sensors:
            self.add_method(f"{sensor.name}.read", sensor.read, command=False)
            self.add_method(f"{sensor.name}.set_mode", sensor.set_mode, command=False)
            add(f"{sensor.name}.value", sensor.read, "the same as `read()`", type="number")
            add(f"{sensor.name}.mode", sensor.mode, "what it measures", type=str)
            add(f"{sensor.name}.type", sensor.type, "what is plugged in", type=str)
        for name, getter, doc, unit, kind in self._readings():
            add(name, getter, doc, unit, type=kind, stale_after=_STALE_AFTER, limits=_LIMITS.get(name))
        doc = "what the distance sensor sees; `scan.nearest(-30, 30)`: straight ahead, in m"
        add("scan", self._scan, doc, type=RayScan, stale_after=_STALE_AFTER)
        self._add_driving()
        add("battery", lambda: self.seen().battery, "what is left in it", "%", type=int)
        add("name", lambda: self.link.name or None, "the brick's name", type=str)
        self.add_method("beep", self.beep)

    def _add_driving(self) -> None:
        doc, limits = "drive: linear in m/s, angular in rad/s; what is not given is 0", self.vehicle.limits
        self.add_method("move", self._move, doc, message=Twist, limits=limits)
        add_errands(
            self,
            self._begin,
            self._cancel,
            (limits["linear"], limits["angular"]),
            saying="show a text on the display",
        )

    def _begin(self, task: Task, what: ByItself) -> None:
        if isinstance(what, Say):
            self._say(task, what)
            return
        self.link.latest()
        for motor in self.vehicle.motors:
            self.motors[motor].check_plugged_in()
        self._driver.begin(what, lambda errand, left: task.update(errand.status, left, reason=errand.reason))

    def _say(self, task: Task, what: Say) -> None:
        characters, lines = protocol.SCREEN
        text = wrap(what.text, characters, max_lines=lines, placeholder=" ...")
        self.link.command(protocol.show(text))
        self._speeches[task] = spoken(what, self._driver.now())
        self._go_on()

    def _go_on(self) -> None:
        """Do what is due after a reading."""
        self._driver.go_on()
        for task, speech in tuple(self._speeches.items()):  # other threads change it
            if self._driver.now() >= speech.until:
                self._speeches.pop(task, None)
                task.update("succeeded")

    def _cancel(self, task: Task) -> None:
        self._driver.end(task.number)
        if self._speeches.pop(task, None) is not None:
            self.link.command(protocol.show(()))

    def _move(self, message: Message) -> None:
        linear, angular = message.linear, message.angular
        if linear.y or linear.z or angular.x or angular.y:
            raise BridgeError("This robot has two wheels. Set only `linear.x` and `angular.z`.")
        for motor in self.vehicle.motors:
            self.motors[motor].check_plugged_in()
        percents, excess = self.vehicle.percents(linear.x, angular.z, self.link.snapshot.reading)
        if excess > 1:
            sentence = f"`move`: The outer wheel would be too fast: both speeds were divided by {excess:.2g}."
            self.safety.notice("limited", sentence, "move wheel", self.origin())
        self.link.turn(percents)

    def _readings(self) -> Iterator[tuple[str, Callable[[], object], str, str, type]]:
        """Iterate over what is read as from the simulated robot: name, getter, doc, unit, type."""
        sense, odom = self._sense, self._odom
        yield "light.data", partial(sense, "light"), "brightness of the floor: 0 black ... 255 white", "", int
        yield "bumper.data", partial(sense, "bumper"), "True pressed, False free", "", bool
        doc = "to the next obstacle ahead; inf: nothing in reach"
        yield "distance.data", partial(sense, "distance"), doc, "m", float
        doc = "way driven along the heading at the start, by the wheels"
        yield "odom.x", partial(odom, 0), doc, "m", float
        doc = "way driven to the left of the heading at the start, by the wheels"
        yield "odom.y", partial(odom, 1), doc, "m", float
        yield "odom.theta", partial(odom, 2), "angle turned since the start, by the wheels", "rad", float

    def _sense(self, name: str) -> object:
        return self.vehicle.sense(name, self.seen(), tuple(self.link.modes))

    def _scan(self) -> RayScan:
        distance: Any = self._sense("distance")
        return RayScan((0.0,), (distance,))

    def _odom(self, axis: int) -> float:
        self.seen()
        return (self._latched if self.latch and self._latched else self.link.snapshot).pose[axis]

    def beep(self, frequency: float = 440, seconds: float = 0.2, volume: float = 50) -> None:
        """Sound a tone: frequency (Hz) 250 to 10000, duration (s), volume (%) 0 to 100."""
        tone = round(real_number(frequency, "beep(frequency=…)"))
        duration = round(1000 * real_number(seconds, "beep(seconds=…)"))
        loudness = round(real_number(volume, "beep(volume=…)"))
        for what, number, low, high in (
            ("frequency", tone, 250, 10_000),
            ("seconds", duration / 1000, 0, 30),
            ("volume", loudness, 0, 100),
        ):
            if not low <= number <= high:
                raise BridgeError(f"`beep`: {what} goes from {low} to {high}, not {number:g}.")
        self.link.command(protocol.beep(loudness, tone, duration))

    # -- the panel --------------------------------------------------------------------------------

    def panel(self) -> Panel:
        """Return every motor and sensor with its value and buttons, the runstop, the brick's address."""
        client, reading = self.link.client, self.link.snapshot.reading
        address = client.place if client else self.host or ""
        return Panel(
            "Lego EV3",
            fields=(
                Field("status", "Status", value=self.status.sentence),
                Field("brick", "Brick", value=self.link.name),
                Field("address", "Address", value=address),
                Field("battery", "Battery", value=str(reading.battery) if reading else "", unit="%"),
                Field("speed", "Speed by hand", "number", "50", unit="%"),
                *self._vehicle_fields(),
            ),
            tables=(self._motor_table(reading), self._sensor_table(reading), self._robot_table()),
            buttons=(STOP, Button("beep", "Beep"), Button("build", "Use these ports and lengths")),
            questions=(Question("host", _WHERE, address),),
        )

    def _vehicle_fields(self) -> Iterator[Field]:
        for name, value in self.vehicle.options().items():
            if isinstance(value, float):
                yield Field(name, _LABELS[name], "number", f"{value:g}", unit="mm")
            else:
                choices = WHEELS if name in ("left", "right") else PORTS
                yield Field(name, _LABELS[name], "choice", str(value), choices)

    def _robot_table(self) -> Table:
        rows = []
        for name, getter, _doc, unit, _kind in self._readings():
            try:
                value = getter()
            except (BridgeError, NoDataYet) as error:
                value, unit = str(error), ""
            rows.append((name, f"{value:.3g}" if isinstance(value, float) else str(value), unit))
        names = tuple(name for name, _value, _unit in rows)
        return Table("robot", "Robot", ("reading", "value", "unit"), names, tuple(rows))

    def _motor_table(self, reading: BrickReading | None) -> Table:
        rows = [("", "", "")] * 4
        if reading:
            rows = [(type_name(m.type), str(m.degrees), str(m.speed)) for m in reading.motors]
        return Table(
            "motors",
            "Motors",
            ("motor", "type", "count (deg)", "speed (%)"),
            tuple(motor.name for motor in self.motors),
            tuple((motor.name, *row) for motor, row in zip(self.motors, rows, strict=True)),
            (
                Button("backward", "Backward"),
                Button("halt", "Stop"),
                Button("forward", "Forward"),
                Button("reset_count", "Count to 0"),
            ),
        )

    def _sensor_table(self, reading: BrickReading | None) -> Table:
        rows = [("", "", "", "")] * 4
        if reading:
            rows = [sensor_texts(seen) for seen in reading.sensors]
        return Table(
            "sensors",
            "Sensors",
            ("sensor", "type", "mode", "value", "unit"),
            tuple(sensor.name for sensor in self.sensors),
            tuple((sensor.name, *row) for sensor, row in zip(self.sensors, rows, strict=True)),
            (Button("next_mode", "Next mode"),),
        )

    def press(self, key: str, row: str = "", values: Mapping[str, str] | None = None) -> None:
        """Press a button; commands pass the bridge's safety, as those of a program do.

        Raises BridgeError: there is no such button, row or number, or no brick is connected.
        """
        if key == "stop":
            self.stop_all()
            return
        if key == "build":
            self._build(values or {})
            return
        if not self.is_open:
            raise BridgeError("No brick is connected. Enter its address first.")
        motor = next((motor for motor in self.motors if motor.name == row), None)
        sensor = next((sensor for sensor in self.sensors if sensor.name == row), None)
        if key == "beep":
            self.robot.beep()
        elif motor and key in ("forward", "backward"):
            speed = number_in((values or {}).get("speed", "50"), "Speed by hand")
            getattr(self.robot, row).start_at_speed(speed if key == "forward" else -speed)
        elif motor and key == "halt":
            getattr(self.robot, row).stop()
        elif motor and key == "reset_count":
            getattr(self.robot, row).reset_count()
        elif sensor and key == "next_mode":
            seen = sensor.reading()
            sensor.set_mode((seen.mode + 1) % max(1, len(MODES.get(seen.type, ()))))
        else:
            raise BridgeError(f"The panel has no button `{key}` for {row!r}.")

    def _build(self, values: Mapping[str, str]) -> None:
        """Apply the ports and lengths that a person has filled in; the motors are stopped first."""
        known = self.vehicle.options()
        vehicle = Vehicle.of({name: values.get(name, value) for name, value in known.items()})
        if self.is_open:
            self.stop_all()
        self.vehicle = vehicle
        self.link.set_usual_modes(vehicle.modes)
        if self.is_open:
            self._add_driving()

    def answer(self, key: str, value: str) -> None:
        """Apply the address of the brick; where the bridge is open, connect in the background.

        Raises BridgeError: it is not an address.
        """
        if key != "host":
            super().answer(key, value)
            return
        self.host = check_address(value)
        client = self.link.client
        if self.is_open and (client is None or client.place != self.host):
            self.stop_all()
            self.link.close()
            self.link = self._new_link()
            self.set_status(ConnectionState.CONNECTING, f"Connecting to {self.host}.")
            self.link.search()


_STALE_AFTER = 1.0  # s; a brick that does not answer is lost sooner, one that refuses to be read is not
_LIMITS = {"light.data": (0.0, 255.0), "distance.data": (0.0, 2.55)}
_WHERE = (
    "Address of the brick: by WiFi or Bluetooth as it shows under Brick Info (Bluetooth: its ID), or `usb`"
)
_LABELS = {
    "left": "Left motor",
    "right": "Right motor",
    "wheel": "Wheel diameter",
    "track": "Distance of the wheels",
    "light": "Colour sensor",
    "bumper": "Touch sensor",
    "distance": "Distance sensor",
}


def sensor_texts(seen: SensorReading) -> tuple[str, str, str, str]:
    """Return a sensor's row: type, mode, value, unit."""
    if seen.type in ABSENT:
        return type_name(seen.type), "", "", ""
    value = "" if math.isnan(seen.value) else f"{seen.value:g}"
    return type_name(seen.type), mode_name(seen), value, UNITS.get((seen.type, seen.mode), "")
