"""What if another program ran from a moment on?"""

import math
from dataclasses import replace

import pytest
from support.robots import Bare

from lrp_jupyter import programs
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.past.timeline import Happening
from lrp_jupyter.live.past.what_if import Course, Divergence, divergence
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim import load
from lrp_jupyter.sim.world import BoxSolid, Patrol

FOLLOWER = programs.load("follower")
INTO_THE_WALL = "(machine m (state go (running [robot.move(linear=0.2)]))) (spawn m go)"


@pytest.fixture(scope="module")
def session():
    """What if changes nothing: one session for all."""
    with Session(FOLLOWER, "sim", world="line") as session:
        session.run(20)
        yield session


def test_the_recorded_course_is_what_happened(session):
    entered = [
        (each.time, each.state)
        for each in session.timeline().happenings
        if each.kind == "entered" and each.tick > 50
    ]
    what_if = session.what_if(50, seconds=15)
    again = [
        (each.time, each.state)
        for each in what_if.recorded.happenings
        if each.kind == "entered" and each.tick > 50
    ]
    assert again == entered
    assert what_if.divergence is None
    assert (what_if.tick, what_if.begin, what_if.end) == (50, 4.9, 19.9)


def test_the_way_of_the_recorded_course_is_that_of_the_robot(session):
    way = session.what_if(50, seconds=10).recorded.way
    for time, x, y, heading in way[::20]:
        pose = session.at(time - 1e-6).robot.robots[0].pose
        assert math.dist((x, y), pose[:2]) < 0.03
        assert abs(heading - pose[2]) < 0.2


def test_the_first_difference_is_told_with_its_moment(session):
    changed = FOLLOWER.replace("lightlim + 10", "lightlim + 60")
    what_if = session.what_if(50, changed, 15)
    assert what_if.divergence is not None
    assert what_if.divergence.time >= what_if.begin
    assert str(what_if).startswith(f"First difference at {what_if.divergence.time:.1f} s: ")
    before = [each for each in what_if.recorded.happenings if each.time < what_if.divergence.time]
    after = [each for each in what_if.changed.happenings if each.time < what_if.divergence.time]
    said = [(each.time, each.kind, each.state) for each in before]
    assert said == [(each.time, each.kind, each.state) for each in after if each.kind != "edit"]


def test_another_command_in_the_same_states_is_a_difference(session):
    changed = FOLLOWER.replace("linear=forward", "linear=forward / 2")
    assert changed != FOLLOWER
    what_if = session.what_if(49, changed, 5)
    assert "robot.move" in what_if.divergence.text or "a different path" in what_if.divergence.text


def test_white_space_makes_no_difference(session):
    assert session.what_if(50, FOLLOWER + "\n; nothing else\n", 10).divergence is None
    same = session.what_if(50, FOLLOWER, 10)
    assert str(same) == "There is no difference up to 14.9 s, where the comparison ends."


def test_programs_are_compared_with_the_first_of_them(session):
    slow, fast = (FOLLOWER.replace("(var forward := [0.2])", f"(var forward := [{v}])") for v in (0.1, 0.4))
    same, other, first = session.try_programs([slow, fast, slow], 3)
    assert same.recorded == other.recorded == first.recorded == same.changed
    assert (same.divergence, first.divergence) == (None, None)
    assert other.changed == session.what_if(program=fast, seconds=3).changed
    assert other.divergence is not None
    assert len(other.changed.way) == len(other.recorded.way) == 30


def test_the_session_does_not_notice(session):
    before = session.frame.tick, session.frame.time, session.bridge.pose, session.timeline()
    session.what_if(50, INTO_THE_WALL, 10)
    session.what_if(seconds=3)
    session.try_programs([INTO_THE_WALL, FOLLOWER], 3)
    assert (session.frame.tick, session.frame.time, session.bridge.pose, session.timeline()) == before
    assert session.program.text == FOLLOWER


def test_both_courses_begin_at_the_same_moment_of_a_session_that_goes_on():
    program = "(machine m (state a) (state b) (ontime 300 a -> b) (ontime 300 b -> a)) (spawn m a)"
    with Session(program, clock=VirtualClock()) as session:
        session.start()
        session.wait_for("b")
        what_if = session.what_if(program=f"{program} ", seconds=1)
        assert what_if.divergence is None
        assert what_if.recorded.happenings[0] == what_if.changed.happenings[0]
        assert session.interpreter.tick > what_if.tick


@pytest.mark.slow
def test_a_touch_is_told_with_its_moment_and_its_solid():
    with Session(INTO_THE_WALL, "sim", world="line") as session:
        touch = session.what_if(seconds=60).changed.touch
        assert touch is not None
        session.run(touch.time - 0.3)
        assert not session.bridge.touched
        session.run(0.5)
        assert session.bridge.touched == {touch.solid}
        assert str(touch) == f"The robot touches `far wall` at {touch.time:.1f} s."
        assert session.what_if(seconds=1).changed.touch is None  # it touches it already


