"""A robot is stopped, and its program ends, whether or not the terminal accepts what the program prints."""

from __future__ import annotations

import os
import select
import signal
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from pathlib import Path

import pytest
from bridges.dying import PATIENT, CommandLine, Robot, on_wheels
from support.waiting import until

termios = pytest.importorskip("termios", reason="Windows has other terminals")
pytestmark = pytest.mark.slow  # each starts processes of its own

LOUD = """
(machine m (state s (running [
  print("x" * 5000)
  robot.move(linear=0.2)
])))
(spawn m s)
"""


@pytest.fixture(scope="module")
def standing() -> Iterator[Callable[[], Robot]]:
    with on_wheels() as standing:
        yield standing


@pytest.fixture
def robot(standing: Callable[[], Robot]) -> Robot:
    """The robot behind a socket, which stands."""
    return standing()


def is_stuck(writer: int, pid: int) -> bool:
    """Whether an output accepts nothing more, and a thread of the program waits for it."""
    if select.select([], [writer], [], 0)[1]:
        return False
    calls = set()
    for thread in Path(f"/proc/{pid}/task").iterdir():
        with suppress(OSError):
            calls.add((thread / "wchan").read_text())
    return bool(calls & {"pipe_write", "anon_pipe_write", "wait_woken"}) or calls <= {
        "0"
    }  # it may not be told


@pytest.fixture
def started(robot: Robot, tmp_path: Path) -> Iterator[Callable[..., tuple[CommandLine, int]]]:
    """Start a program that prints; return it as soon as its output is stuck, and where that can be read."""
    with ExitStack() as stack:

        def start(kind: str, *options: str) -> tuple[CommandLine, int]:
            reader, writer = os.openpty() if kind == "terminal" else os.pipe()
            stack.callback(os.close, reader)
            if kind == "terminal":
                termios.tcflow(writer, termios.TCOOFF)  # as Ctrl-S does
            program = CommandLine(robot, tmp_path, LOUD, PATIENT, options, writer)
            stack.callback(program.end)
            until(lambda: is_stuck(writer, program.pid))
            os.close(writer)
            return program, reader

        yield start


@pytest.mark.parametrize(
    ("kind", "options", "number"),
    [  # each output and each signal; a terminal sends two of them
        pytest.param("terminal", (), signal.SIGINT, id="tty-int"),
        pytest.param("terminal", (), signal.SIGHUP, id="tty-hup"),
        pytest.param("pipe", (), signal.SIGTERM, id="pipe-term"),
        pytest.param("pipe", ("--trace", "-"), signal.SIGINT, id="trace-int"),
    ],
)
def test_a_signal_stops_the_robot_and_ends_the_program(robot, started, kind, options, number):
    program, _ = started(kind, *options)
    robot.is_driven()
    program.process.send_signal(number)
    robot.is_stopped()
    assert program.process.wait(60) == 128 + number
    assert "Fatal" not in program.said()


def test_a_run_stops_the_robot_in_time_and_ends_when_its_output_was_read(robot, started):
    program, reader = started("pipe", "--for", "2")
    robot.is_driven()
    robot.is_stopped()
    text = b""
    while part := os.read(reader, 65536):
        text += part
    assert program.process.wait(60) == 0
    assert text.splitlines()[-1].startswith(b"drive: ")
