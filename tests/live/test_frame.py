from dataclasses import FrozenInstanceError

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.story import robot, started

from lrp_jupyter.bridges.bridge import NullBridge
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.rendering import LONGEST, render
from lrp_jupyter.language.parser import parse
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.running.frame import Frame
from lrp_jupyter.live.running.loop import Loop

LOOKLEFT = ("follower", "looking", "lookalgo", "lookleft")


def make_frame(interpreter, time, status="ready"):
    loop = Loop(interpreter, NullBridge(), VirtualClock(), 10, changed=lambda: None)
    loop.timing.now, loop.status = time, status
    return loop.make_frame()


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


def test_counts_continue_over_restarts_and_rewinds():
    i = started("(machine m (state a) (on [True] a -> a t))(spawn m a)", 3)
    i.reset()
    i.step(0.3)
    i.rewind(1)
    i.step(0.4)
    frame = make_frame(i, 0.4)
    assert (frame.visits, frame.visited_at) == ({("m", "a"): 5}, {("m", "a"): 4})
    assert (frame.fired, frame.fired_at) == ({("m", "t"): 3}, {("m", "t"): 4})
    assert (frame.restarts, frame.restart_reason, frame.revision) == (1, "reset", 1)


def test_a_state_that_an_edit_removed_has_its_count_again_when_the_edit_is_taken_back():
    two = "(machine m (state a) (state b) (ontime 100 a -> b) (ontime 100 b -> a))(spawn m a)"
    i = started(two, 8)
    before = make_frame(i, 0.7).visits["m", "b"]
    i.patch(parse("(machine m (state a))(spawn m a)"))
    i.patch(parse(two))
    for tick in range(8, 12):
        i.step(tick / 10)
    assert make_frame(i, 1.1).visits["m", "b"] < before, "another state of this name"
    i.rewind(5)
    assert make_frame(i, 0.6).visits["m", "b"] == before


def test_a_frame_records_in_which_tick_a_state_was_entered_last_however_late_it_is_made():
    i = started("(machine m (state a) (state b) (ontime 200 a -> b t))(spawn m a)", 10)
    frame = make_frame(i, 0.9)
    assert frame.visited_at == {("m", "a"): 1, ("m", "b"): 3}
    assert frame.fired_at == {("m", "t"): 3}


def test_a_state_was_entered_last_by_whichever_transition_fired_last():
    i = started(
        "(var n := [0])(machine m (state a (onentry [n = n + 1])) (state b) (state c)"
        " (on [n == 2] a -> c u) (eps a -> b t) (eps c -> a) (eps b -> a))(spawn m a)",
        6,
    )
    frame = make_frame(i, 0.5)
    assert frame.visited_at == {("m", "a"): 5, ("m", "b"): 6, ("m", "c"): 4}
    assert frame.visits == {("m", "a"): 3, ("m", "b"): 2, ("m", "c"): 1}


def test_what_was_never_entered_and_never_fired_is_not_in_a_frame():
    i = started("(machine m (state a) (state b) (on [False] a -> b t))(spawn m a)", 2)
    assert (make_frame(i, 0.1).visits, make_frame(i, 0.1).fired) == ({("m", "a"): 1}, {})


def test_counts_belong_to_the_definition_and_are_found_by_a_path_as_spawned_too():
    i = started(
        "(machine k (state s (onentry (spawn l u)) (machine l (state u))))"
        "(machine l (state u))"
        "(machine m (state a (onentry (spawn k s))) (state b (onentry (spawn k s)))"
        " (on [True] a -> b) (on [True] b -> a))"
        "(spawn m a)",
        4,
    )
    frame = make_frame(i, 0.3)
    assert frame.active == (("m", "b", "k", "s", "l", "u"),)
    assert frame.visits == {("m", "a"): 2, ("m", "b"): 2, ("k", "s"): 4, ("k", "s", "l", "u"): 4}
    for state in ("s", "k/s", "m/a/k/s", ("m", "b", "k", "s"), "u", "k/s/l/u", "m/a/k/s/l/u"):
        assert frame.count_of(state) == 4, state
    for state in ("k", "m/c/k/s", "l/u", "m/a/l/u", "m/a/k/t", "x/y/z/s", "m/a/k"):
        assert frame.count_of(state) == 0, state


