"""A machine that runs in two places: every question and command can mean one of them."""

import json

import pytest
from support.twice import TWICE

from lrp_jupyter import Session
from lrp_jupyter.errors import UnknownElementError
from lrp_jupyter.live.trace import Trace


@pytest.fixture
def session():
    with Session(TWICE) as session:
        session.run(0.8)
        yield session


def test_a_question_is_about_one_instance(session):
    assert session.frame.active[:2] == (("m", "left", "follow", "search"), ("k", "one", "follow", "found"))
    left, one = (session.why_not(f"{place}/follow/hit") for place in ("m/left", "k/one"))
    assert (left.code, one.code) == ("condition-false", "fired")
    assert left.facts["values"]["5 + side"] == 7
    assert session.why_not("done").facts["values"] == {"follow.state": "search"}
    assert "has not been entered" in str(session.why("m/left/follow/found"))
    assert session.why("k/one/follow/found").facts["transition"] == ("follow", "hit")
    with pytest.raises(UnknownElementError, match="`m/left/follow/hit`, `k/one/follow/hit`"):
        session.why_not("follow/hit")


def test_a_question_about_an_instance_that_has_ended_is_about_its_own_end(session):
    session.run(0.4)
    assert session.frame.active[0] == ("m", "right")
    assert "because `follow` was in `found`" in str(session.why("right"))
    ended = session.why_not("m/left/follow/hit")
    assert ended.code == "machine-not-running"
    assert "`done` (line 8) left `left`" in str(ended)
    assert "`one`" not in str(ended), "which only spawns the other one"
    assert session.why_not("follow/hit").facts["state"][:3] == ("k", "one", "follow")
    lost = session.why("k/one/follow/search")
    assert (lost.code, "for 400 ms" in str(lost)) == ("fired", True)


def test_a_condition_that_has_to_hold_says_for_how_long_it_has_held(session):
    session.run(0.2)
    waits = session.why_not("k/one/follow/lost")
    assert (waits.code, waits.facts["delay"]) == ("delay-not-over", 400)
    assert waits.facts["elapsed"] == pytest.approx(200)


def test_a_breakpoint_waits_for_one_instance_through_renames(session):
    session.pause_when("m/left/follow/found")
    session.pause_when("follow/found", after=9)
    session.rename("state", "m/left", "west")
    session.run(0.4)
    assert [found.hits for found in session.breakpoints] == [1, 1]
    assert session.frame.tick == 9
    assert [found.name for found in session.breakpoints] == ["m/west/follow/found", "found"]


def test_a_breakpoint_says_where_it_was_hit_and_where_its_condition_is_meant(session):
    session.pause_when("follow/found")
    session.run(0.5)
    assert str(session.frame.paused_by) == "`found` was entered in `m/left/follow` (breakpoint 1, 1st time)."
    session.remove_breakpoint(1)
    found = session.pause_when(condition="side > 5", machine="m/left/follow")
    assert str(found) == "2: pause when `side > 5` in `m/left/follow` becomes True; 0 hits"


def test_the_timeline_as_text_says_in_which_instance_a_state_was_entered(session):
    lines = str(session.timeline()).splitlines()
    assert "0 s: `m/left/follow/search` was entered." in lines
    assert "0.7 s: `k/one/follow/found` was entered. `hit` fired." in lines
    assert "0 s: `clock/t` was entered." in lines


def test_what_if_says_which_instance_differs_first(session):
    sooner = session.what_if(5, program=TWICE.replace("side := [2]", "side := [-9]"), seconds=0.5)
    assert str(sooner.divergence).endswith(
        "`found` in `m/left/follow` is entered; in the original run it is not."
    )


def test_a_state_is_forced_in_one_instance(session):
    session.teleport_to("k/one/follow/search")
    assert [path[-1] for path in session.frame.active[:2]] == ["search", "search"]
    session.transition_to("follow/found")
    assert "Several states are called `follow/found`" in session.issues[-1].message


def test_a_fork_and_a_rewind_keep_both_instances(session):
    with session.fork(6) as fork:
        assert fork.frame.active[:2] == (("m", "left", "follow", "search"), ("k", "one", "follow", "search"))
        fork.run(0.7)
        session.run(0.4)
        assert fork.frame.active == session.frame.active
        assert fork.frame.values == session.frame.values
    session.pause()
    session.rewind(4)
    assert session.frame.active[1] == ("k", "one", "follow", "found")
    session.resume()
    session.run(0.4)
    assert session.frame.active[:2] == (("m", "right"), ("k", "one", "follow", "search"))


def test_a_path_that_begins_at_a_machine_inside_means_the_instance_that_runs():
    text = """(machine leaf (state x) (state y) (ontime 100 x -> y))
    (machine middle (state on (onentry (spawn leaf x))))
    (machine m (state a (onentry (spawn middle on))) (state b (onentry (spawn middle on)))
      (ontime 500 a -> b))
    (spawn m a)"""
    with Session(text) as session:
        session.run(0.3)
        assert session.why("middle/on/leaf/y").code == "fired"
        assert session.why("m/a/middle/on/leaf/y") == session.why("leaf/y")


def test_an_answer_says_which_instance_it_is_about(session):
    assert str(session.why_not("m/left/follow/hit")).startswith(
        "`hit` in `m/left/follow` (line 4) did not fire at 0.7 s: "
    )
    for state, answer in (
        ("k/one/follow/found", "`found` in `k/one/follow` was entered at 0.7 s by "),
        ("m/left/follow/found", "`found` in `m/left/follow` has not been entered. "),
        ("left", "`left` was entered at 0 s "),
    ):
        assert str(session.why(state)).startswith(answer)


