"""A process that drives a brick and is killed or stopped: the brick stops its motors by itself."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support.waiting import until

pytestmark = pytest.mark.slow  # each starts a process of its own

MOVING = "(machine m (state go (running [robot.move(linear=0.2)])))(spawn m go)"
TURNING = """
(machine m (state go (onentry [robot.motorB.start_at_speed(40); robot.motorC.start_at_power(-60)])))
(spawn m go)
"""


@pytest.fixture
def brick(make_brick: Callable[..., Any]) -> Any:
    """A brick in real time."""
    return make_brick()


@pytest.fixture
def drives(
    brick: Any, free_udp_port: int, bare_lrp: Callable[..., subprocess.Popen[str]], tmp_path: Path
) -> Callable[[str], subprocess.Popen[str]]:
    """Start a program in a process of its own; return the process when it has driven."""

    def drives(program: str) -> subprocess.Popen[str]:
        path = tmp_path / "program.lrp"
        path.write_text(program, encoding="utf-8")
        ports = ("--option", f"port={brick.port}", "--option", f"beacon_port={free_udp_port}")
        run = bare_lrp("run", path, "--bridge", "ev3", "--host", "127.0.0.1", *ports)
        until(lambda: brick.motors[1].starts and brick.motors[2].starts)
        return run

    return drives


def stands(brick: Any) -> bool:
    return not any(motor.turning for motor in brick.motors)


def test_motors_stand_when_their_program_was_killed(brick, drives):
    drives(MOVING).kill()
    until(lambda: stands(brick))


def test_motors_stand_while_their_program_is_suspended_and_it_does_not_start_them_again(brick, drives):
    run = drives(TURNING)
    os.kill(run.pid, signal.SIGSTOP)
    until(lambda: stands(brick))
    frames, starts = len(brick.frames), brick.motors[1].starts
    os.kill(run.pid, signal.SIGCONT)
    until(lambda: len(brick.frames) > frames + 20 or run.poll() is not None)
    assert brick.motors[1].starts == starts
    run.send_signal(signal.SIGINT)
    output, _complaints = run.communicate(timeout=180)
    assert "nothing renewed it for 0.6 s" in output or "the robot was stopped" in output
