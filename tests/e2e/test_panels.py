"""The panels of real robots: a ROS robot behind a server of topics, and an emulated EV3 brick."""

import threading

import pytest
from bridges.ev3.brick import Brick
from bridges.ros.rosbridge_server import MemoryGraph, RosbridgeServer
from e2e.programs import COUNTER

from lrp_jupyter.bridges.ros_definitions import KNOWN

DRIVE = """\
(machine m
  (state a (running [robot.move(linear=0.1)])))
(spawn m a)
"""


class RosRobot:
    """Topics in memory that somebody publishes, and the server that a bridge finds them by."""

    def __init__(self):
        self.graph = MemoryGraph(dict(KNOWN))
        self.graph.types |= {
            "/odom": "nav_msgs/Odometry",
            "/light": "std_msgs/UInt8",
            "/cmd_vel": "geometry_msgs/Twist",
        }
        self.graph.others |= set(self.graph.types)
        self.light = 200
        self._gone = threading.Event()
        self._speaker = threading.Thread(target=self._speak, name="topics")
        self._speaker.start()
        self.server = RosbridgeServer(self.graph)

    def _speak(self):
        while not self._gone.wait(0.1):
            self.graph.say("/light", data=self.light)
            self.graph.say("/odom", pose={"pose": {"position": {"x": 1.25, "y": 0.5, "z": 0.0}}})

    def close(self):
        self._gone.set()
        self._speaker.join()
        self.server.close()


@pytest.fixture
def ros():
    robot = RosRobot()
    yield robot
    robot.close()


@pytest.fixture
def brick():
    brick = Brick()
    brick.sensors[0].type, brick.sensors[0].values = 16, {0: 0.0, 1: 3.0}
    brick.sensors[1].type, brick.sensors[1].values = 29, {0: 42.0, 1: 7.0, 2: 5.0}
    brick.sensors[2].type, brick.sensors[2].values = 30, {0: 25.5}
    yield brick
    brick.close()
    assert brick.violations == []


def test_ros_look(open_lab, ros):
    lab = open_lab(DRIVE, f"m --bridge ros --host 127.0.0.1 --port {ros.server.port}")
    lab.page.wait_for_timeout(1500)
    lab.root.screenshot(path="/tmp/ros1.png")
    w=lab.find('[data-lrp="world"]')
    w.screenshot(path="/tmp/ros1w.png")
    print(w.inner_text())


def test_ev3_look(open_lab, brick):
    lab = open_lab(COUNTER, f"m --bridge ev3 --host 127.0.0.1 --port {brick.port}")
    lab.page.wait_for_timeout(1500)
    lab.root.screenshot(path="/tmp/ev1.png")
    w=lab.find('[data-lrp="world"]')
    w.screenshot(path="/tmp/ev1w.png")
    print(w.inner_text())
