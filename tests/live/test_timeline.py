"""The timeline of a session: what happened, in order, and only what is new."""

from collections import deque
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from threading import Thread
from time import sleep

import pytest

from lrp_jupyter import programs
from lrp_jupyter.bridges.interventions import RobotStopped
from lrp_jupyter.live.past.timeline import TimelineCursor
from lrp_jupyter.live.running.inputs import Inputs, Resume
from lrp_jupyter.live.session import Session

PROGRAM = """\
(machine m
  (var n := [0])
  (state a (running [n += 1]))
  (state b (onentry (spawn inner x))
    (machine inner (state x) (state y) (ontime 200 x -> y)))
  (on [n > 4] a -> b go)
  (ontime 1000 b -> a back))
(spawn m a)
"""


def told(session, *kinds, since=None):
    return [each for each in session.timeline(since).happenings if not kinds or each.kind in kinds]


@pytest.fixture
def session():
    with Session(PROGRAM) as session:
        yield session


def test_states_are_entered_and_nested_machines_end(session):
    session.run(3)
    entered = [("/".join(each.state), "/".join(each.lane), each.time) for each in told(session, "entered")]
    assert entered[:4] == [
        ("m/a", "m", 0.0),
        ("m/b", "m", 0.5),
        ("m/b/inner/x", "m/b/inner", 0.5),
        ("m/b/inner/y", "m/b/inner", 0.7),
    ]
    (ended, *_) = told(session, "ended")
    assert (ended.lane, ended.time) == (("m", "b", "inner"), 1.5)
    assert told(session, "entered")[1].by == ("m", "go")


def test_a_name_that_is_changed_outside_the_program_is_told():
    names = {"limit": 100, "steps": []}
    program = PROGRAM.replace("n > 4", "n > limit").replace("n += 1", "n += 1 + len(steps)")
    with Session(program, namespace=names) as session:
        session.run(0.5)
        names["limit"], names["steps"] = 20, [1]
        session.run(0.5)
        del names["steps"]
        session.run(0.1)
        assert [(each.tick, each.text) for each in told(session, "hand")] == [
            (5, "`limit` was set to `20` and `steps` was changed outside the program."),
            (10, "`steps` was deleted outside the program."),
        ]


def test_a_name_that_something_feeds_is_told_once():
    names = {"limit": 100}
    with Session(PROGRAM.replace("n > 4", "n > limit"), namespace=names) as session:
        session.run(0.5)
        cursor = session.timeline().cursor
        for limit in range(101, 130):
            names["limit"] = limit
            session.run(0.1)
            more = told(session, "hand", since=cursor)
            assert len(more) <= 1
            cursor = session.timeline().cursor
        session.run(2)
        names["limit"] = 99
        session.run(0.1)
        assert [each.text for each in told(session, "hand")] == [
            "`limit` was set to `101` outside the program.",
            "`limit` was set to `99` outside the program.",
        ]


def test_a_timeline_is_printed_line_by_line(session):
    session.run(0.9)
    session.edit(PROGRAM.replace("1000", "900"))
    timeline = session.timeline()
    assert repr(timeline) == "<Timeline: 0 to 0.9 s, 5 happenings>"
    assert str(timeline).splitlines() == [
        "0 s: `m/a` was entered.",
        "0.5 s: `m/b` was entered. `go` fired.",
        "0.5 s: `m/b/inner/x` was entered.",
        "0.7 s: `m/b/inner/y` was entered. `200:x->y` fired.",
        "0.8 s: The program was edited.",
    ]


def test_only_what_is_new_is_told_again(session):
    session.run(1)
    first = session.timeline()
    session.run(1)
    more = session.timeline(first.cursor)
    assert more.kept == first.last - 1
    kept = [each for each in first.happenings if each.tick <= more.kept]
    assert [*kept, *more.happenings] == list(session.timeline().happenings)


def test_a_renamed_state_has_its_new_name_everywhere(session):
    session.run(2)
    cursor = session.timeline().cursor
    session.rename("state", ("m", "b"), "waiting")
    again = session.timeline(cursor)
    assert again.kept == -1
    assert ("m", "waiting") in [each.state for each in again.happenings]
    assert ("m", "b") not in [each.state for each in again.happenings]
    assert ("m", "waiting", "inner") in [each.lane for each in again.happenings]


def test_what_people_did_is_marked(session):
    session.run(1)
    session.edit(PROGRAM.replace("n > 4", "n > 5"))
    session.variables["n"] = 1
    session.transition_to("m/a")
    session.teleport_to("b")
    session.fire("back")
    session.run(1)
    session.reset()
    session.pause("A person wanted it.")
    session.run(1)
    marks = [(each.kind, each.text) for each in told(session, "edit", "hand", "restart", "pause")]
    assert marks == [
        ("edit", "The program was edited."),
        ("hand", "`m/n` was set."),
        ("hand", "`a` was entered by hand (Transition here)."),
        ("hand", "`b` was entered by hand (Teleport here), without running actions."),
        ("hand", "`a` was entered by hand (Fire now)."),
        ("restart", "The program was reset."),
    ]


def test_a_breakpoint_is_marked():
    with Session(PROGRAM, rate=100, speed=float("inf")) as session:
        session.pause_when("b")
        session.start()
        assert session.wait_for(lambda frame: frame.status == "paused", 120)
        (pause,) = told(session, "pause")
        assert "`b` was entered" in pause.text


