"""Runs with different values of a variable."""

import pytest

from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.session import Session

TEXT = """(var speed := [0.1])
(machine m
  (state drive (running [robot.move(linear=speed)]))
  (state there (onentry [robot.stop()]))
  (on [robot.odom.x > 0.5] drive -> there arrived))
(spawn m drive)"""


@pytest.fixture
def live():
    with Session(TEXT, "sim", clock=VirtualClock(), world="empty") as session:
        session.run(1)
        yield session


def test_each_value_is_run_from_the_same_moment(live):
    before = live.frame
    trials = live.try_values("speed", [0.1, 0.2, 0.4], seconds=3, until="there")
    slow, middle, fast = trials
    assert slow.reached is None
    assert fast.reached < middle.reached == middle.seconds
    assert [trial.value for trial in trials] == [0.1, 0.2, 0.4]
    assert fast.active == (("m", "there"),)
    assert slow.driven == pytest.approx(0.3, abs=0.03)
    assert (live.frame.tick, live.frame.variables) == (before.tick, before.variables)


def test_each_value_is_run_from_the_same_moment_though_the_session_goes_on(live):
    live.start()
    one, other = live.try_values("speed", [0.1, 0.1], seconds=1, outcome=lambda fork: fork.frame.time)
    assert (one.outcome, one.path) == (other.outcome, other.path)


def test_a_run_begins_in_the_past_if_it_is_asked(live):
    (trial,) = live.try_values("speed", [0.4], seconds=1, at=2)
    assert (trial.seconds, len(trial.path)) == (1.0, 9)


def test_the_outcome_is_what_a_function_makes_of_the_fork(live):
    trials = live.try_values("speed", [0.1, 0.3], 1, outcome=lambda fork: fork.frame.readings["odom.x"])
    assert trials[0].outcome < trials[1].outcome
    assert "outcome" in str(trials)


def test_a_table_has_a_row_and_a_picture_for_each_value(live):
    trials = live.try_values("speed", [0.1, 0.4], seconds=3, until="there")
    text, html = str(trials), trials._repr_html_()
    assert text.splitlines()[0].split("  ")[0] == "`speed`"
    assert "not reached" in text
    assert "time until there" in text
    assert html.count("<tr>") == 3
    assert html.count("<polyline") == 2
    assert trials[:1] == (trials[0],)


def test_a_session_without_a_robot_has_no_ways():
    with Session("(var n := [1])(machine m (state a (running [n *= 2])))(spawn m a)") as session:
        session.run(0.1)
        trials = session.try_values("n", [1, 3], 0.5, lambda frame: frame.values["n"] > 40)
        assert trials[0].reached is None
        assert trials[1].reached == pytest.approx(0.3)
        assert "svg" not in trials._repr_html_()


def test_an_unknown_variable_is_refused(live):
    with pytest.raises(UnknownElementError, match="Did you mean `speed`"):
        live.try_values("sped", [1])
