"""A stand-in for the module `controller` of Webots, from its documentation; the world is our simulator.

As there: one `Robot` for a process, which finds its devices by their names and says on the error stream
when there is none; `step` moves the world and returns -1 when the simulation has ended; the value of a
sensor is NaN until it was enabled and its period has passed; a motor turns at its velocity if its position
is infinite.
"""

from __future__ import annotations

import math
import sys
from typing import ClassVar

from lrp_jupyter.sim.simulation import STEP, Simulation

BASIC_TIME_STEP = 20  # ms, as the world says
WHEEL, APART = 0.0205, 0.052  # m, of the e-puck


class Motor:
    def __init__(self) -> None:
        self.position, self.velocity = 0.0, 6.28

    def setPosition(self, position: float) -> None:
        self.position = position

    def setVelocity(self, velocity: float) -> None:
        self.velocity = velocity

    @property
    def turning(self) -> float:
        return max(-6.28, min(6.28, self.velocity)) if math.isinf(self.position) else 0.0


class Sensor:
    def __init__(self) -> None:
        self.period, self.value = 0, math.nan

    def enable(self, sampling_period: int) -> None:
        self.period = sampling_period

    def getValue(self) -> float:
        return self.value


class Robot:
    created: ClassVar[Robot | None] = None
    without: ClassVar[tuple[str, ...]] = ()  # devices that the robot of a test lacks

    def __init__(self) -> None:
        if Robot.created:
            sys.stderr.write("Error: only one Robot instance can be created per controller process.\n")
            return
        Robot.created = self
        self.simulation = Simulation("line")
        self.milliseconds = 0
        self.has_ended = False
        self.left, self.right = Motor(), Motor()
        self.ground, self.front = Sensor(), (Sensor(), Sensor())
        self.encoders = (Sensor(), Sensor())
        self.wheels = [0.0, 0.0]  # how far they have turned
        self.devices = {
            "left wheel sensor": self.encoders[0],
            "right wheel sensor": self.encoders[1],
            "left wheel motor": self.left,
            "right wheel motor": self.right,
            "gs1": self.ground,
            "ps0": self.front[0],
            "ps7": self.front[1],
        }

    def getDevice(self, name: str) -> object:
        if name in self.devices and name not in self.without:
            return self.devices[name]
        sys.stderr.write(f'Device "{name}" was not found on robot "e-puck"\n')
        return None

    def getBasicTimeStep(self) -> float:
        return float(BASIC_TIME_STEP)

    def getTime(self) -> float:
        return self.milliseconds / 1000

    def step(self, time_step: int) -> int:
        if self.has_ended:
            return -1
        left, right = self.left.turning * WHEEL, self.right.turning * WHEEL
        self.simulation.drive((left + right) / 2, (right - left) / APART)
        x, y, heading = self.simulation.robot.reckoned
        self.simulation.step(round(time_step / 1000 / STEP))
        after = self.simulation.robot.reckoned
        ahead = (after[0] - x) * math.cos(heading) + (after[1] - y) * math.sin(heading)
        turn = (after[2] - heading) * APART / 2
        self.wheels[0] += (ahead - turn) / WHEEL
        self.wheels[1] += (ahead + turn) / WHEEL
        self.milliseconds += time_step
        readings = self.simulation.latch()
        self._sample(self.ground, 300 + 600 * readings.lights[0] / 255)
        for encoder, angle in zip(self.encoders, self.wheels, strict=True):
            self._sample(encoder, angle)
        for sensor in self.front:
            self._sample(sensor, 3500 if readings.bumper else 60)
        return 0

    def _sample(self, sensor: Sensor, value: float) -> None:
        if sensor.period and self.milliseconds % sensor.period == 0:
            sensor.value = value
