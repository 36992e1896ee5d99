"""ev3-dc's own classes drive the emulated brick: what checks our client is checked itself.

ev3-dc listens on UDP 3015 only, and to bricks with a port of four digits: this runs alone, and is
skipped where that port is taken. Its calls wait for ever where a reply is missing; none is here.
"""

from __future__ import annotations

import math
import random
import socket
import struct
from collections.abc import Callable, Iterator
from types import ModuleType
from typing import Any

import pytest
from support.waiting import until

from lrp_jupyter.bridges.ev3 import protocol


@pytest.fixture(scope="module")
def ev3_dc() -> ModuleType:
    return pytest.importorskip("ev3_dc")  # type: ignore[no-any-return]


@pytest.fixture
def brick(make_brick: Callable[..., Any], clock: Any, ev3_dc: ModuleType) -> Any:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("", 3015))
        except OSError:
            pytest.skip("UDP port 3015 is taken by another program")
    for port in random.sample(range(5000, 9999), 50):
        with socket.socket() as tcp, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
            try:
                tcp.bind(("127.0.0.1", port))
                udp.bind(("127.0.0.1", port))
            except OSError:
                continue
        brick = make_brick(3015, clock, for_ev3_dc=True, tcp_port=port)
        brick.sensors[0].type, brick.sensors[0].values = 16, {0: 1.0, 1: 3.0}
        brick.sensors[1].type, brick.sensors[1].values = 29, {0: 42.0, 1: 7.0, 2: 5.0}
        brick.sensors[2].type, brick.sensors[2].values = 32, {0: -90.0, 3: 15.0}
        return brick
    pytest.skip("no port of four digits is free")


@pytest.fixture
def theirs(ev3_dc: ModuleType, brick: Any) -> Iterator[Any]:
    """ev3-dc, connected to the emulated brick by its beacon."""
    device = ev3_dc.EV3(protocol=ev3_dc.WIFI)
    yield device
    device._physical_ev3._socket.close()
    ev3_dc.ev3._PhysicalEV3._devices.clear()


def wait_for_commands(theirs: Any) -> None:
    """Wait for an answer, which comes after every command before it has been executed."""
    assert theirs.battery.percentage == 87


def test_it_answers_the_beacon_as_we_do(theirs, brick):
    until(lambda: brick.answers == 1)


def test_it_connects_and_reads_the_bricks_own_data(theirs, brick):
    assert theirs.host == "00:16:53:5A:1B:2C"
    assert theirs.name == brick.name
    assert theirs.battery == (7.5, pytest.approx(0.2), 87)
    assert theirs.sensors == (16, 29, 32, None, 7, 7, 7, 7)
    assert theirs.memory == (6000, 1000)
    assert (theirs.volume, theirs.sleep, theirs.network.name) == (50, 30, "school")


def test_its_sensors_read_the_emulated_ones(ev3_dc, theirs):
    touch = ev3_dc.Touch(ev3_dc.PORT_1, ev3_obj=theirs)
    assert (touch.touched, touch.bumps) == (True, 3)
    colour = ev3_dc.Color(ev3_dc.PORT_2, ev3_obj=theirs)
    assert (colour.reflected, colour.ambient, colour.color) == (42, 7, 5)


def test_its_motor_turns_the_emulated_one(ev3_dc, theirs, brick, clock):
    motor = ev3_dc.Motor(ev3_dc.PORT_C, ev3_obj=theirs, speed=50)
    assert (motor.position, motor.busy) == (0, False)
    motor.start_move_for(2.0, direction=-1, ramp_up_time=0, ramp_down_time=0)
    assert motor.busy
    clock.now += 1
    assert motor.position == -500
    clock.now += 5
    assert (motor.position, motor.busy) == (-1000, False)
    motor.position = 0
    assert motor.position == 0
    motor.start_move_by(360, speed=100, ramp_up=0, ramp_down=0)
    motor._target_position = None
    clock.now += 5
    assert motor.position == 360
    motor.start_move_for(600.0)
    assert motor.busy
    clock.now += 1
    motor.stop(brake=True)
    stopped = motor.position
    clock.now += 1
    assert motor.position == stopped > 360
    assert brick.motors[2].braked


def test_its_answer_to_our_question_for_everything_is_what_it_reads_itself(ev3_dc, theirs, clock):
    motor = ev3_dc.Motor(ev3_dc.PORT_B, ev3_obj=theirs)
    motor.start_move_for(60.0, speed=20, ramp_up_time=0, ramp_down_time=0)
    wait_for_commands(theirs)
    clock.now += 3
    code, size = protocol.read_everything()
    reading = protocol.parse_reading(theirs.send_direct_cmd(code, global_mem=size))
    assert reading.motors[1] == (motor.position, 20, motor.motor_type)
    assert [sensor.type for sensor in reading.sensors] == [16, 29, 32, 126]
    assert reading.sensors[1].value == 42
    assert reading.sensors[2].value == -90
    assert math.isnan(reading.sensors[3].value)
    assert reading.battery == theirs.battery.percentage


@pytest.mark.parametrize(
    ("code", "turning"),
    [
        (protocol.run_milliseconds(0b1001, 40, 600, False), [40, 0, 0, 40]),
        (protocol.run_milliseconds(0b0110, -100, 600, False, regulated=False), [0, -100, -100, 0]),
        (protocol.run_degrees(0b0001, -30, 90, True), [-30, 0, 0, 0]),
        (protocol.run_milliseconds(0b1000, 99, 1, False), [0, 0, 0, 99]),
        (protocol.run_milliseconds(15, 40, 600, False) + protocol.stop(0b0011, True), [0, 0, 40, 40]),
    ],
)
def test_our_commands_through_its_connection_move_the_motors(theirs, brick, code, turning):
    theirs.send_direct_cmd(code)
    wait_for_commands(theirs)
    assert [motor.turning for motor in brick.motors] == turning


def test_the_emulated_brick_refuses_what_a_brick_would_not_understand(ev3_dc, theirs, brick):
    for code in (b"\xff", b"\xa5\x00\x01", b"\xa5\x00\x01\x81\x80", b"\xa5\x01\x01\x05", b"\xa6\x00\x00"):
        with pytest.raises(ev3_dc.exceptions.DirCmdError):
            theirs.send_direct_cmd(code, sync_mode=ev3_dc.SYNC)
    assert len(brick.violations) == 5
    brick.violations.clear()


def test_a_refusal_is_a_frame_that_it_reads_as_one(ev3_dc, theirs, brick):
    brick.fault = "refuse"
    with pytest.raises(ev3_dc.exceptions.DirCmdError):
        theirs.send_direct_cmd(protocol.stop(15, True), sync_mode=ev3_dc.SYNC)
    brick.fault = ""
    wait_for_commands(theirs)
    assert brick.frames[-2][:2] == struct.pack("<H", 9)
