"""A ROS robot stands although the program that drives it is dead or suspended."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from bridges.dying import Robot, StandsStill

pytestmark = [pytest.mark.ros, pytest.mark.slow]

SETUP = Path(__file__).with_name("follower.json")


@pytest.fixture
def robot(real: Any, backend: str) -> Robot:
    """The simulator behind the topics of a real ROS 1."""
    printed = real.lines(real.start_robot(world="empty"))
    port = real.start_rosbridge() if backend == "rosbridge" else real.master_port

    def speeds() -> list[tuple[float, float]]:
        pairs = [line.split() for line in list(printed)]
        return [(float(moment), float(speed)) for moment, speed in pairs]

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
