"""A recorded session is the same in another process: bit for bit, or the first difference is told."""

import gzip
import itertools
import json
import random
import subprocess
import sys
import tracemalloc
from hashlib import sha256
from itertools import count
from pathlib import Path
from threading import Thread

import pytest
from support import wild
from support.robots import Bare
from support.sessions import seen

from lrp_jupyter import logs
from lrp_jupyter.bridges.bridge import Bridge, Twist
from lrp_jupyter.bridges.ros.definitions import HEADERS
from lrp_jupyter.bridges.ros.types import Types
from lrp_jupyter.errors import FileError, LRPError, NoDataYet, UnknownElementError
from lrp_jupyter.interpreter import journal
from lrp_jupyter.live import recording, reproduction
from lrp_jupyter.live.clock import VirtualClock
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
from lrp_jupyter.live.session import Session
from lrp_jupyter.live.stored.json_values import plain, unplain

COUNTER = "(var n := [0])(machine m (state a (running [n += 1])))(spawn m a)"


@pytest.fixture
def record(tmp_path):
    """Record a run."""

    def of(*arguments, seconds=1, **options):
        path = tmp_path / "run.lrplog"
        with Session(*arguments, clock=VirtualClock(), **options) as session, session.record(path):
            session.run(seconds)
        return path

    return of


AGAIN = """
import sys; sys.path.insert(0, {tests!r})
from hashlib import sha256
from support.sessions import seen
from lrp_jupyter.live.recording import read_recording
from lrp_jupyter.live.reproduction import reproduce
again = reproduce(read_recording({path!r}))
print(again.difference, sha256(repr(seen(again.session)).encode()).hexdigest())
"""


