import ast
import importlib.util
import struct
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lrp_jupyter.widgets.acts import messages
from lrp_jupyter.widgets.acts.messages import ACTS, QUESTIONS, PageMessage
from lrp_jupyter.widgets.connection import DecodeError, decode_message  # with all messages defined
from lrp_jupyter.widgets.views.world_state import pack_poses
from lrp_jupyter.widgets.wire import protocol

JS = Path(__file__).parents[2] / "js"
POINTS = [[0.5, 0.5], [1.0, 0.5]]
JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)


def generator():
    spec = importlib.util.spec_from_file_location("lrp_protocol_generator", JS / "protocol.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
def test_the_types_of_the_page_are_made_from_those_of_the_kernel():
    assert generator().generate().count("export interface") > 80


def test_every_message_is_explained():
    for module in (protocol, messages):
        for node in ast.parse(Path(module.__file__).read_text()).body:
            if isinstance(node, ast.ClassDef):
                assert ast.get_docstring(node), node.name
    for handler in (ACTS | QUESTIONS).values():
        assert handler.function.__doc__, handler.name


def test_a_message_is_decoded_with_its_types():
    message = decode_message({"type": "command", "view": "v", "id": 3, "do": "stroke", "points": POINTS})
    assert (message.id, message.handler.name) == (3, "stroke")
    assert message.given == {"points": [(0.5, 0.5), (1.0, 0.5)]}


def command(act, **fields):
    return {"type": "command", "view": "v", "id": 1, "do": act, **fields}


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (None, "A message must be an object."),
        ({}, "There is no message `None`."),
        ({"type": []}, "There is no message `[]`."),
        ({"type": "command"}, "There is no act `None`."),
        (command("dance"), "There is no act `dance`."),
        ({"type": "hello", "view": "v"}, "`hello` needs `part`."),
        ({"type": "hello", "view": 7, "part": "lab"}, "`view` of `hello` must be a string, not `7`."),
        (command("rate"), "`rate` needs `value`."),
        (command("rate", value="5"), "`value` of `rate` must be a number from 0 to 1000000, not `5`."),
        (
            command("rate", value=float("nan")),
            "`value` of `rate` must be a number from 0 to 1000000, not `nan`.",
        ),
        (command("rate", value=-1), "`value` of `rate` must be a number from 0 to 1000000, not `-1`."),
        (command("rate", value=True), "`value` of `rate` must be a number from 0 to 1000000, not `True`."),
        (
            command("step", value=10**9),
            "`value` of `step` must be a whole number from 1 to 10000, not `1000000000`.",
        ),
        (command("step", value=1.5), "`value` of `step` must be a whole number from 1 to 10000, not `1.5`."),
        (command("hold", on=1), "`on` of `hold` must be true or false, not `1`."),
        (
            command("on_active_edit", name="perhaps"),
            "`name` of `on_active_edit` must be `restart` or `keep`, not `perhaps`.",
        ),
        (
            command("on_active_edit", name=[]),
            "`name` of `on_active_edit` must be `restart` or `keep`, not `[]`.",
        ),
        (
            command("reset_pose", index=-1),
            "`index` of `reset_pose` must be a whole number from 0 to 10000, not `-1`.",
        ),
        (
            command("drag_robot", index=0, pose=[0, 1]),
            "`pose` of `drag_robot` must be a point, not `[0, 1]`.",
        ),
        (
            command("drag_robot", index=0, pose=[0, 1, float("inf")]),
            "An item in `pose` of `drag_robot` must be a number from -1000000 to 1000000, not `inf`.",
        ),
        (
            command("panel", key="a", values={"a": 1}),
            "An item in `values` of `panel` must be a string, not `1`.",
        ),
    ],
)
def test_a_message_of_the_wrong_form_is_refused_in_a_sentence(content, sentence):
    with pytest.raises(DecodeError) as refusal:
        decode_message(content)
    assert str(refusal.value) == sentence


@given(
    st.sampled_from(sorted({**PageMessage.types, **QUESTIONS})),
    st.sampled_from(sorted(ACTS)),
    st.dictionaries(
        st.sampled_from(
            sorted({name for act in ACTS.values() for name in act.fields} | {"view", "id", "seq", "into"})
        ),
        JSON,
    ),
)
def test_whatever_comes_from_a_page_is_a_message_or_refused(kind, act, fields):
    try:
        message = decode_message({**fields, "type": kind, "do": act})
    except DecodeError:
        return
    assert isinstance(message, PageMessage)


def test_the_poses_of_one_robot_are_36_bytes():
    robot = (0.5, 1.0, 0.25, True, True, False, 0.125, [128.0], [float("inf")])
    buffer = pack_poses(7.5, [robot])
    assert len(buffer) == 36
    assert struct.unpack("<d7f", buffer) == (7.5, 0.5, 1.0, 0.25, 3.0, 0.125, 128.0, float("inf"))


@pytest.mark.parametrize(
    ("bumper", "pen", "lamp", "flags"),
    [(True, False, False, 1), (False, True, False, 2), (False, False, True, 4)],
)
def test_bumper_pen_and_lamp_are_bits_of_their_own(bumper, pen, lamp, flags):
    buffer = pack_poses(0.0, [(0, 0, 0, bumper, pen, lamp, 0, [], [])])
    assert struct.unpack("<d5f", buffer)[4] == flags


def test_pushed_solids_follow_the_robots():
    buffer = pack_poses(0.0, [(0, 0, 0, False, False, False, 0, [], [])], [(1, 2, 0.5)])
    assert struct.unpack("<d8f", buffer)[-3:] == (1, 2, 0.5)
