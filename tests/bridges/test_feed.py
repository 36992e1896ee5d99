"""What a bridge is fed: latched, with an age, and a robot that does not drive on old data."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

import pytest
from support.robots import Buggy

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.latched_values import FedValues
from lrp_jupyter.errors import NoDataYet, StaleData
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.live.session import Session


@pytest.fixture
def buggy() -> Buggy:
    """Open and armed."""
    buggy = Buggy()
    buggy.open()
    buggy.arm()
    return buggy


def tick(buggy: Buggy, at: float, *blocks: Callable[[], object]) -> None:
    """Run a tick at a time of the run, which is also that of the sender's clock."""
    buggy.time = 100.0 + at
    buggy.begin_tick(at, 0.1)
    for block in blocks:
        block()
    buggy.end_tick(at)


# -- values ---------------------------------------------------------------------------------------


def test_what_is_declared_is_a_member_before_anything_arrives(buggy):
    light = buggy.describe("light.data")
    assert (light.type, light.unit, light.doc) == ("int", "lx", "0 dark ... 255 bright")
    assert (light.value, light.age, light.absence) == (None, None, "waiting")
    with pytest.raises(NoDataYet, match=r"^`robot\.light\.data` has no data yet\.$"):
        _ = buggy.robot.light.data


def test_a_value_is_a_reading_with_an_age(buggy):
    buggy.feed("light.data", 7)
    assert buggy.robot.light.data == 7
    buggy.time += 0.4
    assert buggy.describe("light.data").age == pytest.approx(0.4)


def test_the_first_value_adds_a_variable_that_was_not_declared(buggy):
    buggy.feed("sound", 3, doc="loudness", unit="dB")
    buggy.feed("sound", 4)
    sound = buggy.describe("sound")
    assert (buggy.robot.sound, sound.doc, sound.unit) == (4, "loudness", "dB")


def test_a_later_call_may_say_more_and_keeps_the_rest(buggy):
    buggy.feed("sound", 3, doc="loudness")
    buggy.feed("sound", 4, unit="dB", stale_after=None)
    buggy.feed("sound", 5)
    sound = buggy.describe("sound")
    assert (buggy.robot.sound, sound.doc, sound.unit) == (5, "loudness", "dB")
    buggy.time += 1000
    assert buggy.robot.sound == 5


def test_a_tick_sees_what_had_arrived_when_it_began(buggy):
    buggy.feed("light.data", 1)
    buggy.feed("sound", 1)
    seen: list[Any] = []

    def read() -> None:
        seen.append(buggy.robot.light.data)
        buggy.feed("light.data", 2)
        buggy.feed("sound", 2)
        seen.append((buggy.robot.light.data, buggy.robot.sound))  # `sound` is read for the first time

    tick(buggy, 0.0, read)
    assert seen == [1, (1, 1)]
    assert buggy.robot.sound == 2, "between ticks a person sees what is newest"
    tick(buggy, 0.1, lambda: seen.append((buggy.robot.light.data, buggy.robot.sound)))
    assert seen[-1] == (2, 2)


