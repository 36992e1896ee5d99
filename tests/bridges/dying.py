"""Programs that drive a robot and are killed or suspended: of the command line, and in a real kernel.

A robot is described by how the two reach it, and by what it was told, as itself reports it. For one more
kind, write a fixture `robot` and a subclass of `StandsStill` whose name begins with ``Test``.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import psutil
from bridges.bounded import bounded

_CONNECTED = (2.5, 5.0, 10.0)  # s until a guard has connected to the robot: more if it came too late
PROGRAM = "(machine m (state s (running [robot.move(linear=0.2)]))) (spawn m s)"

_LRP = "{imports}\nfrom lrp_jupyter.cli import main\nmain()"
_CELL = """
import signal
from lrp_jupyter import Session
{cell}
session = Session({program!r}, bridge)
session.start()
bridge.arm()
"""


def wait_until(holds: Callable[[], object], what: str = "", seconds: float = 60.0) -> None:
    """Wait for what another process or thread does."""
    end, tick = time.monotonic() + seconds, threading.Event()
    while not holds():
        assert time.monotonic() < end, what or "it did not happen"
        tick.wait(0.02)


@dataclass
class Robot:
    """A robot in a process of its own.

    Attributes
    ----------
    speeds : callable
        Returns when it was told which speed, by `time.monotonic`, as far as the speed was another one.
    arguments : sequence of str
        Of ``lrp run``.
    imports : str
        What ``lrp`` imports before.
    cell : str
        Code that makes `bridge` in a notebook.
    """

    speeds: Callable[[], list[tuple[float, float]]]
    arguments: Sequence[str]
    cell: str
    imports: str = ""
    environment: Mapping[str, str] = field(default_factory=lambda: dict(os.environ))

    @property
    def drives(self) -> bool:
        """Whether it was told to drive last."""
        return any(speed for _, speed in self.speeds()[-1:])

    @property
    def stands(self) -> bool:
        """Whether it was told to stand last."""
        return [speed for _, speed in self.speeds()[-1:]] == [0.0]

    def has_driven_for(self, seconds: float) -> None:
        """Wait until it has driven for a while."""
        wait_until(lambda: self.drives and time.monotonic() - self.speeds()[-1][0] > seconds)

    def stood_after(self, moment: float) -> float:
        """Seconds from a moment until it was told to stand, for the last time."""
        return self.speeds()[-1][0] - moment


class Driver(Protocol):
    """A program that drives a robot.

    Attributes
    ----------
    pid : int
        Of its process.
    """

    pid: int

    def __init__(self, robot: Robot, folder: Path) -> None: ...

    def reason(self) -> str:
        """Return why it is paused, or all that it printed."""
        ...

    def notices(self) -> str:
        """Return what was said of the robot."""
        ...

    def resume(self) -> None:
        """Have it drive on; a command line without a keyboard has ended."""
        ...

    def end(self) -> None:
        """End what is left of it."""
        ...


class CommandLine:
    """``lrp run``."""

    def __init__(self, robot: Robot, folder: Path, text: str = PROGRAM) -> None:
        program = folder / "drive.lrp"
        program.write_text(text, encoding="utf-8")
        code = _LRP.format(imports=robot.imports)
        self._log = folder / "log"
        with self._log.open("w") as log:
            self.process = subprocess.Popen(
                [sys.executable, "-c", code, "run", str(program), *robot.arguments],
                env={**robot.environment, "PYTHONWARNINGS": ""},
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        self.pid = self.process.pid

    def reason(self) -> str:
        return " ".join(self._log.read_text().split())

    def notices(self) -> str:
        return self.reason()

    def resume(self) -> None:
        assert self.process.wait(60) == 1, "nobody could resume it"

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
        self._run(_CELL.format(cell=robot.cell, program=PROGRAM))

    def _run(self, code: str, expression: str = "''") -> str:
        reply = self._client.execute(code, reply=True, timeout=120, user_expressions={"it": expression})
        assert reply["content"]["status"] == "ok", "\n".join(reply["content"].get("traceback", []))
        data: Any = reply["content"]["user_expressions"]["it"]["data"]["text/plain"]
        return str(data)

    def reason(self) -> str:
        return self._run("", "session.frame.reason")

    def notices(self) -> str:
        return self._run("", "[notice.text for notice in bridge.safety.notices]")

    def resume(self) -> None:
        self._run("session.resume()")

    def end(self) -> None:
        self._client.stop_channels()
        self._manager.shutdown_kernel(now=True)


DRIVERS: Mapping[str, Callable[[Robot, Path], CommandLine | Kernel]] = {
    "lrp run": CommandLine,
    "kernel": Kernel,
}


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


class StandsStill:
    """A robot stands although the program that drives it is dead or suspended.

    Attributes
    ----------
    guarded : bool
        Whether a guard does that; else the robot itself.
    """

    guarded = True

    def test_after_kill_9_of_its_program(
        self, robot: Robot, driver: Driver, tmp_path: Path, record_property: Callable[..., None]
    ) -> None:
        def scenario(driver: Driver, connected: float) -> None:
            with in_time():
                robot.has_driven_for(connected)
            processes = guards(driver.pid)
            assert len(processes) == self.guarded
            moment = self._stands_after(driver, signal.SIGKILL, robot)
            record_property("stands after", robot.stood_after(moment))
            wait_until(lambda: not any(map(lives, processes)), "the guard lingers")

        patiently(scenario, robot, driver, tmp_path)

    def test_while_its_program_is_suspended_and_does_not_drive_on_by_itself(
        self, robot: Robot, driver: Driver, tmp_path: Path, record_property: Callable[..., None]
    ) -> None:
        def scenario(driver: Driver, connected: float) -> None:
            with in_time():
                robot.has_driven_for(connected)
            moment = self._stands_after(driver, signal.SIGSTOP, robot)
            record_property("stands after", robot.stood_after(moment))
            stood = len(robot.speeds())
            wait_until(lambda: time.monotonic() - moment > 1.5)  # a brick stops sooner than that
            kill(driver, signal.SIGCONT)
            try:
                wait_until(lambda: "This program was suspended for" in driver.reason())
            except AssertionError:
                raise AssertionError(f"no one is told, but {driver.reason()!r}: {driver.notices()}") from None
            with in_time():  # only what was on its way may still arrive, with the stop right after it
                wait_until(lambda: robot.stands, "it drives on by itself", 0.5)
            after = robot.speeds()[stood:]
            assert len([speed for _, speed in after if speed]) <= 1, "it drove on by itself"
            drove = after[-1][0] - after[0][0] if after else 0.0
            record_property("drove on for", drove)
            with in_time():
                assert drove < 0.2, f"it drove on for {drove:.2f} s"
            assert "publishes on" not in driver.notices(), f"no other node commands: {driver.notices()}"
            with in_time():  # a guard whose report is late is not named
                who = ", and the guard stopped the robot." if self.guarded else ": the robot was stopped."
                assert who in driver.reason()
            driver.resume()

        patiently(scenario, robot, driver, tmp_path)

    def _stands_after(self, driver: Driver, number: signal.Signals, robot: Robot) -> float:
        """Kill or suspend the program; return the moment when the robot stands, which is soon."""
        with in_time(), bounded(1.5):
            moment = kill(driver, number)
            wait_until(lambda: robot.stands)
        return moment


class LateError(AssertionError):
    """Something came too late, maybe only because the machine has so much to do."""


@contextmanager
def in_time() -> Iterator[None]:
    """Assert something that a loaded machine breaks."""
    try:
        yield
    except AssertionError as error:
        raise LateError(str(error)) from error


def patiently(scenario: Callable[[Driver, float], None], robot: Robot, driver: Driver, folder: Path) -> None:
    """Run a scenario with a program that drives, and with up to two more where something came too late.

    A machine that holds up a program or its guard does so now and then; a fault does so each time.
    """
    with ExitStack() as started:
        for connected in _CONNECTED:
            try:
                scenario(driver, connected)
                return
            except LateError as late:
                if connected == _CONNECTED[-1]:
                    raise
                sys.stderr.write(f"Trying again: {late}\n")
            kill(driver, signal.SIGKILL)
            wait_until(lambda: robot.stands, "it was not stopped")
            driver = type(driver)(robot, folder)
            started.callback(driver.end)


def kill(driver: Driver, number: signal.Signals) -> float:
    """Send a signal; return the moment, by `time.monotonic`."""
    moment = time.monotonic()
    os.kill(driver.pid, number)
    return moment
