"""A program drives the emulated brick: in real time, on the session's own thread."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from lrp_jupyter.bridges.ev3 import EV3Bridge
from lrp_jupyter.live.session import Session

ROVER = """
(var speed := [40])
(machine rover
  (event bump [robot.sensor1.read() == 1])
  (state drive
    (onentry [robot.motorB.start_at_speed(speed); robot.motorC.start_at_speed(speed)])
    (onexit [robot.motorB.stop(); robot.motorC.stop()]))
  (state back
    (onentry [robot.motorB.start_at_speed(-speed)]))
  (on bump drive -> back))
(spawn rover drive)
"""


@pytest.fixture
def session(bridge: EV3Bridge) -> Iterator[Session]:
    session = Session(ROVER, bridge=bridge, rate=50)
    session.start()
    yield session
    session.close()


def turning(brick: Any) -> list[float]:
    return [motor.turning for motor in brick.motors]


def test_a_bump_sends_the_rover_back(session: Session, brick: Any, until: Callable[..., None]) -> None:
    until(lambda: turning(brick) == [0, 40, 40, 0])
    brick.sensors[0].values[0] = 1.0
    session.wait_for("rover/back", 60)
    until(lambda: turning(brick) == [0, -40, 0, 0])
    assert not session.issues


def test_a_program_that_restarts_fifty_times_connects_once(
    session: Session, brick: Any, until: Callable[..., None]
) -> None:
    until(lambda: turning(brick) == [0, 40, 40, 0])
    threads = threading.active_count()
    for speed in range(51, 101):
        session.edit(ROVER.replace("40", str(speed)).replace("onexit [", f"onexit [{speed}; "))
        session.reset()
    until(lambda: turning(brick) == [0, 100, 100, 0])
    assert brick.connections == 1
    assert threading.active_count() <= threads
    assert not session.issues


def test_the_loss_of_the_brick_is_an_issue_within_a_second_and_the_loop_keeps_its_rate(
    session: Session, brick: Any, until: Callable[..., None]
) -> None:
    until(lambda: turning(brick) == [0, 40, 40, 0])
    brick.unplug()
    until(lambda: session.issues)
    (issue,) = session.issues
    assert "The brick does not answer" in issue.message
    until(lambda: "The brick does not answer" in session.frame.bridge)  # a moment later
    ticks = session.frame.tick
    until(lambda: session.frame.tick >= ticks + 25)
    assert len(session.issues) == 1


def test_a_brick_that_is_back_is_used_by_the_program_as_before(
    session: Session, brick: Any, until: Callable[..., None]
) -> None:
    brick.unplug()
    until(lambda: session.issues)
    brick.plug_in()
    until(lambda: session.issues[0].resolved)
    assert turning(brick) == [0, 0, 0, 0]
    brick.sensors[0].values[0] = 1.0
    session.wait_for("rover/back", 60)
    until(lambda: turning(brick) == [0, -40, 0, 0])


def test_an_event_on_a_sensor_without_a_value_does_not_occur_and_is_not_an_issue(
    session: Session, brick: Any, until: Callable[..., None]
) -> None:
    brick.sensors[0].values[0] = math.nan
    ticks = session.frame.tick
    until(lambda: session.frame.tick > ticks + 20)
    assert not session.issues
    assert session.frame.active == (("rover", "drive"),)


def test_a_speed_that_is_none_is_an_issue_of_its_block(
    session: Session, brick: Any, until: Callable[..., None]
) -> None:
    session.edit(ROVER.replace("[40]", '["full"]'))
    session.reset()
    until(lambda: session.issues)
    assert session.issues[0].element.path == ("rover", "drive")
    assert "must be a number, not 'full'" in session.issues[0].message


def test_a_pause_stops_the_motors(session: Session, brick: Any, until: Callable[..., None]) -> None:
    until(lambda: turning(brick) == [0, 40, 40, 0])
    session.pause()
    until(lambda: turning(brick) == [0, 0, 0, 0])


def test_closing_the_session_stops_the_motors(
    session: Session, brick: Any, until: Callable[..., None]
) -> None:
    until(lambda: turning(brick) == [0, 40, 40, 0])
    session.close()
    until(lambda: turning(brick) == [0, 0, 0, 0])