@pytest.mark.slow
def test_a_session_is_reproduced_in_another_process(tmp_path):
    path, tests = str(tmp_path / "run.lrplog"), str(Path(wild.__file__).parents[1])
    noise = {"motor": 0.1, "light": 8}
    names = {"gain": 1, "marks": {"a", "b"}}
    with Session(
        wild.ROVING, "sim", clock=VirtualClock(), world="line", noise=noise, namespace=names
    ) as session:
        with session.record(path):
            session.run(2)
            session.edit(session.text.replace("900", "500"))
            session.bridge.place_robot((0.5, 0.5, 1.0))
            session.run(2)
        there = sha256(repr(seen(session)).encode()).hexdigest()
    command = [sys.executable, "-c", AGAIN.format(tests=tests, path=path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == (f"None {there}\n", "")


def test_a_recording_of_another_program_tells_the_first_difference(record):
    path = record(COUNTER)
    again = reproduce(read_recording(path), program=COUNTER.replace("n += 1", "n += 1 + (n > 4)"))
    assert again.difference.tick == 6
    assert again.difference.recorded == {
        "tick": 6,
        "time": 0.5,
        "event": "changed",
        "variable": "n",
        "value": 6,
    }
    assert again.difference.now["value"] == 7
    assert again.session.frame.values["n"] == 15, "and the run goes on to its end"


DRIVER_OF_TWO = """(var speed := [0.2]) (var n := [0])
(machine m
  (state a (running [n += 1]))
  (state b (running [robot.move(linear=speed)]))
  (on [n > 3] a -> b go))
(spawn m a)"""


def test_what_another_program_does_otherwise_tells_more_than_its_variables(record):
    path = record(DRIVER_OF_TWO, "sim", seconds=2)
    told = {
        "[0.2]": "at 0.4 s (tick 5)",  # and not at the start, where `speed` has another value
        "n += 1": "at 0.2 s (tick 3), in the machine `m`",
        "[0])": "at 0 s (tick 1). Recorded: `n` became 1. Replay: `n` became 0.9.",
    }
    for old, new in (("[0.2]", "[0.1]"), ("n += 1", "n += 2"), ("[0])", "[-0.1])")):
        again = reproduce(read_recording(path), program=DRIVER_OF_TWO.replace(old, new))
        again.session.close()
        assert told[old] in str(again.difference)


def test_a_replay_knows_what_a_notebook_had_assigned_when(tmp_path):
    path, names = tmp_path / "run.lrplog", {"limit": 40}
    text = """(var n := [50])
    (machine m (state a) (state b) (ontime 300 a -> b) (on [n > limit] b -> a go))
    (spawn m a)"""
    with Session(text, clock=VirtualClock(), namespace=names) as session, session.record(path):
        session.run(0.3)
        names["limit"] = 60
        session.run(0.5)
        answer, told = session.why_not("go"), str(session.timeline())
    assert "`limit` was set to `60` outside the program." in told
    assert (answer.facts["values"], answer.facts["last_true"]) == ({"n": 50, "limit": 60}, 3)
    with reproduce(read_recording(path)).session as again:
        assert again.why_not("go", at=answer.tick) == answer
        assert str(again.timeline()) == told


def test_a_run_that_depends_on_something_else_is_told_where(record):
    names = {"clock": iter(range(100)).__next__}
    text = COUNTER.replace("n += 1", "n = clock()")
    path = record(text, namespace=names)
    recording = read_recording(path)
    assert recording.start.names == ["clock"]
    again = reproduce(recording, namespace={"clock": iter([0, 1, 2, 7, 8]).__next__})
    assert (again.difference.tick, again.difference.now["value"]) == (4, 7)
    assert str(again.difference).endswith("Recorded: `n` became 3. Replay: `n` became 7.")


def test_what_a_notebook_defined_and_changed_is_recorded(tmp_path):
    path, names = tmp_path / "run.lrplog", {"gain": 1, "more": [2], "twice": lambda value: 2 * value}
    text = COUNTER.replace("n += 1", "n += twice(gain + len(more))")
    with Session(text, clock=VirtualClock(), namespace=names) as session, session.record(path):
        session.run(1)
        names["gain"], names["more"] = 3, (1, float("inf"))
        session.run(1)
        del names["gain"]
        session.run(1)
        values, issues = session.frame.values, session.frame.issues
    recording = read_recording(path)
    assert recording.start.values == {"gain": "1", "more": "[2]"}
    again = reproduce(recording, namespace={"twice": names["twice"], "gain": 7})
    assert again.difference is None
    assert (again.session.frame.values, again.session.frame.issues) == (values, issues)
    first, *rest = path.read_text().splitlines(keepends=True)
    path.write_text(first.replace('"[2]"', '"two()"') + "".join(rest))
    with pytest.raises(FileError, match=r"`.*run\.lrplog`.* 1"):
        read_recording(path)


def test_a_recording_can_be_run_again_up_to_a_time(record):
    path = record(COUNTER, seconds=3)
    again = reproduce(read_recording(path), until=1.25)
    assert (again.session.frame.tick, again.difference) == (13, None)
    assert str(again.session.why_not) is not None


def test_a_compressed_and_a_cut_off_file_are_read_up_to_the_last_whole_line(tmp_path):
    path = tmp_path / "run.lrplog.gz"
    with Session(COUNTER, clock=VirtualClock()) as session, session.record(path):
        session.run(50)
    whole = read_recording(path)
    assert (whole.ticks, whole.cut) == (500, False)
    short = tmp_path / "short.lrplog.gz"
    short.write_bytes(path.read_bytes()[:-400])
    cut = read_recording(short)
    assert 0 < cut.ticks < 500
    assert reproduce(cut).difference is None
    text = gzip.decompress(path.read_bytes())
    (tmp_path / "plain.lrplog").write_bytes(text[:-10])
    assert read_recording(tmp_path / "plain.lrplog").cut


def test_issues_that_were_cleared_are_issues_again_in_a_replay(tmp_path):
    path = tmp_path / "run.lrplog"
    with Session(COUNTER.replace("n += 1", "1/0"), clock=VirtualClock()) as session, session.record(path):
        session.run(1)
        (first,) = session.issues
        session.clear_issues()
        assert session.issues == ()
        session.run(1)
        (again,) = session.issues
        with session.fork(at=3, inputs=True) as fork:
            fork.run(1.8)
            assert fork.issues == session.issues
    assert (first.first_tick, again.first_tick) == (1, 11)
    assert b'"input":"clear issues"' in path.read_bytes()
    replay = reproduce(read_recording(path))
    assert replay.difference is None
    assert replay.session.issues == (again,)


def test_a_transition_that_was_fired_by_hand_is_recorded_and_fired_again(tmp_path):
    path = tmp_path / "run.lrplog"
    text = "(machine m (state a) (state b) (on [False] a -> b go) (ontime 300 b -> a back)) (spawn m a)"
    with Session(text, clock=VirtualClock()) as session, session.record(path):
        session.run(0.5)
        session.fire("go")
        session.run(0.5)
        with session.fork(at=3, inputs=True) as fork:
            fork.run(0.8)
            assert seen(fork) == seen(session)
        present = seen(session)
    lines = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    assert {"tick": 5, "time": 0.5, "input": "fire", "path": ["m", "go"]} in lines
    assert {"tick": 5, "time": 0.5, "event": "forced", "state": "m/b", "how": "fire"} in lines
    again = reproduce(read_recording(path))
    assert again.difference is None
    assert seen(again.session) == present


def test_what_a_program_prints_is_compared(record):
    text = "(machine m (state a (running [print('on')])))(spawn m a)"
    path = record(text)
    assert reproduce(read_recording(path)).difference is None
    other = reproduce(read_recording(path), program=text.replace("on'", "off'"))
    assert str(other.difference).endswith(r"Recorded: 'on\n' was printed. Replay: 'off\n' was printed.")


DRIVER = """(machine m
  (state first (running [robot.move(linear=0.1)]))
  (state second (running [robot.move(linear=0.1, angular=0.5)]))
  (ontime 1500 first -> second) (ontime 4000 second -> first))
(spawn m first)"""


@pytest.mark.parametrize("name", ["run.lrplog", "run.lrplog.gz"])
def test_a_running_session_that_is_edited_and_whose_robot_is_moved_is_reproduced(tmp_path, name, monkeypatch):
    monkeypatch.setattr(logs, "_KEPT", 0.0)  # every line is written at once, also in a short run
    path, options = tmp_path / name, {"world": "line", "noise": {"motor": 0.1}, "seed": 4}
    with Session(DRIVER, "sim", speed=50, **options) as session:
        with session.record(path):
            session.start()
            session.wait_for("second", timeout=120)
            session.edit(DRIVER.replace("0.5", "-0.7").replace("4000", "3000"))
            session.bridge.place_robot((0.5, 0.6, 1.0))
            session.wait_for("first", timeout=120)
            session.pause()
        present = seen(session)
    whole = read_recording(path)
    again = reproduce(whole)
    assert again.difference is None
    assert seen(again.session) == present
    data, ticks = path.read_bytes(), []
    for part in range(70, 100, 2):  # the first line is long
        path.write_bytes(data[: len(data) * part // 100])
        cut = read_recording(path)
        assert reproduce(cut).difference is None
        ticks.append(cut.ticks)
    assert 0 < ticks[0] < ticks[7] < ticks[-1] < whole.ticks


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("", "it contains no complete line"),
        ("hello\n", "line 1: This line is not JSON"),
        ("[1]\n", "line 1: This line is not a JSON object"),
        ('{"tick":1,"event":"started"}\n', "line 1: This is not a recording"),
        ('{"lrplog":99}\n', "of version 99, and this release reads version 3"),
        ('{"lrplog":2,"text":"","filename":"x","bridge":"none"}\n', "of version 2, "),
        ('{"lrplog":3,"text":""}\n', "no `filename` and no `bridge`"),
        (
            '{"lrplog":3,"text":"","filename":"x","bridge":"none"}\n{"input":"dance","tick":0,"time":0}\n',
            "line 2",
        ),
        (
            '{"lrplog":3,"text":"","filename":"x","bridge":"none"}\n{"input":"edit","tick":0,"time":0}\n',
            "line 2",
        ),
    ],
)
def test_what_is_no_recording_is_refused_with_its_line(tmp_path, lines, message):
    path = tmp_path / "run.lrplog"
    path.write_text(lines, encoding="utf-8")
    with pytest.raises(FileError, match=message):
        read_recording(path)


def test_a_missing_file_and_a_session_that_has_run_are_refused(tmp_path):
    with pytest.raises(FileError, match="cannot be read"):
        read_recording(tmp_path / "none.lrplog")
    with Session(COUNTER, clock=VirtualClock()) as session:
        session.run(1)
        kept = tmp_path / "run.lrplog"
        kept.write_text("the recording of another run", encoding="utf-8")
        with pytest.raises(ValueError, match="has run already"), session.record(kept):
            pass
        assert kept.read_text(encoding="utf-8") == "the recording of another run"
    with (
        Session(COUNTER, clock=VirtualClock()) as session,
        pytest.raises(FileError, match="cannot be written"),
        session.record(tmp_path / "no" / "run.lrplog"),
    ):
        pass


class Rover(Bridge):
    """A robot whose readings depend on the time."""

    name = "rover"
    hardware = True
    stop_timeout = None

    def open_interface(self):
        self.now, self.driven = 0.0, []
        self.add_variable("range", self.range)
        self.add_variable("pose", lambda: Pose(self.now, (1, 2)))
        self.add_method("move", self.driven.append, message=Twist, limits={"linear": 0.5})

    def sense(self, now):
        self.now = now

    def range(self):
        if self.now < 0.3:
            raise NoDataYet("not yet")
        return 2.0 - self.now


class Pose:
    def __init__(self, x, other):
        self.x, self.other = x, other


ROVER = """(machine m
  (state go (running [robot.move(linear=2)]))
  (state stop (onentry [robot.move(linear=0, angular=robot.pose.x)]))
  (on [robot.range < 1] go -> stop near))
(spawn m go)"""


def test_the_readings_of_a_real_robot_are_fed_to_the_program_again(tmp_path):
    path = tmp_path / "run.lrplog"
    with Session(ROVER, Rover, clock=VirtualClock()) as session, session.record(path):
        session.bridge.arm()
        session.run(2)
        assert len(session.bridge.driven) == 13
    recording = read_recording(path)
    again = reproduce(recording)
    assert again.difference is None
    assert again.session.frame.active == (("m", "stop"),)
    answer = again.session.why_not("near", at=8)
    assert answer.facts["values"] == {"robot.range": 1.3}
    assert again.session.why("robot.move").facts["arguments"] == {"angular": 1.1}
    other = reproduce(recording, program=ROVER.replace("< 1", "< 1.5"))
    assert other.difference.tick == 7


def test_members_that_a_robot_gets_and_loses_in_a_run_are_those_of_its_replay(tmp_path):
    path = tmp_path / "run.lrplog"
    text = "(machine m (state go (running [robot.honk(2)] [robot.light] [robot.move(linear=robot.light)])))"
    with Session(f"{text} (spawn m go)", Rover, clock=VirtualClock()) as session, session.record(path):
        bridge = session.bridge
        bridge.arm()
        session.run(0.3)
        bridge.add_method("honk", lambda times: times)
        bridge.add_variable("light", lambda: bridge.now)
        bridge.robot.honk(1)
        session.run(0.3)
        bridge.remove_member("light")
        session.run(0.3)
        issues = [(issue.message, issue.count) for issue in session.issues]
        commands = [each.arguments for each in bridge.safety.commands]
    again = reproduce(read_recording(path))
    assert again.difference is None
    assert [(issue.message, issue.count) for issue in again.session.issues] == issues
    assert len(issues) == 3
    assert [each.arguments for each in again.session.bridge.safety.commands] == commands


@pytest.mark.parametrize("robot", [Rover, "sim"])
def test_a_replay_tells_as_often_that_a_pause_has_stopped_the_robot(tmp_path, robot):
    path = tmp_path / "run.lrplog"
    once = "(machine m (state go (onentry [robot.move(linear=0.2)])))(spawn m go)"
    with Session(once, robot, clock=VirtualClock()) as session, session.record(path):
        session.bridge.arm()
        for _ in range(2):
            session.run(0.3)
            session.resume()
            session.pause()
        session.run(0.3)
        told = [each.as_dict() for each in session.bridge.safety.notices if each.kind == "stopped"]
    again = reproduce(read_recording(path))
    assert again.difference is None
    replayed = again.session.bridge.safety.notices
    assert len(told) == 1
    assert [each.as_dict() for each in replayed if each.kind == "stopped"] == told


@pytest.mark.parametrize(
    ("first", "then", "sent"),
    [
        (None, None, [False]),
        (None, "arm", [False, True]),
        ("arm", "disarm", [True, False]),
    ],
)
@pytest.mark.filterwarnings("ignore:The bridge `rover` is disarmed")
def test_a_robot_is_as_armed_in_a_replay_and_in_a_fork_as_it_was(tmp_path, first, then, sent):
    path = tmp_path / "run.lrplog"
    with Session(ROVER, Rover, clock=VirtualClock()) as session:
        if first:
            session.bridge.open()
            session.bridge.arm()
        with session.record(path):
            session.run(0.5)
            if then:
                getattr(session.bridge, then)()
            session.run(0.4)
        with session.fork(8) as fork:
            assert [command.sent for command in fork.bridge.safety.commands] == sent
            assert fork.bridge.safety.armed is session.bridge.safety.armed
    again = reproduce(read_recording(path))
    assert again.difference is None
    assert [command.sent for command in again.session.bridge.safety.commands] == sent


def elsewhere(act):
    """Do something on another thread."""
    other = Thread(target=act)
    other.start()
    other.join()


STOPPED = """(var n := [0])
(machine m (state a (running [n += 1] [robot.move(linear=0.2)] [if n == 5: stop()] [robot.move(linear=0.1)])))
(spawn m a)"""


def test_a_stop_by_another_thread_in_the_middle_of_a_tick_is_reproduced(tmp_path):
    path, names = tmp_path / "run.lrplog", {}
    with Session(STOPPED, "sim", clock=VirtualClock(), world="empty", namespace=names) as session:
        names["stop"] = lambda: elsewhere(session.bridge.stop_all)
        with session.record(path):
            session.run(1)
        present = seen(session)
        sent = [command.sent for command in session.bridge.safety.commands]
        names["stop"] = lambda: None
        with session.fork(2, inputs=True) as fork:
            fork.run(session.frame.time - fork.frame.time)
            assert seen(fork) == present
    assert sent.count(False) == 1
    recording = read_recording(path)
    again = reproduce(recording, namespace=names)
    assert (again.difference, seen(again.session)) == (None, present)
    assert [command.sent for command in again.session.bridge.safety.commands] == sent
    lines = path.read_bytes().splitlines(keepends=True)
    held = next(number for number, line in enumerate(lines) if b'"hold"' in line)
    for end in (held, held + 1, held + 2):
        path.write_bytes(b"".join(lines[:end]))
        assert reproduce(read_recording(path), namespace=names).difference is None


def test_a_stop_by_another_thread_between_two_ticks_acts_in_a_replay_when_it_acted(tmp_path):
    path = tmp_path / "run.lrplog"
    with Session(DRIVER, "sim", clock=VirtualClock(), rate=2, world="empty") as session:
        with session.record(path):
            session.run(2, after_tick=lambda: elsewhere(session.bridge.stop_all))
        present = seen(session)
    again = reproduce(read_recording(path))
    assert (again.difference, seen(again.session)) == (None, present)


def test_what_is_done_to_the_world_in_the_middle_of_a_tick_is_reproduced(tmp_path):
    path, names = tmp_path / "run.lrplog", {}
    with Session(STOPPED, "sim", clock=VirtualClock(), world="line", namespace=names) as session:
        names["stop"] = lambda: session.bridge.place_robot((0.5, 0.6, 1.0))
        with session.record(path):
            session.run(1)
        present = seen(session)
    again = reproduce(read_recording(path), namespace={"stop": lambda: None})
    assert (again.difference, seen(again.session)) == (None, present)


def beeper(robot):
    """Methods with parameters, and a reading that is a list."""
    robot.add_variable("ls", lambda: [1, 2, (3,)])
    robot.add_method("move", lambda linear, angular=0.0: None, limits={"linear": 0.5})
    robot.add_method("beep", lambda *, times=1: None)


def test_the_methods_of_a_recorded_robot_take_the_arguments_that_it_took(tmp_path):
    path = tmp_path / "run.lrplog"
    blocks = "[robot.move(0.9, 0.1)] [robot.beep(times=2)] [n = robot.ls + [(4,)]] [robot.beep(3)]"
    text = f"(var n := [0])(machine m (state a (running {blocks})))(spawn m a)"
    with Session(text, Bare(beeper), clock=VirtualClock()) as session, session.record(path):
        session.run(1)
        (issue,) = session.issues
    with reproduce(read_recording(path)).session as again:
        assert [each.message for each in again.issues] == [issue.message]
        assert again.frame.values["n"] == [1, 2, (3,), (4,)]
        assert again.explain("robot.move").facts["arguments"] == {"linear": 0.5, "angular": 0.1}
    assert reproduce(read_recording(path)).difference is None


def moody(robot):
    """A robot that answers and fails otherwise each time."""
    calls = count()

    def battery() -> int:
        return next(calls)

    def grasp(place: float) -> None:
        if next(calls) % 3:
            raise OSError("The gripper is stuck.")

    def allowed(speed: float) -> None:
        if next(calls) % 2:
            raise ValueError("`speed` is too high now.")

    robot.add_method("battery", battery, command=False)
    robot.add_method("grasp", grasp)
    robot.add_task("go", lambda task, speed: None, check=allowed)


MOODY = """
(var seen := [[]])
(machine m
  (state a (running
    [seen = seen + [robot.battery()]]
    [robot.grasp(0.1); seen = seen + ["held"]]
    [robot.go(2); seen = seen + ["went"]]
    [robot.grasp(0.1); seen = seen + [robot.battery()]])))
(spawn m a)
"""


def test_what_a_robot_has_answered_its_program_is_answered_again_in_a_replay_and_a_fork(tmp_path):
    path = tmp_path / "run.lrplog"
    with Session(MOODY, Bare(moody), clock=VirtualClock()) as session:
        with session.record(path):
            session.run(1)
        seen, issues = session.frame.values["seen"], [(each.message, each.count) for each in session.issues]
        assert {"held", "went"} < set(seen)
        assert len(issues) == 3
        with session.fork(at=3) as fork:
            assert fork.frame.values["seen"] == session.at(3).values["seen"]
    again = reproduce(read_recording(path))
    with again.session as session:
        assert again.difference is None
        assert session.frame.values["seen"] == seen
        assert [(each.message, each.count) for each in session.issues] == issues
    other = MOODY.replace("0.1", "0.2")  # whether that would have failed is not known
    with reproduce(read_recording(path), program=other).session as session:
        assert session.frame.values["seen"].count("held") == session.frame.tick


ASKS = """
(var seen := [[]])
(machine m (state a (running [seen = seen + [robot.where("a"), robot.where("b")]])))
(spawn m a)
"""


def test_what_a_program_only_asks_for_is_answered_by_what_it_asks_in_whatever_order(tmp_path):
    answers = itertools.count()

    def where(name):
        return f"{name}{next(answers)}"

    path = tmp_path / "run.lrplog"
    robot = Bare(lambda robot: robot.add_method("where", where, command=False))
    with Session(ASKS, robot, clock=VirtualClock()) as session, session.record(path):
        session.run(0.2)
        assert session.frame.values["seen"] == ["a0", "b1", "a2", "b3"]
    for asked, answered in ((("b", "a"), ["b1", "a0", "b3", "a2"]), (("c",), [None, None])):
        calls = ", ".join(f'robot.where("{name}")' for name in asked)
        program = ASKS.replace('robot.where("a"), robot.where("b")', calls)
        with reproduce(read_recording(path), program=program).session as session:
            assert session.frame.values["seen"] == answered


def publisher(robot):
    """Methods that take messages of ROS."""
    types = Types()
    for name, kind in {"drive": "geometry_msgs/TwistStamped", "say": "std_msgs/String"}.items():
        robot.add_method(name, lambda message: None, message=types.message(kind), limits={})


def test_the_messages_of_a_recorded_robot_have_their_fields(tmp_path):
    path = tmp_path / "run.lrplog"
    blocks = "[robot.drive(linear=1, header_frame_id='map')] [robot.say(data='on')] [robot.say(dat='off')]"
    text = f"(machine m (state a (running {blocks})))(spawn m a)"
    with Session(text, Bare(publisher), clock=VirtualClock()) as session, session.record(path):
        session.run(1)
        (issue,) = session.issues
        assert "it has `data`" in issue.message
        given = session.explain("robot.drive").facts["arguments"]
    again = reproduce(read_recording(path))
    assert again.difference is None
    assert again.session.explain("robot.drive").facts["arguments"] == given


def test_values_are_the_same_as_json():
    for value in [
        1,
        [1, (2, [3])],
        True,
        None,
        "x",
        0.1,
        float("inf"),
        (1, (2.5, "y")),
        {"a": (1,)},
        {1: "a", (2, 3): {}},
    ]:
        assert unplain(json.loads(json.dumps(plain(value)))) == value
    pose = unplain(json.loads(json.dumps(plain(Pose(0.5, Pose(1, None))))))
    assert (pose.x, pose.other.x, pose.other.other) == (0.5, 1, None)
    nothing = json.loads(json.dumps(plain(Types().form("std_msgs/Empty").zero)))
    assert plain(unplain(nothing)) == nothing == {"fields": {}}


def test_a_message_whose_time_was_not_set_is_commanded_again_without_one(tmp_path):
    path, types = tmp_path / "run.lrplog", Types()
    types.add(HEADERS[1])
    stamped = types.message("geometry_msgs/TwistStamped")
    actions = "[robot.move(twist_linear_x=0.1)] [robot.move(header_stamp_secs=1)]"
    text = f"(machine m (state a (running {actions}))) (spawn m a)"
    robot = Bare(lambda robot: robot.add_method("move", robot.calls.append, message=stamped))
    with Session(text, robot, clock=VirtualClock()) as session, session.record(path):
        session.run(0.3)
    assert ["stamp" in command.as_dict()["header"] for command in robot.calls[:2]] == [False, True]
    assert reproduce(read_recording(path)).difference is None


class FullDisk:
    """A file that takes so many lines."""

    def __init__(self, lines):
        self.lines = lines

    def write(self, _line):
        self.lines -= 1
        if self.lines < 0:
            raise OSError(28, "No space left on device")


def test_a_recording_that_fails_ends_and_the_session_goes_on():
    with Session(COUNTER, clock=VirtualClock()) as session:
        recorder = session.recorder(FullDisk(8).write)
        session.run(2)
        assert session.status == "paused"
        assert session.frame.tick >= 20
        with pytest.raises(FileError, match=r"The recording ended early: .*No space left"):
            recorder.end()
        session.run(1)


@pytest.mark.skipif(sys.platform == "win32", reason="needs a limit of the size of a file")
@pytest.mark.parametrize("name", ["run.lrplog", "run.lrplog.gz"])
def test_a_full_disk_is_told_with_the_file_and_the_session_goes_on(tmp_path, name, monkeypatch):
    import resource

    monkeypatch.setattr(logs, "_KEPT", 0.0)
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    with Session(COUNTER, clock=VirtualClock()) as session:
        resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, hard))
        try:
            with (
                pytest.raises(
                    FileError, match=rf"The recording ended early: `.*{name}` cannot be written: File"
                ),
                session.record(tmp_path / name),
            ):
                session.run(300)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        assert (session.status, session.frame.tick) == ("paused", 3000)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a full device")