IN_TURN = """(machine move (var n := [0])
  (state go (running [n += 1] [robot.move(linear=0.1)])) (state end)
  (on [n > 3] go -> end over))
(machine main
  (state left (onentry (spawn move go))) (state right (onentry (spawn move go)))
  (on move.end left -> right))
(spawn main left)
"""


def test_an_answer_says_which_instance_ran_where_a_machine_runs_in_two_states_in_turn():
    with Session(IN_TURN, bridge="sim") as session:
        session.pause_when("end")
        for number, state in enumerate(("left", "right"), 1):
            assert not session.run(2)
            count = ("1st", "2nd")[number - 1]
            at = f"in `main/{state}/move`"
            assert session.frame.reason == f"`end` was entered {at} (breakpoint 1, {count} time)."
            assert str(session.why("end")).startswith(f"`end` {at} was entered at ")
            assert f"`over` {at} (line 3) fired at " in str(session.why_not("over"))
            assert f"given by `go.running` {at} (line 2) at " in str(session.why("robot.move"))


def test_an_event_or_a_condition_pauses_in_each_instance_in_which_it_comes_true():
    text = """(machine part (var k := [0]) (event due [k > 3]) (state a (running [k += 1])))
        (machine m (state one (onentry (spawn part a (var k := [2])))))
        (machine o (state one (onentry (spawn part a))))
        (spawn m one) (spawn o one)"""
    with Session(text) as session:
        session.run(0.1)
        session.pause_when(event="due")
        session.pause_when(condition="k > 9", machine="part")
        reasons = []
        for _ in range(4):
            assert not session.run(2)
            reasons.append((session.frame.tick, session.frame.reason.partition(" (")[0]))
            if len(reasons) == 2:
                session.rename("state", "o/one", "two")
        assert session.run(2)
        assert reasons == [
            (2, "The event `due` occurred in `m/one/part`"),
            (4, "The event `due` occurred in `o/one/part`"),
            (8, "`k > 9` became True in `m/one/part`"),
            (10, "`k > 9` became True in `o/two/part`"),
        ]


FAULTY = """(machine part (var k := [0]) (state a (running [k += 1] [1 / max(0, 3 - k)])))
(machine m (state one (onentry (spawn part a (var k := [1])))))
(machine o (state one (onentry (spawn part a))) (state two (onentry (spawn part a))))
(spawn m one) (spawn o one)
"""
FIRST, SECOND = ("m", "one", "part"), ("o", "one", "part")


def test_an_issue_says_in_which_instances_it_occurred_through_renames():
    lines = []
    with Session(FAULTY) as session:
        session.observe(Trace(lines.append))
        session.run(0.2)
        (issue,) = session.issues
        assert issue.instances == (FIRST,)
        assert str(issue).endswith("LRP601 ZeroDivisionError: division by zero (in `m/one/part`)")
        session.run(0.2)
        (issue,) = session.issues
        assert (issue.instances, issue.count) == ((FIRST, SECOND), 5)
        assert str(issue).endswith("(in `m/one/part` and `o/one/part`, 5 times)")
        session.rename("state", "o/one", "west")
        assert session.issues[0].instances == (FIRST, ("o", "west", "part"))
    told = [json.loads(line) for line in lines]
    assert [(each["tick"], each["instance"]) for each in told if each["event"] == "issue"] == [
        (2, "m/one/part"),
        (3, "o/one/part"),
    ]


def test_a_pause_at_an_issue_says_in_which_instance():
    with Session(FAULTY, on_issue="pause") as session:
        reasons = []
        for _ in range(3):
            session.run(1)
            reasons.append(session.frame.reason)
    assert [each.partition(":")[0] for each in reasons] == [
        f"In `{path}/part`" for path in ("m/one", "o/one", "o/one")
    ]


def test_the_timeline_as_text_says_in_which_instance_an_issue_occurred():
    with Session(FAULTY) as session:
        session.run(0.5)
        lines = [line for line in str(session.timeline()).splitlines() if "division" in line]
    assert lines == [
        "0.1 s: In `m/one/part`: ZeroDivisionError: division by zero",
        "0.2 s: In `o/one/part`: ZeroDivisionError: division by zero",
    ]


def test_an_issue_of_a_machine_with_one_place_names_no_instance():
    with Session("(machine m (state a (running [1 / 0]))) (spawn m a)") as session:
        session.step()
        assert session.issues[0].instances == ()
        assert str(session.issues[0]).endswith("division by zero")


def test_a_command_comes_from_the_instance_whose_action_gives_it_by_whatever_name():
    text = """
        (machine m (state left (onentry (spawn part on (var v := [0.1])))) (state idle))
        (machine k (state one (onentry (spawn part on (var v := [0.2])))))
        (machine part (var v := [0]) (state on (running [r = robot; getattr(r, "move")(linear=v)])))
        (spawn m left) (spawn k one)"""
    with Session(text, "sim", world="empty") as session:
        session.run(0.5)
        safety, tick = session.bridge.safety, session.interpreter.tick
        assert [command.origin.machine for command in safety.given_in(tick)] == [
            ("k", "one", "part"),
            ("m", "left", "part"),
        ]
        assert not safety.given_in(tick - 1)
