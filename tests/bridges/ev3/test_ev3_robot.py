"""The brick as a robot: `move`, `light`, `bumper`, `distance`, `odom`, as of the simulated one."""

from __future__ import annotations

import math
from typing import Any

import pytest

from lrp_jupyter.bridges.discovery import make_bridge
from lrp_jupyter.bridges.ev3 import EV3Bridge
from lrp_jupyter.bridges.ev3.vehicle import Vehicle
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.errors import BridgeError, NoDataYet

FORWARD = [0, 41, 41, 0]  # 0.2 m/s, with wheels of 56 mm


@pytest.fixture
def brick(brick: Any) -> Any:
    """A brick with its sensors where the bridge expects them."""
    brick.sensors[0].type, brick.sensors[0].values = 16, {0: 0.0, 1: 3.0}
    brick.sensors[1].type = 126
    brick.sensors[2].type, brick.sensors[2].values = 29, {0: 42.0, 1: 7.0, 2: 5.0}
    brick.sensors[3].type, brick.sensors[3].values = 30, {0: 25.5, 1: 10.0}
    return brick


def turning(brick: Any) -> list[float]:
    return [motor.turning for motor in brick.motors]


# -- driving ------------------------------------------------------------------------------------------


def drive_in_a_block(robot: Any) -> None:
    with robot.move as msg:
        msg.linear.x = 0.2


@pytest.mark.parametrize(
    "drive",
    [
        lambda robot: robot.move(linear=0.2),
        lambda robot: robot.move(linear_x=0.2, angular_z=0),
        lambda robot: robot.move(lambda msg: msg.linear(x=0.2)),
        drive_in_a_block,
    ],
)
def test_every_form_of_move_drives_the_wheels(bridge, brick, fresh, drive):
    drive(bridge.robot)
    fresh()
    assert turning(brick) == FORWARD


def test_it_has_the_members_of_the_simulated_robot_with_their_units_and_types(bridge):
    simulated = SimBridge("line")
    simulated.open()
    bridge.refresh()
    names = ["light.data", "bumper.data", "odom.x", "odom.y", "odom.theta", "move", "stop"]
    for name in names:
        theirs, ours = simulated.describe(name), bridge.describe(name)
        assert (ours.type, ours.unit, ours.signature) == (theirs.type, theirs.unit, theirs.signature)
    simulated.close()


@pytest.mark.parametrize("drive", [{"linear_y": 0.2}, {"linear_z": 1}, {"angular_x": 1}, {"angular_y": 1}])
def test_what_two_wheels_cannot_do_is_refused(bridge, brick, drive):
    with pytest.raises(BridgeError, match="has two wheels"):
        bridge.robot.move(**drive)
    assert brick.commands == []


def test_a_speed_beyond_the_motors_is_limited_and_that_is_shown(bridge, brick, fresh):
    bridge.robot.move(linear=3)
    fresh()
    assert turning(brick) == [0, 100, 100, 0]
    assert "`move`: linear 3 limited to 0.492." in [notice.text for notice in bridge.safety.notices]


def test_a_curve_beyond_the_motors_is_slowed_down_and_that_is_shown_once(bridge, brick, fresh):
    for _ in range(3):
        bridge.robot.move(linear=0.4, angular=4)
    fresh()
    assert turning(brick) == [0, 25, 100, 0]
    notices = [notice for notice in bridge.safety.notices if notice.kind == "limited"]
    assert [(notice.text, notice.count) for notice in notices] == [
        ("`move`: The outer wheel would be too fast: both speeds were divided by 1.3.", 3)
    ]


def test_a_wheel_without_a_motor_is_reported(bridge, brick, fresh):
    brick.motors[2].type = 126
    fresh()
    with pytest.raises(BridgeError, match="`motorC`: Nothing is plugged into port C"):
        bridge.robot.move(linear=0.2)


def test_a_robot_that_gets_no_more_moves_is_stopped_with_a_reason(bridge, brick, fresh):
    bridge.begin_tick(0.0, 0.1)
    bridge.robot.move(linear=0.2)
    bridge.end_tick(0.0)
    for tick in range(1, 7):
        bridge.begin_tick(tick / 10, 0.1)
        bridge.end_tick(tick / 10)
    fresh()
    assert turning(brick) == [0, 0, 0, 0]
    assert "put `move` into `running`" in bridge.safety.notices[-1].text


def test_a_robot_that_moves_in_every_tick_costs_five_commands_a_second(bridge, brick, clock, fresh):
    fresh()
    for tick in range(50):
        clock.now += 0.02
        bridge.begin_tick(tick / 50, 0.02)
        bridge.robot.move(linear=0.2)
        bridge.end_tick(tick / 50)
        fresh()
        assert turning(brick) == FORWARD
    assert 5 <= brick.motors[1].starts <= 7
    assert len(brick.commands) <= 7


def test_a_motor_that_turns_on_costs_no_frame_at_all(bridge, brick, passes):
    bridge.robot.motorA.start_at_speed(50)
    passes(3)
    assert brick.motors[0].turning == 50
    assert len(brick.commands) == 1, "renewals travel with the questions"


