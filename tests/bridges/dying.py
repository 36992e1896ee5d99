"""Programs that drive a robot and are killed or suspended: of the command line, and in a real kernel.

A robot is described by how the two reach it, and by what it was told, as itself reports it. For one more
kind, write a fixture `robot` and a subclass of `StandsStill` whose name begins with ``Test``.

A program that the machine holds up is suspended, too, and its robot is rightly stopped: what is tested here
holds in either case. Where only the death of the program may stop the robot, its guard is patient.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import psutil
from bridges import wheels
from support.waiting import until

PROGRAM = "(machine m (state s (running [robot.move(linear=0.2)]))) (spawn m s)"
PATIENT = "from lrp_jupyter.bridges.guarding import guard\nguard.SILENCE = guard._LAPSE = 3600.0\n"

_LRP = "{imports}\n{before}\nfrom lrp_jupyter.cli import main\nmain()"
_CELL = """
from lrp_jupyter import Session
{cell}
session = Session({program!r}, bridge)
session.start()
bridge.arm()
"""


@dataclass
class Robot:
    """A robot in a process of its own.

    Attributes
    ----------
    speeds : callable
        Returns when it was told which speed, by `time.monotonic`, as far as the speed was another one.
    arguments : sequence of str
        Of ``lrp run``.
    cell : str
        Code that makes `bridge` in a notebook.
    imports : str
        What ``lrp`` imports before.
    program : str
        What it runs.
    """

    speeds: Callable[[], list[tuple[float, float]]]
    arguments: Sequence[str]
    cell: str = ""
    imports: str = ""
    environment: Mapping[str, str] = field(default_factory=lambda: dict(os.environ))
    program: str = PROGRAM

    @property
    def told(self) -> list[float]:
        """The speeds."""
        return [speed for _, speed in self.speeds()]

    @property
    def drives(self) -> bool:
        """Whether it was told to drive last."""
        return any(self.told[-1:])

    @property
    def stands(self) -> bool:
        """Whether it was told to stand last."""
        return self.told[-1:] == [0.0]

    def is_driven(self) -> None:
        """Wait until it was told to drive."""
        until(lambda: any(self.told), "it does not drive")

    def is_stopped(self) -> None:
        """Wait until it was told to stand, and nothing else after that."""
        until(lambda: self.stands, "it was not stopped")


class CommandLine:
    """``lrp run``, without a keyboard; `before` is code that runs before it, `stdout` a descriptor."""

    def __init__(
        self,
        robot: Robot,
        folder: Path,
        text: str = "",
        before: str = "",
        options: Sequence[str] = (),
        stdout: int | None = None,
    ) -> None:
        program = folder / "drive.lrp"
        program.write_text(text or robot.program, encoding="utf-8")
        code = _LRP.format(imports=robot.imports, before=before)
        self._log = folder / "log"
        with self._log.open("w") as log:
            self.process = subprocess.Popen(
                [sys.executable, "-c", code, "run", str(program), *robot.arguments, *options],
                env={**robot.environment, "PYTHONWARNINGS": ""},
                stdin=subprocess.DEVNULL,
                stdout=log if stdout is None else stdout,
                stderr=log,
                start_new_session=True,
            )
        self.pid = self.process.pid

    def said(self) -> str:
        """All that it printed."""
        return " ".join(self._log.read_text().split())

    def end(self) -> None:
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait(60)


class Kernel:
    """A session in a real Jupyter kernel."""

    def __init__(self, robot: Robot, folder: Path) -> None:
        from jupyter_client.manager import KernelManager

        self._manager = KernelManager(kernel_name="python3")
        self._manager.start_kernel(cwd=str(folder), env={**robot.environment, "PYTHONWARNINGS": ""})
        self._client = self._manager.client()
        self._client.start_channels()
        self._client.wait_for_ready(timeout=120)
        self.pid = self._manager.provisioner.pid  # type: ignore[union-attr]
        self.run(_CELL.format(cell=robot.cell, program=PROGRAM))

    def run(self, code: str, expression: str = "''") -> str:
        reply = self._client.execute(code, reply=True, timeout=120, user_expressions={"it": expression})
        assert reply["content"]["status"] == "ok", "\n".join(reply["content"].get("traceback", []))
        data: Any = reply["content"]["user_expressions"]["it"]["data"]["text/plain"]
        return str(data)

    def said(self) -> str:
        """Why it is paused."""
        return self.run("", "session.frame.reason")

    def end(self) -> None:
        self._client.stop_channels()
        self._manager.shutdown_kernel(now=True)


WHEELS = Path(wheels.__file__)
# the class is one of the notebook, so no module has it
_NOTEBOOK = """
source = {source!r}
exec(source.replace("from __future__ import annotations", ""))
bridge = WheelsBridge({port})
"""


@contextmanager
def on_wheels() -> Iterator[Callable[[], Robot]]:
    """Start the robot behind a socket; a call has it stand, and forgets what it was told until then."""
    with subprocess.Popen([sys.executable, str(WHEELS)], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        stdout, told = process.stdout, list[tuple[float, float]]()
        port = int(stdout.readline())

        def listen() -> None:
            for line in stdout:
                moment, speed = map(float, line.split())
                told.append((moment, speed))

        def standing() -> Robot:
            wheels.halt(port)
            until(lambda: not any(speed for _, speed in told[-1:]))
            before = len(told)
            paths = str(WHEELS.parents[1]), os.environ.get("PYTHONPATH")
            return Robot(
                lambda: told[before:],
                ("--bridge", "wheels", "--option", f"port={port}"),
                _NOTEBOOK.format(source=WHEELS.read_text().partition("\nclass Wheels:")[0], port=port),
                "import bridges.wheels",
                {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, paths))},
            )

        listener = threading.Thread(target=listen)
        listener.start()
        yield standing
        process.kill()
        listener.join()


def guards(pid: int) -> list[int]:
    """Return the guard processes of a process."""
    found = psutil.process_iter(["ppid", "cmdline"])  # `ps` cuts off what its terminal has no room for
    children = [process for process in found if process.info["ppid"] == pid]
    return [
        each.pid for each in children if "lrp_jupyter.bridges.guard_process" in (each.info["cmdline"] or ())
    ]


def lives(pid: int) -> bool:
    """Whether there is such a process; one that nobody has waited for does not live."""
    try:
        return psutil.Process(pid).status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


def kill(driver: CommandLine | Kernel, robot: Robot) -> None:
    """Kill a program, and wait until its guard has stopped the robot, and ended."""
    until(lambda: len(guards(driver.pid)) == 1, "it has no guard")
    processes = guards(driver.pid)
    os.kill(driver.pid, signal.SIGKILL)
    robot.is_stopped()
    until(lambda: not any(map(lives, processes)), "the guard lingers")


def suspend(driver: CommandLine | Kernel, robot: Robot) -> int:
    """Suspend a program until its robot stands, and wake it; return how much the robot had been told then."""
    os.kill(driver.pid, signal.SIGSTOP)
    robot.is_stopped()
    told = len(robot.told)
    os.kill(driver.pid, signal.SIGCONT)
    until(lambda: "This program was suspended for" in driver.said(), driver.said)
    return told


def does_not_drive_on(robot: Robot, told: int) -> None:
    """Assert that only what was on its way has arrived since then, and the stop after it."""
    robot.is_stopped()
    assert len([speed for speed in robot.told[told:] if speed]) <= 1, "it drove on by itself"


class StandsStill:
    """A guard stops a robot whose program is dead or suspended."""

    def test_after_kill_9_of_its_program(self, robot: Robot, tmp_path: Path) -> None:
        driver = CommandLine(robot, tmp_path, before=PATIENT)
        try:
            robot.is_driven()
            kill(driver, robot)
        finally:
            driver.end()

    def test_while_its_program_is_suspended_and_does_not_drive_on_by_itself(
        self, robot: Robot, tmp_path: Path
    ) -> None:
        driver = CommandLine(robot, tmp_path)
        try:
            robot.is_driven()
            told = suspend(driver, robot)
            assert driver.process.wait(60) == 1, "the program did not end"
            does_not_drive_on(robot, told)
            assert "publishes on" not in driver.said(), "the guard is no other node that commands"
        finally:
            driver.end()
