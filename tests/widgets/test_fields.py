"""Fields of readings and messages complete by their types: no robot needs to have sent anything yet."""

import pytest

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.member_tree import RobotVariable
from lrp_jupyter.bridges.message import Twist
from lrp_jupyter.bridges.ros.types import Types
from lrp_jupyter.editors.python_options import arguments_of, fields_of
from lrp_jupyter.widgets.views.view_state import listed_members


class Far(Bridge):
    """A robot that has not sent anything."""

    name = "test-far"

    def open_interface(self):
        odometry = Types().form("nav_msgs/Odometry").kind
        self.add_variable("odom", lambda: None, "where it is", type=odometry)
        self.add_variable("light.data", lambda: 7, "0 dark", unit="grey")
        self.add_method("move", lambda message: None, "drive", message=Twist)
        self.add_method("motor.turn", self.turn, "turn")
        self.add_task("go", self.go, doc="go on", message=Twist)

    def turn(self, speed, brake=True):
        """Turn the motor."""

    def go(self, task, message):
        """Go on."""


@pytest.fixture
def far():
    bridge = Far()
    bridge.open()
    yield bridge
    bridge.close()


def labels(options):
    return [option["label"] for option in options]


def test_a_reading_that_has_not_arrived_has_the_fields_of_its_type(far):
    assert {"x", "y", "theta", "pose", "twist"} <= set(labels(fields_of(far, "robot.odom")))
    position = fields_of(far, "robot.odom.pose.pose.position")
    assert [(option["label"], option["detail"]) for option in position] == [(n, "float") for n in "xyz"]


def test_a_part_of_the_robot_has_its_members_with_their_values(far):
    far.refresh()
    data, new, age = fields_of(far, "robot.light")
    assert (data["label"], data["detail"], data["info"]) == ("data", "7", "0 dark")
    assert (new["label"], new["detail"], age["label"], age["detail"]) == ("new", "tuple", "age", "float")


def test_a_method_has_what_accompanies_it(far):
    age = RobotVariable(far, "motor.turn.age", float, "", "s", float, None, None, "motor.turn")
    far.nodes.accompany("motor.turn", age)
    assert labels(fields_of(far, "robot.motor.turn")) == ["age"]
    assert fields_of(far, "robot.motor.turn.age") == fields_of(far, "robot.move") == []


def test_the_message_of_a_command_has_the_fields_of_its_type(far):
    assert labels(fields_of(far, "robot.move()")) == ["linear", "angular"]
    assert labels(fields_of(far, "robot.move().linear")) == ["x", "y", "z"]
    assert fields_of(far, "robot.move().lineer") is None


def test_a_command_itself_has_no_fields(far):
    assert fields_of(far, "robot.move") == []
    assert fields_of(far, "robot.move.linear") == []
    assert not [member for member in listed_members(far) if member.name.startswith("move.")]


def test_a_task_has_fields_that_can_be_read_and_arguments_that_can_be_given(far):
    states = labels(fields_of(far, "robot.go"))
    assert states == ["status", "active", "succeeded", "failed", "feedback", "result", "reason", "since"]
    assert labels(fields_of(far, "robot.go()")) == ["linear", "angular"]
    assert labels(fields_of(far, "robot.go().linear")) == ["x", "y", "z"]
    assert {"linear=", "linear_x="} <= set(labels(arguments_of(far, "robot.go")))


def test_other_chains_are_not_known_here(far):
    assert fields_of(far, "math") is None
    assert fields_of(far, "robot") is None
    assert fields_of(far, "robot.light.data") is None, "a number: Python knows it better"


def test_a_command_accepts_short_and_long_names_of_its_arguments(far):
    names = labels(arguments_of(far, "robot.move"))
    assert {"linear_x=", "angular_z="} <= set(names)
    assert labels(arguments_of(far, "robot.motor.turn")) == ["speed=", "brake="]
    assert arguments_of(far, "robot.nothing") == arguments_of(far, "print") == []
