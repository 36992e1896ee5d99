"""``lrp run … --bridge ros``: the command line drives a ROS robot, where there is no Jupyter."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import threading
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from support.waiting import until

from lrp_jupyter.bridges.ros import RosBridge
from lrp_jupyter.cli.run import where

pytestmark = pytest.mark.slow  # each starts processes of its own

SETUP = Path(__file__).with_name("follower.json")
ROS = ("rospy", "rosgraph", "roslib", "genpy")
FASTER = 2.0  # than real time, the robot; so the program's times and speeds are scaled:
SCALED = ("--rate", "20", "--set", "maxlook=100", "--set", "back=-0.1", "--set", "turn=0.5")
PATIENT = """
from lrp_jupyter.bridges import guard
from lrp_jupyter.bridges.ros import RosBridge, websocket
guard._LAPSE = websocket._STALE = websocket._FRESH = 60.0
RosBridge.stopper = lambda bridge: None
"""
DRIVE = "(machine m (state a (running [robot.move(linear=0.1)])) (state b)) (spawn m a)"

Start = Callable[..., "subprocess.Popen[str]"]


def forms(lines: list[str]) -> dict[str, set[tuple[str, ...]]]:
    """Return the keys of the events of a trace, by kind."""
    found = defaultdict(set)
    for line in lines:
        event = json.loads(line)
        found[event["event"]].add(tuple(event))
    return found


def on(port: int, *more: object) -> tuple[object, ...]:
    return ("--bridge", "ros", "--host", "127.0.0.1", "--option", f"port={port}", *more)


# -- a real ROS 1 ---------------------------------------------------------------------------------


@pytest.mark.ros
def test_the_follower_goes_there_and_back_without_jupyter_and_without_ros(
    real: Any, bare_lrp: Start, tmp_path: Path
) -> None:
    real.start_robot(FASTER, "line")
    odometry = real.lines(real.start("/usr/bin/rostopic", "echo", "-p", "/odom/pose/pose/position/x"))
    port = on(real.start_rosbridge(), "--option", "backend=rosbridge", "--option", f"setup={SETUP}")
    trace, simulated = tmp_path / "ros.jsonl", tmp_path / "sim.jsonl"
    arguments = ("run", "follower", *port, "--until", "end", "--trace", trace, *SCALED)
    run = bare_lrp(*arguments, missing=ROS, before=PATIENT)
    output, complaints = run.communicate(timeout=180)
    assert (run.returncode, complaints) == (0, "")
    assert "follower/end active" in output.splitlines()[-1]
    assert "issue" not in output.splitlines()[-1]

    def way() -> list[float]:
        return [float(line.split(",")[1]) for line in odometry if not line.startswith("%")]

    assert max(way()) > 1.0, "it came to the far wall"
    until(lambda: way()[-1] < 0.0, what="it came back to the near one")  # `rostopic` may be late

    run = bare_lrp("run", "follower", "--speed", "max", "--until", "end", "--trace", simulated)
    assert run.wait(180) == 0
    there, here = trace.read_text().splitlines(), simulated.read_text().splitlines()
    assert forms(there) == forms(here)
    assert last_state(there) == last_state(here) == "follower/end"


@pytest.mark.ros
def test_the_same_command_drives_over_rospy(real: Any, bare_lrp: Start, tmp_path: Path) -> None:
    real.start_robot(1.0, "line")
    options = ("--option", "backend=rospy", "--option", f"setup={SETUP}", "--until", "moving")
    trace = tmp_path / "trace.jsonl"
    run = bare_lrp(
        *("run", "follower", *on(real.master_port, *options), "--for", "20", "--trace", trace),
        environment=real.environment,
        missing=("websockets",),
        before=PATIENT,
    )
    output, complaints = run.communicate(timeout=180)
    assert (run.returncode, complaints) == (0, "")
    assert "follower/moving active" in output.splitlines()[-1]
    assert last_state(trace.read_text().splitlines()) == "follower/moving"


# -- topics in memory -----------------------------------------------------------------------------


@pytest.fixture
def drive(tmp_path: Path) -> Path:
    path = tmp_path / "drive.lrp"
    path.write_text(DRIVE, encoding="utf-8")
    return path


@pytest.fixture
def light(graph: Any) -> Iterator[Callable[[int], None]]:
    """Set the value of the robot's light sensor, which is published twenty times a second."""
    grey, gone = [255], threading.Event()

    def speak() -> None:
        while not gone.wait(0.05):
            graph.send("/light", data=grey[0])

    speaker = threading.Thread(target=speak, name="light")
    speaker.start()
    yield lambda value: grey.__setitem__(0, value)
    gone.set()
    speaker.join()


def speeds(graph: Any) -> list[float]:
    return [values["linear"]["x"] for topic, values in graph.heard if topic == "/cmd_vel"]


