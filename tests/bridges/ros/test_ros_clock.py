"""How old a message is by the robot's clock, and how often a program can use one."""

from __future__ import annotations

from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lrp_jupyter.bridges.bridge import NullBridge
from lrp_jupyter.bridges.ros.channel import Channel
from lrp_jupyter.bridges.ros.clock import ProgramPace, RobotClock, Stamps, stamp_of
from lrp_jupyter.bridges.ros.setup import Wire
from lrp_jupyter.bridges.ros.sim_time import SimTime
from lrp_jupyter.bridges.ros.types import Types
from lrp_jupyter.live.session import Session

THERE = 1_800_000_000.0  # the robot's time when it is 0 here


def test_a_message_that_was_long_under_way_is_old() -> None:
    clock = RobotClock()
    assert clock.made_at(THERE, 0.05) == 0.05
    assert clock.made_at(THERE + 1, 9.05) == pytest.approx(1.05, abs=0.01)


def test_one_that_comes_sooner_than_all_before_corrects_the_clock() -> None:
    clock = RobotClock()
    clock.made_at(THERE, 8.0)  # the first one was late, too: nobody can know
    clock.made_at(THERE + 9, 9.0)
    assert clock.made_at(THERE + 2, 10.0) == pytest.approx(2.0, abs=0.01)


@given(st.lists(st.tuples(st.floats(0, 50), st.floats(0, 20)), min_size=1), st.floats(-1e6, 1e6))
def test_a_message_is_never_younger_than_its_arrival_nor_older_than_it_is(
    messages: list[tuple[float, float]], offset: float
) -> None:
    clock = RobotClock()
    for made, delay in messages:
        found = clock.made_at(THERE + offset + made, made + delay)
        assert made - 0.01 <= found <= made + delay + 1e-6


@pytest.mark.parametrize("stamp", [None, 0.0, 17.25])
def test_without_a_stamp_of_a_real_clock_the_arrival_counts(stamp: float | None) -> None:
    clock = RobotClock()
    clock.made_at(THERE, 0.0)
    assert clock.made_at(stamp, 5.0) == 5.0


def test_a_stamp_that_is_minutes_off_is_of_another_clock() -> None:
    clock = RobotClock()
    clock.made_at(THERE, 0.0)
    assert clock.made_at(THERE - 3600, 5.0) == 5.0, "a recording, or a computer whose clock was never set"


