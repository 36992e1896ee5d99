"""What simulated robots are asked for is driven, watched, undone and repeated with the program that asks."""

from __future__ import annotations

import math

import pytest

from lrp_jupyter.bridges.bridge import TaskState
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim.world import BoxSolid, Noise, RobotSpec, World

SQUARE = """
(var side := [0.4])
(machine square
  (state driving (running [robot.drive_by(side)]))
  (state turning (running [robot.turn_by(degrees(90))]))
  (state blocked (onentry [robot.say("Who is there?")]))
  (on [robot.drive_by.succeeded] driving -> turning)
  (on [robot.turn_by.succeeded] turning -> driving)
  (on [robot.drive_by.failed] driving -> blocked))
(spawn square driving)
"""


def room(*solids: BoxSolid, noise: Noise = Noise(), robots: int = 1) -> World:  # noqa: B008
    specs = (RobotSpec((1, 0.5, 0), noise=noise), RobotSpec((1, 1.5, 0), name="other"))
    return World((3, 2), specs[:robots], solids=solids)


def session_of(text: str, world: World) -> Session:
    return Session(text, bridge=SimBridge(world))


def active(session: Session) -> str:
    return session.frame.active[0][-1]


FAILED = "(on [robot.drive_by.failed] driving -> blocked)"


def ended(session: Session) -> TaskState:
    """Run until a way has been given up."""
    assert session.run(until=lambda frame: session.bridge.robot.drive_by.failed, limit=20)
    return session.bridge.requested.state("drive_by")


def test_a_wall_ends_it_with_the_reason_and_the_robot_says_so():
    world = room(BoxSolid((1.3, 0.5, 0.1, 1)))
    task = ended(session_of(SQUARE.replace(FAILED, ""), world))
    assert (task.status, task.reason) == (
        "aborted",
        "The robot has not moved for 1 s, 0.23 m before the goal.",
    )
    assert task.feedback == pytest.approx(0.23, abs=0.01)
    session = session_of(SQUARE, world)
    assert session.run(until=lambda frame: frame.active[0][-1] == "blocked", limit=20)
    session.run(0.1)
    assert session.frame.robot.robots[0].says == "Who is there?"
    session.run(3.0)
    assert session.bridge.robot.say.succeeded
    assert session.frame.robot.robots[0].says == ""


def test_the_same_words_in_the_next_state_begin_where_the_robot_is():
    text = """
    (machine m
      (state a (running [robot.turn_by(1)])) (state b (running [robot.turn_by(1)])) (state c)
      (ontime 700 a -> b) (on [robot.turn_by.succeeded] b -> c))
    (spawn m a)
    """
    session = session_of(text, room())
    session.run(0.7)
    turned = session.bridge.simulated.pose[2]
    assert session.run(until=lambda frame: frame.active[0][-1] == "c", limit=10)
    assert session.bridge.simulated.pose[2] == pytest.approx(turned + 1, abs=0.05)
    assert turned > 0.4


def test_what_was_under_way_for_another_visit_or_a_person_is_not_corrected_but_ends():
    text = """
    (machine m
      (state a (running [robot.drive_by(2)])) (state b) (state c (running [robot.drive_by(0.2)]))
      (ontime 1500 a -> b (effect [robot.drive_by(0.2)]))
      (on [robot.drive_by.succeeded] b -> c))
    (spawn m a)
    """
    session = session_of(text, room())
    session.run(1.5)
    ways = [session.bridge.simulated.pose[0]]
    for until in ("b", "c"):
        session.run(until=lambda frame, state=until: frame.active[0][-1] == state, limit=10)
    ways.append(session.bridge.simulated.pose[0])
    by_hand = session_of(
        "(machine m (state a) (state c (running [robot.drive_by(0.2)]))) (spawn m a)", room()
    )
    by_hand.run(0.1)
    by_hand.bridge.robot.drive_by(2)
    by_hand.run(1.4)
    by_hand.transition_to("c")
    by_hand.run(4.0)
    ways.append(by_hand.bridge.simulated.pose[0])
    assert ways[0] > 1.2
    assert ways[1:] == pytest.approx([ways[0] + 0.2] * 2, abs=0.03)


