"""Definitions of message types from `.msg` files."""

from __future__ import annotations

import keyword
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lrp_jupyter.bridges.ros.definitions import FLOATS, INTEGERS, definitions_from_text
from lrp_jupyter.bridges.ros.types import Types
from lrp_jupyter.errors import BridgeError

LINE = "=" * 80


def shapes(type_: str, text: str) -> dict[str, str]:
    return {name: str(kind) for name, kind in definitions_from_text(type_, text)[type_].fields.items()}


def test_fields_are_read_and_everything_else_is_read_over() -> None:
    text = """
    # A comment, and a constant of either kind:
    int32 MOST=5
    string GREETING = "a # b"   # c
    uint8   level     # how loud
    float64[9] matrix
    string name "x = y"
    float32 dim 0.5
    int32[] few [1, 2]
    bool is_on true
    """
    assert shapes("my_msgs/Thing", text) == {
        "level": "uint8",
        "matrix": "float64[9]",
        "name": "string",
        "dim": "float32",
        "few": "int32[]",
        "is_on": "bool",
    }


def test_bounds_are_of_no_matter() -> None:
    text = "string<=10 short\nint8[<=3] few\nstring<=4[<=3] names\nwstring wide\nbyte[] octets\nchar letter"
    assert shapes("a/B", text) == {
        "short": "string",
        "few": "int8[]",
        "names": "string[]",
        "wide": "wstring",
        "octets": "byte[]",
        "letter": "char",
    }


def test_a_type_without_a_package_is_of_the_same_package() -> None:
    text = "Point p\nHeader header\ngeometry_msgs/Pose pose\nstd_msgs/msg/Bool[2] flags\ntime t"
    assert shapes("my_msgs/Thing", text) == {
        "p": "my_msgs/Point",
        "header": "std_msgs/Header",
        "pose": "geometry_msgs/Pose",
        "flags": "std_msgs/Bool[2]",
        "t": "time",
    }


def test_the_types_inside_follow_in_the_same_text() -> None:
    text = f"Part[] parts\n{LINE}\nMSG: my_msgs/Part\nfloat32 x\nother_msgs/Deep deep\n"
    text += f"{LINE}\nMSG: other_msgs/msg/Deep\nint8 z\n"
    types = Types()
    types.add(definitions_from_text("my_msgs/msg/Thing", text))
    assert types.knows("my_msgs/Thing")
    reading: Any = types.form("my_msgs/Thing").decode({"parts": [{"x": 1.0, "deep": {"z": 3}}]})
    assert reading.parts[0].deep.z == 3


@pytest.mark.parametrize(
    ("text", "line", "sentence"),
    [
        ("float64", 1, "Write `type name`"),
        ("\nint8 x\n= 3", 3, "Write `type name`"),
        ("int8 2x", 1, "Write `type name`"),
        ("int8[ x", 1, "cannot be understood"),
        ("int8 x-y", 1, "Write `type name`"),
        ("<html> nothing", 1, "cannot be understood"),
    ],
)
def test_what_cannot_be_read_is_named_with_its_line(text: str, line: int, sentence: str) -> None:
    with pytest.raises(BridgeError, match=f"`a/B`, line {line}: .* cannot be read.*{sentence}"):
        definitions_from_text("a/B", text)


names = (
    st.text("abcf_09", min_size=1, max_size=6)
    .map("i{}".format)
    .filter(lambda name: not keyword.iskeyword(name))
)
kinds = st.builds(
    "{}{}".format,
    st.sampled_from([*INTEGERS, *FLOATS, "string", "geometry_msgs/Point"]),
    st.sampled_from(["", "[]", "[3]"]),
)


@given(st.dictionaries(names, kinds), st.sampled_from(["", "  # why", " "]))
def test_whatever_is_written_is_read(fields: dict[str, str], end: str) -> None:
    text = "\n".join(f"{kind} {name}{end}" for name, kind in fields.items())
    assert shapes("a/B", text) == fields