def test_ctrl_c_stops_the_robot_with_a_last_command_of_zero(
    server: Any, graph: Any, bare_lrp: Start, drive: Path
) -> None:
    run = bare_lrp("run", drive, *on(server.port, "--option", f"setup={SETUP}"), missing=ROS)
    until(lambda: 0.1 in speeds(graph))
    run.send_signal(signal.SIGINT)
    output, complaints = run.communicate(timeout=180)
    assert (run.returncode, complaints) == (130, "")
    assert "m/a active" in output.splitlines()[-1]
    until(lambda: speeds(graph)[-1:] == [0.0])


def test_a_reading_of_the_robot_ends_the_run(
    server: Any, light: Callable[[int], None], bare_lrp: Start, tmp_path: Path
) -> None:
    program = tmp_path / "dark.lrp"
    program.write_text(
        "(machine m (state a) (state b) (on [robot.light.data < 100] a -> b seen)) (spawn m a)"
    )
    arguments = on(server.port, "--option", f"setup={SETUP}", "--until", "b", "--trace", "-")
    run = bare_lrp("run", program, *arguments, missing=ROS)
    assert run.stdout is not None
    begin = [json.loads(run.stdout.readline()) for _ in range(2)]
    light(20)
    output, _complaints = run.communicate(timeout=180)
    end = [json.loads(line) for line in output.splitlines()]
    assert run.returncode == 0
    assert "started" in {event["event"] for event in begin}
    assert [event["event"] for event in end[-3:]] == ["left", "fired", "entered"]
    assert end[-2]["transition"] == "seen"


def test_a_state_that_is_not_reached_in_time_exits_with_1(server: Any, bare_lrp: Start, drive: Path) -> None:
    arguments = on(server.port, "--option", f"setup={SETUP}", "--until", "b", "--for", "0.3")
    run = bare_lrp("run", drive, *arguments, missing=ROS)
    assert run.wait(180) == 1


def test_a_set_up_that_is_kept_is_not_changed_by_a_run(
    server: Any, bare_lrp: Start, drive: Path, tmp_path: Path
) -> None:
    setup = tmp_path / "robot.json"
    setup.write_text(SETUP.read_text())
    run = bare_lrp("run", drive, *on(server.port, "--option", f"setup={setup}", "--for", "0.3"), missing=ROS)
    assert run.wait(180) == 0
    assert json.loads(setup.read_text()) == json.loads(SETUP.read_text())


def test_a_server_that_dies_is_reported_and_the_run_continues(
    server: Any, graph: Any, bare_lrp: Start, drive: Path, tmp_path: Path
) -> None:
    trace = tmp_path / "trace.jsonl"
    arguments = on(server.port, "--option", f"setup={SETUP}", "--for", "8", "--trace", trace)
    run = bare_lrp("run", drive, *arguments, missing=ROS)
    until(lambda: 0.1 in speeds(graph))
    server.close()
    output, complaints = run.communicate(timeout=180)
    assert (run.returncode, complaints) == (0, "")
    assert f"ws://127.0.0.1:{server.port}" in output
    ending = re.fullmatch(r"drive: \d+\.\d s, (\d+) ticks; m/a active; 1 issue", output.splitlines()[-1])
    assert ending is not None
    assert int(ending[1]) > 30, "the loop kept its rate"  # of 80, or what a loaded machine makes of it
    (issue,) = (
        event for event in map(json.loads, trace.read_text().splitlines()) if event["event"] == "issue"
    )
    assert issue["element"] == "m/a"


def test_a_program_for_the_simulator_is_shown_without_its_world() -> None:
    assert where(RosBridge(), "line") == "ros"


def test_an_unknown_option_of_the_bridge_exits_with_2(server: Any, bare_lrp: Start, drive: Path) -> None:
    run = bare_lrp("run", drive, *on(server.port, "--option", "topic=/light"), missing=ROS)
    _output, complaints = run.communicate(timeout=180)
    assert run.returncode == 2
    assert "has no option `topic`" in complaints


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (on(9), "No rosbridge server answers at `ws://127.0.0.1:9`"),
        (on(9, "--option", "backend=rosbrige"), "Did you mean `rosbridge`?"),
        (on(9, "--option", "setup=nowhere.json"), "The set-up nowhere.json cannot be read"),
        (on(9, "--option", "patience=soon"), "`patience` takes a number, not `soon`"),
        (on(9, "--speed", "2"), "`ros` moves in real time"),
        (on(9, "--world", "line"), "--world is for the simulator"),
    ],
)
def test_what_cannot_be_opened_exits_with_2_and_one_sentence(
    bare_lrp: Start, drive: Path, arguments: tuple[str, ...], sentence: str
) -> None:
    run = bare_lrp("run", drive, *arguments, missing=ROS)
    _output, complaints = run.communicate(timeout=180)
    assert run.returncode == 2
    assert sentence in " ".join(complaints.replace("│", " ").split())
    assert "Traceback" not in complaints


def last_state(trace: list[str]) -> str:
    """The state that was entered last."""
    lines = [json.loads(line) for line in trace]
    return str(next(line["state"] for line in reversed(lines) if line["event"] == "entered"))
