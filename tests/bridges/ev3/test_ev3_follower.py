"""The bundled follower, unchanged, drives a brick: there and back on the course of the paper.

The emulated brick's motors drive the simulated robot, whose sensors are those of the brick.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Iterator
from importlib.resources import files
from typing import Any

import pytest
from bridges.bounded import PatientClock

from lrp_jupyter.bridges.ev3 import EV3Bridge
from lrp_jupyter.live.clock import MonotonicClock
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim.simulation import STEP, Simulation

FOLLOWER = files("lrp_jupyter.programs").joinpath("follower.lrp").read_text(encoding="utf-8")
FASTER = 3.0  # the time of the brick, of the robot around it, and of the program
WHEEL, TRACK = 0.056, 0.12  # m
_EVERY = 4  # physics steps between two looks at the motors
_LATE = 0.05  # s


class Course:
    """The simulated world around a brick, on a thread of its own."""

    def __init__(self, brick: Any, world: str) -> None:
        self.brick, self.simulation = brick, Simulation(world)
        brick.sensors[0].type, brick.sensors[2].type, brick.sensors[3].type = 16, 29, 30
        self._sense()
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._drive, name="course")
        self._thread.start()

    def _sense(self) -> None:
        readings, sensors = self.simulation.latch(), self.brick.sensors
        sensors[0].values = {0: float(readings.bumper)}
        sensors[2].values = {0: float(round(readings.lights[0] / 2.55))}
        sensors[3].values = {0: min([255.0, *(way * 100 for way in readings.distances)])}

    def _drive(self) -> None:
        began = time.monotonic()
        while not self._over.is_set():
            left, right = (math.radians(self.brick.motors[i].turning * 10) * WHEEL / 2 for i in (1, 2))
            self.simulation.drive((left + right) / 2, (right - left) / TRACK)
            self.simulation.step(_EVERY)
            self._sense()
            ahead = began + self.simulation.steps * STEP / FASTER - time.monotonic()
            if ahead < -_LATE:  # a robot that was held up is slow: it does not race on with an old command
                began -= ahead
            self._over.wait(max(0.0, ahead))

    def close(self) -> None:
        self._over.set()
        self._thread.join()
        self.simulation.close()


@pytest.fixture
def fast(patient_clock: PatientClock) -> Callable[[], float]:
    """The time of the brick's motors."""
    return lambda: patient_clock() * FASTER


@pytest.fixture
def course(make_brick: Callable[..., Any], fast: Callable[[], float]) -> Iterator[Course]:
    course = Course(make_brick(clock=fast), "line")
    yield course
    course.close()


@pytest.mark.slow
def test_the_follower_goes_there_and_back(
    course: Course, free_udp_port: int, fast: Callable[[], float]
) -> None:
    bridge = EV3Bridge("127.0.0.1", port=course.brick.port, beacon_port=free_udp_port)
    bridge.clock = fast  # type: ignore[method-assign]
    bridge.open()
    bridge.arm()
    session = Session(FOLLOWER, bridge=bridge, clock=MonotonicClock(FASTER))
    reached = home = math.nan
    session.start()
    try:
        assert session.wait_for("bumpback", timeout=180)
        reached = bridge.robot.odom.x
        assert session.wait_for("end", timeout=180)
    finally:
        issues = [issue.message for issue in session.issues]
        home = bridge.link.snapshot.pose[0]
        session.close()
    assert issues == []
    assert reached > 1.0
    assert course.simulation.robot.readings.odom[0] < 0.0
    assert home < 0.5, "dead reckoning, with wheels that slipped at a wall"
