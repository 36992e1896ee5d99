"""The EV3 bridge on an emulated brick: what a program may do, and what happens when things go wrong."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from operator import attrgetter
from typing import Any

import pytest

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.conformance import BridgeConformance
from lrp_jupyter.bridges.ev3 import EV3Bridge
from lrp_jupyter.errors import BridgeError, NoDataYet

STOP_ALL = "a3 00 0f 01"


def sent(brick: Any) -> list[str]:
    """The byte codes of the commands that the brick got, without their headers."""
    return [command[7:].hex(" ") for command in brick.commands]


# -- motors -------------------------------------------------------------------------------------------


def test_a_motor_started_at_a_speed_turns_until_the_next_command(bridge, passes):
    bridge.robot.motorB.start_at_speed(-30)
    passes(2)
    assert bridge.robot.motorB.count == -600
    assert bridge.robot.motorB.speed == -30
    assert bridge.robot.motorA.speed == 0


def test_a_motor_is_stopped_with_brake_unless_it_is_to_coast(bridge, brick, fresh):
    bridge.robot.motorA.start_at_power(80)
    fresh()
    assert brick.motors[0].turning == 80
    bridge.robot.motorA.stop()
    fresh()
    assert (brick.motors[0].turning, brick.motors[0].braked) == (0, True)
    bridge.robot.motorA.stop(brake=False)
    fresh()
    assert not brick.motors[0].braked


@pytest.mark.parametrize(
    ("arguments", "degrees"),
    [
        ({"degrees": 90}, 90),
        ({"degrees": -90}, -90),
        ({"degrees": 90, "speed": -20}, -90),
        ({"seconds": 1.5, "speed": 40}, 600),
        ({"seconds": 0.5, "speed": -40}, -200),
        ({"degrees": 0}, 0),
        ({"degrees": 0.4}, 0),
        ({"seconds": 0}, 0),
    ],
)
def test_a_motor_runs_for_an_angle_or_a_time_and_stops(bridge, clock, fresh, arguments, degrees):
    bridge.robot.motorD.run_for(**arguments)
    fresh()
    clock.now += 60
    fresh()
    assert bridge.robot.motorD.count == degrees
    assert bridge.robot.motorD.speed == 0


def test_a_count_set_to_zero_is_zero_at_once_and_counts_from_there(bridge, passes):
    bridge.robot.motorC.start_at_speed(10)
    passes(5)
    assert bridge.robot.motorC.count == 500
    bridge.robot.motorC.reset_count()
    assert bridge.robot.motorC.count == 0
    passes(1)
    assert bridge.robot.motorC.count == 100


def test_the_beep_sounds(bridge, brick, fresh):
    bridge.robot.beep(frequency=880, seconds=0.1)
    fresh()
    assert brick.tones == [(50, 880, 100)]


@pytest.mark.parametrize(
    ("member", "arguments", "sentence"),
    [
        ("motorA.start_at_speed", (101,), "-100 to 100, not 101"),
        ("motorA.start_at_speed", (-100.5,), "-100 to 100"),
        ("motorA.start_at_speed", (math.nan,), "finite number"),
        ("motorA.start_at_speed", (math.inf,), "finite number"),
        ("motorA.start_at_speed", ("fast",), "must be a number, not 'fast'"),
        ("motorA.start_at_speed", (True,), "must be a number"),
        ("motorA.start_at_speed", (None,), "must be a number"),
        ("motorA.start_at_speed", (), "missing"),
        ("motorA.start_at_speed", (1, 2), "too many"),
        ("motorB.start_at_power", (200,), "-100 to 100"),
        ("motorB.start_at_power", (math.nan,), "finite number"),
        ("motorC.stop", ("hard",), "True or False"),
        ("motorD.run_for", (), "an angle or a time"),
        ("motorD.run_for", (90, 1), "an angle or a time"),
        ("motorD.run_for", (90, None, 0), "never end"),
        ("motorD.run_for", (math.nan,), "finite number"),
        ("motorD.run_for", (1e10,), "further"),
        ("motorD.run_for", (None, -1), "needs a positive time"),
        ("motorD.run_for", (None, 1e9), "further"),
        ("beep", (20,), "frequency goes from 250"),
        ("beep", (440, -1), "seconds goes from 0"),
        ("beep", (440, 1, 101), "volume goes from 0"),
    ],
)
def test_a_wrong_argument_is_refused_and_nothing_is_sent(bridge, brick, fresh, member, arguments, sentence):
    with pytest.raises(BridgeError, match=sentence):
        attrgetter(member)(bridge.robot)(*arguments)
    fresh()
    assert brick.commands == []


@pytest.mark.parametrize("command", ["start_at_speed", "start_at_power", "run_for"])
def test_a_motor_that_is_not_plugged_in_is_reported(bridge, brick, fresh, command):
    brick.motors[1].type = 126
    fresh()
    with pytest.raises(BridgeError, match="`motorB`: Nothing is plugged into port B"):
        getattr(bridge.robot.motorB, command)(50)
    bridge.robot.motorB.stop()  # to stop is always allowed
    fresh()
    assert sent(brick) == ["a3 00 02 01"]


def test_a_disarmed_bridge_moves_nothing_but_reads_and_stops(bridge, brick, fresh):
    bridge.disarm()
    fresh()
    del brick.commands[:]
    bridge.robot.motorA.start_at_speed(50)
    bridge.robot.beep()
    fresh()
    assert brick.commands == []
    assert bridge.robot.sensor2.read() == 42
    bridge.stop_all()
    fresh()
    assert sent(brick) == [STOP_ALL]


# -- sensors ------------------------------------------------------------------------------------------


def test_sensors_are_read_in_their_units(bridge, brick):
    robot = bridge.robot
    assert (robot.sensor1.read(), robot.sensor1.type, robot.sensor1.mode) == (0, "touch", "touch")
    assert (robot.sensor2.read(), robot.sensor2.type, robot.sensor2.mode) == (42, "colour", "reflected")
    assert (robot.sensor3.read(), robot.sensor3.value) == (25.5, 25.5)
    assert type(robot.sensor2.read()) is int


def test_the_brick_reports_its_battery_name_and_motors(bridge):
    assert (bridge.robot.battery, bridge.robot.name, bridge.robot.motorA.type) == (
        87,
        "SLOWPOKE",
        "large motor",
    )


@pytest.mark.parametrize("mode", ["ambient", 1])
def test_a_sensor_measures_what_is_wanted(bridge, until, mode):
    bridge.robot.sensor2.set_mode(mode)
    with pytest.raises(NoDataYet):  # what it measured before is not what is wanted now
        bridge.robot.sensor2.read()
    until(lambda: bridge.robot.sensor2.mode == "ambient")
    assert bridge.robot.sensor2.read() == 7


@pytest.mark.parametrize("mode", ["ambiant", 8, -1, True, None, 1.5])
def test_a_mode_that_does_not_exist_is_refused(bridge, mode):
    with pytest.raises(BridgeError, match=r"`sensor2` \(colour\) has no mode .*`ambient`"):
        bridge.robot.sensor2.set_mode(mode)


def test_a_mode_nearly_right_is_suggested(bridge):
    with pytest.raises(BridgeError, match="Did you mean `ambient`"):
        bridge.robot.sensor2.set_mode("ambiant")


def test_a_sensor_without_a_value_yet_has_no_data(bridge, brick, fresh):
    brick.sensors[1].values = {}  # it reports NaN
    fresh()
    with pytest.raises(NoDataYet):
        bridge.robot.sensor2.read()


def test_an_empty_port_is_reported(bridge):
    for ask in (bridge.robot.sensor4.read, lambda: bridge.robot.sensor4.set_mode(0)):
        with pytest.raises(BridgeError, match="Nothing is plugged into port 4"):
            ask()
    assert bridge.robot.sensor4.type == "nothing"


def test_another_sensor_in_the_port_measures_in_its_own_mode(bridge, brick, fresh):
    bridge.robot.sensor2.set_mode("colour")
    fresh()
    assert bridge.robot.sensor2.read() == 5
    brick.sensors[1].type, brick.sensors[1].values, brick.sensors[1].mode = 32, {0: -90.0}, 0
    fresh()
    brick.sensors[1].mode = 0
    fresh()
    assert (bridge.robot.sensor2.read(), bridge.robot.sensor2.mode) == (-90, "angle")


def test_one_tick_sees_one_world(bridge, brick, fresh):
    bridge.begin_tick(0.0, 0.1)
    brick.sensors[0].values[0] = 1.0
    fresh()
    assert bridge.robot.sensor1.read() == 0
    assert bridge.robot.sensor1.value == 0
    bridge.end_tick(0.0)
    assert bridge.robot.sensor1.read() == 1


def test_what_was_not_read_lately_has_an_age(bridge, air):
    air.now += 0.3
    assert bridge.describe("sensor1.value").age == pytest.approx(0.3)


# -- stopping -----------------------------------------------------------------------------------------


def test_the_runstop_stops_all_motors_in_one_packet(bridge, brick, fresh):
    for motor in (bridge.robot.motorA, bridge.robot.motorD):
        motor.start_at_speed(100)
    fresh()
    del brick.commands[:]
    assert bridge.stop_all() is True
    fresh()
    assert sent(brick) == [STOP_ALL]
    assert [motor.turning for motor in brick.motors] == [0, 0, 0, 0]


def test_the_runstop_works_while_a_reading_hangs(bridge, brick):
    bridge.robot.motorA.start_at_speed(100)
    brick.fault, pressed = "silent", []

    def press() -> None:
        if not pressed:
            pressed.append(threading.Thread(target=bridge.press, args=("stop",)))
            pressed[0].start()
            pressed[0].join(60)
            assert sent(brick)[-1] == STOP_ALL

    brick.waits = press
    bridge.link._turn()
    assert pressed
    assert brick.motors[0].turning == 0


def test_a_runstop_that_cannot_reach_the_brick_reports_it(bridge, brick, until):
    brick.unplug()
    until(lambda: bridge.status.state == "lost")
    assert bridge.stop_all() is False
    texts = {notice.text for notice in bridge.safety.notices if "may not have stopped" in notice.text}
    assert any("within 0.6 s by itself, and all as soon as it is found" in text for text in texts)


def test_a_motor_started_once_runs_on_without_new_commands(bridge, brick, passes):
    bridge.begin_tick(0.0, 0.1)
    bridge.robot.motorA.start_at_speed(100)
    bridge.end_tick(0.0)
    for tick in range(1, 30):
        bridge.begin_tick(tick / 10, 0.1)
        bridge.end_tick(tick / 10)
    passes(3)
    assert brick.motors[0].turning == 100


def test_closing_stops_the_motors(bridge, brick, until):
    bridge.robot.motorA.start_at_speed(100)
    bridge.close()
    until(lambda: brick.goodbyes == 1)
    assert brick.motors[0].turning == 0
    assert brick.resets == 0


# -- faults: each is reported within a second ------------------------------------------------------------


@pytest.mark.parametrize("fault", ["split", "merge"])
def test_replies_cut_or_joined_disturb_nothing(bridge, brick, fresh, fault):
    brick.fault = fault
    fresh()
    brick.sensors[1].values[0] = 43.0
    fresh()
    assert bridge.robot.sensor2.read() == 43
    assert bridge.status.state == "connected"


@pytest.mark.parametrize(
    ("fault", "sentence"),
    [
        ("half", "does not answer"),
        ("silent", "does not answer"),
        ("close", "closed the connection"),
        ("noise", "not a reply"),
    ],
)
def test_a_brick_that_fails_is_lost_within_half_a_second_and_every_use_explains_why(
    bridge, brick, air, fault, sentence
):
    brick.fault, began = fault, air.now
    bridge.link._turn()
    assert bridge.status.state == "lost"
    assert air.now - began < 0.56
    for use in (
        bridge.robot.sensor1.read,
        lambda: bridge.robot.motorA.count,
        lambda: bridge.robot.battery,
        lambda: bridge.robot.motorA.start_at_speed(50),
        bridge.robot.motorA.reset_count,
        bridge.robot.beep,
    ):
        with pytest.raises(BridgeError, match=sentence):
            use()
    assert sentence in bridge.status.sentence
    lost, moving = [notice.text for notice in bridge.safety.notices if notice.kind == "fault"]
    assert lost == bridge.status.sentence
    assert moving.startswith("The robot may not have stopped: ")


@pytest.mark.parametrize(("fault", "sentence"), [("refuse", "refused"), ("other size", "instead of")])
def test_a_brick_that_refuses_to_be_read_stays_connected(bridge, brick, until, fault, sentence):
    brick.fault = fault
    until(lambda: bridge.status.state == "stale")
    with pytest.raises(BridgeError, match=sentence):
        bridge.robot.sensor1.read()
    brick.fault = ""
    until(lambda: bridge.status.state == "connected")
    assert bridge.robot.sensor2.read() == 42
    assert brick.connections == 1


def test_the_loop_does_not_wait_for_a_brick_that_hangs(bridge, brick):
    brick.fault, ticks = "silent", []

    def tick() -> None:
        thread = threading.Thread(target=run)
        thread.start()
        thread.join(60)
        ticks.append(not thread.is_alive())

    def run() -> None:
        bridge.begin_tick(len(ticks) / 100, 0.01)
        assert bridge.robot.sensor1.read() == 0
        bridge.robot.motorA.start_at_speed(50)
        bridge.end_tick(len(ticks) / 100)

    brick.waits = tick
    bridge.link._turn()
    assert len(ticks) >= 10
    assert all(ticks)


def test_unplugged_while_a_motor_runs_and_plugged_in_again_the_motor_is_stopped_and_nothing_is_sent_twice(
    bridge, brick, fresh, until
):
    bridge.robot.motorA.start_at_speed(70)
    fresh()
    brick.unplug()

    bridge.robot.motorB.start_at_speed(20)  # under way when the loss is noticed
    until(lambda: bridge.status.state == "lost")
    with pytest.raises(BridgeError, match="does not answer"):
        bridge.robot.motorB.start_at_speed(20)
    assert brick.motors[0].turning == 70
    del brick.commands[:]
    brick.plug_in()
    until(lambda: bridge.status.state == "connected")
    assert sent(brick) == [STOP_ALL]
    assert [motor.turning for motor in brick.motors] == [0, 0, 0, 0]
    assert "its motors were stopped" in bridge.status.sentence
    bridge.robot.motorA.start_at_speed(30)
    fresh()
    assert [motor.turning for motor in brick.motors] == [30, 0, 0, 0]


def test_a_fault_of_the_bridge_itself_is_a_lost_brick_that_is_found_again(bridge, brick, fresh, until):
    bridge.robot.motorA.start_at_speed(70)
    fresh()
    faults, advance = [ZeroDivisionError("no track")], bridge.link._advance

    def fail_once(pose: Any, degrees: tuple[int, ...]) -> Any:
        if faults:
            raise faults.pop()
        return advance(pose, degrees)

    bridge.link._advance = fail_once
    sentence = "The EV3 bridge itself failed: ZeroDivisionError: no track."
    until(lambda: sentence in [notice.text for notice in bridge.safety.notices])
    until(lambda: bridge.status.state == "connected")
    assert "its motors were stopped" in bridge.status.sentence
    assert brick.motors[0].turning == 0
    fresh()


# -- its address -------------------------------------------------------------------------------------


def test_opening_at_an_address_without_a_brick_fails_and_can_be_tried_again(make_bridge, brick):
    brick.unplug()
    bridge = make_bridge()
    with pytest.raises(BridgeError, match="No EV3 brick was found"):
        bridge.open()
    assert bridge.status.state == "disconnected"
    brick.plug_in()
    bridge.open()
    assert bridge.status.state == "connected"


@pytest.mark.parametrize("address", ["", "my brick", "1.2.3"])
def test_an_answer_that_is_not_an_address_is_refused(make_bridge, address):
    bridge = make_bridge(None)
    bridge.open()
    with pytest.raises(BridgeError, match="not the address"):
        bridge.answer("host", address)


def test_an_unknown_question_is_refused(make_bridge):
    with pytest.raises(BridgeError, match="has no option `colour`"):
        make_bridge(None).answer("colour", "red")


# -- the panel ----------------------------------------------------------------------------------------


def test_the_panel_shows_every_motor_and_sensor(bridge):
    panel = bridge.panel()
    motors, sensors, _robot = panel.tables
    assert motors.keys == ("motorA", "motorB", "motorC", "motorD")
    assert motors.rows[0] == ("motorA", "large motor", "0", "0")
    assert sensors.rows == (
        ("sensor1", "touch", "touch", "0", ""),
        ("sensor2", "colour", "reflected", "42", "%"),
        ("sensor3", "ultrasonic", "centimetres", "25.5", "cm"),
        ("sensor4", "nothing", "", "", ""),
    )
    fields = {field.key: field.value for field in panel.fields}
    assert fields["brick"] == "SLOWPOKE"
    assert fields["battery"] == "87"
    assert fields["address"] == "127.0.0.1"


def test_the_panel_is_there_before_and_after_the_brick(make_bridge):
    bridge = make_bridge(None)
    assert bridge.panel().tables[0].rows[0] == ("motorA", "", "", "")
    bridge.open()
    bridge.close()
    assert bridge.panel().tables[1].rows[3] == ("sensor4", "", "", "", "")


def test_motors_are_driven_by_hand(bridge, brick, clock, fresh):
    bridge.press("forward", "motorA", {"speed": "30"})
    bridge.press("backward", "motorB", {"speed": "12,5"})
    bridge.press("forward", "motorC")
    fresh()
    assert [motor.turning for motor in brick.motors] == [30, -12, 50, 0]
    clock.now += 1
    bridge.press("halt", "motorA", {})
    bridge.press("reset_count", "motorA")
    bridge.press("beep")
    fresh()
    assert brick.motors[0].turning == 0
    assert bridge.robot.motorA.count == 0
    assert len(brick.tones) == 1


def test_the_hand_cannot_move_a_disarmed_robot(bridge, brick, fresh):
    bridge.disarm()
    bridge.press("forward", "motorA", {"speed": "30"})
    fresh()
    assert brick.motors[0].turning == 0
    assert bridge.safety.notices[-1].kind == "disarmed"


def test_a_sensors_mode_is_changed_by_hand(bridge, until):
    for mode in ("ambient", "colour", "reflected"):
        bridge.press("next_mode", "sensor2")
        until(lambda: bridge.robot.sensor2.mode == mode)  # noqa: B023


@pytest.mark.parametrize(
    ("key", "row", "values"),
    [
        ("fly", "motorA", {}),
        ("forward", "motorE", {}),
        ("forward", "sensor1", {}),
        ("next_mode", "motorA", {}),
        ("forward", "motorA", {"speed": "quick"}),
        ("forward", "motorA", {"speed": "nan"}),
        ("forward", "motorA", {"speed": "1000"}),
        ("next_mode", "sensor4", {}),
    ],
)
def test_a_button_that_cannot_be_pressed_explains_why(bridge, brick, key, row, values):
    with pytest.raises(BridgeError):
        bridge.press(key, row, values)
    assert brick.commands == []


def test_buttons_of_a_closed_bridge_report_what_is_missing(make_bridge):
    with pytest.raises(BridgeError, match="No brick is connected"):
        make_bridge(None).press("forward", "motorA", {})


# -- what every bridge has to keep --------------------------------------------------------------------


class TestConformance(BridgeConformance):
    moves = True

    @pytest.fixture(autouse=True)
    def _wired(self, brick: Any, make_bridge: Callable[..., EV3Bridge], clock: Any, air: Any) -> None:
        self.brick, self.make, self.clocks = brick, make_bridge, (clock, air)
        brick.sensors[1].type = 126
        brick.sensors[2].type, brick.sensors[2].values = 29, {0: 42.0}
        brick.sensors[3].type, brick.sensors[3].values = 30, {0: 25.5}

    def make_bridge(self) -> EV3Bridge:
        self.bridge = self.make()
        return self.bridge

    def wait(self, seconds: float) -> None:
        for clock in self.clocks:
            clock.now += seconds
        self.bridge.link._turn()

    def has_moved(self, bridge: Bridge) -> bool:
        return any(motor.turning for motor in self.brick.motors)

    def silence(self) -> None:
        self.brick.fault = "refuse"  # it answers, but with no reading

    def cut(self) -> None:
        self.brick.unplug()

    def restore(self) -> None:
        self.brick.fault = ""
        self.brick.plug_in()
