"""Ways, turns, points and texts that a program asks a brick for: driven by its wheels, and displayed."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.waiting import until

from lrp_jupyter.bridges.ev3 import EV3Bridge
from lrp_jupyter.errors import BridgeError

Drive = Callable[[float], None]


@pytest.fixture
def drive(bridge: EV3Bridge, clock: Any, fresh: Callable[[], None]) -> Drive:
    """Let time pass, in which the brick is read every 20 ms, and then see what a tick sees."""
    ticks = iter(range(1, 10_000))

    def drive(seconds: float) -> None:
        for _ in range(round(seconds * 50)):
            clock.now += 0.02
            fresh()
        now = next(ticks) / 10
        bridge.begin_tick(now, 0.1)
        bridge.end_tick(now)

    return drive


def turning(brick: Any) -> list[float]:
    return [motor.turning for motor in brick.motors]


def ask(bridge: EV3Bridge, what: str, *arguments: object, **named: float) -> Any:
    """Ask for a task, as a person does; return it when it has begun."""
    task = getattr(bridge.robot, what)
    task(*arguments, **named)
    until(lambda: not any(thread.name == f"task {what}" for thread in threading.enumerate()))
    return task


def test_a_way_is_driven_and_ends_where_it_should_with_what_is_left_of_it_meanwhile(bridge, brick, drive):
    task = ask(bridge, "drive_by", 0.5)
    drive(1)
    assert turning(brick) == [0, 41, 41, 0]
    assert task.feedback == pytest.approx(0.3, abs=0.02)
    drive(3)
    assert (task.status, turning(brick)) == ("succeeded", [0, 0, 0, 0])
    assert bridge.robot.odom.x == pytest.approx(0.5, abs=0.002)
    assert brick.motors[1].braked
    assert len(brick.commands) <= 3, "the rest travels with the questions"


@pytest.mark.slow
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=30)
@given(st.floats(-0.4, 0.4), st.floats(-0.4, 0.4), st.floats(0.05, 0.4), st.sampled_from(["BC", "B-C", "CB"]))
def test_a_point_is_reached_however_the_motors_are_built_in(bridge, clock, fresh, x, y, speed, built):
    bridge.press("build", values={"left": built[0], "right": built[1:]})
    bridge.begin_tick(0.0, 0.1)
    robot = bridge.robot
    to_x, to_y = robot.odom.x + x, robot.odom.y + y
    ask(bridge, "drive_to", to_x, to_y, speed=speed)
    for _ in range(3000):
        clock.now += 0.02
        fresh()
        if bridge._driver._trip is None:
            break
    bridge.begin_tick(0.0, 0.1)
    bridge.end_tick(0.0)
    assert robot.drive_to.status == "succeeded"
    assert (robot.odom.x, robot.odom.y) == pytest.approx((to_x, to_y), abs=0.006)
    bridge.requested.drop()


@pytest.mark.parametrize("radians", [math.pi / 2, -math.pi / 2, 0.1, 7.0])
def test_a_turn_is_as_wide_as_asked_for(bridge, drive, radians):
    task = ask(bridge, "turn_by", radians)
    drive(9)
    assert task.succeeded
    assert bridge.robot.odom.theta == pytest.approx(radians, abs=math.radians(1.2))
    assert math.hypot(bridge.robot.odom.x, bridge.robot.odom.y) < 0.002


def test_a_wheel_that_something_holds_ends_it_with_the_reason_and_the_other_one_stands_too(
    bridge, brick, drive
):
    task = ask(bridge, "drive_by", 1)
    drive(1)
    for wheel in brick.motors[1:3]:
        wheel.hold(True)
    drive(2)
    assert task.status == "aborted"
    assert task.reason == "The robot has not moved for 1 s, 0.80 m before the goal."
    assert turning(brick) == [0, 0, 0, 0]


def test_cancelling_it_stops_its_wheels_and_no_other_motor(bridge, brick, drive):
    bridge.robot.motorA.start_at_speed(20)
    task = ask(bridge, "drive_by", 1)
    drive(1)
    bridge.requested.drop()
    drive(0.1)
    assert turning(brick) == [20, 0, 0, 0]
    assert task.status is None


@pytest.mark.parametrize(
    ("command", "speeds"),
    [
        (lambda robot: robot.move(linear=0.1), [0, 20, 20, 0]),
        (lambda robot: robot.motorC.start_at_speed(10), [0, 0, 10, 0]),
        (lambda robot: robot.motorB.stop(), [0, 0, 0, 0]),
    ],
)
def test_another_command_for_its_wheels_ends_it(bridge, brick, drive, command, speeds):
    task = ask(bridge, "drive_by", 1)
    drive(0.5)
    command(bridge.robot)
    drive(0.1)
    assert task.status == "aborted"
    assert task.reason == "The robot was driven by `move`, or stopped, before that was done."
    drive(0.4)
    if speeds[1]:
        assert turning(brick) == speeds


def test_a_number_that_is_dragged_changes_the_way_without_a_stop(bridge, brick, drive):
    ask(bridge, "drive_by", 0.3)
    drive(0.5)
    task = ask(bridge, "drive_by", 0.6)
    starts = [motor.braked for motor in brick.motors]
    drive(0.02)
    assert turning(brick) == [0, 41, 41, 0]
    assert not any(starts)
    drive(4)
    assert task.succeeded
    assert bridge.robot.odom.x == pytest.approx(0.6, abs=0.002)


def test_a_brick_that_nothing_reaches_any_more_stops_by_itself_at_any_moment_of_a_way(
    bridge, brick, clock, drive
):
    for moment in (0.5, 1.0, 1.2, 1.3, 1.4):
        ask(bridge, "drive_by", 0.3)
        drive(moment)
        clock.now += 0.62  # the process is stopped
        assert turning(brick) == [0, 0, 0, 0]
        bridge.stop_all()
        drive(0.1)


def test_a_stop_of_the_robot_ends_it_and_the_next_one_begins_where_it_stands(bridge, brick, drive):
    task = ask(bridge, "drive_by", 0.4)
    drive(1)
    bridge.stop_all()
    drive(0.1)
    assert (task.status, turning(brick)) == ("cancelled", [0, 0, 0, 0])
    x = bridge.robot.odom.x
    ask(bridge, "drive_by", 0.1)
    drive(2)
    assert bridge.robot.odom.x == pytest.approx(x + 0.1, abs=0.002)


def test_a_brick_that_is_lost_meanwhile_has_lost_it_and_does_not_go_on_with_it(
    bridge, brick, clock, drive, fresh
):
    task = ask(bridge, "drive_by", 1)
    drive(0.5)
    brick.hang_up()
    for _ in range(20):
        clock.now += 0.02
        fresh()
    drive(0.1)
    assert task.status == "lost"
    assert brick.connections == 2
    drive(1)
    assert turning(brick) == [0, 0, 0, 0]


def test_a_wheel_without_a_motor_is_the_reason_that_it_was_aborted(bridge, brick, fresh, drive):
    brick.motors[2].type = 126
    fresh()
    task = ask(bridge, "drive_by", 1)
    drive(0.1)
    assert task.reason == "`motorC`: Nothing is plugged into port C."


def test_a_wrong_number_is_refused_at_once_as_in_the_simulator(bridge, drive):
    robot = bridge.robot
    with pytest.raises(BridgeError, match=r"^`drive_by\(metres=…\)` must be a finite number, not nan\.$"):
        robot.drive_by(math.nan)
    with pytest.raises(BridgeError, match=r"^`robot.turn_by`: `speed` must be greater than 0, not -0\.2: "):
        robot.turn_by(1, speed=-0.2)
    with pytest.raises(BridgeError, match=r"^`robot.say`: A text has at most 200 characters, not 300\.$"):
        robot.say("x" * 300)
    drive(0.1)
    assert [task.status for task in (robot.drive_by, robot.turn_by, robot.say)] == [None] * 3


def test_a_text_is_on_the_display_until_it_is_read_or_no_longer_wanted(bridge, brick, drive):
    task = ask(bridge, "say", "Grüße! I am on my way to you, and will be there soon")
    assert brick.shown == ["Gr??e! I am on my way", "to you, and will be", "there soon"]
    drive(5.1)
    assert task.active
    drive(0.2)
    assert task.succeeded
    ask(bridge, "say", "Here")
    assert brick.shown == ["Here"]
    bridge.requested.drop()
    assert brick.shown == []


def test_a_text_that_comes_when_the_one_before_is_over_is_shown_for_its_own_time(bridge, drive, monkeypatch):
    task, now = ask(bridge, "say", "Here"), bridge._driver.now
    texts = iter(["There"])

    def say_more() -> int:
        for text in texts:
            ask(bridge, "say", text)
        return now()

    monkeypatch.setattr(bridge._driver, "now", lambda: say_more() if now() >= over else now())
    over = now() + 132
    drive(1.4)
    assert task.status == "active"
    drive(1.5)
    assert task.status == "succeeded"
