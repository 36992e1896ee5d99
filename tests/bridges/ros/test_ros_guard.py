"""A ROS robot stands although the program that drives it is dead or suspended."""

from __future__ import annotations

import json
import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from bridges.dying import Robot, StandsStill
from bridges.ros.follower import LOOSE
from support.waiting import until

from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.live.session import Session

pytestmark = [pytest.mark.ros, pytest.mark.slow]

SERVER = Path(__file__).with_name("action_node.py")
GOAL = "robot.drive_to(target_pose_pose_position_x=2.0)"
GUARDED = ("--action", "/move_base", "--alive", "/alive")
PROGRAM = f"(machine m (state s (onentry [{GOAL}]) (running [robot.move(linear=0.2)]))) (spawn m s)"


class Printed:
    """What the processes of a robot print, in the order in which it came."""

    def __init__(self, real: Any) -> None:
        self.wheels = real.lines(real.start_robot(world="empty"))
        self.goals = real.lines(real.start(sys.executable, str(SERVER), "full", ready=True))
        self._seen, self._speeds = [0, 0], list[tuple[float, float]]()
        self._moving = [False, False]

    def speeds(self) -> list[tuple[float, float]]:
        """When it moved or stood, as a whole, from when it both drove and pursued a goal."""
        for part, lines in enumerate((self.wheels, self.goals)):
            for line in lines[self._seen[part] :]:
                self._seen[part] += 1
                moment, _, speed = line.partition(" ")
                self._moving[part] = moment == "drives" if part else bool(float(speed))
                if self._speeds or all(self._moving):
                    self._speeds.append((0.0, float(any(self._moving))))
        return self._speeds


@pytest.fixture
def port(real: Any, backend: str) -> int:
    return int(real.start_rosbridge() if backend == "rosbridge" else real.master_port)


@pytest.fixture
def robot(real: Any, backend: str, port: int, tmp_path: Path) -> Robot:
    """The simulator behind the topics of a real ROS 1, and in another process a server of goals."""
    setup = tmp_path / "setup.json"
    setup.write_text(json.dumps({**LOOSE, "actions": {"drive_to": "/move_base"}}))
    options = {"backend": backend, "host": "127.0.0.1", "port": port, "setup": str(setup)}
    named = [f"{name}={value}" for name, value in options.items()]
    return Robot(
        Printed(real).speeds,
        ("--bridge", "ros", *(part for option in named for part in ("--option", option))),
        environment=real.environment,
        program=PROGRAM,
    )


class TestARosRobot(StandsStill):
    """Its stopper has a node, or a connection to the rosbridge server, of its own.

    The server of its goals drives by itself, and its wheels do as they were told last: the guard ends both.
    """


def test_a_robot_whose_commands_cease_is_stopped_on_its_own_side(real: Any, backend: str, port: int) -> None:
    wheels: list[str] = real.lines(real.start_robot(world="empty"))
    options = ("--backend", backend, "--host", f"127.0.0.1:{port}", "--topic", "drive")
    launched = ("__name:=stopper", "__log:=stopper.log", "__ns:=/robot1", "drive:=/cmd_vel")
    command = (sys.executable, "-m", "lrp_jupyter", "guard", *options, *launched)
    printed: list[str] = real.lines(real.start(*command))
    until(lambda: any("nothing has arrived" in line for line in printed))
    command = ("/cmd_vel", "geometry_msgs/Twist", "[0.2, 0, 0]", "[0, 0, 0.5]")
    program = real.start("/usr/bin/rostopic", "pub", "-r", "10", *command)
    until(lambda: "0.2" in " ".join(wheels[-1:]) and any("Connected" in line for line in printed))
    os.killpg(program.pid, signal.SIGKILL)
    until(lambda: wheels[-1].endswith(" 0.0"))
    until(lambda: any("No command for 0.5 s" in line for line in printed))


def test_a_goal_whose_program_is_gone_is_cancelled_on_the_robots_side(
    real: Any, backend: str, port: int, connect: Callable[..., RosBridge]
) -> None:
    done: list[str] = real.lines(real.start(sys.executable, str(SERVER), "full", ready=True))
    ros = connect()
    options = ("--backend", backend, "--host", f"127.0.0.1:{port}", *GUARDED)
    printed: list[str] = real.lines(real.start(sys.executable, "-m", "lrp_jupyter", "guard", *options))
    ros.action("drive_to", "/move_base")
    ros.publish("alive", "/alive", "std_msgs/Empty", at_tick={})
    with Session(f"(machine m (state s (onentry [{GOAL}]))) (spawn m s)", bridge=ros) as session:
        session.start()
        until(lambda: any("Connected" in line for line in printed))
        until(lambda: "drives 2.0" in done)
        ros.act = lambda now: None  # as if its messages no longer came through
        until(lambda: "stands" in done, lambda: f"{printed}")
        until(lambda: any("No message of its program for 0.5 s" in line for line in printed))
        until(lambda: ros.robot.drive_to.status == "cancelled")