def test_a_recording_that_cannot_begin_is_refused(tmp_path):
    (tmp_path / "run.lrplog").symlink_to("/dev/full")
    with (
        Session(COUNTER, clock=VirtualClock()) as session,
        pytest.raises(FileError, match=r"run.lrplog` cannot be written: No space"),
        session.record(tmp_path / "run.lrplog"),
    ):
        session.run(1)


def test_what_cannot_be_written_ends_the_recording_not_the_session(tmp_path):
    path, knot = tmp_path / "run.lrplog", []
    knot.append(knot)

    odd = Bare(lambda robot: robot.add_method("take", lambda thing: None))
    text = "(machine m (state a (onentry [print('\\ud800')] [robot.take(knot)])))(spawn m a)"
    session = Session(text, odd, clock=VirtualClock(), namespace={"knot": knot})
    with session:
        recording = session.record(path)
        recording.__enter__()
        session.run(1)
        assert session.status == "paused"
        with pytest.raises(FileError, match="ended early: A value contains itself"):
            recording.__exit__(None, None, None)
    assert b"\xed\xa0\x80" in path.read_bytes()


def test_a_session_can_be_closed_while_it_is_recorded(tmp_path):
    path = tmp_path / "run.lrplog"
    session = Session(COUNTER, clock=VirtualClock())
    with session.record(path):
        session.run(1)
        session.close()
    assert reproduce(read_recording(path)).difference is None


