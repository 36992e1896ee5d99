"""The example bridges of the notebooks' folder, and the robots that they meet here."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NoReturn

import pytest
from support.ports import free_port
from support.waiting import no_thread_left, until

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.conformance import BridgeConformance
from lrp_jupyter.bridges.guarding.safety import Safety
from lrp_jupyter.live.session import Session
from lrp_jupyter.sim.simulation import Simulation

HERE = Path(__file__).parent
EXAMPLES = Path(__file__).parents[3] / "notebooks" / "bridges"


@pytest.fixture(autouse=True)
def _nothing_is_left_behind() -> Iterator[None]:
    """Neither threads nor names of bridges."""
    names = dict(Bridge.registry)
    with no_thread_left(lambda thread: thread.name != "listener"):
        yield
        Bridge.registry.clear()
        Bridge.registry.update(names)


class Processes:
    """Programs of this folder, which say `ready`; all are ended in the end."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
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

        self._listeners.append(threading.Thread(target=listen, name="listener", daemon=True))
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
def processes(tmp_path: Path) -> Iterator[Processes]:
    processes = Processes(tmp_path)
    yield processes
    processes.end_all()


@pytest.fixture(scope="class")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Processes]:
    """Those of all tests of a class."""
    processes = Processes(tmp_path_factory.mktemp("shared"))
    yield processes
    processes.end_all()


class OfARobot(BridgeConformance):
    """The checks of a bridge to one robot, a process of its own that is started again when it was killed."""

    moves = True
    processes: Processes
    robot: subprocess.Popen[str]
    told: list[str]
    before = 0

    @pytest.fixture(autouse=True, scope="class")
    @classmethod
    def _robot(cls, shared: Processes) -> None:
        cls.processes = shared
        cls.start()

    @classmethod
    def start(cls) -> None:
        """Start the robot, and set `robot` and `told`."""
        raise NotImplementedError

    def make(self) -> Bridge:
        """Return a bridge to it."""
        raise NotImplementedError

    def make_bridge(self) -> Bridge:
        type(self).before = len(self.told)
        return self.make()

    def has_moved(self, bridge: Bridge) -> bool:
        return any(told != "drives 0.000 0.000" for told in self.told[self.before :])

    def silence(self) -> None:
        self.robot.send_signal(signal.SIGSTOP)

    def cut(self) -> None:
        self.processes.end(self.robot)

    def restore(self) -> None:
        if self.robot.poll() is None:
            self.robot.send_signal(signal.SIGCONT)
        else:
            self.start()


def drives_and_senses(bridge: Bridge, told: Callable[[], list[str]]) -> None:
    """Assert that a robot at the start of its world turns as it was told, and its readings are those."""
    light, bumper = (lambda readings: (readings.lights[0], readings.bumper))(Simulation("line").latch())
    until(lambda: _sensed(bridge) == (pytest.approx(light, abs=3), bumper), "it senses something else")
    bridge.robot.move(linear=0.2, angular=1)
    still = "drives 0.000 0.000"
    until(lambda: any(word.startswith("drives") and word != still for word in told()), "it does not drive")
    first = next(word for word in told() if word.startswith("drives") and word != still)
    assert tuple(map(float, first.split()[1:])) == pytest.approx((0.2, 1.0), abs=0.01)


def _sensed(bridge: Bridge) -> tuple[Any, Any]:
    bridge.refresh()
    return bridge.describe("light.data").value, bridge.describe("bumper.data").value


ROUND = """
(machine round
  (state moving (running [robot.move(linear=0.1)]))
  (state ahead (running [robot.drive_by(0.2)]))
  (state turning (running [robot.turn_by(degrees(90))]))
  (state away (running [robot.drive_by(5)]))
  (state blocked (onentry [print(robot.drive_by.reason)] [robot.turn_by(degrees(2880))]))
  (state over)
  (ontime 300 moving -> ahead)
  (on [robot.drive_by.succeeded] ahead -> turning)
  (on [robot.turn_by.succeeded] turning -> away)
  (on [robot.drive_by.failed] away -> blocked)
  (ontime 1000 blocked -> over))
(spawn round moving)
"""
ASKED = ["drives by 0.200", "turns by 1.571", "drives by 5.000", "turns by 50.265", "drives 0.000 0.000"]


def does_tasks(bridge: str, told: Callable[[], list[str]], **options: object) -> None:
    """Assert that a robot at the start of its world goes through the same states as the simulated one.

    Its last task is cancelled when the state is left.
    """

    def visits(session: Session) -> list[str]:
        visited: list[str] = []
        session.observe(lambda event: visited.append(event.path[-1]) if event.kind == "entered" else None)
        return visited

    with Session(ROUND, "sim") as simulated:
        expected = visits(simulated)
        assert simulated.run(until="over", seconds=60)
    with Session(ROUND, bridge, **options) as session, pytest.MonkeyPatch.context() as patch:
        patch.setattr(Safety, "tick_overdue", lambda *_: None)  # the machine may hold the program up
        visited = visits(session)
        session.bridge.arm()
        session.start()
        assert session.wait_for("over", timeout=120)
        until(lambda: told()[-1:] == ASKED[-1:], "the last task goes on")
        assert not session.issues
        assert "command watchdog" not in [notice.kind for notice in session.bridge.safety.notices]
    assert visited == expected
    asked = [word for word in told() if " by " in word]
    assert asked == ASKED[:-1]


DRIVE = "(machine m (state driving (running [robot.move(linear=0.2)]))) (spawn m driving)"
TURN = "(machine m (state turning (running [robot.turn_by(100)]))) (spawn m turning)"
DOES = {DRIVE: "drives 0.200 0.000", TURN: "turns by 100.000"}


WAYS = pytest.mark.parametrize("driven", [DRIVE, TURN], ids=["by-velocities", "by-a-task"])


@pytest.fixture
def driving(processes: Processes, tmp_path: Path) -> Callable[..., subprocess.Popen[str]]:
    """Start `lrp run` with an example bridge, and wait until its robot does what a program says."""

    def start(told: list[str], bridge: str, driven: str = DRIVE, **options: object) -> subprocess.Popen[str]:
        program = tmp_path / "drive.lrp"
        program.write_text(driven)
        command = [sys.executable, "-m", "lrp_jupyter", "run", program, "--bridge", EXAMPLES / bridge]
        for name, value in options.items():
            command += ["--option", f"{name}={value}"]
        run = processes.start(*command, ready=False)
        until(lambda: told[-1:] == [DOES[driven]], "it does not drive")
        return run

    return start


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
        until(self._answers, "mosquitto did not start")
        return process

    def _answers(self) -> bool:
        with socket.socket() as probe:
            return probe.connect_ex(("127.0.0.1", self.port)) == 0

    def kill(self) -> None:
        self._processes.end(self.process)


@pytest.fixture
def broker(processes: Processes) -> Broker:
    return Broker(processes)
