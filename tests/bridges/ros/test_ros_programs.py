"""What robots do every day: the programs of `notebooks/ros`, run by `lrp run` beside other nodes.

The nodes around them say what a robot would say; what the program does is what they hear.
"""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from bridges.ros.conftest import HERE, Ros
from support.waiting import until

ROS = HERE.parents[2] / "notebooks" / "ros"
TWIST, ODOM, BOOL, STRING = "geometry_msgs/Twist", "nav_msgs/Odometry", "std_msgs/Bool", "std_msgs/String"

pytestmark = [pytest.mark.ros, pytest.mark.slow]


class Robot:
    """The nodes around a program."""

    def __init__(self, real: Ros) -> None:
        self.real = real
        self.body = real.start(sys.executable, str(HERE / "body_node.py"), ready=True)
        self.server: subprocess.Popen[str] | None = None

    def _tell(self, *what: object) -> None:
        assert self.body.stdin is not None
        self.body.stdin.write(f"{json.dumps(what)}\n")
        self.body.stdin.flush()

    def says(self, topic: str, type_: str, **fields: object) -> None:
        """Publish that twenty times a second."""
        self._tell("says", topic, type_, fields)

    def tells(self, topic: str, type_: str, **fields: object) -> None:
        """Publish that once."""
        self._tell("tells", topic, type_, fields)

    def hears(self, topic: str, type_: str) -> None:
        self._tell("hears", topic, type_)

    def heard(self, topic: str = "") -> list[Any]:
        """What it has heard on a topic, each message that differed from the one before."""
        lines = [line.partition(" ") for line in tuple(self.real.lines(self.body))]
        return [json.loads(message) for name, _, message in lines if name == topic]

    def meets(self) -> None:
        """Wait until the program says that it is there."""
        self.hears("/lrp/alive", "std_msgs/Empty")
        until(lambda: self.heard("/lrp/alive"))

    def moves(self, holds: Callable[[float, float], bool], topic: str = "/cmd_vel") -> None:
        """Wait until the last velocity is a certain one."""

        def last() -> bool:
            heard = self.heard(topic)
            return bool(heard) and holds(heard[-1]["linear"]["x"], heard[-1]["angular"]["z"])

        until(last, lambda: f"{topic}: {self.heard(topic)}")

    def serves(self) -> None:
        """Serve `/move_base` and `/lamp`."""
        self.server = self.real.start(sys.executable, str(HERE / "action_node.py"), "full", ready=True)

    def does(self, *said: str) -> None:
        """Wait until the server has said so, one after the other, and forget what it had said before."""
        assert self.server is not None
        lines = self.real.lines(self.server)
        for each in said:
            until(lambda each=each: each in lines, lambda each=each: f"{each}: {lines}")  # type: ignore[misc]
            del lines[: lines.index(each) + 1]

    def obeys(self, line: str) -> None:
        """Let the server do something: see `action_node.py`."""
        assert self.server is not None
        assert self.server.stdin is not None
        self.server.stdin.write(f"{line}\n")
        self.server.stdin.flush()


@pytest.fixture
def robot(real: Ros) -> Robot:
    return Robot(real)


@pytest.fixture
def behave(real: Ros) -> Iterator[Callable[..., None]]:
    """Start a program of `notebooks/ros`; in the end it is ended as by Ctrl-C."""
    runs = []

    def start(name: str, setup: str = "robot") -> None:
        options = ("--bridge", "ros", "-o", f"setup={ROS / setup}.json", "-o", "backend=rospy")
        program = str(ROS / f"{name}.lrp")
        runs.append(real.start(sys.executable, "-m", "lrp_jupyter", "run", program, *options))

    yield start
    for run in runs:
        run.send_signal(signal.SIGINT)
        run.wait(60)
        assert run.returncode == 128 + signal.SIGINT, real.log(run)


def test_wander(robot: Robot, behave: Callable[..., None]) -> None:
    def sees(left: float, ahead: float) -> None:
        robot.says(
            "/scan",
            "sensor_msgs/LaserScan",
            angle_min=-1.5,
            angle_max=1.5,
            angle_increment=0.5,
            range_min=0.1,
            range_max=10.0,
            ranges=[9.0, 9.0, 9.0, ahead, 9.0, 9.0, left],
        )

    robot.hears("/cmd_vel", TWIST)
    sees(left=0.2, ahead=5.0)
    behave("wander")
    robot.moves(lambda linear, angular: (linear, angular) == (0.3, 0.0))
    sees(left=9.0, ahead=0.4)
    robot.moves(lambda linear, angular: (linear, angular) == (0.0, 0.8))
    sees(left=9.0, ahead=1.0)
    robot.moves(lambda linear, angular: (linear, angular) == (0.3, 0.0))


