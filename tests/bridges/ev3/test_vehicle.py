"""The vehicle around a brick: its wheels, and what its sensors are for."""

from __future__ import annotations

import math

import pytest

from lrp_jupyter.bridges.ev3.link import NOWHERE
from lrp_jupyter.bridges.ev3.protocol import BrickReading, MotorReading, SensorReading
from lrp_jupyter.bridges.ev3.vehicle import Vehicle
from lrp_jupyter.errors import BridgeError, NoDataYet

USUAL = Vehicle()
RIM = math.pi * 0.056  # m that a wheel rolls in a turn
NOTHING = SensorReading(math.nan, 126, 0)


def reading(motor: int = 7, **sensors: SensorReading) -> BrickReading:
    """All motors of a type, and the sensors at ports `p1` to `p4`."""
    return BrickReading(
        (MotorReading(0, 0, motor),) * 4, tuple(sensors.get(f"p{i}", NOTHING) for i in range(1, 5)), 80
    )


def percents(vehicle: Vehicle, linear: float, angular: float, motor: int = 7) -> dict[int, int]:
    return vehicle.percents(linear, angular, reading(motor))[0]


def test_straight_on_both_motors_turn_alike():
    turns_a_second = 0.2 / RIM
    assert percents(USUAL, 0.2, 0) == {1: round(turns_a_second * 360 / 10.07), 2: 41}
    assert percents(USUAL, -0.2, 0) == {1: -41, 2: -41}


def test_a_positive_turn_is_to_the_left():
    assert percents(USUAL, 0, 1) == {1: -12, 2: 12}


def test_a_medium_motor_needs_fewer_percent_for_the_same_speed():
    assert percents(USUAL, 0.2, 0, motor=8) == {1: 26, 2: 26}


def test_a_motor_built_in_the_other_way_round_turns_backwards_to_drive_forwards():
    vehicle = Vehicle.of({"left": "-a", "right": " -D "})
    assert percents(vehicle, 0.2, 0) == {0: -41, 3: -41}
    x, y, theta = vehicle.advanced(NOWHERE, (-360, 5, 5, -360))
    assert (x, y, theta) == (pytest.approx(RIM), 0, 0)


def test_the_greatest_speed_is_what_a_large_motor_can_do():
    limits = USUAL.limits
    assert limits["linear"] == pytest.approx(168 / 60 * RIM, rel=0.005)
    assert USUAL.percents(limits["linear"], 0, None) == ({1: 100, 2: 100}, 1)
    assert USUAL.percents(0, limits["angular"], None) == ({1: -100, 2: 100}, 1)
    assert Vehicle(wheel=43.2).limits["linear"] < limits["linear"]


def test_a_curve_that_is_too_fast_stays_the_same_curve():
    turned, excess = USUAL.percents(0.4, 4, None)
    assert max(turned.values()) == 100
    assert excess == pytest.approx((0.4 + 4 * 0.06) / USUAL.limits["linear"], rel=0.01)
    assert turned[1] / turned[2] == pytest.approx((0.4 - 0.24) / (0.4 + 0.24), abs=0.01)


@pytest.mark.parametrize(("linear", "angular"), [(0.2, 0), (0.1, 0.5), (0, -1.0), (-0.15, 0.8)])
def test_what_was_driven_is_found_again_by_dead_reckoning(linear, angular):
    pose, seconds, steps = NOWHERE, 3.0, 150
    for _ in range(steps):
        part = seconds / steps
        left = (linear - angular * 0.06) * part / RIM * 360
        right = (linear + angular * 0.06) * part / RIM * 360
        pose = USUAL.advanced(pose, (0, left, right, 0))  # type: ignore[arg-type]
    turn = angular * seconds
    radius = linear / angular if angular else 0.0
    x = radius * math.sin(turn) if angular else linear * seconds
    assert pose == pytest.approx((x, radius * (1 - math.cos(turn)), turn), abs=1e-4)


@pytest.mark.parametrize(("percent", "grey"), [(0, 0), (50, 127), (100, 255)])
def test_reflected_light_is_given_from_black_to_white(percent, grey):
    seen = reading(p3=SensorReading(percent, 29, 0))
    assert USUAL.sense("light", seen, USUAL.modes) == grey


