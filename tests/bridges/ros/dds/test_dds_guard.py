"""A ROS 2 robot stands although the program that drives it over DDS is dead or suspended."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from bridges.dying import PATIENT, CommandLine, Robot, StandsStill, guards
from support.waiting import until

pytestmark = [pytest.mark.ros, pytest.mark.slow]

SETUP = Path(__file__).parents[1] / "follower.json"


@pytest.fixture
def robot(robot: Callable[..., Any], processes: Any, domain: int) -> Robot:
    """The simulator behind topics, in another process."""
    printed = processes.lines(robot(world="empty"))

    def speeds() -> list[tuple[float, float]]:
        return [(float(moment), float(speed)) for moment, speed in map(str.split, list(printed))]

    options = {"backend": "dds", "domain": domain, "setup": str(SETUP)}
    named = [f"{name}={value}" for name, value in options.items()]
    return Robot(
        speeds,
        ("--bridge", "ros", *(part for option in named for part in ("--option", option))),
        environment=dict(os.environ),
    )


class TestARobotBehindDds(StandsStill):
    """Its stopper is a participant of its own."""


def test_a_robot_is_stopped_on_its_own_side_when_the_computer_of_the_program_sleeps(
    robot: Robot, processes: Any, tmp_path: Path
) -> None:
    driver = CommandLine(robot, tmp_path, before=PATIENT)
    asleep: list[int] = []
    try:
        until(lambda: robot.drives)
        command = (sys.executable, "-m", "lrp_jupyter", "guard", "--backend", "dds", "--topic", "/cmd_vel")
        printed = processes.lines(processes.start(*command))
        until(lambda: any("Connected" in line for line in printed))
        asleep = [*guards(driver.pid), driver.pid]
        assert len(asleep) == 2
        for each in asleep:
            os.kill(each, signal.SIGSTOP)
        robot.is_stopped()
        until(lambda: any("No command for 0.5 s" in line for line in printed))
    finally:
        for each in asleep:
            os.kill(each, signal.SIGKILL)
        driver.end()
