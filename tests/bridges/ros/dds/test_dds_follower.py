"""The bundled follower, unchanged, drives a ROS 2 robot without ROS: there and back, over DDS."""

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

SETUP = Path(__file__).parents[1] / "follower.json"
FOLLOWER = files("lrp_jupyter.programs").joinpath("follower.lrp").read_text(encoding="utf-8")
PATIENT = """
from lrp_jupyter.bridges import guard
from lrp_jupyter.bridges.ros import RosBridge
guard._LAPSE = 60.0
RosBridge.stopper = lambda bridge: None
"""
FASTER = 4.0  # both the robot's time and the program's


def test_the_follower_goes_there_and_back(
    robot: Callable[..., Any], connect: Callable[..., RosBridge]
) -> None:
    robot(FASTER)
    ros = connect(setup=SETUP)
    session = Session(FOLLOWER, bridge=ros, clock=MonotonicClock(FASTER))
    reached = 0.0
    session.start()
    try:
        assert session.wait_for("bumpback", timeout=180)
        reached = ros.robot.odom.x
        assert session.wait_for("end", timeout=180)
    finally:
        issues = [issue.message for issue in session.issues]
        home = ros.robot.odom.x
        session.close()
    assert reached > 1.0
    assert home < 0.0
    assert issues == []


@pytest.mark.slow
def test_it_does_so_on_the_command_line_where_there_is_neither_jupyter_nor_ros(
    domain: int, robot: Callable[..., Any], bare_lrp: Callable[..., Any], tmp_path: Path
) -> None:
    robot(2.0)
    trace = tmp_path / "trace.jsonl"
    options = ("--option", "backend=dds", "--option", f"domain={domain}", "--option", f"setup={SETUP}")
    scaled = ("--rate", "20", "--set", "maxlook=100", "--set", "back=-0.1", "--set", "turn=0.5")
    run = bare_lrp(
        *("run", "follower", "--bridge", "ros", *options, *scaled, "--until", "end", "--trace", trace),
        missing=("rospy", "rclpy", "websockets"),
        before=PATIENT,
    )
    output, complaints = run.communicate(timeout=180)
    assert (run.returncode, complaints) == (0, "")
    assert "follower/end active" in output.splitlines()[-1]
    assert "issue" not in output.splitlines()[-1]
    entered = [line for line in map(json.loads, trace.read_text().splitlines()) if line["event"] == "entered"]
    assert entered[-1]["state"] == "follower/end"