def test_random_numbers_are_reproduced_though_nobody_seeded_them(record):
    text = "(var r := [0]) (machine m (state a (running [import random; r = random.random()])))(spawn m a)"
    path = record(text)
    before = random.getstate()
    again = reproduce(read_recording(path))
    assert again.difference is None
    assert random.getstate() == before, "a replay draws numbers of its own"
    with again.session.fork(5) as fork, fork.fork() as other:
        fork.run(0.6)
        other.run(0.6)
        assert fork.frame.values["r"] == other.frame.values["r"] == again.session.frame.values["r"]


START = {"lrplog": 3, "text": COUNTER, "filename": "a.lrp", "bridge": "none"}


@pytest.mark.parametrize(
    ("fields", "line", "message"),
    [
        ({"text": 5}, {}, "line 1: The field `text` is wrong: it is 5"),
        ({"rate": "x"}, {}, "line 1: The field `rate` is wrong: it is 'x'"),
        ({"rate": -1}, {}, "line 1: The field `rate` is wrong: it is -1"),
        ({"rate": True}, {}, "line 1: The field `rate` is wrong: it is True"),
        ({"random": [1]}, {}, "line 1: The field `random` is wrong"),
        ({"initials": [1]}, {}, "line 1: The field `initials` is wrong"),
        ({"on_issue": "zz"}, {}, "line 1: The field `on_issue` is wrong"),
        ({"names": 5}, {}, "line 1: The field `names` is wrong"),
        ({"members": [5]}, {}, "line 1: The field `members` is wrong"),
        ({"members": [{}]}, {}, "line 1: The field `kind` is missing"),
        ({"text": "(machine"}, {}, "line 1: A field is wrong: .*LRP1"),
        ({"rate": 1e9}, {}, "line 1: The field `rate` is wrong"),
        ({"world": {"a": 1}}, {}, "line 1: A field is wrong: .*Unknown key"),
        ({"recorded": "yesterday"}, {}, "line 1: The field `recorded` is wrong: it is 'yesterday'"),
        ({}, {"readings": {}, "clock": "noon"}, "line 2: A field is wrong"),
        ({}, {"foo": 1}, "line 2: This line has no `input`, `event` or `readings`"),
        ({}, {"event": None}, "line 2: This line has no `input`, `event` or `readings`"),
        ({}, {"event": "entered", "state": 5}, "line 2: The field `state` is wrong: it is 5"),
        ({}, {"input": "beyond", "what": "x"}, "line 2: This input cannot be stored in a file, so"),
        ({}, {"event": "fired"}, "line 2: The field `machine` is missing"),
        ({}, {"event": "commanded"}, "line 2: The field `command` is missing"),
        ({}, {"input": "set", "path": "n"}, "line 2: The field `expression` is missing"),
        ({}, {"tick": "x", "readings": {}}, "line 2: `tick` is 'x'"),
        ({}, {"time": float("inf"), "readings": {}}, "line 2: `time` is inf"),
        ({}, {"time": 1e9, "readings": {}}, "line 2: `time` is 1e"),
        ({}, {"readings": 5}, "line 2: A field is wrong"),
        ({}, {"input": "edit", "text": "(machine"}, "line 2: A field is wrong: .*LRP1"),
    ],
)
def test_what_is_wrong_in_a_recording_is_told_with_its_line(tmp_path, fields, line, message):
    path = tmp_path / "run.lrplog"
    rows = [{**START, **fields}, {"tick": 1, "time": 0.0, **line}]
    path.write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")
    with pytest.raises(FileError, match=message):
        read_recording(path)