def test_the_readings_of_a_robot_that_cannot_be_simulated_are_fed():
    program = """\
    (machine m (state a (running [robot.count])) (state b (running [robot.count]))
      (on [robot.count > 15] a -> b))
    (spawn m a)
    """
    counter = Bare(lambda robot: robot.add_variable("count", lambda: len(robot.calls)), notes="sense")
    with Session(program, counter) as session:
        session.run(3)
        what_if = session.what_if(5, program.replace("15", "20"), 2.4)
        assert what_if.open_loop
        assert what_if.changed.way == ()
        entered = [each.time for each in what_if.changed.happenings if each.state == ("m", "b")]
        assert entered == [pytest.approx(2.0)]
        assert what_if.divergence.text == "`b` is not entered; in the original run it is."


def happened(tick, kind, **parts):
    return Happening(tick, tick / 10, kind, **parts)


B = happened(3, "entered", lane=("m",), state=("m", "b"))
C = happened(3, "entered", lane=("m",), state=("m", "c"))
ENDED, RESTARTED = happened(3, "ended", lane=("m",)), happened(3, "restart")
SLOW = happened(3, "command", by=("move",), text="of line 3", call="`robot.move(linear=0.1)`")
FAST = happened(3, "command", by=("move",), text="of line 4", call="`robot.move(linear=0.2)`")


@pytest.mark.parametrize(
    ("recorded", "changed", "text"),
    [
        (B, None, "`b` is not entered; in the original run it is."),
        (None, B, "`b` is entered; in the original run it is not."),
        (B, C, "`c` is entered instead of `b`."),
        (ENDED, None, "`m` does not end; in the original run it does."),
        (None, ENDED, "`m` ends; in the original run it does not."),
        (RESTARTED, None, "The program does not restart; in the original run it does."),
        (SLOW, None, "`robot.move(linear=0.1)` is not commanded; in the original run it is."),
        (SLOW, FAST, "`robot.move(linear=0.2)` is commanded instead of `robot.move(linear=0.1)`."),
        (B, SLOW, "`robot.move(linear=0.1)` is commanded; in the original run it is not."),
    ],
)
def test_the_first_difference_is_told_in_words(recorded, changed, text):
    courses = (Course((each,) if each else (), 0) for each in (recorded, changed))
    assert divergence(*courses) == Divergence(3, 0.3, text)


def test_two_commands_on_other_lines_are_no_difference():
    assert divergence(Course((SLOW,), 0), Course((replace(SLOW, text="of line 7"),), 0)) is None


def test_a_difference_of_the_paths_alone_has_its_tick():
    recorded = Course((), 7, ((0.7, 0, 0, 0), (0.8, 1, 0, 0)))
    changed = Course((), 7, ((0.7, 0, 0, 0), (0.8, 2, 0, 0)))
    assert divergence(recorded, changed) == Divergence(9, 0.8, "The robot takes a different path.")


def test_an_invalid_program_is_refused(session):
    with pytest.raises(ValueError, match="seconds"):
        session.what_if(50, FOLLOWER, 0)
    with pytest.raises(ValueError, match="Tick 5000 is not remembered"):
        session.what_if(5000, FOLLOWER)


def test_what_was_done_and_is_not_possible_in_the_other_program_is_left_out_there():
    text = "(var n := [0]) (machine m (state a (running [n += 1]))) (spawn m a)"
    with Session(text) as session:
        session.run(1)
        session.variables["n"] = 50
        session.run(1)
        other = text.replace("var n", "var k").replace("n += 1", "k += 1")
        what_if = session.what_if(5, other, seconds=1.5)
        assert what_if.end == pytest.approx(1.9)
        with session.fork(5, other, inputs=True) as fork:
            fork.run(1.5)
            assert fork.frame.values["k"] == 15
            assert fork.fault == ""


def test_every_robot_and_what_moves_is_foretold_and_told_apart():
    cart = BoxSolid((3.0, 0.7, 0.1, 0.1), patrol=Patrol(((0.9, 0.0),), 0.1))
    world = replace(load("convoy"), solids=(cart, BoxSolid((0.1, 0.1, 0.1, 0.1))))
    text = programs.load("convoy")
    with Session(text, SimBridge(world), clock=VirtualClock()) as session:
        session.run(seconds=1)
        ahead = session.what_if(seconds=3.0)
        poses = []
        session.run(seconds=3, after_tick=lambda: poses.append(session.bridge.simulation.robots[1].pose))
        assert ahead.divergence is None
        assert [point[1:] for point in ahead.changed.others["follower"]] == poses
        assert ahead.changed.solids == ((0, (pytest.approx(3.4, abs=0.011), 0.7, 0.0)),)
        slower = session.what_if(10, text.replace("eager := [2]", "eager := [1]"), seconds=3.0)
        assert slower.divergence.text.startswith("`robot.follower.move(linear=0.117")
        assert slower.recorded.way == slower.changed.way


def test_the_first_robot_that_goes_another_way_is_named():
    way = ((0.1, 0.0, 0.0, 0.0), (0.2, 0.1, 0.0, 0.0))
    one = Course((), 0, way, others={"follower": way})
    aside = ((0.1, 0.0, 0.0, 0.0), (0.2, 0.1, 0.01, 0.0))
    other = Course((), 0, way, others={"follower": aside})
    assert divergence(one, other) == Divergence(2, 0.2, "`follower` takes a different path.")
    earlier = ((0.1, 0.5, 0.0, 0.0), (0.2, 0.1, 0.0, 0.0))
    assert divergence(one, Course((), 0, aside, others={"follower": earlier})).tick == 1
    assert divergence(one, one) is None
