"""A ROS robot stands although the program that drives it is dead or suspended."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from bridges.dying import Robot, StandsStill
from support.waiting import until

from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.live.session import Session

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


class TestARosRobotWithAGoal(StandsStill):
    """It drives by itself, and its own server goes on: the guard cancels the goal."""

    @pytest.fixture
    def robot(self, real: Any, backend: str, tmp_path: Path) -> Robot:
        node = Path(__file__).with_name("action_node.py")
        printed = real.lines(real.start(sys.executable, str(node), "full", ready=True))
        port = real.start_rosbridge() if backend == "rosbridge" else real.master_port
        setup = tmp_path / "setup.json"
        setup.write_text('{"actions": {"drive_to": "/move_base"}}')

        def speeds() -> list[tuple[float, float]]:
            return [(0.0, float(line.startswith("drives"))) for line in list(printed)]

        options = {"backend": backend, "host": "127.0.0.1", "port": port, "setup": str(setup)}
        named = [f"{name}={value}" for name, value in options.items()]
        return Robot(
            speeds,
            ("--bridge", "ros", *(part for option in named for part in ("--option", option))),
            environment=real.environment,
            program="(machine m (state s (onentry [robot.drive_to(target_pose_pose_position_x=2.0)])))"
            " (spawn m s)",
        )


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


def test_a_goal_whose_program_is_gone_is_cancelled_on_the_robots_side(
    real: Any, backend: str, connect: Callable[..., RosBridge]
) -> None:
    node = real.start(sys.executable, str(Path(__file__).with_name("action_node.py")), "full")
    done: list[str] = real.lines(node)
    until(lambda: "ready" in done)
    ros = connect()
    place = f"127.0.0.1:{real.rosbridge_port if backend == 'rosbridge' else real.master_port}"
    options = ("--backend", backend, "--host", place, "--action", "/move_base", "--alive", "/alive")
    printed: list[str] = real.lines(real.start(sys.executable, "-m", "lrp_jupyter", "guard", *options))
    ros.action("drive_to", "/move_base")
    ros.publish("alive", "/alive", "std_msgs/Empty", at_tick={})
    text = "(machine m (state s (onentry [robot.drive_to(target_pose_pose_position_x=2.0)]))) (spawn m s)"
    with Session(text, bridge=ros) as session:
        session.start()
        until(lambda: any("Connected" in line for line in printed))
        until(lambda: "drives 2.0" in done)
        session.wait_for(lambda frame: frame.time > 1.5)
        assert "stands" not in done
        ros.act = lambda now: None  # as if its messages no longer came through
        until(lambda: "stands" in done, lambda: f"{printed}")
        assert any("No message of its program for 0.5 s" in line for line in printed)
        until(lambda: ros.robot.drive_to.status == "cancelled")