def test_stop_stands_still_and_ends_the_renewals(bridge, brick, passes):
    bridge.robot.move(linear=0.2)
    bridge.robot.motorA.start_at_speed(10)
    bridge.robot.stop()
    passes(1)
    assert turning(brick) == [0, 0, 0, 0]
    assert all(motor.braked for motor in brick.motors)
    assert not bridge.safety.motion


def test_a_motor_that_is_stopped_or_run_for_an_angle_is_not_renewed(bridge, brick, passes):
    bridge.robot.motorA.start_at_speed(50)
    bridge.robot.motorB.start_at_speed(50)
    bridge.robot.motorC.start_at_power(50)
    bridge.robot.motorA.stop()
    bridge.robot.motorB.run_for(degrees=100)
    passes(2)
    assert turning(brick) == [0, 0, 50, 0]
    assert not brick.motors[2].regulated
    assert bridge.robot.motorB.count == 100


def test_of_the_motors_those_are_halted_by_a_stop_that_would_have_turned_on(bridge):
    for motor in "ABD":
        getattr(bridge.robot, f"motor{motor}").start_at_speed(50)
    bridge.robot.motorA.start_at_power(20)
    bridge.robot.motorB.stop()
    bridge.robot.motorC.run_for(degrees=100)
    bridge.robot.motorD.start_at_speed(0)
    bridge.stop_all()
    assert [each.name for each in bridge.safety.left_halted()] == ["motorA.start_at_power"]
    assert bridge.safety.left_halted() == []


def test_a_bridge_that_was_held_up_for_long_starts_no_motor_again_and_says_so(
    bridge, brick, clock, fresh, passes
):
    bridge.robot.motorA.start_at_speed(50)
    bridge.robot.motorD.start_at_speed(50)
    fresh()
    clock.now += 5  # as after a SIGSTOP
    fresh()
    passes(1)
    assert turning(brick) == [0, 0, 0, 0]
    assert bridge.safety.notices[-1].text == (
        "`motorA` and `motorD` stopped: nothing renewed it for 0.6 s. Start it again."
    )
    assert bridge.status.state == "connected"


def test_what_turned_before_a_loss_is_not_renewed_after_it(bridge, brick, until, passes):
    bridge.robot.move(linear=0.2)
    brick.hang_up()
    until(lambda: brick.connections == 2 and bridge.status.state == "connected")
    passes(1)
    assert turning(brick) == [0, 0, 0, 0]


def test_the_brick_is_named_as_what_stops_the_motors_of_a_dead_process(bridge):
    assert bridge.failsafe.startswith("The brick itself stops its motors: 0.6 s after the last renewal")


# -- sensing ------------------------------------------------------------------------------------------


def test_sensors_are_read_as_those_of_the_simulated_robot(bridge):
    robot = bridge.robot
    assert (robot.light.data, robot.bumper.data, robot.distance.data) == (107, False, 0.255)
    assert robot.scan.nearest(-30, 30) == 0.255


def test_sensors_in_other_ports_are_found_by_the_options(brick, make_bridge):
    brick.sensors[1], brick.sensors[2] = brick.sensors[2], brick.sensors[1]
    options = {"light": "2", "distance": "none", "left": "-A", "right": "D", "wheel": 28.0}
    bridge = make_bridge(**options)
    bridge.open()
    assert bridge.robot.light.data == 107
    with pytest.raises(BridgeError, match="No port is named for it"):
        bridge.robot.distance.data  # noqa: B018
    assert bridge.vehicle.motors == (0, 3)


def test_a_sensor_left_in_another_mode_is_set_to_the_right_one(brick, make_bridge):
    brick.sensors[2].mode, brick.sensors[3].mode = 2, 1
    bridge = make_bridge()
    bridge.open()
    assert brick.sensors[2].mode == brick.sensors[3].mode == 0
    assert bridge.robot.light.data == 107


def test_a_sensor_that_is_plugged_in_again_gets_its_mode_again(bridge, brick, fresh, until):
    bridge.robot.sensor3.set_mode("ambient")
    fresh()
    with pytest.raises(BridgeError, match="has set sensor 3 to another mode"):
        bridge.robot.light.data  # noqa: B018
    brick.sensors[2].type = 126
    fresh()
    with pytest.raises(BridgeError, match="Port 3 has nothing in it"):
        bridge.robot.light.data  # noqa: B018
    brick.sensors[2].type, brick.sensors[2].mode = 29, 2
    until(lambda: brick.sensors[2].mode == 0)
    fresh()
    assert bridge.robot.light.data == 107


def test_a_sensor_that_is_starting_has_no_value_yet(bridge, brick, fresh):
    brick.sensors[2].type = 125
    fresh()
    with pytest.raises(NoDataYet):
        bridge.robot.light.data  # noqa: B018