def test_a_renamed_state_keeps_its_count_and_so_does_a_renamed_transition():
    i = started("(machine m (state a) (state b) (on [True] a -> b t) (eps b -> a))(spawn m a)", 3)
    i.rename("state", "m/b", "c")
    i.rename("machine", "m", "n")
    i.step(0.3)
    frame = make_frame(i, 0.3)
    assert frame.visits == {("n", "a"): 2, ("n", "c"): 2}
    assert frame.fired[("n", "t")] == 2


COUNTED = "(machine m (state a) (state b) (ontime 100 a -> b) (eps b -> a))(spawn m a)"


def test_a_transition_keeps_its_count_when_its_delay_is_edited():
    i = started(COUNTED, 4)
    before = make_frame(i, 0.3).fired
    i.patch(parse(COUNTED.replace("100", "300")))
    assert len(before) == 2
    assert make_frame(i, 0.3).fired == before
    for tick in range(4, 8):
        i.step(tick / 10)
    assert sorted(make_frame(i, 0.7).fired.values()) == [2, 3]


def test_what_an_edit_removes_loses_its_counts():
    i = started(COUNTED, 3)
    i.patch(parse(COUNTED.replace(" (ontime 100 a -> b)", "")))
    frame = make_frame(i, 0.2)
    assert (len(frame.fired), frame.visits) == (1, {("m", "a"): 2, ("m", "b"): 1})
    i.patch(parse("(machine m (state a))(spawn m a)"))
    frame = make_frame(i, 0.2)
    assert (frame.fired, frame.visits) == ({}, {("m", "a"): 2})
    i.patch(parse(COUNTED))
    assert make_frame(i, 0.2).visits == {("m", "a"): 2}


def test_a_restart_by_an_edit_drops_the_counts_of_what_is_gone():
    i = started(COUNTED)
    patch = i.patch(parse("(machine m (state b))(spawn m b)"))
    i.step(0.1)
    assert patch.restarted
    assert make_frame(i, 0.1).visits == {("m", "b"): 1}


def test_going_back_over_a_rename_restores_old_names_and_keeps_counts():
    i = started(COUNTED, 3)
    i.rename("state", "m/b", "c")
    i.step(0.3)
    i.step(0.4)
    assert make_frame(i, 0.4).visits == {("m", "a"): 3, ("m", "c"): 2}
    i.rewind(2)
    assert make_frame(i, 0.2).visits == {("m", "a"): 3, ("m", "b"): 2}


def test_going_back_over_renames_maps_elements_and_keeps_their_issues():
    text = "(machine m (state a (running [1 / 0])) (state b) (on [False] a -> b t)) (spawn m a)"
    i = started(text, 2)
    i.rename("machine", "m", "n")
    i.rename("state", "n/a", "c")
    i.step(0.2)
    i.patch(parse(i.program.text + "(machine new (state x))"))
    i.rename("state", "n/c", "a")
    i.step(0.3)
    i.rewind(2)
    revision, back = make_frame(i, 0.1).moved[-1]
    assert revision == i.revision
    assert back.path("state", ("n", "a")) == ("m", "a")
    assert back.path("transition", ("n", "t")) == ("m", "t")
    assert back.path("machine", ("new",)) == ("new",)
    (issue,) = i.issues
    assert (issue.element.path, issue.resolved) == (("m", "a"), False)


def test_going_back_over_an_edit_twice_undoes_only_the_newer_renames():
    i = Interpreter(parse("(machine m (state a)) (spawn m a)"))
    for tick, name in enumerate("bcd"):
        i.step(tick / 10)
        i.rename("state", f"m/{'abc'[tick]}", name)
    i.rewind(0)
    assert make_frame(i, 0.2).moved[-1][1].path("state", ("m", "d")) == ("m", "c")
    i.rewind(1)
    assert make_frame(i, 0.1).moved[-1][1].path("state", ("m", "c")) == ("m", "b")
    before = i.moved
    i.step(0.2)
    i.rewind(1)
    assert i.moved == before


def test_a_fault_and_an_edit_elsewhere_leave_the_counts_as_they_are():
    text = "(var n := [0])(machine m (state a (onentry [1 / n])) (state b) (eps a -> b) (eps b -> a))"
    i = started(text + "(spawn m a)", 4)
    i.patch(parse(text + "(spawn m a)(machine other (state x))"))
    i.step(0.4)
    assert make_frame(i, 0.4).visits == {("m", "a"): 3, ("m", "b"): 2}


PROGRAM = """(var n := [10 ** 400])(var ok := [True])(var speed := [0.5])(var gone := [1 / 0])
(machine m (state a (onentry (spawn k s)) (machine k (state s))) (state b) (on [robot.bumper] *-> b hit)
  (on [not robot.bumper] b -> a))
(spawn m a)"""