def test_an_issue_is_marked_once_while_it_lasts():
    with Session("(machine m (state a (running [1 / 0]))) (spawn m a)") as session:
        session.run(2)
        (issue,) = told(session, "issue")
        assert "zero" in issue.text
        assert issue.time == 0.0


def test_the_commands_of_the_robot_are_marked_where_they_change():
    with Session(programs.load("follower"), "sim", world="line") as session:
        session.run(5)
        commands = told(session, "command")
        assert commands[0].text.startswith("`robot.stop()`, line ")
        assert all(a.text != b.text for a, b in pairwise(commands))


def test_what_is_done_to_the_world_by_hand_is_marked():
    with Session(programs.load("follower"), "sim", world="line") as session:
        session.run(1)
        session.call(lambda: session.bridge.place_robot((0.5, 0.5, 0)))
        session.run(1)
        assert [each.text for each in told(session, "hand")] == ["The robot was moved by hand."]


def test_a_cursor_of_another_run_gets_everything(session):
    session.run(1)
    whole = session.timeline()
    assert session.timeline(TimelineCursor(whole.epoch + 7, 3)) == whole
    assert session.timeline(TimelineCursor(whole.epoch, 10_000)) == whole


def test_a_session_that_has_not_run_has_no_ticks():
    with Session(PROGRAM) as session:
        timeline = session.timeline()
        assert (timeline.first, timeline.last, timeline.happenings) == (1, 0, ())


def test_an_earlier_moment_is_found_by_its_time(session):
    session.run(2)
    assert session.at(1.0).tick == 11
    assert session.at(1.05).tick == 11
    assert session.at(11).time == 1.0
    with pytest.raises(ValueError, match=r"Tick 0 is not remembered\. Ask about ticks 1 to 20\."):
        session.at(0)


def test_inputs_can_be_read_while_another_thread_adds_some():
    inputs = Inputs()
    for tick in (0, 0, 3, 5):
        inputs.keep(inputs.next(tick, tick / 10, Resume()))
    read = iter(inputs)
    next(read)
    inputs.keep(inputs.next(7, 0.7, Resume()))
    assert [entry.tick for entry in read] == [0, 3, 5]
    assert [entry.number for entry in inputs.since(3)] == [3, 4, 5]


def test_the_tick_of_an_input_is_read_when_no_other_is_noted(session):
    """Else a thread that was held up would add an earlier tick after a later one."""
    loop, held = session._loop, session._loop.record.inputs.lock
    with held:
        other = Thread(target=loop.record.note, args=(Resume(),))
        other.start()
        other.join(0.05)
        for _ in range(3):
            loop.tick()
        loop.record.note(Resume())
    other.join()
    assert [entry.tick for entry in loop.record.inputs.since(0)] == [3, 3]


class Contended(deque):
    """A queue in which another thread may be quicker between a look and a grasp."""

    def __len__(self):
        length = super().__len__()
        sleep(0.05)
        return length


def test_the_stop_of_another_thread_is_noted_once_by_whoever_comes_first(session):
    loop = session._loop
    loop.record._stops, noted = Contended([RobotStopped()]), []
    loop.record.written = noted.append
    with ThreadPoolExecutor() as threads:
        for done in [threads.submit(loop.record.prepare, False), threads.submit(loop.record.note, Resume())]:
            done.result()
    assert [entry.what for entry in noted] == [RobotStopped(), Resume()]


def test_a_stop_while_a_checkpoint_is_taken_is_noted_before_the_next_tick(session):
    loop, noted = session._loop, []
    taken, loop.record.written = loop.record.checkpoint, noted.append

    def stopped_meanwhile(running):
        other = Thread(target=session.bridge.stop_all)
        other.start()
        other.join()
        return taken(running)

    loop.record.checkpoint = stopped_meanwhile
    loop.tick()
    loop.tick()
    assert [(entry.tick, entry.what) for entry in noted] == [(1, RobotStopped())]


def test_a_session_that_remembers_nothing_says_so_and_has_a_timeline():
    with Session(PROGRAM, journal=0) as session:
        session.run(1)
        timeline = session.timeline(plots={"m/n": 0})
        assert [(plot.name, plot.values) for plot in timeline.plots] == [("m/n", ())]
        with pytest.raises(ValueError, match=r"^No tick is remembered, because `journal` is 0\.$"):
            session.at(3)
    with Session(PROGRAM) as session:
        with pytest.raises(ValueError, match=r"^No tick has run yet\. Run the program first\.$"):
            session.at(1)
        session.step()
        with pytest.raises(ValueError, match=r"^Tick 99 is not remembered\. Ask about tick 1\.$"):
            session.at(99)


def test_a_number_that_no_float_can_hold_is_no_number_of_the_past_either():
    with Session("(var n := [10 ** 400]) (machine m (state a)) (spawn m a)") as session:
        session.run(1)
        assert session.at(3).numbers == session.frame.numbers == {}


def test_a_command_that_a_stop_held_is_not_said_to_be_one_of_a_disarmed_robot():
    text = "(machine m (state a (running [stop(); robot.move(linear=0.1)]))) (spawn m a)"
    names = {}
    with Session(text, "sim", world="empty", namespace=names) as session:
        names["stop"] = session.bridge.stop_all
        session.run(0.2)
        (command,) = told(session, "command")
        assert command.text.endswith(", line 1, not sent.")