def test_a_robot_that_drives_on_readings_that_no_longer_come_is_stopped(bridge, brick, air, fresh):
    bridge.begin_tick(0.0, 0.1)
    bridge.robot.move(linear=0.2)
    bridge.end_tick(0.0)
    assert turning(brick) == FORWARD
    del brick.commands[:]
    brick.fault = "refuse"  # it answers, but with nothing
    air.now += 1.01
    fresh()
    bridge.begin_tick(0.1, 0.1)
    bridge.robot.move(linear=0.2)
    assert bridge.status.state == "stale"
    assert [command[7:].hex(" ") for command in brick.commands] == ["a3 00 0f 01"]


def test_options_are_understood_as_they_are_typed_on_a_command_line():
    typed = {"left": "a", "right": "-D", "wheel": "68.8", "track": "150", "light": "2", "distance": "none"}
    bridge = make_bridge("ev3", **typed)
    assert isinstance(bridge, EV3Bridge)
    assert bridge.vehicle == Vehicle("A", "-D", 68.8, 150, "2", "1", "none")
    with pytest.raises(BridgeError, match="`wheel` takes a number, not `wide`"):
        make_bridge("ev3", wheel="wide")
    with pytest.raises(BridgeError, match="`left` is a motor port"):
        make_bridge("ev3", left="1")


# -- where it is --------------------------------------------------------------------------------------


def test_the_motors_tell_where_it_has_driven(bridge, brick, passes):
    bridge.robot.move(linear=0.2)
    passes(3)
    ahead = 3 * 410 / 360 * math.pi * 0.056
    assert bridge.robot.odom.x == pytest.approx(ahead, abs=0.001)
    bridge.robot.move(angular=1)
    passes(3)
    turn = 2 * 3 * 120 / 360 * math.pi * 0.056 / 0.12
    assert bridge.robot.odom.theta == pytest.approx(turn, abs=0.02)
    assert bridge.robot.odom.x == pytest.approx(ahead, abs=0.001)


def test_setting_a_count_to_zero_does_not_move_the_robot(bridge, brick, fresh, passes):
    bridge.robot.move(linear=0.2)
    passes(1)
    before = bridge.robot.odom.x
    bridge.robot.motorB.reset_count()
    for _ in range(3):
        fresh()
    assert bridge.robot.odom.x == pytest.approx(before)
    assert abs(bridge.robot.odom.theta) < 0.01


def test_a_motor_that_is_plugged_in_again_does_not_move_the_robot(bridge, brick, fresh, passes):
    bridge.robot.move(linear=0.2)
    passes(1)
    bridge.robot.stop()
    fresh()
    before = bridge.robot.odom.x
    brick.motors[1].type, brick.motors[1].zero = 126, brick.motors[1].angle
    fresh()
    brick.motors[1].type = 7
    fresh()
    assert bridge.robot.odom.x == pytest.approx(before)


# -- the panel ----------------------------------------------------------------------------------------


def test_the_panel_shows_how_the_robot_is_built_and_what_it_reads(bridge):
    panel = bridge.panel()
    fields = {field.key: field for field in panel.fields}
    assert (fields["left"].kind, fields["left"].value) == ("choice", "B")
    assert (fields["wheel"].kind, fields["wheel"].value, fields["wheel"].unit) == ("number", "56", "mm")
    assert fields["distance"].choices == ("1", "2", "3", "4", "none")
    assert panel.tables[2].rows[:3] == (
        ("light.data", "107", ""),
        ("bumper.data", "False", ""),
        ("distance.data", "0.255", "m"),
    )


def test_a_reading_that_fails_is_shown_by_its_reason_without_a_unit(bridge):
    bridge.press("build", values={"distance": "none"})
    name, reason, unit = bridge.panel().tables[2].rows[2]
    assert (name, unit) == ("distance.data", "")
    assert "No port is named for it" in reason


def test_another_vehicle_is_used_from_the_panel_on(bridge, brick, fresh):
    bridge.robot.move(linear=0.2)
    values = {"left": "A", "right": "-D", "wheel": "112", "light": "none", "speed": "50"}
    bridge.press("build", values=values)
    fresh()
    assert turning(brick) == [0, 0, 0, 0]
    assert bridge.describe("move").signature
    bridge.robot.move(linear=0.2)
    fresh()
    assert turning(brick) == [20, 0, 0, -20]
    bridge.robot.move(linear=0.9)
    fresh()
    assert turning(brick) == [91, 0, 0, -91]
    with pytest.raises(BridgeError, match="No port is named"):
        bridge.robot.light.data  # noqa: B018
    assert bridge.panel().fields[-1].value == "4"


def test_a_vehicle_that_cannot_be_changes_nothing(bridge):
    with pytest.raises(BridgeError, match="both in port C"):
        bridge.press("build", values={"left": "C"})
    assert bridge.vehicle.left == "B"


def test_a_vehicle_is_chosen_before_the_brick_is_there():
    bridge = EV3Bridge()
    bridge.press("build", values={"track": "150"})
    assert bridge.vehicle.track == 150


@pytest.mark.parametrize(
    ("option", "sentence"), [({"left": "Z"}, "motor port"), ({"light": 9}, "sensor port")]
)
def test_a_wrong_option_is_refused_before_anything_is_connected(option, sentence):
    with pytest.raises(BridgeError, match=sentence):
        EV3Bridge("127.0.0.1", **option)