def test_feedback_says_what_is_left_and_a_number_that_is_dragged_plans_again_without_a_stop():
    session = session_of(SQUARE, room())
    session.run(1.0)
    task, before = session.bridge.robot.drive_by, session.bridge.picture.robots[0].command[0]
    assert task.feedback == pytest.approx(0.25, abs=0.03)
    session.set_variable("side", 0.8)
    session.run(0.2)
    assert session.bridge.picture.robots[0].command[0] == pytest.approx(before)
    assert task.feedback == pytest.approx(0.61, abs=0.03)
    assert session.run(until=lambda frame: frame.active[0][-1] == "turning", limit=20)
    assert session.bridge.simulated.pose[0] == pytest.approx(1.8, abs=0.005)  # 0.8 m from where it began


@pytest.mark.parametrize("how", ["stop_robot", "reset"])
def test_every_stop_lets_it_stand_and_silences_it(how):
    text = SQUARE.replace(
        "(state driving (running", '(state driving (onentry [robot.say("On my way")]) (running'
    )
    session = session_of(text, room())
    session.run(1.0)
    assert session.frame.robot.robots[0].says == "On my way"
    getattr(session, how)()
    picture = session.bridge.picture.robots[0]
    session.bridge.advance(0.1)
    after = session.bridge.picture.robots[0]
    assert (after.command, after.says) == ((0, 0), "")
    assert math.dist(picture.pose[:2], after.pose[:2]) < 0.005


def test_a_stop_by_hand_or_by_the_program_cancels_what_that_robot_was_asked_for_as_on_every_robot():
    text = """
    (var halt := [False])
    (machine m (state s (running
      [robot.drive_by(1)] [robot.say("On my way")] [robot.other.drive_by(1)] [if halt: robot.stop()])))
    (spawn m s)
    """
    session = session_of(text, room(robots=2))
    session.run(1.0)
    robot, first = session.bridge.robot, session.bridge.simulated.pose[0]
    robot.stop()
    session.bridge.begin_tick(1.0, 0.1)
    for task in (robot.drive_by, robot.say):
        assert (task.status, task.reason) == ("cancelled", "The robot was stopped.")
    assert robot.other.drive_by.active
    session.run(1.0)
    assert session.bridge.simulated.pose[0] > first + 0.1, "running has asked again"
    session.set_variable("halt", True)
    session.run(0.2)
    stood = session.bridge.picture.robots
    session.run(1.0)
    now = session.bridge.picture.robots
    assert now[0].pose == pytest.approx(stood[0].pose, abs=0.001)
    assert now[1].pose[0] > stood[1].pose[0] + 0.1


def test_leaving_the_state_lets_it_stand_and_a_move_of_the_next_state_drives_at_once():
    text = """
    (machine m
      (state a (running [robot.drive_by(2)])) (state b (running [robot.move(linear=-0.1)]))
      (ontime 1000 a -> b))
    (spawn m a)
    """
    session = session_of(text, room())
    session.run(1.1)
    assert session.bridge.picture.robots[0].command == (-0.1, 0)
    session.run(0.5)
    assert session.bridge.picture.robots[0].command == (-0.1, 0)
    assert session.bridge.robot.drive_by.status is None


def test_a_velocity_before_it_is_over_by_it_and_its_watchdog_does_not_end_it():
    text = """
    (machine m
      (state a (running [robot.move(linear=0.1)])) (state b (running [robot.turn_by(4)])) (state c)
      (ontime 300 a -> b) (on [robot.turn_by.succeeded] b -> c))
    (spawn m a)
    """
    session = session_of(text, room())
    assert session.run(until=lambda frame: frame.active[0][-1] == "c", limit=10)
    assert not [notice for notice in session.bridge.safety.notices if "watchdog" in notice.kind]