@pytest.mark.parametrize(("value", "pressed"), [(0.0, False), (1.0, True)])
def test_the_bumper_is_pressed_or_free(value, pressed):
    assert USUAL.sense("bumper", reading(p1=SensorReading(value, 16, 0)), USUAL.modes) is pressed


@pytest.mark.parametrize(
    ("kind", "value", "metres"),
    [(30, 25.5, 0.255), (30, 254.9, 2.549), (30, 255.0, math.inf), (33, 50, 0.35), (33, 100, math.inf)],
)
def test_a_distance_is_given_in_metres_and_is_infinite_where_nothing_is(kind, value, metres):
    seen = reading(p4=SensorReading(value, kind, 0))
    assert USUAL.sense("distance", seen, USUAL.modes) == pytest.approx(metres)


@pytest.mark.parametrize(
    ("name", "sensors", "sentence"),
    [
        ("light", {}, "`robot.light`: Port 3 has nothing in it, and not a colour sensor. Plug one in."),
        (
            "light",
            {"p3": SensorReading(20, 30, 0), "p2": SensorReading(20, 29, 0)},
            r"Port 3 has another sensor \(ultrasonic\), .* Set `light` to 2, where one is.",
        ),
        ("bumper", {"p1": SensorReading(20, 29, 0)}, r"another sensor \(colour\), and not a touch sensor"),
        ("distance", {}, "not an ultrasonic or infrared sensor"),
    ],
)
def test_a_sensor_that_is_not_there_is_reported(name, sensors, sentence):
    with pytest.raises(BridgeError, match=sentence):
        USUAL.sense(name, reading(**sensors), USUAL.modes)


def test_a_sensor_without_a_port_is_reported():
    vehicle = Vehicle.of({"distance": "none"})
    with pytest.raises(BridgeError, match=r"No port is named for it\. Set `distance` to that of an ultra"):
        vehicle.sense("distance", reading(p4=SensorReading(20, 30, 0)), vehicle.modes)
    assert vehicle.modes == (0, -1, 0, -1)


@pytest.mark.parametrize(
    "seen", [SensorReading(math.nan, 29, 0), SensorReading(3, 29, 1), SensorReading(0, 125, 0)]
)
def test_a_sensor_that_starts_or_changes_its_mode_has_no_value_yet(seen):
    with pytest.raises(NoDataYet):
        USUAL.sense("light", reading(p3=seen), USUAL.modes)


def test_a_sensor_that_the_program_put_into_another_mode_is_reported():
    with pytest.raises(BridgeError, match=r'Set it back: `robot.sensor3.set_mode\("reflected"\)`'):
        USUAL.sense("light", reading(p3=SensorReading(3, 29, 1)), (0, -1, 1, 0))


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"left": "E"}, "`left` is a motor port, A to D, or -A to -D, not 'E'"),
        ({"right": ""}, "`right` is a motor port"),
        ({"right": "-b"}, "`left` and `right` are both in port B"),
        ({"light": 5}, "`light` is a sensor port, 1 to 4, or none, not '5'"),
        ({"bumper": 3}, "`light` and `bumper` are both in port 3"),
        ({"wheel": "big"}, "`wheel` must be a number, not 'big'"),
        ({"wheel": 0}, "`wheel` is a length in mm, from 1 to 2000, not 0"),
        ({"track": math.inf}, "`track` must be a finite number"),
        ({"track": True}, "`track` must be a number"),
    ],
)
def test_a_vehicle_that_cannot_be_is_refused(options, sentence):
    with pytest.raises(BridgeError, match=sentence):
        Vehicle.of(options)


def test_options_are_taken_as_values_and_as_typed():
    typed = {"left": "a", "right": "d", "wheel": "68,8", "track": "150", "light": "2", "bumper": "NONE"}
    vehicle = Vehicle.of({**typed, "distance": None})
    assert vehicle == Vehicle("A", "D", 68.8, 150, "2", "none", "none")
    assert Vehicle.of(vehicle.options()) == vehicle
