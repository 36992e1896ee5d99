from dataclasses import FrozenInstanceError

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lrp_jupyter.interpreter.events import TraceEvent
from lrp_jupyter.interpreter.frame import LONGEST, Frame, Tally, render
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.language.parser import parse

LOOKLEFT = ("follower", "looking", "lookalgo", "lookleft")


def test_a_frame_cannot_be_changed():
    with pytest.raises(FrozenInstanceError):
        Frame().tick = 3


@pytest.mark.parametrize(
    "state", ["lookleft", "looking", "follower/looking", LOOKLEFT, "follower/looking/lookalgo/lookleft"]
)
def test_a_state_is_active_by_name_and_by_path_at_any_depth(state):
    assert Frame(active=(LOOKLEFT,)).is_active(state)


@pytest.mark.parametrize(
    "state", ["follower", "lookalgo", "follower/looking/lookalgo", "moving", "looking/lookalgo"]
)
def test_machines_and_other_states_are_not_active_states(state):
    assert not Frame(active=(LOOKLEFT,)).is_active(state)


def test_the_counts_of_a_tally_go_on_over_restarts():
    tally = Tally()
    for tick in (1, 2, 3):
        tally(TraceEvent("entered", ("m", "a"), tick, tick / 10))
        tally(TraceEvent("fired", ("m", "t"), tick, tick / 10, ("a", "a")))
        tally(TraceEvent("restarted", (), tick, tick / 10, "`a` is active and its `running` changed"))
    assert (tally.visits, tally.fired, tally.fired_at) == ({("m", "a"): 3}, {("m", "t"): 3}, {("m", "t"): 3})
    assert (tally.restarts, tally.restart_reason) == (3, "`a` is active and its `running` changed")


def test_a_value_without_a_text_is_shown_by_its_type():
    class Shy:
        def __repr__(self):
            raise RuntimeError("not today")

    assert "Shy" in render(Shy())
    assert render([Shy()]).startswith("[<Shy")


VALUES = st.recursive(
    st.integers() | st.text() | st.floats() | st.binary() | st.none(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner) | st.sets(st.integers()),
)


@given(VALUES)
def test_rendered_values_are_bounded(value):
    assert len(render(value)) <= LONGEST


@pytest.mark.parametrize(
    "value",
    [10**9000, "x" * 10**6, [[[[[[1]]]]]], list(range(10**5)), {1: {2: {3: {4: 5}}}}],
    ids=["integer", "string", "deep", "long", "dict"],
)
def test_huge_and_deep_values_are_bounded(value):
    assert len(render(value)) <= LONGEST


def test_a_frame_tells_what_each_event_was_at_its_last_test_once_they_are_watched():
    program = parse(
        "(var n := [0]) (event outer [n > 1])"
        "(machine m (event mine [n == 1]) (event bad [1 / 0]) (event unused [True])"
        " (state a (running [n = n + 1])) (state b) (on outer a -> b) (on bad a -> b) (on mine b -> a))"
        "(spawn m a)"
    )
    i = Interpreter(program)
    tally = Tally()
    i.step(0.0)
    i.step(0.1)
    assert tally.frame(i, 0.1).events == {}
    i.watch_events()
    i.step(0.2)
    assert tally.frame(i, 0.2).events == {("outer",): False, ("m", "bad"): None}
    i.step(0.3)
    i.step(0.4)
    assert tally.frame(i, 0.4).events == {("outer",): True, ("m", "bad"): None, ("m", "mine"): False}