@pytest.mark.parametrize(
    "line",
    [
        {"input": "set", "path": ["n"], "expression": "1/0"},
        {"input": "set", "path": ["n"], "expression": "n.q"},
        {"input": "set", "path": ["n"], "expression": 5},
        {"input": "rename", "kind": 5, "path": ["m"], "name": "q"},
        {"input": "rename", "kind": "machine", "path": ["m"], "name": 5},
        {"input": "rewind", "ticks": "x"},
        {"input": "rewind", "ticks": 100},
        {"input": "force", "path": [5], "teleport": False},
        {"input": "fire", "path": ["m", "nothing"]},
        {"input": "rate", "rate": "x"},
        {"input": "policy", "name": "on_issue", "value": "zz"},
        {"input": "place", "pose": ["a", "b", "c"], "robot": 0},
        {"input": "place", "pose": [1, 1, 1], "robot": 9},
        {"input": "draw", "path": [[0.1, 1]], "width": "x", "grey": 1},
        {"input": "world", "world": 5},
        {"input": "command", "name": "mov", "arguments": {"dict": {}}},
        {"input": "command", "name": "move", "arguments": 5},
    ],
)
def test_an_input_that_cannot_be_repeated_is_told_with_its_line(record, line):
    path = record(COUNTER, "sim", world="empty", seconds=0.5)
    *rows, end = path.read_text(encoding="utf-8").splitlines()
    rows.append(json.dumps({"tick": 5, "time": 0.5, **line}))
    path.write_text("\n".join([*rows, end, ""]), encoding="utf-8")
    recording = read_recording(path)
    with pytest.raises(FileError, match=f"line {len(rows)}: This input cannot be repeated: "):
        reproduce(recording)
    reproduce(recording, program=COUNTER.replace("1", "2")).session.close()


