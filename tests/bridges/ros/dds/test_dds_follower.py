"""The bundled follower, unchanged, drives a ROS 2 robot without ROS, over DDS."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from bridges.ros.follower import LOOSE, PATIENT, SETUP, TOLD, go_there_and_back, last_state

from lrp_jupyter.bridges.ros import RosBridge

pytestmark = pytest.mark.ros


def test_the_follower_goes_there_and_back(
    robot: Callable[..., Any], connect: Callable[..., RosBridge]
) -> None:
    robot(TOLD)
    go_there_and_back(connect(setup=LOOSE))


@pytest.mark.slow
def test_it_drives_on_the_command_line_where_there_is_neither_jupyter_nor_ros(
    domain: int, robot: Callable[..., Any], bare_lrp: Callable[..., Any], tmp_path: Path
) -> None:
    robot()
    trace = tmp_path / "trace.jsonl"
    options = ("--option", "backend=dds", "--option", f"domain={domain}", "--option", f"setup={SETUP}")
    run = bare_lrp(
        *("run", "follower", "--bridge", "ros", *options, "--until", "moving", "--trace", trace),
        missing=("rospy", "rclpy", "websockets"),
        before=PATIENT,
    )
    output, complaints = run.communicate(timeout=180)
    assert (run.returncode, complaints) == (0, "")
    assert "follower/moving active" in output.splitlines()[-1]
    assert "issue" not in output.splitlines()[-1]
    assert last_state(trace) == "follower/moving"
