"""The bundled follower, unchanged, drives a ROS robot: there and back on the course of the paper."""

from __future__ import annotations

import json
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest

from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.live.clock import MonotonicClock
from lrp_jupyter.live.session import Session

pytestmark = pytest.mark.ros

SETUP = Path(__file__).with_name("follower.json")
FOLLOWER = files("lrp_jupyter.programs").joinpath("follower.lrp").read_text(encoding="utf-8")
FASTER = 4.0  # both the robot's time and the program's


def test_the_follower_goes_there_and_back(real: Any, connect: Callable[..., RosBridge]) -> None:
    real.start_robot(FASTER, "line")
    ros = connect(setup=SETUP)
    session = Session(FOLLOWER, bridge=ros, clock=MonotonicClock(FASTER))
    reached = [0.0]
    session.start()
    try:
        assert session.wait_for("bumpback", timeout=180)
        reached[0] = ros.robot.odom.x
        assert session.wait_for("end", timeout=180)
    finally:
        issues = [issue.message for issue in session.issues]
        home = ros.robot.odom.x
        session.close()
    assert reached[0] > 1.0
    assert home < 0.0
    assert issues == []


def test_the_setup_of_the_follower_survives_saving(tmp_path: Path) -> None:
    ros = RosBridge(setup=SETUP)
    ros.save(tmp_path / "again.json")
    assert json.loads((tmp_path / "again.json").read_text()) == json.loads(SETUP.read_text())
