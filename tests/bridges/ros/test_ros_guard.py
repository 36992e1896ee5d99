"""A ROS robot stands although the program that drives it is dead or suspended."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path
from typing import Any

import pytest
from bridges.dying import Robot, StandsStill
from support.waiting import until

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
        environment=real.environment,
    )


class TestARosRobot(StandsStill):
    """Its stopper has a node, or a connection to the rosbridge server, of its own."""


def test_a_robot_whose_commands_cease_is_stopped_on_its_own_side(
    real: Any, robot: Robot, backend: str
) -> None:
    port = real.rosbridge_port if backend == "rosbridge" else real.master_port
    options = ("--backend", backend, "--host", f"127.0.0.1:{port}", "--topic", "/cmd_vel")
    printed: list[str] = real.lines(real.start(sys.executable, "-m", "lrp_jupyter", "guard", *options))
    until(lambda: any("nothing has arrived" in line for line in printed))
    command = ("/cmd_vel", "geometry_msgs/Twist", "[0.2, 0, 0]", "[0, 0, 0.5]")
    program = real.start("/usr/bin/rostopic", "pub", "-r", "10", *command)
    until(lambda: robot.drives and any("Connected" in line for line in printed))
    os.killpg(program.pid, signal.SIGKILL)
    robot.is_stopped()
    until(lambda: any("No command for 0.5 s" in line for line in printed))
