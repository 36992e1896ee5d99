"""Messages that a program fills: every notation, and every mistake that is refused here."""

from __future__ import annotations

import copy
import math
import re
from fractions import Fraction
from typing import Any

import numpy
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.robots import Bare

from lrp_jupyter.bridges.members import MemberError
from lrp_jupyter.bridges.message import NUMBER, Message, Plain, Twist, Vector3, real_number
from lrp_jupyter.bridges.recorded import RecordedBridge
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import BridgeError

finite = st.floats(allow_nan=False, allow_infinity=False)


@pytest.fixture
def rover() -> Bare:
    """It takes a Twist."""

    def members(rover: Any) -> None:
        rover.add_method("move", lambda msg: rover.calls.append(msg.as_dict()), "drive", message=Twist)

    rover = Bare(members)
    rover.open()
    return rover


def twist(x: float = 0.0, z: float = 0.0) -> dict[str, dict[str, float]]:
    return {"linear": {"x": x, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": z}}


def test_the_papers_block_fills_a_message(rover: Bare) -> None:
    forward, turn = 0.2, 0.5
    rover.robot.move(lambda msg: [msg.linear(x=forward), msg.angular(z=turn)])
    assert rover.calls == [twist(0.2, 0.5)]


def test_a_def_fills_a_message(rover: Bare) -> None:
    def fill(msg: Any) -> None:
        msg.linear.x = 0.2
        msg.angular.z = 0.5

    rover.robot.move(fill)
    assert rover.calls == [twist(0.2, 0.5)]


def test_with_fills_a_message_and_sends_it_at_the_end(rover: Bare) -> None:
    with rover.robot.move as msg:
        msg.linear.x = 0.2
        assert rover.calls == []
    assert rover.calls == [twist(0.2)]


def test_a_with_block_that_fails_sends_nothing(rover: Bare) -> None:
    with pytest.raises(ZeroDivisionError), rover.robot.move as msg:
        msg.linear.x = 1 / 0
    assert rover.calls == []
    with rover.robot.move as msg:
        msg.angular.z = 1
    assert rover.calls == [twist(z=1.0)]


def test_keywords_fill_a_message_short_and_long(rover: Bare) -> None:
    rover.robot.move(linear=0.2, angular=0.5)
    rover.robot.move(linear_x=0.2, angular_z=0.5)
    rover.robot.move(linear={"x": 0.2}, angular=Vector3(z=0.5))
    rover.robot.move(Twist(linear=0.2, angular=0.5))
    assert rover.calls == [twist(0.2, 0.5)] * 4


def test_what_is_not_set_keeps_its_default(rover: Bare) -> None:
    rover.robot.move(linear=0.2)
    rover.robot.move(angular=0.5)
    rover.robot.move()
    assert rover.calls == [twist(0.2), twist(z=0.5), twist()]


def test_a_mistake_in_a_name_is_answered_with_the_right_one(rover: Bare) -> None:
    with pytest.raises(MemberError, match=r"`msg` has no `linaer`; it has .* Did you mean `linear`\?"):
        rover.robot.move(lambda msg: msg.linaer)
    with pytest.raises(MemberError, match=r"Did you mean `linear`\?"):
        rover.robot.move(liner=0.2)
    with pytest.raises(MemberError, match=r"Did you mean `linear_x`\?"):
        rover.robot.move(linearx=0.2)
    with pytest.raises(MemberError, match=r"`msg\.linear` has no `w`; it has `x`, `y`, `z`"):
        rover.robot.move(lambda msg: msg.linear(w=1))
    with pytest.raises(MemberError, match=r"`msg\.angular` has no `zz`"):
        rover.robot.move(lambda msg: setattr(msg.angular, "zz", 1))
    with pytest.raises(MemberError, match="`msg` has no `linear_w`"):
        rover.robot.move(linear_w=1)
    assert rover.calls == []


@pytest.mark.parametrize("value", ["fast", None, True, [1], 1j, math.nan, math.inf, -math.inf])
def test_only_finite_numbers_are_numbers(rover: Bare, value: object) -> None:
    with pytest.raises(BridgeError, match=r"`linear` must be a (finite )?number"):
        rover.robot.move(linear=value)
    with pytest.raises(BridgeError, match=r"`msg\.angular\.z` must be"):
        rover.robot.move(lambda msg: setattr(msg.angular, "z", value))
    assert rover.calls == []


@pytest.mark.parametrize("value", [1, 1.0, Fraction(1), numpy.float32(1), numpy.int64(1), numpy.float64(1)])
def test_every_real_number_is_converted_to_a_float(rover: Bare, value: object) -> None:
    rover.robot.move(linear=value)
    assert rover.calls == [twist(1.0)]
    assert type(rover.calls[0]["linear"]["x"]) is float


def test_a_bare_number_or_two_arguments_are_refused_with_an_example(rover: Bare) -> None:
    with pytest.raises(BridgeError, match=r"does not accept 0\.2. Call it like `robot\.move\(linear=0\.2\)`"):
        rover.robot.move(0.2)
    with pytest.raises(BridgeError, match="takes one block or message, or keyword arguments"):
        rover.robot.move(0.2, 0.5)
    with pytest.raises(BridgeError, match="takes one block or message, or keyword arguments"):
        rover.robot.move(lambda msg: None, linear=1)
    with pytest.raises(BridgeError, match="does not accept"):
        rover.robot.move(Vector3(x=1))


@pytest.mark.parametrize(
    ("fields", "call"),
    [
        ({"count": Plain("int", 0, real_number)}, "count=1"),
        ({"header": Vector3, "pose": Vector3}, "pose_x=0.2"),
        ({"name": Plain("str", "", real_number)}, "name='text'"),
        ({}, ""),
    ],
)
def test_the_example_of_a_call_has_a_field_of_its_message(
    rover: Bare, fields: dict[str, object], call: str
) -> None:
    rover.add_method("do", rover.calls.append, "do it", message=type("Any", (Message,), {"FIELDS": fields}))
    with pytest.raises(BridgeError, match=re.escape(f"Call it like `robot.do({call})`.")):
        rover.robot.do("this")
    some = ", ".join(f"`{name}`" for name in fields) or "no fields"
    with pytest.raises(MemberError, match=f"has no `thing`; it has {some}"):
        rover.robot.do(thing=1)


def test_an_error_of_the_block_is_its_own(rover: Bare) -> None:
    with pytest.raises(ZeroDivisionError):
        rover.robot.move(lambda msg: msg.linear(x=1 / 0))


def test_a_nested_message_is_copied_never_shared() -> None:
    speed = Vector3(x=1)
    message = Twist(linear=speed)
    speed.x = 2
    assert message.linear.x == 1
    again = copy.deepcopy(message)
    again.linear.x = 5
    assert message.linear.x == 1
    assert copy.copy(message) == message != again


def test_messages_compare_by_value_and_show_themselves() -> None:
    assert Vector3(x=1) == Vector3(x=1.0) != Vector3(y=1)
    assert Vector3() != Twist()
    assert repr(Vector3(x=1)) == "Vector3(x=1.0, y=0.0, z=0.0)"
    assert dir(Twist()) == ["angular", "linear"]
    with pytest.raises(TypeError):
        hash(Twist())


def _text(value: object, what: str) -> str:
    if not isinstance(value, str):
        raise BridgeError(f"`{what}` must be a string.")
    return value


class Label(Message):
    """A message that is not all numbers, without short forms."""

    FIELDS = {"text": Plain("string", "", _text), "size": NUMBER, "place": Vector3}  # noqa: RUF012


class Pose(Message):
    """A message whose numbers are two parts deep."""

    FIELDS = {"target": Label}  # noqa: RUF012


def test_what_is_set_deep_inside_is_copied() -> None:
    pose = Pose()
    pose.target.place.x = 1
    pose.target.place(y=2)
    assert copy.copy(pose) == pose == Pose(target_place_x=1, target_place_y=2) != Pose()


def test_a_field_may_be_of_any_kind() -> None:
    label = Label(text="home", size=2)
    assert label.as_dict() == {"text": "home", "size": 2.0, "place": {"x": 0.0, "y": 0.0, "z": 0.0}}
    with pytest.raises(BridgeError, match=r"`msg\.text` must be a string"):
        label.text = 3
    assert list(Label.paths()) == ["text", "size", "place.x", "place.y", "place.z"]


def test_a_nested_message_without_a_short_form_is_not_replaced_by_a_number() -> None:
    with pytest.raises(BridgeError, match=r"`msg\.place` has fields of its own. Set these: `msg\.place\.x`"):
        Label(place=3)


def test_fields_are_described_for_completion() -> None:
    linear, angular = Twist.describe("move")
    assert (linear.name, linear.type) == ("move.linear", "Vector3")
    assert [(field.name, field.type) for field in angular.fields][2] == ("move.angular.z", "float")


@given(finite, finite)
def test_all_ways_of_filling_agree(x: float, z: float) -> None:
    by_block = Twist()
    by_block.linear(x=x)
    by_block.angular(z=z)
    by_path = Twist()
    by_path.set("linear.x", x)
    by_path.set("angular", z)
    assert by_block == by_path == Twist(linear=x, angular=z) == Twist(linear_x=x, angular_z=z)
    assert (by_path.get("linear"), by_path.get("angular.z")) == (x, z)


def test_the_robot_of_a_fork_fills_messages_of_its_own() -> None:
    robot = SimBridge("walls")
    robot.open()
    fork = RecordedBridge(robot.nodes.members())
    fork.open()
    with robot.robot.move as ours:
        theirs = fork.robot.move.__enter__()
        ours.linear(x=0.1)
        theirs.linear(x=0.2)
    assert robot.safety.commands[-1].arguments["linear"]["x"] == 0.1
