"""Actions and services of a real ROS 1 as tasks: its master, and Debian's actionlib in Python and C++."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from uuid import uuid4

import pytest
from bridges.ros.conftest import Compiling
from support.waiting import until

from lrp_jupyter.bridges.ros import RosBridge, goal_topics
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.live.session import Session

pytestmark = pytest.mark.ros

Connect = Callable[..., RosBridge]
Run = Callable[..., Session]
HERE = Path(__file__).parent
PYTHON = (sys.executable, str(HERE / "action_node.py"))
LIBRARIES = ("actionlib", "roscpp", "rosconsole", "roscpp_serialization", "rostime", "boost_thread")
SETUP = {"actions": {"drive_to": "/move_base"}, "services": {"lamp": "/lamp"}}

GOING = """
(var x := [2.0])
(machine courier
  (state going (running [robot.drive_to(target_pose_pose_position_x=x)]))
  (state there)
  (state failed)
  (on [robot.drive_to.succeeded] going -> there)
  (on [robot.drive_to.failed] going -> failed))
(spawn courier going)
"""


class Base:
    """The robot, in a process of its own: what it has done so far, and what it is to do."""

    def __init__(self, real: Any, process: Any) -> None:
        self.process = process
        self.done: list[str] = real.lines(process)

    def say(self, line: str) -> None:
        self.process.stdin.write(f"{line}\n")
        self.process.stdin.flush()

    def does(self, *lines: str) -> None:
        """Wait until it has done this, and nothing else, since the last time."""
        until(lambda: len(self.done) >= len(lines), lambda: f"it did {self.done}, not {lines}")
        assert self.done == list(lines)
        self.done.clear()

    def signal(self, number: int) -> None:
        os.killpg(self.process.pid, number)


@pytest.fixture
def base(real: Any) -> Base:
    base = Base(real, real.keep(*PYTHON, "full"))
    base.say("reset")
    until(lambda: "reset" in base.done)
    base.done.clear()
    return base


@pytest.fixture(scope="module", autouse=True)
def _compiling(ros_home: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Compiling]]:
    folder = tmp_path_factory.mktemp("robot")
    program, source = str(folder / "action_server"), str(HERE / "action_server.cpp")
    links = [f"-l{library}" for library in LIBRARIES]
    with Compiling(folder, ["g++", "-w", source, "-o", program, *links]) as compiling:
        yield program, compiling


@pytest.fixture(scope="module")
def compiled(_compiling: tuple[str, Compiling]) -> str:
    program, compiling = _compiling
    compiling.wait()
    return program


@pytest.fixture
def run() -> Iterator[Callable[..., Session]]:
    sessions = []

    def start(text: str, bridge: RosBridge, **options: Any) -> Session:
        sessions.append(Session(text, bridge=bridge, **options))
        sessions[-1].start()
        return sessions[-1]

    yield start
    for session in sessions:
        session.close()


def state(session: Session) -> str:
    return session.frame.active[0][-1]


def status(ros: RosBridge) -> tuple[str | None, str]:
    return ros.robot.drive_to.status, ros.robot.drive_to.reason


def test_whatever_ends_the_program_ends_the_goal(base: Base, connect: Connect, run: Run) -> None:
    ros = connect(setup=SETUP)
    session = run(GOING, ros)
    base.does("drives 2.0")
    without = GOING.replace("(running [robot.drive_to(target_pose_pose_position_x=x)])", "")
    for end, begin in (
        (session.pause, session.resume),
        (session.stop_robot, session.resume),
        (ros.disarm, ros.arm),
        (lambda: session.edit(without), lambda: session.edit(GOING)),
        (lambda: session.transition_to("there"), lambda: session.transition_to("going")),
    ):
        end()
        base.does("stands")
        begin()
        base.does("drives 2.0")
    session.reset()  # and asked for again, on another topic: the robot may get that before the cancel
    until(lambda: base.done[-1:] == ["drives 2.0"])
    base.done.clear()
    session.close()
    base.does("stands")


def test_what_a_server_says_too_late_twice_or_of_other_goals_changes_nothing(
    base: Base, real: Any, connect: Connect, run: Run
) -> None:
    ros = connect(setup=SETUP)
    session = run(GOING, ros)
    base.does("drives 2.0")
    base.say("hold")
    base.does("holds")
    session.transition_to("there")
    base.does("stands")
    session.transition_to("going")  # the same words, another goal
    base.does("drives 2.0")
    base.say("confirm")  # the one before is cancelled only now
    base.say("feedback 1.0")
    until(lambda: ros.robot.drive_to.feedback)
    assert (state(session), status(ros)) == ("going", ("active", ""))
    base.say("succeed")
    until(lambda: state(session) == "there")
    session.transition_to("going")
    base.does("stands", "drives 2.0")
    base.say("again")  # the last result, for the second time
    foreign = f"{{goal_id: {{id: {uuid4()}}}, goal: {{target_pose: {{pose: {{position: {{x: 9.0}}}}}}}}}}"
    real.start("/usr/bin/rostopic", "pub", "/move_base/goal", "move_base_msgs/MoveBaseActionGoal", foreign)
    until(lambda: ros.robot.drive_to.status == "cancelled")
    assert ros.robot.drive_to.reason == "another goal came."
    base.does("drives 9.0")
    base.say("succeed")  # of the other client
    base.does("stands")
    assert (state(session), ros.robot.drive_to.status) == ("going", "cancelled")


def test_a_rejected_goal_says_why(base: Base, connect: Connect) -> None:
    ros = connect(setup=SETUP)
    base.say("reject the battery is low")
    base.does("rejects")
    ros.robot.drive_to(target_pose_pose_position_x=1.0)
    until(lambda: latched(ros) == ("rejected", "the battery is low."))
    until(lambda: ros.panel().tables[0].rows[0][-1] == "rejected: the battery is low.")
    assert ros.robot.drive_to.failed


def latched(ros: RosBridge) -> tuple[str | None, str]:
    """What a tick sees."""
    ros.begin_tick(0.0, 0.1)
    ros.end_tick(0.0)
    return status(ros)


def test_a_goal_whose_server_hangs_dies_starts_again_or_is_not_there_is_lost(
    base: Base, real: Any, connect: Connect, monkeypatch: pytest.MonkeyPatch
) -> None:
    patient = goal_topics._SILENT  # a server that is only held up keeps its goal
    ros = connect(setup=SETUP)

    def drive(x: float) -> None:
        latched(ros)  # a tick in which it was stopped is over
        ros.robot.drive_to(target_pose_pose_position_x=x)

    def silence(base: Base, number: int) -> None:
        base.signal(number)
        monkeypatch.setattr(goal_topics, "_SILENT", 1.0)
        until(lambda: "no action server of `/move_base` is heard" in ros.status.sentence)

    def is_heard_again() -> None:
        until(lambda: "is heard" not in ros.status.sentence)
        monkeypatch.setattr(goal_topics, "_SILENT", patient)

    def drives(base: Base, x: float) -> None:
        drive(x)
        until(lambda: base.done[-1:] == [f"drives {x}"])  # rosbridge repeats its first messages to a new one
        base.done.clear()
        base.say("feedback 0.5")
        until(lambda: latched(ros) and ros.robot.drive_to.feedback)

    drives(base, 1.0)
    silence(base, signal.SIGSTOP)
    until(lambda: latched(ros)[0] == "lost")
    assert "has fallen silent" in status(ros)[1]
    base.signal(signal.SIGCONT)
    base.does("stands")  # it was cancelled all the same
    is_heard_again()
    drives(base, 2.0)
    silence(base, signal.SIGKILL)
    until(lambda: latched(ros)[0] == "lost")
    another = Base(real, real.start(*PYTHON, "full", ready=True))
    is_heard_again()
    drives(another, 3.0)
    ros.stop_all()
    another.does("stands")
    silence(another, signal.SIGKILL)
    monkeypatch.setattr(goal_topics, "_AGAIN", 0.5)
    monkeypatch.setattr(goal_topics, "_TRIES", 3)
    drive(4.0)
    until(lambda: latched(ros)[0] == "lost")
    assert status(ros)[1].startswith("No action server of `/move_base` takes the goal")


def test_a_goal_that_was_lost_with_the_connection_is_cancelled_when_it_is_back(
    base: Base, real: Any, connect: Connect, backend: str
) -> None:
    ros = connect(setup=SETUP)
    ros.robot.drive_to(target_pose_pose_position_x=2.0)
    base.does("drives 2.0")
    lose = real.kill_rosbridge if backend == "rosbridge" else real.kill_master
    lose()
    until(lambda: latched(ros)[0] == "lost")
    assert [row[-1] for row in ros.panel().tables[0].rows if row[0] == "drive_to"] != ["active"]
    restore = real.start_rosbridge if backend == "rosbridge" else real.start_master
    restore()
    base.does("stands")


def test_a_service_is_called_once_and_says_why_it_failed(
    base: Base, real: Any, connect: Connect, run: Run
) -> None:
    ros = connect(setup=SETUP)
    text = """
    (machine m
      (state dark (running [robot.lamp(data=True)]))
      (state bright (running [robot.lamp(data=True)]))
      (state off)
      (on [robot.lamp.succeeded] dark -> bright)
      (on [robot.lamp.failed] bright -> off))
    (spawn m dark)
    """
    base.say("slow")
    base.does("slow")
    session = run(text, ros)
    base.does("lamp True")
    ticks = session.frame.tick
    until(lambda: session.frame.tick > ticks + 5)  # it does not wait for the answer
    assert ros.robot.lamp.status == "active"
    base.say("answer")
    until(lambda: state(session) == "off")
    base.does("lamp True")
    session.pause()

    def latched() -> tuple[str | None, str]:
        ros.begin_tick(0.0, 0.1)
        ros.end_tick(0.0)
        return ros.robot.lamp.status, ros.robot.lamp.reason

    ros.robot.lamp(data=True)
    until(lambda: latched() == ("aborted", "«An» is what it is: it's on."))
    ros.robot.lamp(data=False)
    until(lambda: latched()[0] == "succeeded")
    assert ros.robot.lamp.result.message == "off"
    base.does("lamp True", "lamp False")
    base.say("slow")
    base.does("slow")
    ros.robot.lamp(data=True)
    base.does("lamp True")
    base.signal(signal.SIGKILL)
    until(lambda: latched()[0] == "lost")


def test_the_types_of_live_actions_and_services_are_known_and_wrong_ones_are_named(
    base: Base, connect: Connect
) -> None:
    ros = connect()
    shown = until(lambda: {row[0]: row for table in ros.panel().tables[2:] for row in table.rows})
    assert shown["/move_base"] == ("/move_base", "action", "move_base_msgs/MoveBase")
    assert shown["/lamp"][:2] == ("/lamp", "service")
    assert not any(row[0].startswith("/move_base/") for row in ros.panel().tables[1].rows)
    ros.press("pick", row="/move_base")
    drafted = {field.key: field.value for field in ros.panel().fields}
    assert (drafted["variable"], drafted["type"]) == ("move_base", "move_base_msgs/MoveBase")
    ros.press("action", values={"variable": "drive_to", "topic": "/move_base"})
    ros.press("service", values={"variable": "lamp", "topic": "/lamp"})
    until(lambda: [channel.type for channel in ros.wiring.channels if channel.message is not None][1:])
    assert ros.setup["services"] == {"lamp": {"service": "/lamp"}}
    with pytest.raises(BridgeError, match="Did you mean `target_pose`"):
        ros.robot.drive_to(traget_pose={})
    for connect_it, sentence in (
        (lambda: ros.action("a", "/move_base", "std_srvs/SetBool"), "has the type `move_base_msgs/MoveBase`"),
        (
            lambda: ros.action("b", "/elsewhere", "move_base_msgs/MoveBas"),
            "no action type `move_base_msgs/MoveBas`",
        ),
        (lambda: ros.service("c", "/elsewhere", "std_srvs/SetBol"), "no service type `std_srvs/SetBol`"),
    ):
        with pytest.raises(BridgeError, match=sentence):
            connect_it()


def test_a_recorded_navigation_is_repeated_and_sends_no_goal(
    base: Base, connect: Connect, tmp_path: Path
) -> None:
    ros = connect(setup=SETUP)
    text = GOING.replace("(state there)", "(state there (running [robot.lamp(data=True)]))")
    with Session(text, bridge=ros) as session:
        session.open()
        ros.arm()
        with session.record(tmp_path / "run.lrplog"):
            session.start()
            base.does("drives 2.0")
            base.say("feedback 1.5")
            until(lambda: ros.robot.drive_to.feedback)
            session.set_variable("x", 3.0)
            base.does("drives 3.0")
            session.pause()
            base.does("stands")
            session.resume()
            base.does("drives 3.0")
            base.say("succeed")
            until(lambda: state(session) == "there" and ros.robot.lamp.succeeded)
            base.does("stands", "lamp True")
        there = session.frame.active
    again = reproduce(read_recording(tmp_path / "run.lrplog"))
    with again.session as session:
        assert again.difference is None
        assert session.frame.active == there
    base.does()


def test_a_robot_whose_name_another_takes_ends(base: Base, real: Any) -> None:
    real.start(*PYTHON, "full", ready=True)
    until(lambda: base.process.poll() is not None)


@pytest.mark.parametrize("server", ["SimpleActionServer", "SimpleActionServer in C++", "ActionServer"])
def test_a_goal_is_pursued_changed_while_the_robot_drives_and_reached(
    real: Any, connect: Connect, run: Run, server: str, compiled: str
) -> None:
    commands = {"SimpleActionServer": (*PYTHON, "simple"), "ActionServer": (*PYTHON, "full")}
    base = Base(real, real.start(*commands.get(server, (compiled,)), ready=True))
    ros = connect()
    ros.action("drive_to", "/move_base")
    session = run(GOING, ros)
    base.does("drives 2.0" if server != "SimpleActionServer in C++" else "drives 2")
    base.say("feedback 1.5")
    until(lambda: ros.robot.drive_to.feedback)
    assert ros.robot.drive_to.feedback.base_position.pose.position.x == 1.5
    session.set_variable("x", 3.5)
    base.does("drives 3.5")  # it did not stand in between
    base.say("succeed")
    until(lambda: state(session) == "there")
    base.does("stands")
    session.edit(GOING.replace("=x", "=4.5"))
    session.transition_to("going")
    base.does("drives 4.5")
    base.say("abort no path")
    until(lambda: state(session) == "failed")
    base.does("stands")
    assert status(ros) == (None, ""), "it was forgotten when the state was left"
    session.pause()
    latched(ros)
    ros.robot.drive_to(target_pose_pose_position_x=5.5)
    base.does("drives 5.5")
    base.say("abort no path")
    until(lambda: latched(ros) == ("aborted", "no path."))
    base.does("stands")