def test_of_two_that_drive_the_later_one_is_done_and_the_other_one_says_why_not():
    text = """
    (machine one (state s (onentry [robot.drive_by(0.5)])))
    (machine two (state s) (state t (onentry [robot.turn_by(1)])) (ontime 500 s -> t))
    (spawn one s) (spawn two s)
    """
    session = session_of(text, room())
    session.run(3.0)
    robot = session.bridge.robot
    assert (robot.drive_by.status, robot.turn_by.status) == ("aborted", "succeeded")
    assert robot.drive_by.reason == "The robot was asked for `turn_by` meanwhile."


def test_every_robot_of_a_world_has_its_own():
    text = """
    (machine m (state s (running
      [robot.drive_by(0.3)] [robot.other.drive_to(0.2, 0.1)] [robot.other.say("Me too")])))
    (spawn m s)
    """
    session = session_of(text, room(robots=2))
    session.run(1.0)
    assert [robot.says for robot in session.frame.robot.robots] == ["", "Me too"]
    session.run(5.0)
    robot = session.bridge.robot
    assert robot.drive_by.succeeded
    assert robot.other.drive_to.succeeded
    first, other = session.bridge.picture.robots
    assert first.pose[:2] == pytest.approx((1.3, 0.5), abs=0.01)
    assert other.pose[:2] == pytest.approx((1.2, 1.6), abs=0.01)


def test_what_cannot_be_done_is_said_at_the_line_that_asks():
    wrong = {
        'robot.drive_by("far")': "`drive_by(metres=…)` must be a number, not 'far' (a text).",
        'robot.turn_by(float("nan"))': "`turn_by(radians=…)` must be a finite number, not nan.",
        "robot.drive_to(1)": "`robot.drive_to(x, y, speed=0.2)`: missing a required argument: 'y'.",
        "robot.drive_by(1, spede=1)": "got an unexpected keyword argument 'spede'. Did you mean `speed`?",
        "robot.drive_by(1, speed=-2)": "`robot.drive_by`: `speed` must be greater than 0, not -2:",
        "robot.drive_by.cancel()": "`robot.drive_by` has no `cancel`; it has `status`, `active`,",
        'robot.say("x" * 300)': "`robot.say`: A text has at most 200 characters, not 300.",
    }
    for call, sentence in wrong.items():
        session = session_of(f"(machine m\n (state s (running [{call}])))\n(spawn m s)", room())
        session.run(0.3)
        (issue,) = session.issues
        assert sentence in issue.message, call
        assert issue.line == 2
        assert session.bridge.picture.robots[0].command == (0, 0)


def test_too_high_a_speed_is_limited_and_that_is_shown():
    session = session_of(SQUARE.replace("(side)", "(side, speed=3)"), room())
    session.run(1.0)
    assert "`drive_by`: speed 3 limited to 0.5." in [notice.text for notice in session.bridge.safety.notices]


@pytest.mark.parametrize("text", ["", " "])
def test_nothing_is_said_at_once_and_ends_what_was_said_before(text):
    asking = '(var text := ["Hello"]) (machine m (state a (running [robot.say(text)]))) (spawn m a)'
    session = session_of(asking, room())
    session.run(0.3)
    session.set_variable("text", repr(text))
    session.run(0.2)
    assert session.bridge.robot.say.succeeded
    assert session.frame.robot.robots[0].says == ""


def test_a_reset_of_the_world_ends_it():
    session = session_of(SQUARE, room())
    session.run(0.5)
    session.bridge.reset_world()
    session.run(0.2)
    assert active(session) == "blocked"


@pytest.mark.parametrize("is_stopped", [False, True])
def test_another_world_ends_what_the_robots_of_the_one_before_were_asked_for(is_stopped):
    text = "(machine m (state s (onentry [robot.other.drive_by(2)] [robot.drive_by(2)]))) (spawn m s)"
    session = session_of(text, room(robots=2))
    session.run(0.5)
    session.call(lambda: session.bridge.load_world(room()))
    assert not is_stopped or session.bridge.stop_all()
    session.run(0.3)
    stopped = ("cancelled", "The robot was stopped.")
    begun_again = ("aborted", "The world has begun again.")
    assert session.bridge.status.state == "connected"
    for name in ("drive_by", "other.drive_by"):
        state = session.bridge.requested.state(name)
        assert (state.status, state.reason) == (stopped if is_stopped else begun_again)
    assert session.bridge.picture.robots[0].command == (0, 0)