def test_patrol(robot: Robot, behave: Callable[..., None]) -> None:
    def charge(percentage: float) -> None:
        robot.says("/battery", "sensor_msgs/BatteryState", percentage=percentage)

    robot.serves()
    charge(0.8)
    behave("patrol")
    robot.does("drives 2.0")
    robot.obeys("succeed")
    for _ in range(3):
        robot.does("stands", "drives 2.0")
        robot.obeys("abort no path")
    robot.does("stands", "drives 0.0")
    charge(0.1)
    robot.does("drives 0.0")  # the goal may come before the cancel of the last one, which is another topic
    robot.obeys("succeed")
    robot.does("stands")
    charge(0.95)
    robot.does("drives 0.0")


def test_lamp(robot: Robot, behave: Callable[..., None]) -> None:
    robot.serves()
    behave("lamp")
    robot.meets()
    robot.tells("/button", BOOL, data=True)
    robot.does("lamp True")
    robot.tells("/button", BOOL, data=True)
    robot.does("lamp False")


def test_orders(robot: Robot, behave: Callable[..., None]) -> None:
    orders = [f"order {number}" for number in range(8)]
    robot.hears("/receipt", STRING)
    behave("orders")
    robot.meets()
    for order in orders:
        robot.tells("/order", STRING, data=order)
    until(lambda: len(robot.heard("/receipt")) == len(orders), lambda: str(robot.heard("/receipt")))
    assert [message["data"] for message in robot.heard("/receipt")] == orders


def test_convoy(robot: Robot, behave: Callable[..., None]) -> None:
    def stand(first: float, second: float) -> None:
        for name, x in (("robot1", first), ("robot2", second)):
            robot.says(f"/{name}/odom", ODOM, pose={"pose": {"position": {"x": x}}})

    for name in ("robot1", "robot2"):
        robot.hears(f"/{name}/cmd_vel", TWIST)
    stand(1.5, 0.0)
    behave("convoy", "convoy")
    robot.moves(lambda linear, _: linear == 0.3, "/robot1/cmd_vel")
    robot.moves(lambda linear, _: linear == 0.5, "/robot2/cmd_vel")
    stand(3.0, 0.0)
    robot.moves(lambda linear, _: linear == 0.0, "/robot1/cmd_vel")
    robot.moves(lambda linear, _: linear == 2.0, "/robot2/cmd_vel")
    stand(3.0, 2.0)
    robot.moves(lambda linear, _: linear == 0.3, "/robot1/cmd_vel")
    robot.moves(lambda linear, _: linear == 0.0, "/robot2/cmd_vel")


def test_dock(robot: Robot, behave: Callable[..., None]) -> None:
    def dock_at(x: float, y: float) -> None:
        transform = {"translation": {"x": x, "y": y}, "rotation": {"w": 1.0}}
        link = {"header": {"frame_id": "base_link"}, "child_frame_id": "dock", "transform": transform}
        robot.says("/tf", "tf2_msgs/TFMessage", transforms=[link])

    robot.hears("/cmd_vel", TWIST)
    behave("dock")
    robot.moves(lambda linear, angular: (linear, angular) == (0.0, 0.4))
    dock_at(2.0, 1.0)
    robot.moves(lambda linear, angular: (linear, angular) == (0.2, 0.75))
    dock_at(0.2, 0.0)
    robot.moves(lambda linear, angular: (linear, angular) == (0.0, 0.0))


def test_cruise(robot: Robot, behave: Callable[..., None]) -> None:
    import rosgraph

    master = rosgraph.Master("/tests")
    robot.hears("/cmd_vel", TWIST)
    master.setParam("/cruise_speed", 0.2)
    behave("cruise")
    robot.moves(lambda linear, _: linear == 0.2)
    master.setParam("/cruise_speed", 0.0)
    robot.moves(lambda linear, _: linear == 0.0)
    master.setParam("/cruise_speed", 0.4)
    robot.moves(lambda linear, _: linear == 0.4)


def test_torch(robot: Robot, behave: Callable[..., None]) -> None:
    def sees(left: int, right: int) -> None:
        picture = {"height": 2, "width": 4, "step": 4, "encoding": "mono8"}
        robot.says("/camera/image_raw", "sensor_msgs/Image", **picture, data=[left, left, right, right] * 2)

    robot.hears("/cmd_vel", TWIST)
    sees(20, 30)
    behave("torch")
    sees(150, 100)
    robot.moves(lambda linear, angular: (linear, angular) == (0.2, 0.5))
    sees(100, 180)
    robot.moves(lambda linear, angular: (linear, angular) == (0.2, -0.8))
    sees(60, 60)
    robot.moves(lambda linear, angular: (linear, angular) == (0.0, 0.0))