def at(seconds: float) -> dict[str, Any]:
    """A message that was made so many seconds after the first."""
    nanoseconds = round(seconds % 1 * 1e9)
    return {"header": {"stamp": {"sec": int(THERE + seconds // 1), "nanosec": nanoseconds}}}


def test_a_clock_that_is_set_back_is_learned_again() -> None:
    stamps = Stamps(RobotClock())
    found = [now - stamps.made_at(at(now if now < 5 else now - 30), float(now)) for now in range(25)]
    assert found[:5] == pytest.approx([0] * 5, abs=0.01)
    assert found[5] == pytest.approx(30, abs=0.01)
    assert found[-5:] == pytest.approx([0] * 5, abs=0.01)


def test_messages_that_stay_old_are_not_a_clock_that_was_set_back() -> None:
    stamps = Stamps(RobotClock())
    stamps.made_at(at(0), 0.0)
    for now in range(1, 60):
        assert now - stamps.made_at(at(now - 8), float(now)) == pytest.approx(8, abs=0.01)


def test_the_clock_of_the_robot_itself_shows_that_it_was_set_back() -> None:
    clock = RobotClock()
    clock.made_at(THERE, 0.0)
    clock.read(THERE + 10 - 5, 10.0)
    assert clock.made_at(THERE + 11 - 5, 11.0) == pytest.approx(11, abs=0.01)
    clock.read(None, 12.0)
    clock.read(17.0, 13.0)
    assert clock.made_at(THERE + 14 - 7, 14.0) == pytest.approx(12, abs=0.01)


def test_two_clocks_may_drift_apart() -> None:
    clock = RobotClock()
    for second in range(0, 36_000, 60):  # 50 parts in a million, for ten hours
        made = clock.made_at(THERE + second * (1 - 5e-5), float(second))
        assert second - made < 0.01


@pytest.mark.parametrize(
    ("message", "stamp"),
    [
        ({"header": {"stamp": {"secs": 12, "nsecs": 500_000_000}}}, 12.5),
        ({"header": {"stamp": {"sec": 12, "nanosec": 0}}}, 12.0),
        (SimpleNamespace(header=SimpleNamespace(stamp=SimpleNamespace(secs=1, nsecs=0))), 1.0),
        ({"header": {"stamp": {"secs": "12"}}}, None),
        ({"header": 3}, None),
        ({"data": 1}, None),
        (None, None),
        (7, None),
    ],
)
def test_the_stamp_of_a_message_is_found_in_its_header(message: Any, stamp: float | None) -> None:
    assert stamp_of(message) == stamp


def test_the_age_of_a_reading_is_that_of_its_stamp(monkeypatch: pytest.MonkeyPatch) -> None:
    now = 0.0
    monkeypatch.setattr("lrp_jupyter.bridges.ros.clock.time", SimpleNamespace(monotonic=lambda: now))
    channel = Channel(Wire("scan", "subscription", "/scan", "sensor_msgs/LaserScan"))
    channel.form = Types().form("sensor_msgs/LaserScan")
    channel.live = True

    def arrive(seconds_late: float) -> float | None:
        stamp = {"sec": int(THERE + now - seconds_late), "nanosec": 0}
        channel.receive({"header": {"stamp": stamp, "frame_id": "base"}, "ranges": [1.0]})
        return channel.age()

    assert arrive(0) == 0
    now = 1.0
    assert arrive(0) == pytest.approx(0, abs=0.01)
    now = 10.0
    assert arrive(8) == pytest.approx(8, abs=0.01)
    now = 11.0
    assert channel.age() == pytest.approx(9, abs=0.01)


# -- the pace of a program ------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("period", "pace"),
    [(1.0, 0.1), (0.1, 0.05), (0.0999, 0.05), (0.05, 0.02), (0.02, 0.01), (0.01, 0.005), (0.001, 0.0)],
)
def test_a_program_can_use_two_messages_in_a_tick(
    period: float, pace: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = 0.0
    monkeypatch.setattr("lrp_jupyter.bridges.ros.clock.time", SimpleNamespace(monotonic=lambda: now))
    watch = ProgramPace()
    assert watch.seconds == 0.02
    for tick in range(12):
        watch.tick()
        now += 5.0 if tick == 6 else period  # a stall changes nothing
    assert watch.seconds == pace


class Elsewhere(NullBridge, offered=False):
    """No robot, in a world with a time of its own."""

    def __init__(self, time: SimTime | None) -> None:
        self.time = time

    @property
    def world_clock(self) -> SimTime | None:
        return self.time


@given(
    st.integers(0, 2 * 10**18),
    st.lists(st.integers(-3 * 10**9, 10**9), max_size=40),
    st.sampled_from([0, 4, 10, 50]),
    st.sets(st.integers(0, 40)),
)
def test_a_session_goes_by_the_time_that_is_told_and_ticks_when_that_says_so(
    start: int, steps: list[int], rate: int, pauses: set[int]
) -> None:
    backwards: list[float] = []
    time = SimTime(backwards.append)
    with Session("(machine m (state s)) (spawn m s)", Elsewhere(time), rate=rate) as session:
        ticks: list[float] = []
        session.on_tick(lambda: ticks.append(session.interpreter.now))
        session.resume()
        session._loop.turn()
        assert not ticks, "no time has come"
        passed, shown = 0, start
        time.tell(shown)
        for number, step in enumerate(steps):
            session._loop.turn()
            if number in pauses:
                session.pause()
            step = max(step, -shown)
            shown += step
            time.tell(shown)
            passed += max(0, step) if number not in pauses else 0
            session.resume()
        session._loop.turn()
        assert time.now() == pytest.approx(passed / 1e9, abs=1e-6)
        assert len(ticks) <= len(steps) + 1
        assert all(before < after for before, after in pairwise(ticks))
        assert time.now() - ticks[-1] < session._loop.timing.period + 1e-6, "none that is due is left out"
        assert len(backwards) == sum(step < 0 for step in _taken(start, steps))


def _taken(start: int, steps: list[int]) -> list[int]:
    """The steps that do not lead before 0."""
    taken = []
    for step in steps:
        taken.append(max(step, -start))
        start += taken[-1]
    return taken


def test_a_session_goes_on_where_it_is_when_a_time_is_found_or_given_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    wall = [100.0]
    monkeypatch.setattr("lrp_jupyter.live.clock.monotonic", lambda: wall[0])
    elsewhere = Elsewhere(None)
    with Session("(machine m (state s)) (spawn m s)", elsewhere) as session:
        session.resume()
        wall[0] += 1.0
        session._loop.turn()
        assert session._loop.timing.now == 1.0
        elsewhere.time = SimTime(lambda _seconds: None)
        wall[0] += 5.0
        session._loop.turn()
        for second in (50, 51):
            elsewhere.time.tell(second * 10**9)
            session._loop.turn()
        assert session._loop.timing.now == 2.0
        elsewhere.time = None
        wall[0] += 0.5
        session._loop.turn()
        wall[0] += 0.5
        session._loop.turn()
        assert session._loop.timing.now == 2.5


@pytest.mark.parametrize(("pace", "patience"), [(0.25, 2.0), (1.0, 0.5), (4.0, 0.5)])
def test_the_watchdog_goes_by_the_wall_however_slow_the_world_is(
    monkeypatch: pytest.MonkeyPatch, pace: float, patience: float
) -> None:
    wall = [100.0]
    monkeypatch.setattr("lrp_jupyter.live.running.timing.perf_counter", lambda: wall[0])
    monkeypatch.setattr("lrp_jupyter.bridges.ros.sim_time.time", SimpleNamespace(monotonic=lambda: wall[0]))
    time = SimTime(lambda _seconds: None)
    with Session("(machine m (state s)) (spawn m s)", Elsewhere(time)) as session:
        session.resume()
        timing, bridge = session._loop.timing, session.bridge
        for tenth in range(1, 50):
            wall[0] += 0.1
            time.tell(round(tenth * 1e8 * pace))
            session._loop.turn()
            assert bridge.check_watchdog(timing.expected()) is None
        last = wall[0]
        wall[0] = last + patience - 0.01
        assert bridge.check_watchdog(timing.expected()) is None
        wall[0] = last + patience + 0.01
        notice = bridge.check_watchdog(timing.expected())
        assert notice is not None
        assert notice.text.startswith("No tick for 0.5 s")
