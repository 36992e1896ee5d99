"""The bytes of direct commands: against the documentation, the emulated brick, and ev3-dc's encoder."""

from __future__ import annotations

import math
import struct
import threading
from types import ModuleType
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lrp_jupyter.bridges.ev3 import protocol
from lrp_jupyter.errors import BridgeError

INT32 = st.integers(-(2**31) + 1, 2**31 - 1)


def test_motor_a_at_speed_50_for_a_slice_is_the_frame_of_the_documentation():
    assert protocol.frame(42, protocol.run_milliseconds(1, 50, 600, brake=False)).hex(" ") == (
        "13 00 2a 00 80 00 00 af 00 01 81 32 00 82 58 02 00 00 a6 00 01"
    )


def test_unregulated_power_for_a_slice_differs_in_the_operation_only():
    power = protocol.run_milliseconds(1, 50, 600, brake=False, regulated=False)
    assert power == b"\xad" + protocol.run_milliseconds(1, 50, 600, brake=False)[1:]


@pytest.mark.parametrize(
    ("value", "encoded"),
    [
        (0, "00"),
        (31, "1f"),
        (-1, "3f"),
        (-32, "20"),
        (32, "81 20"),
        (-33, "81 df"),
        (127, "81 7f"),
        (-127, "81 81"),
        (128, "82 80 00"),
        (-128, "82 80 ff"),
        (-32767, "82 01 80"),
        (-32768, "83 00 80 ff ff"),
        (2**31 - 1, "83 ff ff ff 7f"),
    ],
)
def test_a_constant_has_the_shortest_form_that_is_not_the_bricks_nan(value, encoded):
    assert protocol.constant(value).hex(" ") == encoded


@pytest.mark.parametrize("value", [2**31, -(2**31)])
def test_a_constant_that_does_not_fit_is_refused(value):
    with pytest.raises(BridgeError, match="too large"):
        protocol.constant(value)


@given(value=INT32)
def test_a_constant_is_read_as_itself_by_the_emulated_brick(emulation, value):
    decode = emulation.decode_parameter
    assert decode(protocol.constant(value), 0) == ("constant", value, len(protocol.constant(value)))


@given(offset=st.integers(0, 1000))
def test_a_place_in_the_reply_is_read_as_itself_by_the_emulated_brick(emulation, offset):
    encoded = protocol.variable(offset)
    assert emulation.decode_parameter(encoded, 0) == ("global", offset, len(encoded))


@pytest.fixture(scope="module")
def ev3_dc_functions() -> ModuleType:
    return pytest.importorskip("ev3_dc.functions")  # type: ignore[no-any-return]


@given(value=INT32)
def test_a_constant_equals_that_of_ev3_dc(ev3_dc_functions, value):
    assert protocol.constant(value) == ev3_dc_functions.LCX(value)


@given(offset=st.integers(0, 127))
def test_a_place_in_the_reply_equals_that_of_ev3_dc(ev3_dc_functions, offset):
    assert protocol.variable(offset) == ev3_dc_functions.GVX(offset)


REPLIES = st.lists(
    st.builds(protocol.BrickReply, st.integers(0, 0xFFFF), st.booleans(), st.binary(max_size=60)), max_size=5
)


def written(reply: protocol.BrickReply) -> bytes:
    kind = 2 if reply.ok else 4
    return struct.pack("<HHB", 3 + len(reply.data), reply.counter, kind) + reply.data


@given(REPLIES, st.lists(st.integers(1, 9), min_size=1))
def test_replies_are_the_same_however_the_network_cuts_them(replies, cuts):
    stream, rest, found = b"".join(map(written, replies)), b"", []
    for turn in range(len(stream)):
        size = cuts[turn % len(cuts)]
        part, stream = stream[:size], stream[size:]
        some, rest = protocol.split_replies(rest + part)
        found += some
    assert (found, rest) == (replies, b"")


def test_half_a_reply_is_kept_for_later():
    data = written(protocol.BrickReply(7, True, b"abcd"))
    assert protocol.split_replies(data[:6]) == ([], data[:6])


@pytest.mark.parametrize(
    "noise", [b"\xff\xff\x01\x00\x02", b"\x00\x00\x01\x00\x02", b"\x03\x00\x01\x00\x03", b"HTTP/1.1 400"]
)
def test_noise_is_not_a_reply(noise):
    with pytest.raises(BridgeError, match="The brick sent a frame"):
        protocol.split_replies(noise)


@given(st.binary(max_size=80))
def test_whatever_arrives_is_either_read_or_refused(data):
    try:
        replies, rest = protocol.split_replies(data)
    except BridgeError:
        return
    assert b"".join(map(written, replies)) + rest == data


def test_one_frame_reads_everything_that_the_brick_knows(brick, emulation):
    brick.motors[2].setting = 30
    brick.motors[2].start()
    brick.motors[2].clock.now += 2
    brick.sensors[1].mode = 1
    code, size = protocol.read_everything()
    reading = protocol.parse_reading(emulation.run_code(brick, code, size))
    assert reading.motors[2] == protocol.MotorReading(600, 30, 7)
    assert reading.sensors[1] == protocol.SensorReading(7.0, 29, 1)
    assert reading.sensors[3].type == 126
    assert math.isnan(reading.sensors[3].value)
    assert reading.battery == 87


