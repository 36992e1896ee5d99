"""A process that drives a brick and is killed or stopped: the brick stops its motors by itself."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from lrp_jupyter.bridges.ev3.slices import SLICE

pytestmark = pytest.mark.slow  # each starts a process of its own

MOVING = "(machine m (state go (running [robot.move(linear=0.2)])))(spawn m go)"
TURNING = """
(machine m (state go (onentry [robot.motorB.start_at_speed(40); robot.motorC.start_at_power(-60)])))
(spawn m go)
"""
MEASURED = 1.5  # s, what is promised: a slice, with what a loaded machine adds


@pytest.fixture
def brick(make_brick: Callable[..., Any]) -> Any:
    """A brick in real time."""
    return make_brick()


@pytest.fixture
def drives(
    brick: Any, free_udp_port: int, bare_lrp: Callable[..., subprocess.Popen[str]], tmp_path: Path, until: Any
) -> Callable[[str], subprocess.Popen[str]]:
    """Start a program in a process of its own; return the process when it has driven for two slices.

    One that was held up for longer than a slice is rightly at rest: then another one is started.
    """

    def drives(program: str) -> subprocess.Popen[str]:
        path = tmp_path / "program.lrp"
        path.write_text(program, encoding="utf-8")
        ports = ("--option", f"port={brick.port}", "--option", f"beacon_port={free_udp_port}")

        def turning() -> bool:
            return bool(brick.motors[1].turning and brick.motors[2].turning)

        for _ in range(5):
            run = bare_lrp("run", path, "--bridge", "ev3", "--host", "127.0.0.1", *ports)
            until(turning)
            begun = time.monotonic()
            until(lambda begun=begun: time.monotonic() > begun + 2 * SLICE)
            if turning():
                return run
            run.kill()
            run.wait(60)
            until(lambda: not turning())
        raise AssertionError("the motors do not go on turning")

    return drives


def stood_after(brick: Any, until: Any, since: float) -> float:
    """Wait until all motors stand; return the seconds until then, by the brick's own clock."""
    until(lambda: not any(motor.turning for motor in brick.motors))
    return max(motor.ends for motor in brick.motors[1:3]) - since


@pytest.mark.parametrize("program", [MOVING, TURNING])
def test_killed_in_the_middle_of_driving_the_motors_stand_at_once(
    brick: Any, drives: Callable[[str], subprocess.Popen[str]], until: Any, program: str
) -> None:
    run = drives(program)
    killed = time.monotonic()
    run.kill()
    assert stood_after(brick, until, killed) < MEASURED


@pytest.mark.parametrize("program", [MOVING, TURNING])
def test_stopped_in_the_middle_of_driving_the_motors_stand_at_once(
    brick: Any, drives: Callable[[str], subprocess.Popen[str]], until: Any, program: str
) -> None:
    run = drives(program)
    stopped = time.monotonic()
    os.kill(run.pid, signal.SIGSTOP)
    assert stood_after(brick, until, stopped) < MEASURED


def test_a_motor_that_was_started_once_stands_still_when_the_process_goes_on(
    brick: Any, drives: Callable[[str], subprocess.Popen[str]], until: Any
) -> None:
    run = drives(TURNING)
    os.kill(run.pid, signal.SIGSTOP)
    stood_after(brick, until, 0)
    frames, starts = len(brick.frames), brick.motors[1].starts
    os.kill(run.pid, signal.SIGCONT)
    until(lambda: len(brick.frames) > frames + 20)
    assert brick.motors[1].starts == starts
    run.send_signal(signal.SIGINT)
    output, _complaints = run.communicate(timeout=180)
    assert "nothing renewed it for 0.6 s" in output or "the robot was stopped" in output
