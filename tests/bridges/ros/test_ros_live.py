"""The bridge against a real ROS 1: its master, its command line tools, its C++ relay."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.errors import BridgeError, NoDataYet

pytestmark = pytest.mark.ros


def test_what_rostopic_publishes_arrives(real: Any, connect: Callable[..., RosBridge], until: Any) -> None:
    ros = connect()
    ros.subscribe("text", "/chatter", "std_msgs/String")
    with pytest.raises(NoDataYet):
        _ = ros.robot.text
    real.start("/usr/bin/rostopic", "pub", "-r", "10", "/chatter", "std_msgs/String", "data: 'hello'")
    until(lambda: ros.describe("text").value is not None or _read(ros, "text"), 10)
    assert ros.robot.text.data == "hello"


def _read(ros: RosBridge, name: str) -> object:
    try:
        return getattr(ros.robot, name)
    except (NoDataYet, BridgeError):
        return None