def test_values_arrive_on_any_thread(buggy):
    def send(number: int) -> None:
        for value in range(200):
            buggy.feed(f"sensor{number}.data", value)

    threads = [threading.Thread(target=send, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [getattr(buggy.robot, f"sensor{number}").data for number in range(8)] == [199] * 8


def test_what_arrives_after_the_end_is_left_out(buggy):
    buggy.feed("light.data", 7)
    buggy.close()
    buggy.feed("light.data", 8)
    buggy.feed("sound", 8)
    assert buggy.members() == ()
    buggy.open()
    assert [member.name for member in buggy.members() if member.kind == "variable"] == [
        "light.data",
        "battery",
    ]
    with pytest.raises(NoDataYet):
        _ = buggy.robot.light.data


@pytest.mark.parametrize("wrong", [0, -1.0, float("nan")])
def test_a_limit_of_age_is_a_positive_number(buggy, wrong):
    with pytest.raises(ValueError, match=r"`x`: `stale_after` is a number of seconds above 0, or None"):
        buggy.feed("x", 1, stale_after=wrong)


def test_a_limit_of_age_needs_an_age(buggy):
    with pytest.raises(ValueError, match=r"`x`: `stale_after` needs an `age`; or `feed` the values\."):
        buggy.add_variable("x", lambda: 1, stale_after=0.5)


# -- old data -------------------------------------------------------------------------------------


def test_an_old_value_is_no_reading(buggy):
    buggy.feed("light.data", 7)
    buggy.time += 1.0
    assert buggy.robot.light.data == 7
    buggy.time += 0.4
    with pytest.raises(StaleData, match=r"^`robot\.light\.data` is stale: its value is 1\.4 s old\.$"):
        _ = buggy.robot.light.data
    assert buggy.describe("light.data").absence == "stale, 1.4 s old"
    buggy.feed("light.data", 8)
    assert buggy.robot.light.data == 8


def test_the_age_is_that_of_the_stamp(buggy):
    buggy.fed.wall_clock = lambda: 5000.0
    buggy.feed("light.data", 7, stamp=4999.5)
    assert buggy.describe("light.data").age == 0.5
    buggy.feed("light.data", 7, stamp=4992.0)  # it was 8 s on its way, and has just arrived
    with pytest.raises(StaleData, match=r"8\.0 s old"):
        _ = buggy.robot.light.data
    buggy.feed("light.data", 7, stamp=5003.0)  # the other clock is ahead
    assert buggy.describe("light.data").age == 0.0


def test_a_value_that_may_be_old_stays(buggy):
    buggy.feed("battery", 0.8)
    buggy.feed("light.data", 7)
    buggy.time += 3600
    buggy.feed("light.data", 7)
    tick(buggy, 3600.0, lambda: buggy.robot.move(linear=0.2))
    assert buggy.robot.battery == 0.8
    assert buggy.calls == [0.2]


def test_a_robot_with_old_data_is_stopped_once_and_moves_again_by_itself(buggy):
    def drive() -> None:
        buggy.robot.move(linear=0.2)

    buggy.feed("light.data", 7)
    tick(buggy, 0.0, drive)
    assert buggy.calls == [0.2]
    for number in range(11, 31):
        tick(buggy, number / 10, drive)
    assert buggy.calls == [0.2, "stop"]
    assert buggy.status.state is ConnectionState.STALE
    assert buggy.status.sentence == "`robot.light.data` is stale: its value is 3.0 s old."
    assert buggy.safety.commands[-1].sent is False
    (notice,) = [notice for notice in buggy.safety.notices if notice.kind == "stale"]
    assert notice.text == (
        "`robot.light.data` is stale: its value is 1.1 s old. Until new data arrive, nothing moves the robot."
    )
    buggy.feed("light.data", 8)
    tick(buggy, 3.1, drive)
    assert buggy.calls == [0.2, "stop", 0.2]
    assert buggy.status.state is ConnectionState.CONNECTED


def test_with_old_data_the_robot_may_stop_and_do_what_does_not_move_it(buggy):
    buggy.add_method("spin", lambda: buggy.calls.append("spin"), "turn", velocity=True)
    buggy.feed("light.data", 7)
    tick(buggy, 1.1)
    del buggy.calls[:]
    robot = buggy.robot
    tick(buggy, 1.2, robot.beep, lambda: robot.move(linear=0), robot.spin, lambda: robot.move(linear=1))
    assert buggy.calls == ["beep", 0]


def test_a_robot_that_was_never_heard_does_not_drive(buggy):
    def drive() -> None:
        buggy.robot.move(linear=0.2)

    tick(buggy, 0.0, drive)
    tick(buggy, 1.0, drive)
    assert buggy.calls == [0.2, 0.2], "it may take a moment"
    tick(buggy, 1.1, drive)
    tick(buggy, 1.2, drive)
    assert buggy.calls == [0.2, 0.2, "stop"]
    assert buggy.status.state is ConnectionState.WAITING
    assert buggy.status.sentence == "`robot.light.data`: nothing has arrived yet."
    buggy.feed("light.data", 7)
    tick(buggy, 1.3, drive)
    assert buggy.calls[-1] == 0.2


def test_another_run_waits_for_the_first_value_no_longer_than_the_first_run(buggy):
    tick(buggy, 100.0)
    for at in (0.0, 1.0, 1.1, 1.2):
        tick(buggy, at, partial(buggy.robot.move, linear=at))
    assert buggy.calls == [0.0, 1.0, "stop"]


def test_an_event_with_old_data_does_not_occur_and_is_no_issue():
    text = """(machine m (state a) (state b)
      (on [robot.light.data > 5] a -> b bright))
    (spawn m a)"""
    buggy = Buggy()
    with Session(text, buggy, clock=VirtualClock()) as session:
        buggy.feed("light.data", 7)
        buggy.time += 2
        session.run(0.3)
        assert session.frame.active == (("m", "a"),)
        assert session.issues == ()
        assert "is stale: its value is 2.0 s old" in str(session.why_not("bright", at=2))
        buggy.feed("light.data", 7)
        session.run(0.2)
        assert session.frame.active == (("m", "b"),)


def test_in_a_pause_old_data_are_shown_and_nothing_else_happens(buggy):
    buggy.feed("light.data", 7)
    tick(buggy, 0.0)
    buggy.stop_all()
    done, notices = list(buggy.calls), buggy.safety.notices
    buggy.time += 60
    buggy.refresh()
    assert buggy.describe("light.data").absence == "stale, 60 s old"
    assert (buggy.calls, buggy.safety.notices) == (done, notices)
    assert buggy.status.state is ConnectionState.CONNECTED


def test_a_person_may_drive_again_as_soon_as_the_data_are_fresh(buggy):
    buggy.feed("light.data", 7)
    tick(buggy, 1.1)
    buggy.stop_all()
    buggy.safety.rest()
    buggy.robot.move(linear=0.1)
    assert 0.1 not in buggy.calls
    buggy.feed("light.data", 8)
    buggy.robot.move(linear=0.1)
    assert buggy.calls[-1] == 0.1


def test_a_world_of_its_own_has_its_own_time():
    class Toy(Buggy):
        name = "test-toy"
        time_step = 0.01

    toy = Toy()
    toy.open()
    toy.begin_tick(5.0, 0.1)
    toy.feed("light.data", 7)
    toy.end_tick(5.0)
    toy.begin_tick(6.5, 0.1)
    assert toy.describe("light.data").age == 1.5
    assert toy.status.state is ConnectionState.STALE


def test_a_subscription_may_say_itself_how_old_its_value_is(buggy):
    ages = [0.1]
    buggy.add_variable("odom", lambda: (1, 2), "pose", age=lambda: ages[0], stale_after=0.5)
    buggy.feed("light.data", 7)
    tick(buggy, 0.0, lambda: ages.__setitem__(0, 0.6), lambda: buggy.robot.odom)  # no reading dies in a tick
    with pytest.raises(StaleData):
        _ = buggy.robot.odom
    tick(buggy, 0.1)
    assert buggy.status.sentence == "`robot.odom` is stale: its value is 0.6 s old."


# -- the past -------------------------------------------------------------------------------------

DRIVER = """(var dark := [0])
(machine m (state go (running [robot.move(linear=0.2)] [robot.beep()]))
  (state dim)
  (on [robot.light.data < 5] go -> dim night)
  (on [robot.light.data > 5] dim -> go day))
(spawn m go)"""


def test_what_was_not_sent_because_of_old_data_is_not_sent_in_a_replay(tmp_path):
    path, buggy = tmp_path / "run.lrplog", Buggy()
    with Session(DRIVER, buggy, clock=VirtualClock()) as session:
        buggy.arm()
        buggy.feed("light.data", 7)
        with session.record(path):
            session.run(0.5)
            buggy.time += 2
            session.run(0.5)
            why = session.why("robot.move")
            assert "It was not sent: `robot.light.data` is stale: its value is 2.0 s old." in str(why)
            held = next(each.text for each in buggy.safety.notices if each.kind == "held")
            assert held == "`move` was not sent: `robot.light.data` is stale: its value is 2.0 s old."
            buggy.feed("light.data", 9)
            session.run(0.5)
        sent = [(command.name, command.sent) for command in buggy.safety.commands]
    assert [name for name, was_sent in sent if not was_sent].count("move") >= 1
    again = reproduce(read_recording(path))
    assert again.difference is None
    assert [(each.name, each.sent) for each in again.session.bridge.safety.commands] == sent


def test_why_a_robot_stands_that_was_set_in_motion_before_names_the_reading() -> None:
    buggy = Buggy()
    with Session(DRIVER.replace("running", "onentry"), buggy, clock=VirtualClock()) as session:
        buggy.arm()
        buggy.feed("light.data", 7)
        session.run(0.3)
        buggy.time += 2
        session.run(0.2)
        why = "The robot was stopped at 0.3 s: `robot.light.data` is stale: its value is 2.0 s old."
        assert why in str(session.why("robot.move"))


def test_a_tick_whose_sensing_fails_sees_one_world_too(monkeypatch: pytest.MonkeyPatch) -> None:
    buggy = Buggy()
    buggy.open()
    buggy.feed("light.data", 1)
    monkeypatch.setattr(buggy, "sense", lambda now: 1 / 0)
    buggy.begin_tick(0.0, 0.1)
    buggy.feed("light.data", 2)
    seen = buggy.fed.value("light.data")
    buggy.end_tick(0.0)
    assert (seen, buggy.fed.value("light.data")) == (1, 2)
    buggy.close()


def test_who_reads_does_not_wait_for_who_feeds():
    fed = FedValues(None, in_tick=lambda: False)
    fed.put("light.data", 7, None)
    with ThreadPoolExecutor() as others, fed._lock:
        assert others.submit(fed.value, "light.data").result(60) == 7