def test_the_past_of_a_world_with_fewer_robots_has_its_readings_and_tasks():
    session = session_of(SQUARE, room())
    session.run(0.5)
    session.call(lambda: session.bridge.load_world(room(robots=2)))
    session.run(0.5)
    then = session.at(3).readings
    assert then["drive_by"].active
    assert "odom.x" in then
    assert "other.odom.x" not in then
    assert "other.odom.x" in session.at(9).readings


NOISY = Noise(motor=0.1, light=5, gyro=0.02, odom=0.05, distance=0.01)


def test_a_rewind_and_a_fork_go_on_exactly_as_the_run_did_from_every_tick():
    session = session_of(SQUARE, room(BoxSolid((1.9, 0.9, 0.2, 0.2), push=0.3), noise=NOISY))
    session.run(6.0)

    def seen(run):
        return run.frame.tick, run.frame.robot.robots, run.frame.robot.solids

    present = seen(session)
    for tick in (1, 5, 13, 22, 29, 37, 44, 58):
        fork = session.fork(at=tick)
        fork.run((61 - tick) / 10)
        assert seen(fork) == present
    session.rewind(35)
    session.run(3.5)
    assert seen(session) == present


def test_a_stop_that_a_rewind_has_undone_holds_nothing_back():
    states = "(state a (onentry [robot.drive_by(2)])) (state b (onentry [robot.turn_by(2)]))"
    text = f"(machine m {states}) (spawn m a)"
    session = session_of(text, room())
    session.run(1.0)
    session.edit(text.replace("drive_by(2)", "drive_by(3)"))  # it restarts, and the robot is stopped
    session.rewind(2)
    session.transition_to("b")
    session.run(0.5)
    assert session.bridge.robot.turn_by.active
    fork = session.fork(at=session.frame.tick)
    assert fork.frame.readings["turn_by"] == session.frame.readings["turn_by"]


def test_what_was_left_after_the_tick_to_which_a_rewind_goes_is_under_way_again():
    session = session_of("(machine m (state a (running [robot.drive_by(2)])) (state b)) (spawn m a)", room())
    session.run(1.0)
    session.transition_to("b")
    session.rewind(2)
    session.run(1.0)
    assert (active(session), session.bridge.robot.drive_by.status) == ("a", "active")


def test_after_a_rewind_what_is_asked_for_by_hand_is_of_the_time_to_which_it_went():
    session = session_of(SQUARE, room())
    session.run(2.0)
    session.rewind(10)
    session.bridge.robot.say("Hello")
    session.run(0.5)
    assert session.bridge.robot.say.since == pytest.approx(0.5)
    state = session.at(session.frame.tick).readings["say"]
    fork = session.fork(at=session.frame.tick - 1)
    fork.run(0.1)
    assert fork.frame.readings["say"] == state


def test_what_was_left_ends_before_the_next_one_begins_whoever_looks_at_the_world_in_between(tmp_path):
    text = "(machine m (state a (running [robot.drive_by(2)])) (state b)) (spawn m a)"
    poses = []
    for looks in (False, True):
        path = str(tmp_path / f"{looks}.lrplog")
        session = session_of(text, room())
        with session.record(path):
            session.run(1.0)
            session.transition_to("b")
            if looks:
                assert session.bridge.moment()
            session.bridge.robot.drive_by(0.2)
            session.run(0.5)
        poses.append(session.bridge.simulated.pose)
        assert reproduce(read_recording(path)).difference is None
    assert poses[0] == poses[1]


def test_a_recorded_run_is_repeated_with_its_stops_and_hands(tmp_path):
    path = str(tmp_path / "run.lrplog")
    session = session_of(SQUARE, room(noise=NOISY))
    with session.record(path):
        session.run(2.0)
        session.stop_robot()
        session.run(1.0)
        session.bridge.place_robot((2, 1, 1))
        session.run(1.0)
        session.set_variable("side", 0.1)
        session.run(3.0)
    replay = reproduce(read_recording(path))
    assert replay.difference is None
    assert replay.session.frame.robot == session.frame.robot