def test_a_simulated_run_without_end_is_refused(record):
    path = record(COUNTER, "sim", world="empty", seconds=0.5)
    with open(path, "a", encoding="utf-8") as stream:
        stream.write('{"tick":6,"time":1e6,"readings":{}}\n')
    with pytest.raises(FileError, match=r"`time` is 1e\+06, and it is 0.5 in the line before"):
        read_recording(path)


def test_what_was_refused_is_no_part_of_the_recording(tmp_path):
    path = tmp_path / "run.lrplog"
    with Session(DRIVER, "sim", clock=VirtualClock(), world="empty") as session, session.record(path):
        session.run(1.05)
        for refused in (
            lambda: session.rename("state", "m/first", "second"),
            lambda: session.set_variable("nothing", evaluate="1"),
        ):
            with pytest.raises((LRPError, ValueError)):
                refused()
        session.call(lambda: session.bridge.robot.move(angular=1))
        session.run(1)
    assert reproduce(read_recording(path)).difference is None


def test_a_run_at_full_speed_is_reproduced(record):
    path = record(COUNTER, rate=0, seconds=0.5)
    assert reproduce(read_recording(path)).difference is None


def test_a_run_that_was_rewound_by_more_than_is_usually_kept_is_reproduced(tmp_path, monkeypatch):
    for module in (journal, reproduction):
        monkeypatch.setattr(module, "TICKS", 100)
    monkeypatch.setattr(journal, "SECONDS", 10.0)
    path = tmp_path / "run.lrplog"
    with Session(COUNTER, clock=VirtualClock(), journal=2000) as session, session.record(path):
        session.run(120)
        session.rewind(600)
        session.rewind(550)
        session.run(1)
        count = session.frame.values["n"]
    assert read_recording(path).reach == 1150
    with reproduce(read_recording(path)).session as again:
        assert again.frame.values["n"] == count


