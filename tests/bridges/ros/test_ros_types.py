"""ROS message types: what a program fills, what it gets, and what either refuses."""

from __future__ import annotations

import base64
import copy
import json
import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lrp_jupyter.bridges.members import Member, MemberError, describe_value
from lrp_jupyter.bridges.ros.definitions import (
    FLOATS,
    INTEGERS,
    KNOWN,
    Definition,
    FieldType,
    canonical,
    from_rosapi,
    parse_field,
)
from lrp_jupyter.bridges.ros.panel import gist
from lrp_jupyter.bridges.ros.types import Types
from lrp_jupyter.errors import BridgeError


@pytest.fixture
def types() -> Types:
    types = Types()
    types.add(
        {
            "test_msgs/Part": Definition("test_msgs/Part", {"name": FieldType("string")}),
            "test_msgs/All": Definition(
                "test_msgs/All",
                {
                    **{f"a_{name}": FieldType(name) for name in (*INTEGERS, *FLOATS, "bool", "string")},
                    "three_floats": FieldType("float64", 3),
                    "numbers": FieldType("int16", 0),
                    "octets": FieldType("uint8", 0),
                    "part": FieldType("test_msgs/Part"),
                    "parts": FieldType("test_msgs/Part", 0),
                    "stamp": FieldType("time"),
                },
            ),
        }
    )
    return types


@pytest.mark.parametrize(
    ("text", "length", "expected"),
    [
        ("float64", -1, "float64"),
        ("float64[36]", -1, "float64[36]"),
        ("geometry_msgs/Point[]", -1, "geometry_msgs/Point[]"),
        ("geometry_msgs/msg/Point", 0, "geometry_msgs/Point[]"),
        ("sequence<double>", -1, "float64[]"),
        ("sequence<double, 10>", -1, "float64[]"),
        ("double, 10", 0, "float64[]"),
        ("string<10>", -1, "string"),
        ("boolean", -1, "bool"),
        ("octet", 4, "byte[4]"),
        ("uint8[<=10]", -1, "uint8[]"),
    ],
)
def test_the_types_of_fields_are_read_in_both_dialects(text: str, length: int, expected: str) -> None:
    assert str(parse_field(text, length)) == expected


def test_both_spellings_name_the_same_type() -> None:
    assert canonical("geometry_msgs/msg/Twist") == canonical(" geometry_msgs/Twist ") == "geometry_msgs/Twist"


def test_rosapi_of_ros_2_shows_its_slots() -> None:
    typedef = {
        "type": "test/msg/T",
        "fieldnames": ["_x", "_data"],
        "fieldtypes": ["double", "octet"],
        "fieldarraylen": [-1, 0],
    }
    fields = from_rosapi([typedef])["test/T"].fields
    assert {name: str(kind) for name, kind in fields.items()} == {"x": "float64", "data": "byte[]"}


@pytest.mark.parametrize("answer", [[{}], [{"type": "t", "fieldnames": [1, 2], "fieldtypes": []}], [7]])
def test_what_is_not_a_description_of_a_type_is_refused(answer: Any) -> None:
    with pytest.raises(BridgeError, match="cannot be understood"):
        from_rosapi(answer)


def test_a_twist_accepts_the_keywords_of_the_simulator(types: Types) -> None:
    twist = types.message("geometry_msgs/Twist")
    for message in (twist(linear=0.2, angular=1), twist(linear_x=0.2, angular_z=1.0)):
        assert message.linear.x == 0.2
        assert message.angular.z == 1.0
    stamped = types.message("geometry_msgs/TwistStamped")(linear=0.2)
    assert stamped.twist.linear.x == 0.2


def test_fields_that_are_not_set_keep_their_defaults(types: Types) -> None:
    message = types.message("test_msgs/All")(a_int8=5)
    assert message.as_dict() == {
        **types.message("test_msgs/All")().as_dict(),
        "a_int8": 5,
    }
    assert message.three_floats == (0.0, 0.0, 0.0)


def test_long_names_reach_fields_with_underscores_of_their_own(types: Types) -> None:
    message = types.message("sensor_msgs/Imu")(angular_velocity_z=2.0, header_frame_id="base")
    assert message.angular_velocity.z == 2.0
    assert message.header.frame_id == "base"


@pytest.mark.parametrize(
    ("field", "value", "sentence"),
    [
        ("a_int8", 128, "goes from -128 to 127, not 128"),
        ("a_uint8", -1, "goes from 0 to 255"),
        ("a_int32", 1.5, "whole number"),
        ("a_int32", True, "whole number"),
        ("a_float32", 1e39, "too large"),
        ("a_float64", "1", "must be a number"),
        ("a_float64", math.inf, "finite"),
        ("a_bool", 1, "True or False"),
        ("a_string", 3, "must be a string"),
        ("three_floats", [1, 2], "has 3 elements, not 2"),
        ("numbers", "12", "must be a list"),
        ("numbers", [1, "x"], r"numbers\[1\]"),
        ("part", 1, "has fields of its own"),
        ("parts", [1], r"parts\[0\]"),
        ("parts", [{"nmae": "x"}], "Did you mean `name`"),
        ("a_int9", 1, "has no `a_int9`"),
    ],
)
def test_what_does_not_fit_is_refused_in_a_sentence(
    types: Types, field: str, value: object, sentence: str
) -> None:
    with pytest.raises(BridgeError, match=sentence):
        types.message("test_msgs/All")(**{field: value})


def test_an_unknown_type_has_a_suggestion(types: Types) -> None:
    with pytest.raises(BridgeError, match="Did you mean `geometry_msgs/Twist`"):
        types.message("geometry_msgs/Twit")


def integers(name: str) -> st.SearchStrategy[int]:
    return st.integers(*INTEGERS[name])


