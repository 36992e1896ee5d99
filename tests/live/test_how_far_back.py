"""A session remembers 10,000 ticks or 10 minutes, whichever are more, and no more than that needs.

The tests run with a tenth of both: 1,000 ticks or a minute.
"""

import gc
import itertools
import sys
import tracemalloc

import pytest

from lrp_jupyter.interpreter import journal
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.running import checkpoints
from lrp_jupyter.live.session import Session

COUNTER = "(var n := [0])(machine m (state a (running [n += 1])))(spawn m a)"
DRIVER = "(var n := [0])(machine m (state a (running [n += 1] [robot.move(angular=n % 7 / 10)])))(spawn m a)"


@pytest.fixture(autouse=True)
def a_tenth(monkeypatch):
    assert (journal.TICKS, journal.SECONDS, checkpoints._SPACING) == (10_000, 600.0, 200)
    monkeypatch.setattr(journal, "TICKS", 1_000)
    monkeypatch.setattr(journal, "SECONDS", 60.0)
    monkeypatch.setattr(checkpoints, "_SPACING", 20)


@pytest.fixture
def always_rested(monkeypatch):
    """Take checkpoints every so many ticks, however long each of them takes on this machine."""
    monkeypatch.setattr(checkpoints, "_SHARE", 0)


def started(text=COUNTER, bridge="none", rate=100, **options):
    return Session(text, bridge, VirtualClock(), rate, **options)


def reach(session):
    """Return the first tick that can be undone, and the seconds since it."""
    first = session.interpreter.history.ticks.start
    return first, session.frame.time - session.at(first).time


@pytest.mark.slow
@pytest.mark.parametrize("rate", [100, 350])
def test_a_fast_session_remembers_the_last_minute(rate):
    with started(rate=rate) as session:
        session.run(90)
        first, seconds = reach(session)
        assert 59.9 < seconds < 70
        for tick in (first, first + 1, first + 77):
            with session.fork(tick) as fork:
                assert fork.frame.values["n"] == session.at(tick).values["n"] == tick
        session.rewind(session.frame.tick - first)
        assert (session.frame.tick, session.frame.values["n"]) == (first, first)


def test_a_slow_session_remembers_as_many_ticks():
    with started(rate=1) as session:
        session.run(1_500)
        assert 1_000 <= session.interpreter.journal < 1_200


def test_a_session_that_becomes_faster_still_remembers_a_minute():
    with started() as session:
        session.run(70)
        session.rate = 300
        for _ in range(5):
            session.run(6)
            assert reach(session)[1] > 59.9


def test_a_session_that_was_slow_takes_checkpoints_as_often_when_it_is_fast(always_rested):
    with started(rate=0.01) as session:
        session.run(150)
        session.rate = 100
        session.run(90)
        assert len(session._loop.record.checkpoints.all) > 1


def test_a_world_is_remembered_as_long_as_the_program():
    with started(DRIVER, "sim", 20, world="empty") as session:
        session.run(65)
        first, seconds = reach(session)
        assert seconds > 59.9
        there = session.at(first + 1)
        with session.fork(first + 1) as fork:
            assert fork.frame.robot.robots[0].pose == there.robot.robots[0].pose
            assert fork.frame.values["n"] == there.values["n"]
        answer = session.why("robot.move", at=first + 1)
        assert answer.facts["arguments"]["angular"] == pytest.approx((first + 1) % 7 / 10)
        pose = session.at(first).robot.robots[0].pose
        session.rewind(session.interpreter.journal)
        assert session.frame.robot.robots[0].pose == pose


def test_the_world_of_a_slow_session_is_remembered_too():
    with started(COUNTER, "sim", rate=1, world="empty") as session:
        session.run(1_300)
        assert session.interpreter.journal >= 1_000
        session.rewind(session.interpreter.journal)
        assert session.frame.time < 300