@pytest.mark.parametrize(
    "value", [float("inf"), [1, (float("-inf"),)], {"inf": "inf"}, {1: None}, {2}, set()]
)
def test_a_value_that_was_assigned_is_repeated(tmp_path, value):
    path = tmp_path / "run.lrplog"
    with Session(COUNTER.replace("n += 1", "n"), clock=VirtualClock()) as session, session.record(path):
        session.run(1)
        session.variables["n"] = value
    again = reproduce(read_recording(path))
    assert again.difference is None
    assert again.session.frame.values["n"] == value


def test_a_value_that_no_file_can_hold_is_told(tmp_path):
    path = tmp_path / "run.lrplog"
    with Session(COUNTER.replace("n += 1", "n"), clock=VirtualClock()) as session, session.record(path):
        session.run(1)
        session.variables["n"] = object()
    with pytest.raises(FileError, match="This input cannot be stored in a file, so the recording cannot be"):
        read_recording(path)


def test_a_tick_without_readings_is_told(record):
    path = record(COUNTER, "sim", world="empty", seconds=0.5)
    rows = path.read_text(encoding="utf-8").splitlines()
    rows = [row.partition('"readings"')[0] + '"readings":{}}' if '"readings"' in row else row for row in rows]
    path.write_text("\n".join([*rows, ""]), encoding="utf-8")
    told = str(reproduce(read_recording(path)).difference)
    assert "Recorded: the tick was at 0 s, with no other reading. Replay: `robot." in told


def test_a_deep_line_and_a_file_that_is_not_compressed_are_told(tmp_path, record):
    whole = record(COUNTER).read_bytes()
    path, packed = tmp_path / "run.lrplog", tmp_path / "run.lrplog.gz"
    path.write_text("[" * 100_000 + "\n")
    with pytest.raises(FileError, match="line 1: This line is not JSON"):
        read_recording(path)
    packed.write_text("{}\n")
    with pytest.raises(FileError, match="it is not a gzip file"):
        read_recording(packed)
    packed.write_bytes(gzip.compress(whole) + b"more")
    with pytest.raises(FileError, match="Its compressed data is damaged"):
        read_recording(packed)
    packed.write_bytes(gzip.compress(b"{}\n")[:10] + b"\xff" * 40)
    with pytest.raises(FileError, match="Its compressed data is damaged"):
        read_recording(packed)


