"""A subscription whose messages cease is too old to drive by, although the set-up does not say when."""

from __future__ import annotations

import math
import os
import signal
import sys
import time
from collections.abc import Callable, Iterable
from itertools import accumulate
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.waiting import until

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.bridges.ros.rhythm import Motion, Rhythm
from lrp_jupyter.live.session import Session

DRIVES = """\
(machine m
  (state s (running [robot.move(linear=0.2)]))
  (state near)
  (on [robot.scan.data < 5] s -> near))
(spawn m s)
"""


def heard(pauses: Iterable[float], rhythm: Rhythm | None = None, since: float = 0.0) -> Rhythm:
    """What a topic is like whose messages come after these pauses."""
    found = Rhythm() if rhythm is None else rhythm
    for now in accumulate(pauses, initial=since):
        found.note(now)
    return found


@given(st.floats(0.001, 10), st.floats(0.3, 0.6), st.integers(0, 30))
def test_a_sensor_is_waited_for_a_second_and_for_a_message_that_was_lost(
    period: float, jitter: float, lost: int
) -> None:
    count = 20 + round(5 / period)
    pauses = [period * (1 + jitter * (-1) ** number) for number in range(2 * count)]
    rhythm = heard(pauses)
    patience = rhythm.patience
    assert patience is not None
    assert 1 + 2 * period <= patience <= 1 + 4 * period
    heard([2 * period], rhythm, rhythm.last or 0.0)
    assert 2 * period * (1 + jitter) < patience, "a lost message is not a silence"


BURST = [0.02] * 100  # of a joystick, for two seconds
SLOWLY = [3.0, 40.0, 0.7, 12.0, 90.0, 5.0, 31.0, 0.2, 65.0, 8.0]


@pytest.mark.parametrize(
    "pauses",
    [[], [0.1] * 15, [0.001] * 300, (*BURST, 3.0) * 20, SLOWLY * 20, [0.1, 0.1, 4.0] * 50],
    ids=["map", "few", "a single burst", "joystick", "orders", "button"],
)
def test_what_comes_by_events_is_never_too_late(pauses: list[float]) -> None:
    assert heard(pauses).patience is None


def test_a_pause_counts_for_some_minutes_and_then_no_more() -> None:
    rhythm = heard([0.1] * 100)
    assert rhythm.patience == pytest.approx(1.2)
    heard([8.0], rhythm, rhythm.last or 0.0)
    assert rhythm.patience == pytest.approx(17)
    heard([0.1] * 5900, rhythm, rhythm.last or 0.0)
    assert rhythm.patience == pytest.approx(17)
    heard([0.1] * 200, rhythm, rhythm.last or 0.0)
    assert rhythm.patience == pytest.approx(1.2)


def test_a_pause_before_the_first_rhythm_or_of_a_robot_that_was_lost_is_none_of_the_topic() -> None:
    rhythm = heard([30.0, *[0.1] * 100])
    assert rhythm.patience == pytest.approx(1.2)
    rhythm.interrupt()
    assert rhythm.last is None
    heard([0.1] * 3, rhythm, 1000.0)
    assert rhythm.patience == pytest.approx(1.2)


def test_what_ceases_as_the_robot_stops_is_missed_from_when_it_moves_again() -> None:
    motion = Motion()
    assert motion.excused(None) == motion.excused(5.0) == 0, "it has never moved"
    motion.note(True, 10.0)
    assert motion.excused(12.0) == 0
    motion.note(False, 20.0)
    assert motion.excused(20.4) == math.inf, "it coasts"
    assert motion.excused(25.0) == motion.excused(18.0) == 0, "it has ceased for another reason"
    motion.note(True, 60.0)
    assert motion.excused(20.4) == pytest.approx(39.6)
    assert motion.excused(60.1) == 0
    motion.note(False, 62.0)  # nothing came, and the robot was stopped because of that
    assert motion.excused(20.4) == 0


def test_a_silence_that_has_a_reason_is_no_pause() -> None:
    rhythm = heard([0.1] * 100)
    rhythm.note((rhythm.last or 0.0) + 60, has_reason=True)
    heard([0.1] * 3, rhythm, (rhythm.last or 0.0) + 0.1)
    assert rhythm.patience == pytest.approx(1.2)
    heard([0.1] * 3, rhythm, 5.0)  # another clock
    assert rhythm.patience == pytest.approx(1.2)


# -- a real ROS 1 ---------------------------------------------------------------------------------


