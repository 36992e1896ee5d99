"""A ROS robot stands although the program that drives it is dead or suspended."""

from __future__ import annotations

import os
import signal
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from bridges.bounded import bounded, persistently
from bridges.dying import Robot, StandsStill, wait_until

pytestmark = [pytest.mark.ros, pytest.mark.slow]

SETUP = Path(__file__).with_name("follower.json")


@pytest.fixture
def robot(real: Any, backend: str) -> Robot:
    """The simulator behind the topics of a real ROS 1."""
    printed = real.lines(real.start_robot(world="empty"))
    port = real.start_rosbridge() if backend == "rosbridge" else real.master_port

    def speeds() -> list[tuple[float, float]]:
        return [(float(moment), float(speed)) for moment, speed in map(str.split, list(printed))]

    options = {"backend": backend, "host": "127.0.0.1", "port": port, "setup": str(SETUP)}
    named = [f"{name}={value}" for name, value in options.items()]
    return Robot(
        speeds,
        ("--bridge", "ros", *(part for option in named for part in ("--option", option))),
        f"from lrp_jupyter.bridges.ros import RosBridge\nbridge = RosBridge(**{options!r})",
        environment=real.environment,
    )


class TestARosRobot(StandsStill):
    """Its stopper has a node, or a connection to the rosbridge server, of its own."""


@pytest.fixture
def beside(real: Any, robot: Robot, backend: str) -> list[str]:
    """``lrp guard`` beside the robot; what it prints."""
    port = real.rosbridge_port if backend == "rosbridge" else real.master_port
    options = ("--backend", backend, "--host", f"127.0.0.1:{port}", "--topic", "/cmd_vel")
    printed: list[str] = real.lines(real.start(sys.executable, "-m", "lrp_jupyter", "guard", *options))
    wait_until(lambda: any("Connected" in line or "nothing has arrived" in line for line in printed))
    return printed


def stops(beside: list[str]) -> int:
    return sum("No command for 0.5 s" in line for line in beside)


def test_a_robot_whose_commands_cease_is_stopped_on_its_own_side(
    real: Any, robot: Robot, beside: list[str], record_property: Any
) -> None:
    def ceases() -> None:
        command = ("/cmd_vel", "geometry_msgs/Twist", "[0.2, 0, 0]", "[0, 0, 0.5]")
        program = real.start("/usr/bin/rostopic", "pub", "-r", "10", *command)
        try:
            robot.has_driven_for(1.0)  # so it lets a robot drive that is commanded
            stopped = stops(beside)
            with bounded(1.5):
                moment = time.monotonic()
                os.killpg(program.pid, signal.SIGKILL)
                wait_until(lambda: robot.stands)
        finally:
            if program.poll() is None:
                os.killpg(program.pid, signal.SIGKILL)
        record_property("stands after", robot.stood_after(moment))
        wait_until(lambda: stops(beside) > stopped)

    for _ in range(2):
        persistently(ceases)


def test_another_driver_of_a_robot_that_stands_is_left_alone(
    real: Any, robot: Robot, beside: list[str]
) -> None:
    command = ("/cmd_vel", "geometry_msgs/Twist", "[0, 0, 0]", "[0, 0, 0]")
    real.start("/usr/bin/rostopic", "pub", "-1", *command)
    end = time.monotonic() + 2
    wait_until(lambda: time.monotonic() > end)
    assert stops(beside) == 0
    assert robot.speeds() == []