@pytest.mark.slow
def test_what_is_remembered_is_dropped_when_no_tick_needs_it(always_rested):
    with started(DRIVER, "sim", world="empty") as session:
        loop = session._loop
        session.run(1)
        for number in range(35):
            session.edit(DRIVER + f"; {number}")
            session.run(2)
        first, _ = reach(session)
        oldest = loop.record.checkpoints.all[0].tick
        assert oldest < first
        assert len(loop.record.moments) == session.frame.tick - oldest
        assert next(iter(loop.record.inputs)).tick >= oldest
        assert session.bridge.safety.commands[0].origin.tick >= oldest - 1
        assert session.bridge.simulation.earliest > oldest - 1000
        with session.fork(first) as fork:
            assert fork.program.text == session.at(first).program.text


def test_a_command_is_known_for_as_long_as_it_holds():
    text = """(machine m (state a (onentry [robot.move(angular=0.1)])) (state b (onentry [robot.move()]))
      (ontime 900000 a -> b)) (spawn m a)"""
    with started(text, "sim", rate=1, world="empty", journal=500) as session:
        session.run(1200)
        assert session.why("robot.move", at=800).facts["arguments"]["angular"] == 0.1


def test_typing_does_not_shorten_what_is_remembered():
    with started(rate=10) as session:
        for number in range(40):
            session.edit(COUNTER + f"; {number}")
            session.run(0.5)
        session.rewind(session.interpreter.journal)
        assert (session.frame.tick, session.frame.time) == (0, 0.0)


def test_a_fork_is_never_far_from_a_checkpoint(always_rested):
    with started() as session:
        for _ in range(8):
            session.run(30)
            ticks = [each.tick for each in session._loop.record.checkpoints.all]
            gaps = [second - first for first, second in itertools.pairwise([*ticks, session.frame.tick])]
            assert max(gaps) <= 250
            assert len(session._loop.record.moments) <= 6_500


@pytest.mark.slow
def test_memory_does_not_grow_after_that(always_rested):
    tracemalloc.start()
    try:
        with started(rate=20) as session:
            session.run(70)
            gc.collect()  # what is kept counts, not what is still to be collected
            before = tracemalloc.get_traced_memory()[0]
            session.run(100)
            gc.collect()
            after = tracemalloc.get_traced_memory()[0]
    finally:
        tracemalloc.stop()
    assert after < 1.2 * before
    assert after < 3_000_000


def test_memory_bounds_what_a_very_fast_session_remembers(monkeypatch, always_rested):
    monkeypatch.setattr(journal, "LONGEST", 90_000)
    with started(rate=1000) as session:
        session.run(10)
        first, seconds = reach(session)
        assert 2 <= seconds < 4
        assert len(session._loop.record.moments) < 9_000
        session.rewind(session.frame.tick - first)
        assert session.frame.values["n"] == first


@pytest.mark.parametrize("ticks", [1, 7, 100])
def test_another_number_of_ticks_is_kept_if_that_is_asked_for(ticks):
    with started(journal=ticks) as session:
        session.run(3)
        assert session.interpreter.journal == ticks
        session.rewind(ticks)
        assert session.frame.values["n"] == 300 - ticks


def calls(function):
    """Call a function; return how many calls that took, generators that continued included."""
    count = 0

    def seen(frame, event, argument):
        nonlocal count
        count += event == "call"

    sys.setprofile(seen)
    try:
        function()
    finally:
        sys.setprofile(None)
    return count


def test_looking_at_the_past_takes_almost_no_memory():
    with started() as session:
        session.run(20)
        tracemalloc.start()
        try:
            session.at(1_900)
            session.timeline()
            assert tracemalloc.get_traced_memory()[0] < 500_000
        finally:
            tracemalloc.stop()


def test_what_is_new_is_found_without_going_through_what_is_old():
    with started(DRIVER, "sim", world="empty") as session:
        session.run(8)
        for _ in range(1_000):
            session.rate = 100
        session.run(1)
        cursor = session.timeline().cursor
        assert len(session.bridge.safety.commands) > 600
        assert len(session._loop.record.inputs) > 1_000
        session.run(0.1)
        assert calls(lambda: session.timeline(cursor)) < 1_000
    with started() as session:
        session.run(20)
        session.at(1_900)
        session.run(0.1)
        assert calls(lambda: session.at(2_009)) < 600
        assert calls(lambda: session.at(20.05)) < 600