def test_a_frame_shows_a_moment_of_a_run_and_what_happened_since_the_beginning():
    i = Interpreter(parse(PROGRAM), bot := robot())
    for tick, bot.bumper in enumerate([False, True, False, True]):
        i.step(tick / 10)
    frame = make_frame(i, 0.35, status="running")
    assert (frame.status, frame.rate, frame.tick, frame.time) == ("running", 10.0, 4, 0.35)
    assert frame.active == (("m", "b"),)
    assert (frame.is_active("b"), frame.is_active("k")) == (True, False)
    assert dict(frame.visits) == {("m", "a"): 2, ("m", "a", "k", "s"): 2, ("m", "b"): 2}
    assert (frame.count_of("s"), frame.count_of("m/b"), frame.count_of("c")) == (2, 2, 0)
    assert (frame.fired[("m", "hit")], frame.fired_at[("m", "hit")]) == (2, 4)
    assert frame.variables[("ok",)] == "True"
    assert frame.variables.keys() == {("n",), ("ok",), ("speed",)}, "one without a value is absent"
    assert frame.numbers == {("speed",): 0.5}, "neither truth values nor what is no float"
    assert [issue.code for issue in frame.issues] == ["LRP601"]
    assert frame.program is i.program
    with pytest.raises(TypeError):
        frame.visits[("m", "a")] = 3
    i.step(0.4)
    assert frame.tick == 4


def test_applied_edits_are_counted_and_others_have_a_reason():
    i = started(PROGRAM)
    i.patch(parse(PROGRAM + "; the same"))
    i.rename("state", "m/b", "c")
    assert (i.revision, i.patch_reason, i.restarts) == (2, "", 0)
    i.patch(parse(PROGRAM.replace("state a", "state aa")))
    assert i.revision == 2
    assert "The old program keeps running." in i.patch_reason
    i.patch(parse(PROGRAM.replace("m a", "m b")))
    assert (i.revision, i.restarts) == (3, 1)
    assert i.restart_reason == i.patch_reason == "`(spawn m a)` was changed or removed."
    i.reset()
    assert (i.restarts, i.restart_reason) == (2, "reset")


def test_an_event_without_a_truth_has_none_and_watching_twice_is_watching_once():
    i = Interpreter(parse("(event odd [5])(machine m (state a) (on odd a -> a))(spawn m a)"))
    i.watch_events()
    i.step(0.0)
    i.step(0.1)
    i.watch_events()
    assert i.event_values == {("odd",): None}


def test_a_value_without_a_text_is_shown_by_its_type():
    class Shy:
        def __repr__(self):
            raise RuntimeError("not today")

    class Fatal:
        def __repr__(self):
            raise SystemExit

    assert render(Fatal()) == "<Fatal: no text, SystemExit>"
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


def test_a_frame_records_the_last_test_of_each_event_once_they_are_watched():
    program = parse(
        "(var n := [0]) (event outer [n > 1])"
        "(machine m (event mine [n == 1]) (event bad [1 / 0]) (event unused [True])"
        " (state a (running [n = n + 1])) (state b) (on outer a -> b) (on bad a -> b) (on mine b -> a))"
        "(spawn m a)"
    )
    i = Interpreter(program)
    i.step(0.0)
    assert make_frame(i, 0.0).events == {}
    i.watch_events()
    i.step(0.1)
    assert make_frame(i, 0.1).events == {("outer",): False, ("m", "bad"): None}
    i.step(0.2)
    assert make_frame(i, 0.2).events == {("outer",): True, ("m", "bad"): None, ("m", "mine"): False}


def test_an_event_has_a_value_in_each_instance_of_its_machine_while_that_runs():
    program = parse(
        "(event far [k > 9]) (var k := [0])"
        "(machine part (var n := [0]) (event near [n > 1])"
        " (state a) (state b) (on near a -> b) (on far a -> b))"
        "(machine m (state one (onentry (spawn part a))) (state two) (ontime 200 one -> two))"
        "(machine o (state one (onentry (spawn part a (var n := [5])))))"
        "(spawn m one) (spawn o one)"
    )
    i = Interpreter(program)
    i.watch_events()
    i.step(0.0)
    left, right = ("m", "one", "part", "near"), ("o", "one", "part", "near")
    assert i.event_values == {left: False, right: True, ("far",): False}
    i.step(0.2)
    assert i.event_values == {right: True, ("far",): False}
