"""``lrp run … --bridge ev3``: the command line drives an EV3 brick, where there is no Jupyter."""

from __future__ import annotations

import json
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from bridges.ev3.brick import Brick, Hands
from bridges.ev3.conftest import equip
from support.waiting import until

pytestmark = pytest.mark.slow  # each starts processes of its own

ROVER = """
(var speed := [40])
(machine rover
  (event bump [robot.sensor1.read() == 1])
  (state drive (onentry [robot.motorB.start_at_speed(speed)]))
  (state halt (onentry [robot.motorB.stop()]))
  (on bump drive -> halt tbump))
(spawn rover drive)
"""

PATIENT = """
from lrp_jupyter.bridges.guarding import guard
from lrp_jupyter.bridges.ev3.client import BrickClient
guard.SILENCE = guard._LAPSE = 3600.0
BrickClient.request.__defaults__ = BrickClient.command.__defaults__ = (60.0,)  # it may be held up
"""

Start = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture
def brick(make_brick: Callable[..., Brick], clock: Hands) -> Brick:
    """A brick on the loopback, with its motors in virtual time."""
    return equip(make_brick(clock=clock))


@pytest.fixture
def rover(tmp_path: Path) -> Path:
    path = tmp_path / "rover.lrp"
    path.write_text(ROVER, encoding="utf-8")
    return path


@pytest.fixture
def at(free_udp_port: int) -> Callable[[Any], tuple[object, ...]]:
    """Options that lead to a brick."""

    def options(brick: Any) -> tuple[object, ...]:
        ports = ("--option", f"port={brick.port}", "--option", f"beacon_port={free_udp_port}")
        return ("--bridge", "ev3", "--host", "127.0.0.1", *ports)

    return options


def test_a_program_drives_a_brick_until_it_bumps(brick, at, bare_lrp, rover):
    arguments = ("run", rover, *at(brick), "--set", "speed=30", "--until", "halt", "--trace", "-")
    run = bare_lrp(*arguments, before=PATIENT)
    until(lambda: brick.motors[1].turning == 30)
    brick.sensors[0].values[0] = 1.0
    output, complaints = run.communicate(timeout=180)
    lines = [json.loads(line) for line in output.splitlines()]
    events = [line for line in lines if line["event"] != "commanded"]
    assert run.returncode == 0
    assert "Traceback" not in complaints
    assert [event["event"] for event in events[-3:]] == ["left", "fired", "entered"]
    assert events[-1]["state"] == "rover/halt"
    assert [motor.turning for motor in brick.motors] == [0, 0, 0, 0]
    assert (brick.connections, brick.goodbyes) == (1, 1)


def test_ctrl_c_stops_the_motors(brick, at, bare_lrp, rover):
    run = bare_lrp("run", rover, *at(brick), missing=("websockets",), before=PATIENT)
    until(lambda: brick.motors[1].turning == 40)
    run.send_signal(signal.SIGINT)
    output, complaints = run.communicate(timeout=180)
    assert (run.returncode, complaints) == (130, "")
    assert "rover/drive active" in output.splitlines()[-1]
    assert [motor.turning for motor in brick.motors] == [0, 0, 0, 0]


def test_a_brick_that_hangs_up_is_reported_and_the_run_continues(brick, at, bare_lrp, rover, tmp_path):
    trace = tmp_path / "trace.jsonl"
    run = bare_lrp("run", rover, *at(brick), "--trace", trace, before=PATIENT)
    until(lambda: brick.motors[1].turning == 40)
    brick.unplug()
    brick.hang_up()
    until(lambda: '"issue"' in trace.read_text())
    run.send_signal(signal.SIGINT)
    output, complaints = run.communicate(timeout=180)
    assert (run.returncode, complaints) == (130, "")
    assert "The brick closed the connection" in output or "The connection to the brick broke" in output
    assert "rover/drive active; 1 issue" in output.splitlines()[-1]


def test_a_host_that_is_not_a_brick_exits_with_4_and_one_sentence(brick, at, bare_lrp, rover):
    brick.unplug()
    run = bare_lrp("run", rover, *at(brick), "--option", "patience=0.3")
    _output, complaints = run.communicate(timeout=180)
    assert run.returncode == 4
    assert complaints.startswith("lrp: ")
    assert "127.0.0.1" in complaints
    assert "Traceback" not in complaints