def test_every_part_of_a_compressed_recording_is_read_and_it_is_bounded(tmp_path, monkeypatch, record):
    packed = tmp_path / "run.lrplog.gz"
    path = record(COUNTER)
    first, *rows = path.read_bytes().splitlines(keepends=True)
    packed.write_bytes(gzip.compress(first) + gzip.compress(b"".join(rows)))
    assert (read_recording(packed).ticks, read_recording(packed).cut) == (10, False)
    packed.write_bytes(packed.read_bytes()[:-8])
    assert (read_recording(packed).ticks, read_recording(packed).cut) == (10, True)
    monkeypatch.setattr(logs, "_LARGEST", 1000)
    with pytest.raises(FileError, match="It contains more than"):
        read_recording(packed)


def test_no_more_is_read_of_a_file_than_a_recording_may_contain(tmp_path, monkeypatch):
    path = tmp_path / "run.lrplog"
    with path.open("wb") as stream:
        stream.truncate(100_000_000)
    monkeypatch.setattr(logs, "_LARGEST", 1000)
    tracemalloc.start()
    try:
        with pytest.raises(FileError, match="It contains more than"):
            read_recording(path)
        assert tracemalloc.get_traced_memory()[1] < 1_000_000
    finally:
        tracemalloc.stop()


def test_a_name_that_no_file_can_have_is_told():
    with pytest.raises(FileError, match="cannot be read: embedded null"):
        read_recording("run\0.lrplog")
    for name in ("run\0.lrplog", "run\0.lrplog.gz"):
        with pytest.raises(FileError, match=r"`run<U\+0000>\.lrplog(\.gz)?` cannot be the name of a file"):
            logs.open_log(name)


def test_of_a_process_that_is_killed_a_compressed_recording_is_kept(tmp_path):
    path = tmp_path / "run.lrplog.gz"
    stream = logs.open_log(path)
    stream.write("the first line\n")
    assert path.stat().st_size > 20
    stream.close()


def test_a_command_by_hand_has_the_time_at_which_it_was_given(tmp_path):
    path = tmp_path / "run.lrplog"
    with Session(COUNTER, "sim", clock=VirtualClock()) as session, session.record(path):
        session.step()
        with pytest.raises(UnknownElementError):
            session.rename("state", "m/nowhere", "b")
        session.call(lambda: session.bridge.robot.move(linear=0.2))
        session.step()
    (command,) = [
        line for line in map(json.loads, path.read_text().splitlines()) if line.get("event") == "commanded"
    ]
    assert command["time"] == 0.1
    assert reproduce(read_recording(path)).difference is None


def test_a_recording_is_its_users_own_as_long_as_none_of_its_code_was_changed(tmp_path):
    path = tmp_path / "run.lrplog"
    with Session(COUNTER, clock=VirtualClock()) as session, session.record(path):
        session.run(1)
        session.edit(COUNTER.replace("+= 1", "+= 2"))
        session.run(1)
        session.set_variable("n", "3 + 4")
        session.run(1)
        session.reset()
        session.run(1)
    data = path.read_bytes()
    lines = data.splitlines(keepends=True)
    kinds = [json.loads(line).get("input") for line in lines]
    assert {"edit", "set", "reset"} < set(kinds)

    def is_own(content, name="other.lrplog"):
        (tmp_path / name).write_bytes(content)
        return read_recording(tmp_path / name).is_own

    assert is_own(data)
    assert is_own(gzip.compress(data), "run.lrplog.gz")
    edited = kinds.index("edit")
    assert is_own(b"".join(lines[: edited + 1]))
    assert is_own(b"".join(lines[:edited]) + lines[edited][:-20])
    assert is_own(data.replace(b'"value":4', b'"value":5')), "what followed is not run"
    for old, new in (
        (b"+= 1", b"+= 3"),
        (b"+= 2", b"+= 3"),
        (b"3 + 4", b"3 + 5"),
        (b'"rate":10', b'"rate":5'),
    ):
        assert data.count(old) == 1
        assert not is_own(data.replace(old, new))
    without = [line for number, line in enumerate(lines) if number != edited]
    assert not is_own(b"".join(without)), "an edit is missing"
    with Session(f"{COUNTER}\n", clock=VirtualClock()) as session, session.record(path):
        session.run(1)
    assert is_own(path.read_bytes())
    assert not is_own(b"".join([path.read_bytes(), *lines[edited : edited + 1]])), "an edit of another one"


@pytest.mark.slow
def test_a_recording_is_read_within_bounds_and_the_error_names_the_line(tmp_path, record, monkeypatch):
    first = record(COUNTER).read_bytes().splitlines(keepends=True)[0]
    path = tmp_path / "other.lrplog.gz"

    def told(*lines):
        path.write_bytes(gzip.compress(b"".join(lines)))
        with pytest.raises(FileError) as error:
            read_recording(path)
        return str(error.value).partition("lrplog.gz`, ")[2]

    long = json.loads(first) | {"text": ";" * 1_000_001}
    assert (
        told(json.dumps(long).encode() + b"\n") == "line 1: Its program has more than 1,000,000 characters."
    )
    edit = {"tick": 0, "time": 0, "input": "edit", "text": ";" * 1_000_001}
    assert told(first, json.dumps(edit).encode() + b"\n").startswith("line 2: Its program has more")
    assert told(first, b" " * 32_000_001) == "line 2: It is longer than 32 MB."
    monkeypatch.setattr(recording, "_MOST", 20_000_000)
    many = b'{"tick":0,"time":0,"readings":{"a":{"list":[' + b"[]," * 50_000 + b"[]]}}}\n"
    tracemalloc.start()
    try:
        assert (
            told(first, many * 9) == "line 5: Up to here, this recording takes more than 0.02 GB of memory."
        )
        assert tracemalloc.get_traced_memory()[1] < 25_000_000
    finally:
        tracemalloc.stop()