every_field = st.fixed_dictionaries(
    {},
    optional={
        **{f"a_{name}": integers(name) for name in INTEGERS},
        "a_float32": st.floats(width=32, allow_nan=False, allow_infinity=False),
        "a_float64": st.floats(allow_nan=False, allow_infinity=False),
        "a_bool": st.booleans(),
        "a_string": st.text(),
        "three_floats": st.tuples(*[st.floats(-1e9, 1e9)] * 3),
        "numbers": st.lists(integers("int16")).map(tuple),
        "part": st.fixed_dictionaries({"name": st.text()}),
        "parts": st.lists(st.fixed_dictionaries({"name": st.text()})),
    },
)


@pytest.mark.slow
@given(every_field)
def test_what_was_filled_arrives_as_it_was_filled(values: dict[str, Any]) -> None:
    types = Types()
    part = Definition("test_msgs/Part", {"name": FieldType("string")})
    fields = {f"a_{name}": FieldType(name) for name in (*INTEGERS, *FLOATS, "bool", "string")}
    fields |= {"three_floats": FieldType("float64", 3), "numbers": FieldType("int16", 0)}
    fields |= {"part": FieldType("test_msgs/Part"), "parts": FieldType("test_msgs/Part", 0)}
    types.add({"test_msgs/Part": part, "test_msgs/All": Definition("test_msgs/All", fields)})
    sent = types.message("test_msgs/All")(**values)
    came = types.form("test_msgs/All").decode(json.loads(json.dumps(sent.as_dict())))
    assert types.message("test_msgs/All")(**came._as_dict()).as_dict() == sent.as_dict()
    for name, value in values.items():
        if not name.startswith("part"):
            assert getattr(came, name) == value


# -- readings -------------------------------------------------------------------------------------


def odometry(theta: float) -> dict[str, Any]:
    turn = {"z": math.sin(theta / 2), "w": math.cos(theta / 2)}
    return {"pose": {"pose": {"position": {"x": 1.0, "y": 2.0}, "orientation": turn}}}


@given(st.floats(-3.14, 3.14))
def test_an_odometry_has_a_heading(theta: float) -> None:
    reading: Any = Types().form("nav_msgs/Odometry").decode(odometry(theta))
    assert (reading.x, reading.y) == (1.0, 2.0)
    assert reading.theta == pytest.approx(theta, abs=1e-9)


def test_a_reading_does_not_change_and_is_its_own_copy() -> None:
    reading: Any = Types().form("nav_msgs/Odometry").decode(odometry(0.0))
    with pytest.raises(MemberError, match="cannot be assigned"):
        reading.x = 3
    assert copy.deepcopy(reading) is reading
    with pytest.raises(MemberError, match="Did you mean `pose`"):
        _ = reading.pos


def test_octets_come_as_base64_over_rosbridge(types: Types) -> None:
    reading: Any = types.form("test_msgs/All").decode({"octets": base64.b64encode(b"\x00\xff").decode()})
    assert reading.octets == b"\x00\xff"


@pytest.mark.parametrize(
    ("type_", "raw"),
    [
        ("std_msgs/String", {"data": 3}),
        ("std_msgs/Int32", {"data": "3"}),
        ("std_msgs/Int32", {"data": 1.5}),
        ("std_msgs/Bool", {"data": "true"}),
        ("std_msgs/Float64", {"data": "fast"}),
        ("std_msgs/Float64", {"value": 1.0}),
        ("std_msgs/Float64", 1.0),
        ("std_msgs/Float64", None),
        ("nav_msgs/Odometry", {"pose": {"pose": 1}}),
    ],
)
def test_a_message_of_another_type_is_not_a_reading(type_: str, raw: object) -> None:
    with pytest.raises((ValueError, TypeError, AttributeError)):
        Types().form(type_).decode(raw)


def test_the_fields_of_a_type_are_known_before_the_first_message() -> None:
    kind = Types().form("nav_msgs/Odometry").kind
    member = describe_value(Member("odom", "variable", "Odometry"), kind)
    names = {field.name: field.type for field in member.fields}
    assert names["odom.x"] == "float"
    assert names["odom.pose"] == "PoseWithCovariance"
    inner = next(field for field in member.fields if field.name == "odom.pose").fields
    assert "odom.pose.pose" in [field.name for field in inner]


def test_every_type_known_from_the_start_is_complete() -> None:
    types = Types()
    for name in KNOWN:
        assert types.knows(name), name
        types.form(name).decode(types.message(name)().as_dict())


@pytest.mark.parametrize(
    ("type_", "fields", "line"),
    [
        ("std_msgs/UInt8", {"data": 7}, "7"),
        ("std_msgs/String", {"data": "hello"}, "'hello'"),
        (
            "geometry_msgs/Twist",
            {"linear": {"x": 0.25}, "angular": {"z": -1.0}},
            "linear.x=0.25, angular.z=-1",
        ),
        (
            "nav_msgs/Odometry",
            {"pose": {"pose": {"position": {"x": 1.25, "y": 2.0}}}},
            "x=1.25, y=2, theta=0",
        ),
    ],
)
def test_a_message_is_summarised_in_a_line(type_: str, fields: dict[str, Any], line: str) -> None:
    assert gist(Types().form(type_).decode(fields)) == line


def test_a_message_to_send_is_summarised_by_its_set_fields() -> None:
    twist = Types().message("geometry_msgs/Twist")
    assert gist(twist(linear=0.2)) == "linear.x=0.2"
    assert gist(twist()).startswith("linear.x=0, linear.y=0")


def test_an_orientation_that_is_not_set_is_no_rotation(types: Types) -> None:
    pose = types.message("geometry_msgs/PoseStamped")(pose_position_x=2.0)
    assert pose.as_dict()["pose"]["orientation"] == {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
