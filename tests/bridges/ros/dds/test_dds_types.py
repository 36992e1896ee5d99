"""ROS 2's message types without ROS: their bytes, their hashes, and those of the user's own folders."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lrp_jupyter.bridges.ros.definitions import Definition, FieldType
from lrp_jupyter.errors import BridgeError

pytest.importorskip("cyclonedds", reason="the extra `ros2` is missing")
pytest.importorskip("rosbags", reason="the extra `ros2` is missing")

from rosbags.typesys import Stores, get_typestore

from lrp_jupyter.bridges.ros.dds_types import MessageTypes
from lrp_jupyter.bridges.ros.types import Types

TYPES = MessageTypes()
STORE = get_typestore(Stores.ROS2_JAZZY)
TRIED = (
    *("std_msgs/Bool", "std_msgs/String", "std_msgs/Empty", "std_msgs/ColorRGBA", "std_msgs/Int64MultiArray"),
    *("geometry_msgs/TwistStamped", "nav_msgs/Odometry", "sensor_msgs/LaserScan", "sensor_msgs/JointState"),
    *("sensor_msgs/CompressedImage", "tf2_msgs/TFMessage", "diagnostic_msgs/DiagnosticArray"),
)
INTEGERS = {
    **{f"uint{bits}": st.integers(0, 2**bits - 1) for bits in (8, 16, 32, 64)},
    **{f"int{bits}": st.integers(-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)},
    "byte": st.integers(0, 255),
}
ONES = {
    **INTEGERS,
    "bool": st.booleans(),
    "string": st.text(st.characters(exclude_characters="\0", exclude_categories=["Cs"]), max_size=6),
    "float32": st.floats(width=32, allow_nan=False, allow_infinity=False),
    "float64": st.floats(allow_nan=False, allow_infinity=False),
}


def values_of(type_: str) -> st.SearchStrategy[dict[str, Any]]:
    """Values for every field, as the bridge sends them."""
    definitions = TYPES.define(type_)

    def one(shape: FieldType) -> st.SearchStrategy[Any]:
        single = ONES[shape.base] if shape.base in ONES else values_of(shape.base)
        if shape.length < 0:
            return single
        sizes = (shape.length, shape.length) if shape.length else (0, 3)
        return st.lists(single, min_size=sizes[0], max_size=sizes[1])

    return st.fixed_dictionaries({name: one(shape) for name, shape in definitions[type_].fields.items()})


messages = st.sampled_from(TRIED).flatmap(lambda type_: st.tuples(st.just(type_), values_of(type_)))


@given(messages)
def test_what_is_sent_is_what_rosbags_writes_and_arrives_as_it_was(message: tuple[str, Any]) -> None:
    """Two programs of different people agree on every octet."""
    type_, values = message
    kind, full = TYPES.struct(type_), type_.replace("/", "/msg/")
    sent = TYPES.sample(type_, values).serialize()
    assert bytes(STORE.serialize_cdr(STORE.deserialize_cdr(sent, full), full)) == sent
    types = Types()
    types.add(TYPES.define(type_))
    arrived = types.form(type_).decode(kind.deserialize(sent))
    again = TYPES.sample(type_, arrived._as_dict()).serialize()
    assert again == sent


@pytest.mark.slow
def test_every_type_of_a_distribution_can_be_sent() -> None:
    for name in TYPES.names():
        TYPES.struct(name)
        full = name.replace("/", "/msg/")
        sent = TYPES.sample(name, {}).serialize()
        assert bytes(STORE.serialize_cdr(STORE.deserialize_cdr(sent, full), full)) == sent


@pytest.mark.parametrize(
    ("type_", "digest"),
    [  # as `ros2 topic info -v` of Jazzy shows them
        ("geometry_msgs/TwistStamped", "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64"),
        (
            "rmw_dds_common/ParticipantEntitiesInfo",
            "91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e",
        ),
    ],
)
def test_a_type_has_the_hash_that_ros_2_shows(type_: str, digest: str) -> None:
    assert TYPES.hash(type_) == f"RIHS01_{digest}"


def test_a_stamp_that_was_set_is_kept() -> None:
    TYPES.struct("geometry_msgs/TwistStamped")
    set_ = TYPES.sample("geometry_msgs/TwistStamped", {"header": {"stamp": {"sec": 5, "nanosec": 6}}})
    assert (set_.header.stamp.sec, set_.header.stamp.nanosec) == (5, 6)
    now = TYPES.sample("geometry_msgs/TwistStamped", {})
    assert abs(now.header.stamp.sec + now.header.stamp.nanosec * 1e-9 - time.time()) < 60


# -- the user's own -----------------------------------------------------------------------------------


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Path]:
    """Write definitions into a folder: ``{"my_msgs/Thing": text}``."""

    def write(texts: dict[str, str], folder: str = "src") -> Path:
        for type_, text in texts.items():
            package, name = type_.split("/")
            path = tmp_path / folder / package / "msg" / f"{name}.msg"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return tmp_path / folder

    return write


THING = """\
# what a workshop has
uint8 EMPTY=0
geometry_msgs/Point at  # metres
Part[] parts
float32[3] size
string<=10 name "box"
"""
PART = "float64 weight 1.0\nbool from\n"


def test_a_type_of_a_folder_is_known_with_those_that_it_needs(write: Callable[..., Path]) -> None:
    types = MessageTypes([write({"my_msgs/Thing": THING, "my_msgs/Part": PART})])
    found = types.define("my_msgs/Thing")
    assert found["my_msgs/Thing"] == Definition(
        "my_msgs/Thing",
        {
            "at": FieldType("geometry_msgs/Point"),
            "parts": FieldType("my_msgs/Part", 0),
            "size": FieldType("float32", 3),
            "name": FieldType("string"),
        },
    )
    assert list(found["my_msgs/Part"].fields) == ["weight", "from_"]  # `from` is a word of Python
    kind = types.struct("my_msgs/Thing")
    sent = types.sample("my_msgs/Thing", {"parts": [{"weight": 2.0}], "name": "crate"}).serialize()
    assert kind.deserialize(sent).parts[0].weight == 2.0
    assert types.hash("my_msgs/Thing").startswith("RIHS01_")


def test_the_users_folder_counts_more_than_an_installed_ros_and_that_more_than_what_is_brought(
    write: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    installed = write(
        {"std_msgs/Bool": "bool data\nbool sure\n", "my_msgs/Part": "bool old\n"}, "opt/share"
    ).parent
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(installed))
    types = MessageTypes([write({"my_msgs/Part": PART})])
    assert list(types.define("std_msgs/Bool")["std_msgs/Bool"].fields) == ["data", "sure"]
    assert list(types.define("my_msgs/Part")["my_msgs/Part"].fields) == ["weight", "from_"]


@pytest.mark.parametrize(
    ("text", "line", "sentence"),
    [
        ("float64 x\nfloat64\n", 2, r"`float64` is not a field\. Write its type and its name"),
        ("float64 x\n\n  2fast y\n", 3, r"`2fast y` is not a field"),
        ("flot64 x\n", 1, r"There is no message type `my_msgs/flot64`"),
        ("float64 x\ngeometry_msgs/Pont at # here\n", 2, r"Did you mean `geometry_msgs/Point`\?"),
        ("int8 a\nint8 b\nint16 a\n", 1, r"There are two fields `a`\. Rename one"),
        ("int8 a\nThing inside\n", 2, r"A `my_msgs/Thing` cannot contain a `my_msgs/Thing`"),
    ],
)
def test_a_mistake_in_a_definition_is_named_with_its_line(
    write: Callable[..., Path], text: str, line: int, sentence: str
) -> None:
    folder = write({"my_msgs/Thing": text})
    types = MessageTypes([folder])
    with pytest.raises(BridgeError, match=sentence) as refused:
        types.define("my_msgs/Thing")
    assert str(refused.value).startswith(f"{folder / 'my_msgs/msg/Thing.msg'}, line {line}: ")


def test_a_mistake_elsewhere_in_a_folder_does_not_matter(write: Callable[..., Path]) -> None:
    types = MessageTypes([write({"my_msgs/Part": PART, "my_msgs/Broken": "???"})])
    assert types.define("my_msgs/Part")


@pytest.mark.parametrize(
    ("folder", "sentence"),
    [("nowhere", r"`.*nowhere` is not a folder"), ("", r"has no message types\. They are files such as")],
)
def test_a_folder_without_definitions_is_refused(tmp_path: Path, folder: str, sentence: str) -> None:
    with pytest.raises(BridgeError, match=sentence):
        MessageTypes([tmp_path / folder])


def test_a_type_that_nobody_defines_is_not_defined() -> None:
    assert TYPES.define("my_msgs/Thing") == {}
    with pytest.raises(
        BridgeError, match=r"There is no message type `nav_msgs/Odometri`.*`nav_msgs/Odometry`"
    ):
        TYPES.struct("nav_msgs/Odometri")


def test_the_distribution_of_the_environment_is_the_one_that_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DISTRO", "humble")
    humble = MessageTypes().define("rmw_dds_common/Gid")["rmw_dds_common/Gid"].fields
    monkeypatch.setenv("ROS_DISTRO", "unheard of")
    assert humble["data"].length == 24
    assert MessageTypes().define("rmw_dds_common/Gid")["rmw_dds_common/Gid"].fields["data"].length == 16
