"""The robot behind the wires of the tests: the simulator, in a process of its own."""

from __future__ import annotations

import math
import sys
import threading
import time
from collections.abc import Callable
from typing import Any, TextIO

from lrp_jupyter.sim.errands import Errand, Errands
from lrp_jupyter.sim.simulation import STEP, Simulation
from lrp_jupyter.sim.world_inputs import DriveBy

_LATE = 0.05  # s

Odom = tuple[float, float, float]


class SimulatedRobot:
    """A robot that drives as its last command says, and publishes what it senses.

    Parameters
    ----------
    speed : float
        Seconds of its time per second. 0: its time passes in `go_on` only, at once.
    says : file
        Where it says when it is commanded to drive otherwise.
    """

    world = "line"
    steps = 2  # of physics between two messages

    def __init__(self, speed: float = 1.0, says: TextIO = sys.stdout) -> None:
        self.simulation = Simulation(self.world)
        self.speed, self.says = speed, says
        self.wanted: tuple[float, float] | Errands = (0.0, 0.0)
        self.obeyed = (0.0, 0.0)
        self._begun: Errands | None = None
        self.gone = threading.Event()
        self._until, self._news = 0.0, threading.Event()

    def drive(self, linear: float, angular: float) -> None:
        if (linear, angular) != self.wanted:
            self.say(linear, angular)
        self.wanted = (linear, angular)
        self._news.set()

    def say(self, linear: float, angular: float) -> None:
        self.says.write(f"drives {linear:.3f} {angular:.3f}\n")
        self.says.flush()

    def ask(self, what: Errands) -> None:
        """Let it drive by itself until it is commanded again."""
        by = f"drives by {what.metres:.3f}" if isinstance(what, DriveBy) else f"turns by {what.radians:.3f}"
        self.says.write(f"{by}\n")
        self.says.flush()
        self.wanted = what
        self._news.set()

    @property
    def errand(self) -> Errand | None:
        """What it was asked for, unless it was commanded since; None before it has begun."""
        return self.simulation.robot.memory.errand if self._begun is self.wanted else None

    def _obey(self) -> None:
        wanted = self.wanted
        if isinstance(wanted, tuple):
            self.obeyed = wanted
            self.simulation.drive(*wanted)
        elif self._begun is not wanted:
            self.simulation.apply(wanted)
            self._begun = wanted

    def go_on(self, until: float) -> None:
        """Let its time pass until so many seconds from its beginning."""
        self._until = until
        self._news.set()

    def end(self) -> None:
        self.gone.set()
        self._news.set()

    def run(self, publish: Callable[[int, bool, Odom], object]) -> None:
        """Live until the end; `publish` gets the light, the bumper and the odometry."""
        began = time.monotonic()
        while not self.gone.is_set():
            self._news.clear()
            self._obey()
            left = round(self._until / STEP) - self.simulation.steps
            self.simulation.step(self.steps if self.speed else max(0, left))
            readings = self.simulation.latch()
            publish(readings.lights[0], readings.bumper, readings.odom)
            if not self.speed:
                self._news.wait()
                continue
            ahead = began + self.simulation.steps * STEP / self.speed - time.monotonic()
            if ahead < -_LATE:  # a robot that was held up is slow: it does not race on with an old command
                began -= ahead
            self.gone.wait(max(0.0, ahead))


class RosRobot(SimulatedRobot):
    """A robot that says when it is commanded another speed, by `time.monotonic`.

    With a `speed` of 0 the odometry tells its time, as its frame; the light has the last four bits of it.
    """

    steps = 4

    def __init__(self, speed: float, world: str) -> None:
        self.world = world
        super().__init__(speed)

    def say(self, linear: float, angular: float) -> None:
        if linear != self.wanted[0]:
            self.says.write(f"{time.monotonic()} {linear}\n")
            self.says.flush()

    def odometry(self, odom: Any, pose: Odom) -> Any:
        """Fill in an `Odometry`: where the robot is, and the command that it obeys."""
        x, y, theta = pose
        odom.header.frame_id = str(self.simulation.steps)
        odom.pose.pose.position.x, odom.pose.pose.position.y = x, y
        odom.pose.pose.orientation.z, odom.pose.pose.orientation.w = math.sin(theta / 2), math.cos(theta / 2)
        odom.twist.twist.linear.x, odom.twist.twist.angular.z = self.obeyed
        return odom

    def brightness(self, light: int) -> int:
        return light if self.speed else light & ~15 | self.simulation.steps & 15


def ready(robot: SimulatedRobot, word: str = "ready") -> None:
    """Say that the robot is there; it ends with its standard input."""
    threading.Thread(target=lambda: (sys.stdin.read(), robot.end()), daemon=True).start()
    sys.stdout.write(f"{word}\n")
    sys.stdout.flush()
