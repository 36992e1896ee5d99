"""The example bridges of the notebooks' folder, and the robots that they meet here."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NoReturn

import pytest

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.live.session import Session

HERE = Path(__file__).parent
EXAMPLES = Path(__file__).parents[3] / "notebooks" / "bridges"


@pytest.fixture(autouse=True)
def _nothing_is_left_behind() -> Iterator[None]:
    """Neither threads nor names of bridges."""
    threads, names = set(threading.enumerate()), dict(Bridge.registry)
    yield
    Bridge.registry.clear()
    Bridge.registry.update(names)
    left = set(threading.enumerate()) - threads
    for thread in left:
        thread.join(60)
    assert not [thread for thread in left if thread.is_alive()]


class Processes:
    """Programs of this folder, which say `ready`; all are ended in the end."""

    def __init__(self) -> None:
        self._running: list[subprocess.Popen[str]] = []
        self._listeners: list[threading.Thread] = []

    def start(self, *command: object, ready: bool = True) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [str(part) for part in command], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self._running.append(process)
        if ready:
            assert process.stdout is not None
            assert process.stdout.readline().startswith("ready")
        return process

    def robot(self, name: str, *arguments: object) -> subprocess.Popen[str]:
        return self.start(sys.executable, HERE / f"{name}_robot.py", *arguments)

    def told(self, robot: subprocess.Popen[str]) -> list[str]:
        """What a robot is told, as it comes: `drives 0.200 0.000`."""
        told: list[str] = []

        def listen() -> None:
            assert robot.stdout is not None
            told.extend(line.strip() for line in robot.stdout)

        self._listeners.append(threading.Thread(target=listen, daemon=True))
        self._listeners[-1].start()
        return told

    def end(self, process: subprocess.Popen[str]) -> None:
        process.kill()
        process.wait()

    def end_all(self) -> None:
        for process in self._running:
            self.end(process)
        for listener in self._listeners:
            listener.join()
        for process in self._running:
            for stream in (process.stdin, process.stdout):
                assert stream is not None
                stream.close()


@pytest.fixture
def processes() -> Iterator[Processes]:
    processes = Processes()
    yield processes
    processes.end_all()


DRIVE = "(machine m (state driving (running [robot.move(linear=0.2)]))) (spawn m driving)"


@pytest.fixture
def driving(processes: Processes, tmp_path: Path) -> Callable[..., subprocess.Popen[str]]:
    """Start `lrp run` with an example bridge, and wait until its robot drives."""

    def start(told: list[str], bridge: str, **options: object) -> subprocess.Popen[str]:
        program = tmp_path / "drive.lrp"
        program.write_text(DRIVE)
        command = [sys.executable, "-m", "lrp_jupyter", "run", program, "--bridge", EXAMPLES / bridge]
        for name, value in options.items():
            command += ["--option", f"{name}={value}"]
        run = processes.start(*command, ready=False)
        wait_until(lambda: told and told[-1] == "drives 0.200 0.000", "it does not drive")
        return run

    return start


def wait_until(holds: Callable[[], object], what: str, seconds: float = 60.0) -> None:
    """Wait for what another process or thread does; fail after so many seconds."""
    over, tick = threading.Event(), threading.Event()
    timer = threading.Timer(seconds, over.set)
    timer.start()
    try:
        while not holds():
            assert not over.is_set(), what
            tick.wait(0.02)
    finally:
        timer.cancel()
        timer.join()


def reaches(session: Session, state: str) -> bool:
    """Wait for a state; where the machine holds this process up, its guard stops the robot: it is resumed."""
    for _ in range(10):
        frame = session.wait_for(lambda frame: frame.count_of(state) or frame.status == "paused", timeout=180)
        if frame.status != "paused":
            return True
        assert "was suspended for" in frame.reason, frame.reason
        session.resume()
    return False


@pytest.fixture(scope="session")
def until() -> Callable[..., None]:
    return wait_until


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def missing(what: str) -> NoReturn:
    """Skip a test for which something is not installed; a failure where everything must be."""
    if os.environ.get("CI", "").lower() == "true":
        pytest.fail(f"{what} is not installed.")
    pytest.skip(f"{what} is not installed.")


class Broker:
    """A real mosquitto on loopback, which can be killed, held and started again."""

    def __init__(self, processes: Processes, port: int = 0, *options: object) -> None:
        program = shutil.which("mosquitto", path=f"{os.environ.get('PATH', '')}:/usr/sbin")
        self._program = program or missing("mosquitto")
        self._processes, self.port = processes, port or free_port()
        self._options = options or ("-p", self.port)
        self.process = self._start()

    def start(self) -> None:
        self.process = self._start()

    def _start(self) -> subprocess.Popen[str]:
        process = self._processes.start(self._program, *self._options, ready=False)
        wait_until(self._answers, "mosquitto did not start")
        return process

    def _answers(self) -> bool:
        with socket.socket() as probe:
            return probe.connect_ex(("127.0.0.1", self.port)) == 0

    def kill(self) -> None:
        self._processes.end(self.process)


@pytest.fixture
def broker(processes: Processes) -> Broker:
    return Broker(processes)
