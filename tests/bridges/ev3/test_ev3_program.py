"""A program drives the emulated brick: in real time, on the session's own thread."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from bridges.ev3.brick import Brick, Hands
from bridges.ev3.conftest import equip
from support.waiting import until

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


pytestmark = pytest.mark.usefixtures("patient")


@pytest.fixture
def brick(make_brick: Callable[..., Brick], clock: Hands) -> Brick:
    """A brick on the loopback, with its motors in virtual time."""
    return equip(make_brick(clock=clock))


@pytest.fixture
def session(brick: Brick, free_udp_port: int, clock: Hands) -> Iterator[Session]:
    """A session that drives it, as quickly as it can."""
    bridge = EV3Bridge("127.0.0.1", port=brick.port, beacon_port=free_udp_port)
    bridge.clock = clock  # type: ignore[method-assign]
    bridge.open()
    bridge.arm()
    with Session(ROVER, bridge=bridge, rate=50) as session:
        session.start()
        yield session
    bridge.close()


def turning(brick: Any) -> list[float]:
    return [motor.turning for motor in brick.motors]


def test_a_bump_sends_the_rover_back(session, brick):
    until(lambda: turning(brick) == [0, 40, 40, 0])
    brick.sensors[0].values[0] = 1.0
    session.wait_for("rover/back", 60)
    until(lambda: turning(brick) == [0, -40, 0, 0])
    assert not session.issues


def test_a_program_that_restarts_again_and_again_connects_once(session, brick):
    until(lambda: turning(brick) == [0, 40, 40, 0])
    threads = threading.active_count()
    for speed in range(96, 101):
        session.edit(ROVER.replace("40", str(speed)).replace("onexit [", f"onexit [{speed}; "))
        session.reset()
    until(lambda: turning(brick) == [0, 100, 100, 0])
    assert brick.connections == 1
    assert threading.active_count() <= threads
    assert not session.issues


def test_a_lost_brick_is_an_issue_while_the_loop_goes_on_and_one_that_is_back_is_used_as_before(
    session, brick
):
    until(lambda: turning(brick) == [0, 40, 40, 0])
    brick.unplug()
    brick.hang_up()
    until(lambda: session.issues)
    (issue,) = session.issues
    assert "connection" in issue.message, "it is closed, or broke with what was on its way"
    until(lambda: "connection" in session.frame.bridge)
    ticks = session.frame.tick
    until(lambda: session.frame.tick >= ticks + 5)
    assert len(session.issues) == 1
    brick.plug_in()
    until(lambda: session.issues[0].resolved)
    assert turning(brick) == [0, 0, 0, 0]
    brick.sensors[0].values[0] = 1.0
    session.wait_for("rover/back", 60)
    until(lambda: turning(brick) == [0, -40, 0, 0])


def test_closing_the_session_stops_the_motors(session, brick):
    until(lambda: turning(brick) == [0, 40, 40, 0])
    session.close()
    until(lambda: turning(brick) == [0, 0, 0, 0])
