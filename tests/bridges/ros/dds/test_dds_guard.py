"""A ROS 2 robot stands although the program that drives it over DDS is dead or suspended."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from bridges.bounded import bounded
from bridges.dying import Driver, Robot, StandsStill, guards, in_time, patiently, wait_until

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
        f"from lrp_jupyter.bridges.ros import RosBridge\nbridge = RosBridge(**{options!r})",
        environment=dict(os.environ),
    )


class TestARobotBehindDds(StandsStill):
    """Its stopper is a participant of its own."""


@pytest.mark.parametrize("driver", ["lrp run"], indirect=True)
def test_a_robot_is_stopped_on_its_own_side_when_the_computer_of_the_program_sleeps(
    robot: Robot, driver: Driver, processes: Any, tmp_path: Path, record_property: Callable[..., None]
) -> None:
    command = (sys.executable, "-m", "lrp_jupyter", "guard", "--backend", "dds", "--topic", "/cmd_vel")
    printed = processes.lines(processes.start(*command))
    wait_until(lambda: any("Connected" in line for line in printed))

    def scenario(driver: Driver, connected: float) -> None:
        with in_time():
            robot.has_driven_for(connected)
        asleep, before = guards(driver.pid), stops()
        assert len(asleep) == 1
        try:
            with in_time(), bounded(1.5):
                moment = time.monotonic()
                for each in (*asleep, driver.pid):
                    os.kill(each, signal.SIGSTOP)
                wait_until(lambda: robot.stands)
            wait_until(lambda: stops() > before)
        finally:
            for each in asleep:
                os.kill(each, signal.SIGKILL)
        record_property("stands after", robot.stood_after(moment))

    def stops() -> int:
        return sum("No command for 0.5 s" in line for line in printed)

    patiently(scenario, robot, driver, tmp_path)
