"""The robot behind every wire of these tests: the simulator in real time, as a process of its own."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable
from typing import TextIO

from lrp_jupyter.sim.simulation import STEP, Simulation

_EVERY = 2  # physics steps between two messages
_LATE = 0.05  # s


class SimulatedRobot:
    """A robot that drives as it was told last, and publishes what it senses fifty times a second of its time.

    Parameters
    ----------
    speed : float
        Seconds of its time per second.
    says : file
        Where it says when it is told to drive otherwise.
    """

    def __init__(self, speed: float = 1.0, says: TextIO = sys.stdout) -> None:
        self.simulation = Simulation("line")
        self.speed, self.says = speed, says
        self.wanted = (0.0, 0.0)
        self.gone = threading.Event()

    def drive(self, linear: float, angular: float) -> None:
        if (linear, angular) != self.wanted:
            self.says.write(f"drives {linear:.3f} {angular:.3f}\n")
            self.says.flush()
        self.wanted = (linear, angular)

    def run(self, publish: Callable[[int, bool, tuple[float, float, float]], object]) -> None:
        """Live until `gone` is set; `publish` gets the light, the bumper and the odometry."""
        began = time.monotonic()
        while not self.gone.is_set():
            self.simulation.drive(*self.wanted)
            self.simulation.step(_EVERY)
            readings = self.simulation.latch()
            publish(readings.lights[0], readings.bumper, readings.odom)
            ahead = began + self.simulation.steps * STEP / self.speed - time.monotonic()
            if ahead < -_LATE:  # a robot that was held up is slow: it does not race on with an old command
                began -= ahead
            self.gone.wait(max(0.0, ahead))


def ready(robot: SimulatedRobot, word: str = "ready") -> None:
    """Tell the test that the robot is there; it ends with its standard input."""
    threading.Thread(target=lambda: (sys.stdin.read(), robot.gone.set()), daemon=True).start()
    sys.stdout.write(f"{word}\n")
    sys.stdout.flush()