def test_one_frame_also_sets_the_modes_that_are_wanted(brick, emulation):
    code, size = protocol.read_everything((-1, 2, -1, -1))
    assert protocol.parse_reading(emulation.run_code(brick, code, size)).sensors[1] == (5.0, 29, 2)


def test_the_frame_that_reads_everything_fits_the_bricks_buffer():
    code, size = protocol.read_everything((7, 7, 7, 7))
    assert len(protocol.frame(1, code, size)) <= 1024
    assert size <= 1019


def test_a_reading_of_another_size_is_refused():
    with pytest.raises(BridgeError, match="3 bytes instead of"):
        protocol.parse_reading(b"abc")


class Tape:
    """A socket that keeps what is sent."""

    def __init__(self) -> None:
        self.sent = b""

    def send(self, data: bytes) -> int:
        self.sent += data
        return len(data)


@pytest.fixture
def ev3_dc_motor() -> tuple[Any, Tape]:
    """A motor of ev3-dc at port B (no network): what it sends, byte for byte."""
    ev3_dc = pytest.importorskip("ev3_dc")
    from ev3_dc.ev3 import _PhysicalEV3

    brick, tape = object.__new__(_PhysicalEV3), Tape()
    brick._protocol, brick._socket, brick._msg_cnt, brick._host = ev3_dc.WIFI, tape, 41, "00:16:53"
    brick._lock, brick._reply_buffer = threading.Lock(), {}
    brick._introspection = {
        "sensors": {bytes([i]): {"type": 7, "used_by": None} for i in (0, 1, 2, 3, 16, 17, 18, 19)}
    }
    owner = object.__new__(ev3_dc.EV3)
    owner._physical_ev3, owner._conn_owner, owner._verbosity, owner._sync_mode = brick, False, 0, ev3_dc.STD
    motor = ev3_dc.Motor(ev3_dc.PORT_B, ev3_obj=owner)
    brick._msg_cnt, tape.sent = 41, b""
    return motor, tape


@pytest.mark.parametrize("brake", [True, False])
def test_stop_equals_that_of_ev3_dc(ev3_dc_motor, brake):
    motor, tape = ev3_dc_motor
    motor.stop(brake=brake)
    assert protocol.frame(42, protocol.stop(2, brake)) == tape.sent


@pytest.mark.parametrize("speed", [1, 31, 32, 100])
@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("seconds", [0.02, 0.5, 40, 100_000])
def test_run_for_seconds_equals_that_of_ev3_dc(ev3_dc_motor, speed, direction, seconds):
    motor, tape = ev3_dc_motor
    motor.start_move_for(
        seconds, speed=speed, direction=direction, ramp_up_time=0, ramp_down_time=0, brake=True
    )
    ours = protocol.run_milliseconds(2, direction * speed, round(seconds * 1000), True)
    assert protocol.frame(42, ours) == tape.sent


def test_reset_count_equals_that_of_ev3_dc(ev3_dc_motor):
    motor, tape = ev3_dc_motor
    motor.position = 0
    assert protocol.frame(42, protocol.clear_count(2)) == tape.sent


@pytest.mark.parametrize("ports", [1, 2, 4, 8, 15])
@pytest.mark.parametrize("percent", [0, 31, 32, -33, -100, 100])
def test_power_and_angle_equal_what_ev3_dcs_encoder_makes_of_the_operations(ev3_dc_motor, ports, percent):
    from ev3_dc import constants as op
    from ev3_dc.functions import LCX

    def operation(head: bytes, *values: int) -> bytes:
        return head + b"".join(map(LCX, values))

    motor, tape = ev3_dc_motor
    start = operation(op.opOutput_Start, 0, ports)
    commands = [
        (
            operation(op.opOutput_Time_Power, 0, ports, percent, 0, 600, 0, 0) + start,
            protocol.run_milliseconds(ports, percent, 600, False, regulated=False),
        ),
        (
            operation(op.opOutput_Step_Speed, 0, ports, percent, 0, 3600, 0, 0) + start,
            protocol.run_degrees(ports, percent, 3600, False),
        ),
    ]
    for number, (theirs, ours) in enumerate(commands):
        tape.sent = b""
        motor.send_direct_cmd(theirs)
        assert protocol.frame(42 + number, ours) == tape.sent


def test_a_question_equals_that_of_ev3_dc(ev3_dc_motor):
    from ev3_dc import constants as op
    from ev3_dc.functions import GVX, LCX

    motor, tape = ev3_dc_motor
    theirs = op.opCom_Get + op.GET_BRICKNAME + LCX(32) + GVX(0)
    motor.send_direct_cmd(theirs, global_mem=32, sync_mode="ASYNC")
    assert protocol.frame(42, *protocol.brick_name()) == tape.sent


def test_a_tone_equals_that_of_ev3_dc(ev3_dc_motor):
    from ev3_dc import constants as op
    from ev3_dc.functions import LCX

    motor, tape = ev3_dc_motor
    motor.send_direct_cmd(op.opSound + op.TONE + LCX(50) + LCX(440) + LCX(200))
    assert protocol.frame(42, protocol.beep(50, 440, 200)) == tape.sent
