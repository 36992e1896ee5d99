"""`degrees` in blocks: an angle in degrees as radians, unless the program or the notebook has that name."""

import math

import pytest

from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.running.checking import check
from lrp_jupyter.live.session import Session

TURNING = """
(var seen := [0])
(machine m
  (state a (running [seen = degrees(90)]))
  (state b)
  (on [seen > degrees(5000)] a -> b enough))
(spawn m a)
"""


def seen(session):
    return session.variables["seen"]


def session_of(text, bridge=None, **names):
    return Session(text, bridge, clock=VirtualClock(), namespace=names)


def test_an_angle_in_degrees_turns_the_robot():
    text = "(machine m (state a (running [robot.move(angular=degrees(45))]))) (spawn m a)"
    with session_of(text, "sim") as session:
        session.run(seconds=2)
        assert session.bridge.pose[2] == pytest.approx(math.pi / 2, abs=0.1)
        assert session.issues == ()


def test_a_name_of_the_notebook_wins_as_soon_as_it_is_there():
    with session_of(TURNING) as session:
        session.step()
        session.step()
        assert seen(session) == math.pi / 2
        session.namespace["degrees"] = lambda angle: 2
        session.step()
        assert seen(session) == 2
        del session.namespace["degrees"]
        session.step()
        assert seen(session) == math.pi / 2


def test_a_name_of_the_notebook_need_not_be_a_function():
    with session_of(
        TURNING.replace("degrees(90)", "degrees + 1").replace("degrees(5000)", "8"), degrees=3
    ) as session:
        session.step()
        session.step()
        assert seen(session) == 4


def test_it_is_not_written_into_the_namespace():
    names = {}
    with Session(TURNING, clock=VirtualClock(), namespace=names) as session:
        session.step()
        assert names.keys() == {"__builtins__"}


def test_an_import_in_a_block_wins_in_that_block():
    text = TURNING.replace("seen = degrees(90)", "from math import degrees; seen = degrees(math.pi)")
    with session_of(text, math=math) as session:
        session.step()
        session.step()
        assert seen(session) == 180


def test_the_checks_know_it_and_suggest_it():
    assert check(TURNING) == ()
    (finding,) = check(TURNING.replace("degrees(90)", "degreees(90)"))
    assert "Did you mean `degrees`?" in finding.message


def test_a_wrong_argument_is_an_issue_in_a_sentence():
    with session_of(TURNING.replace("(90)", "('x')")) as session:
        session.step()
        session.step()
        assert session.issues[0].message == "TypeError: must be real number, not str"


def test_what_a_condition_compared_with_is_shown():
    with session_of(TURNING) as session:
        session.run(seconds=1)
        reason = session.why_not("enough", at=5)
        assert reason.facts["values"]["degrees(5000)"] == math.radians(5000)


def test_a_copy_repeats_what_the_notebook_had():
    with session_of(TURNING, degrees=lambda angle: angle / 90) as session:
        session.run(seconds=1)
        del session.namespace["degrees"]
        session.run(seconds=1)
        assert seen(session) == math.pi / 2
        with session.fork(at=5) as fork:
            assert seen(fork) == 1
            fork.run(seconds=0.1)
            assert seen(fork) == 1