@pytest.mark.ros
def test_a_robot_stands_when_its_scanner_dies_and_drives_when_that_is_back(
    real: Any, connect: Callable[..., RosBridge]
) -> None:
    wheels: list[str] = real.lines(real.start_robot(world="empty"))
    scanner = real.start("/usr/bin/rostopic", "pub", "-r", "20", "/scan", "std_msgs/UInt8", "data: 9")
    real.start("/usr/bin/rostopic", "pub", "-r", "20", "/unused", "std_msgs/UInt8", "data: 9")
    ros = connect(setup={"subscriptions": {"scan": "/scan", "unused": "/unused"}})
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")

    def limit() -> float:
        row = dict(zip(ros.panel().tables[0].columns, ros.panel().tables[0].rows[0], strict=True))
        return float(row["too old after (s)"].partition(" (measured)")[0] or 0)

    def state() -> ConnectionState:
        return ros.status.state

    with Session(DRIVES, bridge=ros, rate=20) as session:
        session.start()
        until(lambda: wheels[-1:] and wheels[-1].endswith(" 0.2"))
        first = until(limit)
        os.killpg(scanner.pid, signal.SIGSTOP)
        silent = time.monotonic()
        until(lambda: wheels[-1].endswith(" 0.0"))
        assert float(wheels[-1].split()[0]) > silent + 0.9 * first, "not before its time"
        assert state() is ConnectionState.STALE
        said = next(notice.text for notice in ros.safety.notices if notice.kind == "stale")
        assert said.startswith("`robot.scan` is stale: its value is ")
        assert "Before, one came every " in said
        assert '`"stale_after": null` in the set-up' in said
        assert "nothing moves the robot" in said
        os.killpg(scanner.pid, signal.SIGCONT)
        until(lambda: wheels[-1].endswith(" 0.2"))
        until(lambda: limit() > 2 * first)
        until(lambda: state() is ConnectionState.CONNECTED)

        ros.safety.forget_notices("stale")
        ros.subscribe("scan", "/scan", stale_after=None)
        until(lambda: ros.describe("scan").age is not None)
        real.end(scanner)
        until(lambda: (ros.describe("scan").age or 0) > 1.5 * first)
        assert {notice.kind for notice in ros.safety.notices}.isdisjoint({"stale"}), "it is never too old"


BASE = """\
import rospy, sys
from geometry_msgs.msg import Twist
from std_msgs.msg import Float64
rospy.init_node("base", disable_rosout=True)
speed = [0.0]
def drive(twist):
    if twist.linear.x != speed[0]:
        speed[0] = twist.linear.x
        print(speed[0], flush=True)
travelled = rospy.Publisher("/travelled", Float64, queue_size=1)
rospy.Subscriber("/cmd_vel", Twist, drive)
print("ready", flush=True)
rate = rospy.Rate(20)
while not rospy.is_shutdown():
    if speed[0]:
        travelled.publish(speed[0])
    rate.sleep()
"""
DRIVEN = """\
(machine m
  (state s (running [robot.move(linear={})] [robot.travelled.age]))
  (state far)
  (on [robot.travelled.data > 9] s -> far))
(spawn m s)
"""


@pytest.mark.ros
@pytest.mark.parametrize("backend", ["rospy"])
def test_an_odometry_that_rests_with_its_robot_holds_up_no_start_and_is_missed_on_the_way(
    real: Any, connect: Callable[..., RosBridge], monkeypatch: pytest.MonkeyPatch
) -> None:
    slack = 3.0  # s; more than the machine holds up the robot
    monkeypatch.setattr("lrp_jupyter.bridges.ros.rhythm._SLACK", slack)
    base = real.start(sys.executable, "-c", BASE, ready=True)
    speeds: list[str] = real.lines(base)
    ros = connect(setup={"subscriptions": {"travelled": {"topic": "/travelled", "type": "std_msgs/Float64"}}})
    ros.publish("move", "/cmd_vel", "geometry_msgs/Twist")

    def stale() -> list[str]:
        return [notice.text for notice in ros.safety.notices if notice.kind == "stale"]

    def limit() -> float:
        return ros.wiring.channels[0].age_limit().seconds or 0.0

    with Session(DRIVEN.format(0.2), bridge=ros, rate=20) as session:
        session.start()
        first = until(lambda: limit() if limit() < math.inf else 0)
        session.edit(DRIVEN.format(0.0))
        until(lambda: speeds[-1:] == ["0.0"])
        until(lambda: (ros.describe("travelled").age or 0) > 1.1 * first)
        assert stale() == []
        session.edit(DRIVEN.format(0.3))
        until(lambda: speeds[-1:] == ["0.3"] and (ros.describe("travelled").age or 9) < first)
        assert stale() == []
        until(lambda: limit() < 2 * first, "the rest was a pause")
        before = len(speeds)
        os.killpg(base.pid, signal.SIGSTOP)
        until(stale)
        os.killpg(base.pid, signal.SIGCONT)
        until(lambda: "0.0" in speeds[before:])  # maybe not for long: what it measures comes again
