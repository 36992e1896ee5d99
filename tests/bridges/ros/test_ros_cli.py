"""``lrp run … --bridge ros``: the command line drives a ROS robot, where there is no Jupyter."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections import defaultdict
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from bridges.ros.follower import PATIENT, SETUP, last_state
from support.waiting import until
from typer.testing import CliRunner

from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.cli import app
from lrp_jupyter.cli.robot_of_run import where

ROS = ("rospy", "rosgraph", "roslib", "genpy")
DRIVE = "(machine m (state a (running [robot.move(linear=0.1)])) (state b) {more}) (spawn m a)"

Start = Callable[..., "subprocess.Popen[str]"]


def forms(trace: Path) -> dict[str, set[tuple[str, ...]]]:
    """Return the keys of the events of a trace, by kind."""
    found = defaultdict(set)
    for event in map(json.loads, trace.read_text().splitlines()):
        found[event["event"]].add(tuple(event))
    return found


def on(port: int, *more: object) -> tuple[object, ...]:
    return ("--bridge", "ros", "--host", "127.0.0.1", "--option", f"port={port}", *more)


def lrp(*arguments: object) -> Any:
    """Run the command in this process."""
    return CliRunner().invoke(app, list(map(str, arguments)), prog_name="lrp")


@pytest.fixture
def drive(tmp_path: Path) -> Callable[..., Path]:
    """Write a program that drives, and whatever `more` there is."""

    def write(more: str = "") -> Path:
        path = tmp_path / "drive.lrp"
        path.write_text(DRIVE.format(more=more), encoding="utf-8")
        return path

    return write


# -- a real ROS 1 ---------------------------------------------------------------------------------


@pytest.mark.ros
@pytest.mark.slow
@pytest.mark.parametrize(
    ("backend", "missing"), [("rosbridge", ROS), ("rospy", ("websockets",))], ids=["rosbridge", "rospy"]
)
def test_the_follower_drives_where_jupyter_and_the_libraries_of_other_back_ends_are_missing(
    real: Any, bare_lrp: Start, tmp_path: Path, backend: str, missing: tuple[str, ...]
) -> None:
    real.start_robot(1.0, "line")
    trace, simulated = tmp_path / "ros.jsonl", tmp_path / "sim.jsonl"
    address: tuple[object, ...] = ("--bridge", "ros")  # of the master that is set
    if backend == "rosbridge":
        address = on(real.start_rosbridge(), "--option", "backend=rosbridge")
    run = bare_lrp(
        *("run", "follower", *address, "--option", f"setup={SETUP}", "--until", "moving", "--trace", trace),
        environment=real.environment,
        missing=missing,
        before=PATIENT,
    )
    output, complaints = run.communicate(timeout=180)
    assert (run.returncode, complaints) == (0, "")
    if backend == "rospy":
        assert "Back end: rospy, because `ROS_MASTER_URI` is set" in output
    assert "follower/moving active" in output.splitlines()[-1]
    assert "issue" not in output.splitlines()[-1]
    assert lrp("run", "follower", "--speed", "max", "--until", "moving", "--trace", simulated).exit_code == 0
    assert forms(trace) == forms(simulated)
    assert last_state(trace) == "follower/moving"


@pytest.mark.ros
@pytest.mark.slow
def test_a_node_that_is_ended_from_outside_stops_the_robot_and_ends_the_run(
    real: Any, bare_lrp: Start, drive: Callable[..., Path]
) -> None:
    import xmlrpc.client

    import rosgraph

    wheels = real.lines(real.start_robot(world="empty"))
    options = ("--bridge", "ros", "-o", f"setup={SETUP}", "__name:=behaviour")
    run = bare_lrp("run", drive(), *options, environment=real.environment, before=PATIENT)
    until(lambda: wheels and not wheels[-1].endswith(" 0.0"))
    address = rosgraph.Master("/tests").lookupNode("/behaviour")
    with suppress(OSError), xmlrpc.client.ServerProxy(address) as node:  # it may end before it answers
        node.shutdown("/tests", "user request")  # as `rosnode kill` does
    _output, complaints = run.communicate(timeout=180)
    assert run.returncode == 5
    assert "The ROS node `/behaviour` was shut down from outside, as by `rosnode kill`." in complaints
    until(lambda: wheels[-1].endswith(" 0.0"))


@pytest.mark.ros
@pytest.mark.slow
def test_a_node_waits_for_its_master_has_its_name_and_does_not_fight_for_it(
    real: Any, bare_lrp: Start, drive: Callable[..., Path], tmp_path: Path
) -> None:
    import rosgraph

    setup = tmp_path / "robot.json"
    setup.write_text(
        json.dumps({"publishers": {"move": {"topic": "cmd_vel", "type": "geometry_msgs/Twist"}}})
    )
    real.kill_master()
    options = ("--bridge", "ros", "-o", f"setup={setup}", "-o", "patience=inf")
    launched = ("__name:=behaviour", "__ns:=/robot1", "/robot1/cmd_vel:=/cmd_vel")
    run = bare_lrp("run", drive(), *options, *launched, environment=real.environment, before=PATIENT)
    assert run.stderr is not None
    assert run.stderr.readline().startswith("lrp: Waiting for the robot: No ROS master answers")
    real.start_master()
    wheels = real.lines(real.start_robot(world="empty"))
    until(lambda: wheels and not wheels[-1].endswith(" 0.0"))
    assert rosgraph.Master("/tests").lookupNode("/robot1/behaviour")
    twin = (
        "import rospy; rospy.init_node('behaviour', argv=['', '__ns:=/robot1']); print('ready'); rospy.spin()"
    )
    real.start(sys.executable, "-c", twin, "__ns:=/robot1", ready=True)
    _output, complaints = run.communicate(timeout=180)
    assert (run.returncode, complaints.count("\n")) == (5, 1)
    assert "Another node has taken the name `/robot1/behaviour`" in complaints
    until(lambda: wheels[-1].endswith(" 0.0"))


# -- topics in memory -----------------------------------------------------------------------------


@pytest.mark.slow
def test_a_run_survives_the_death_of_the_server_and_ctrl_c_stops_the_robot(
    serve: Callable[..., Any], graph: Any, bare_lrp: Start, drive: Callable[..., Path], tmp_path: Path
) -> None:
    def speeds() -> list[float]:
        return [values["linear"]["x"] for topic, values in tuple(graph.heard) if topic == "/cmd_vel"]

    trace, server = tmp_path / "trace.jsonl", serve()
    arguments = on(server.port, "--option", f"setup={SETUP}", "--trace", trace)
    run = bare_lrp("run", drive(), *arguments, missing=ROS)
    until(lambda: 0.1 in speeds())
    server.close()
    until(lambda: '"issue"' in trace.read_text())
    before = len(speeds())
    serve(server.port)
    until(lambda: 0.1 in speeds()[before:])
    assert speeds()[before] == 0.0, "it is stopped when it is found"
    run.send_signal(signal.SIGINT)
    output, complaints = run.communicate(timeout=180)
    assert (run.returncode, complaints) == (130, "")
    assert f"ws://127.0.0.1:{server.port}" in output
    assert "m/a active" in output.splitlines()[-1]
    until(lambda: speeds()[-1:] == [0.0])
    events = map(json.loads, trace.read_text().splitlines())
    assert [event["element"] for event in events if event["event"] == "issue"] == ["m/a"]


@pytest.mark.slow
def test_a_robot_that_is_lost_at_the_end_is_an_exit_code(
    serve: Callable[..., Any], bare_lrp: Start, tmp_path: Path
) -> None:
    server, sign = serve(), tmp_path / "sign"
    program, seen = tmp_path / "idle.lrp", f"__import__('os').path.exists({str(sign)!r})"
    program.write_text(f"(machine m (state a) (state b (running [1 / 0])) (on [{seen}] a -> b)) (spawn m a)")
    options = ("-o", f"setup={SETUP}", "--on-issue", "pause")
    run = bare_lrp("run", program, *on(server.port, *options), before=PATIENT)
    assert run.stdout is not None
    lines = iter(run.stdout.readline, "")
    assert any("Connected to" in line or "nothing has arrived" in line for line in lines)
    server.close()
    assert any("No rosbridge server answers" in line or "is lost" in line for line in lines)
    sign.touch()
    _output, complaints = run.communicate(timeout=180)
    assert run.returncode == 4
    assert "lrp: " in complaints


@pytest.mark.slow
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, -signal.SIGTERM)])
def test_waiting_for_a_robot_ends_at_once(
    bare_lrp: Start, drive: Callable[..., Path], number: int, code: int
) -> None:
    run = bare_lrp("run", drive(), *on(9, "-o", "backend=rosbridge", "-o", "patience=inf"))
    assert run.stderr is not None
    assert run.stderr.readline().startswith("lrp: Waiting for the robot: No rosbridge server answers")
    run.send_signal(number)
    assert (run.communicate(timeout=180)[1], run.returncode) == ("", code)


@pytest.mark.slow
def test_a_robot_that_never_answered_or_of_which_nothing_ever_worked_is_an_exit_code(
    server: Any, drive: Callable[..., Path], tmp_path: Path
) -> None:
    absent = lrp("run", drive(), *on(9, "--option", "patience=2"))
    assert (absent.exit_code, "No rosbridge server answers" in absent.stderr) == (4, True)
    setup = tmp_path / "robot.json"
    setup.write_text(json.dumps({"subscriptions": {"light": "/lihgt"}}))
    idle = tmp_path / "idle.lrp"
    idle.write_text("(machine m (state a)) (spawn m a)")
    silent = lrp("run", idle, *on(server.port, "--option", f"setup={setup}", "--for", "0.2"))
    assert silent.exit_code == 4
    assert (
        "lrp: Nothing of the robot ever worked. `robot.light`: `/lihgt` does not exist yet" in silent.stderr
    )


@pytest.mark.slow
def test_a_run_says_in_a_line_that_no_node_hears_its_velocity(
    server: Any, graph: Any, bare_lrp: Start, drive: Callable[..., Path]
) -> None:
    graph.others.clear()
    graph.others |= {"/base/cmd_vel"}
    graph.types["/base/cmd_vel"] = "geometry_msgs/Twist"
    run = bare_lrp("run", drive(), *on(server.port, "--option", f"setup={SETUP}"), missing=ROS)
    assert run.stdout is not None
    line = next(line for line in run.stdout if "subscribes to `/cmd_vel`. Did you" in line)
    assert "`robot.move`: no other node" in line
    assert "mean `/base/cmd_vel`, to which `/robot` subscribes?" in line
    run.send_signal(signal.SIGINT)
    assert run.wait(180) == 130


def test_a_run_names_what_is_not_in_its_set_up_before_the_state_that_uses_it(
    server: Any, drive: Callable[..., Path]
) -> None:
    path = drive("(state c (running [robot.mov(linear=robot.lihgt.data)]))")
    result = lrp("run", path, *on(server.port, "--option", f"setup={SETUP}"), "--for", 0.3)
    assert result.exit_code == 0
    assert "error LRP520: `robot` has no `mov`. Did you mean `move`?" in result.stdout
    assert "error LRP520: `robot` has no `lihgt`. Did you mean `light`?" in result.stdout


def test_a_reading_of_the_robot_ends_the_run(server: Any, graph: Any, drive: Callable[..., Path]) -> None:
    publish = graph.publish

    def darken(handle: object, values: dict[str, Any]) -> None:
        publish(handle, values)
        graph.send("/light", data=20 if len(graph.heard) > 2 else 255)

    graph.publish = darken
    arguments = on(server.port, "--option", f"setup={SETUP}", "--until", "b", "--trace", "-")
    run = lrp("run", drive("(on [robot.light.data < 100] a -> b seen)"), *arguments)
    events = [json.loads(line) for line in run.stdout.splitlines()]
    assert run.exit_code == 0
    assert events[0]["event"] == "started"
    assert [event["event"] for event in events[-3:]] == ["left", "fired", "entered"]
    assert events[-2]["transition"] == "seen"


def test_a_state_that_is_not_reached_in_time_exits_with_1_and_an_unknown_option_with_2(
    server: Any, drive: Callable[..., Path], tmp_path: Path
) -> None:
    setup = tmp_path / "robot.json"
    setup.write_text(SETUP.read_text())
    arguments = on(server.port, "--option", f"setup={setup}", "--until", "b", "--for", "0.1")
    assert lrp("run", drive(), *arguments).exit_code == 1
    assert json.loads(setup.read_text()) == json.loads(SETUP.read_text())
    refused = lrp("run", drive(), *on(server.port, "--option", "topic=/light"))
    assert refused.exit_code == 2
    assert "has no option `topic`" in refused.stderr


def test_what_a_launch_file_appends_counts_and_is_for_this_bridge_only(
    server: Any, graph: Any, drive: Callable[..., Path], tmp_path: Path
) -> None:
    setup = tmp_path / "robot.json"
    setup.write_text(
        json.dumps({"publishers": {"move": {"topic": "cmd_vel", "type": "geometry_msgs/Twist"}}})
    )
    arguments = on(server.port, "--option", f"setup={setup}", "-o", "remap=a:=b", "--for", "0.2")
    launched = (
        "__name:=behaviour",
        "__log:=/x.log",
        "--ros-args",
        "-r",
        "cmd_vel:=base",
        "-r",
        "__ns:=/robot1",
    )
    assert lrp("run", drive(), *arguments, *launched).exit_code == 0
    assert {topic for topic, _values in graph.heard} == {"/robot1/base", "/rosout"}
    for name, sentence in (
        ("__name:=x", "is for a node of ROS, and the bridge is `sim`"),
        ("x", "unexpected"),
    ):
        refused = lrp("run", "follower", name)
        assert (refused.exit_code, sentence in " ".join(refused.stderr.replace("│", " ").split())) == (
            2,
            True,
        )


def test_a_program_for_the_simulator_is_shown_without_its_world() -> None:
    assert where(RosBridge(), "line") == "ros"


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (on(9, "--option", "backend=rosbrige"), "Did you mean `rosbridge`?"),
        (on(9, "--option", "setup=nowhere.json"), "The set-up nowhere.json cannot be read"),
        (on(9, "--option", "patience=soon"), "`patience` takes `inf` or a number, not `soon`"),
        (on(9, "--speed", "2"), "`ros` moves in real time"),
        (on(9, "--world", "line"), "--world is for the simulator"),
    ],
)
def test_what_cannot_be_opened_exits_with_2_and_one_sentence(
    drive: Callable[..., Path], arguments: tuple[object, ...], sentence: str
) -> None:
    run = lrp("run", drive(), *arguments)
    assert run.exit_code == 2
    assert sentence in " ".join(run.stderr.replace("│", " ").split())
