"""A robot stands although the program that drives it is dead or suspended."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from bridges import wheels
from bridges.dying import CommandLine, Robot, StandsStill, guards, lives, wait_until

from lrp_jupyter.bridges import guard
from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.guard import UNGUARDED, Stopper
from lrp_jupyter.errors import BridgeError

pytestmark = pytest.mark.slow  # each starts processes of its own

WHEELS = Path(wheels.__file__)


@pytest.fixture(autouse=True)
def _no_suspension() -> None:
    """Have time pass: here they are."""


@pytest.fixture
def robot() -> Iterator[Robot]:
    """The robot behind a socket."""
    process = subprocess.Popen([sys.executable, str(WHEELS)], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    port, told = int(process.stdout.readline()), []

    def listen() -> None:
        assert process.stdout is not None
        for line in process.stdout:
            moment, speed = map(float, line.split())
            told.append((moment, speed))

    listener = threading.Thread(target=listen)
    listener.start()
    folder = str(WHEELS.parent.parent)
    yield Robot(
        lambda: list(told),
        ("--bridge", "wheels", "--option", f"port={port}"),
        _NOTEBOOK.format(source=WHEELS.read_text().partition("\nclass Wheels:")[0], port=port),
        "import bridges.wheels",
        {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, (folder, os.environ.get("PYTHONPATH"))))},
    )
    process.kill()
    process.wait()
    listener.join()
    process.stdout.close()


# the class is one of the notebook, so no module has it
_NOTEBOOK = """
source = {source!r}
exec(source.replace("from __future__ import annotations", ""))
bridge = WheelsBridge({port})
"""


def port_of(robot: Robot) -> int:
    return int(robot.arguments[-1].partition("=")[2])


class TestARobotBehindASocket(StandsStill):
    """Its stopper is a bridge of a module, or of the notebook."""


@pytest.mark.parametrize("driver", ["lrp run"], indirect=True)
def test_ctrl_c_stops_the_robot_and_ends_the_guard(robot: Robot, driver: CommandLine) -> None:
    (process,) = guards(driver.pid)
    os.killpg(driver.pid, signal.SIGINT)  # as a terminal does
    assert driver.process.wait(60) == 130
    wait_until(lambda: robot.stands)
    wait_until(lambda: not lives(process), "the guard lingers")


_HELD = """
(machine m
  (state drive (running [robot.move(linear=0.2)]))
  (state held (running [__import__("ctypes").PyDLL(None).sleep(600)])) ; it keeps the interpreter lock
  (ontime 1500 drive -> held))
(spawn m drive)
"""


@pytest.mark.skipif(os.name != "posix", reason="the call is one of POSIX")
def test_a_robot_stands_while_a_call_of_c_keeps_the_interpreter_lock(robot: Robot, tmp_path: Path) -> None:
    driver = CommandLine(robot, tmp_path, _HELD)
    try:
        wait_until(lambda: any(speeds(robot)))
        wait_until(lambda: robot.stands)
        assert driver.process.poll() is None
        assert "was suspended" not in driver.reason(), "it still is"
    finally:
        driver.end()


_KILLED_AT_ONCE = """
import os
import signal
from bridges.wheels import WheelsBridge

bridge = WheelsBridge({port})
bridge.open()
bridge.arm()
print(bridge._guard._process._process.pid, flush=True)
{meanwhile}
bridge.robot.move(linear=0.3)
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.parametrize(
    "meanwhile",
    [
        pytest.param("", id="while the guard is starting"),
        pytest.param("while not bridge._guard._process._is_ready: pass", id="right after the first command"),
    ],
)
def test_a_program_that_is_killed_at_once_leaves_neither_a_moving_robot_nor_a_guard(
    robot: Robot, meanwhile: str
) -> None:
    code = _KILLED_AT_ONCE.format(port=port_of(robot), meanwhile=meanwhile)
    done = subprocess.run([sys.executable, "-c", code], env=robot.environment, stdout=subprocess.PIPE)
    assert done.returncode == -signal.SIGKILL
    wait_until(lambda: speeds(robot) == [0.3, 0.0])
    wait_until(lambda: not lives(int(done.stdout)), "a guard lingers")


def test_a_child_that_holds_the_pipe_open_keeps_no_guard_alive(robot: Robot) -> None:
    code = _KILLED_AT_ONCE.format(port=port_of(robot), meanwhile="if not os.fork(): signal.pause()")
    process = subprocess.Popen(
        [sys.executable, "-c", code], env=robot.environment, stdout=subprocess.PIPE, start_new_session=True
    )
    try:
        assert process.wait(60) == -signal.SIGKILL
        assert process.stdout is not None
        with process.stdout:
            guarding = int(process.stdout.readline())
        wait_until(lambda: robot.stands)
        wait_until(lambda: not lives(guarding), "the guard lingers")
    finally:
        os.killpg(process.pid, signal.SIGKILL)


# -- in this process ------------------------------------------------------------------------------


class Driven(wheels.WheelsBridge, offered=False):
    """The robot behind a socket, with any stopper."""

    kind: Stopper | Exception | None = None

    def stopper(self) -> Stopper | None:
        if isinstance(self.kind, Exception):
            raise self.kind
        return self.kind


@pytest.fixture
def drive(robot: Robot) -> Iterator[Callable[..., Driven]]:
    """Open and arm a bridge to the robot, with a stopper."""
    bridges: list[Driven] = []

    def build(kind: Stopper | Exception | None) -> Driven:
        bridge = Driven(port_of(robot))
        bridge.kind = kind
        bridges.append(bridge)
        bridge.open()
        bridge.arm()
        return bridge

    yield build
    for bridge in bridges:
        bridge.close()
    wait_until(lambda: not guards(os.getpid()), "a guard lingers")


def texts(bridge: Bridge, kind: str = "guard") -> list[str]:
    return [notice.text for notice in bridge.safety.notices if notice.kind == kind]


def ready(bridge: Bridge) -> bool:
    process = bridge._guard._process
    return process is not None and process._is_ready


def suspend(bridge: Bridge, robot: Robot) -> None:
    """Have no beat come, as while this process is suspended, until the robot stands."""
    send_no_beat(bridge)
    wait_until(lambda: robot.stands)


def send_no_beat(bridge: Bridge) -> None:
    thread = bridge._guard._thread
    assert thread is not None
    bridge._guard._end.set()
    thread.join()


def speeds(robot: Robot) -> list[float]:
    """What it was told, whenever: a process that is held up has its robot stopped."""
    return [speed for _, speed in robot.speeds()]


@pytest.mark.parametrize(
    "target",
    [
        "bridges.wheels:Wheels",
        "bridges.wheels:halt",
        "bridges.wheels:WheelsBridge",
        wheels.Wheels,
        wheels.halt,
        pytest.param(lambda port: wheels.halt(port), id="a function that no module has"),
    ],
)
def test_a_class_a_function_and_a_bridge_stop_the_robot(
    robot: Robot, drive: Callable[..., Driven], target: Any
) -> None:
    bridge = drive(Stopper(target, {"port": port_of(robot)}))
    wait_until(lambda: ready(bridge), bridge.failsafe)
    bridge.robot.move(linear=0.3)
    wait_until(lambda: 0.3 in speeds(robot))
    suspend(bridge, robot)
    bridge.robot.move(linear=0.3)  # comes too late
    assert speeds(robot) == [0.3, 0.0]
    (told,) = texts(bridge)
    assert "suspended for" in told
    assert "the guard stopped the robot" in told
    bridge.arm()
    bridge.robot.move(linear=0.2)
    wait_until(lambda: 0.2 in speeds(robot))


@pytest.mark.parametrize("target", [wheels.halt, wheels.WheelsBridge])
def test_a_robot_that_stands_is_left_to_others(
    robot: Robot, drive: Callable[..., Driven], target: Any
) -> None:
    bridge = drive(Stopper(target, {"port": port_of(robot)}))
    wait_until(lambda: ready(bridge))
    bridge.robot.move(linear=0.3)
    bridge.robot.move(linear=0.0)
    bridge.robot.move(linear=0.3)
    bridge.stop_all()
    wait_until(lambda: speeds(robot) == [0.3, 0.0, 0.3, 0.0])
    with socket.create_connection(("127.0.0.1", port_of(robot))) as another:
        another.sendall(b"0.5\n")
        wait_until(lambda: robot.drives)
        beat = bridge._guard._beat
        wait_until(lambda: bridge._guard._beat > beat + 0.2, "the guard knows")
        process = bridge._guard._process
        assert process is not None
        send_no_beat(bridge)
        process._pipe.close()
        wait_until(lambda: process.is_gone, "it has nothing to do")
        another.sendall(b"0.6\n")
        wait_until(lambda: 0.6 in speeds(robot))
    assert speeds(robot)[-3:] == [0.0, 0.5, 0.6]


def test_a_suspension_right_after_a_check_is_found_by_the_next_one(
    robot: Robot, drive: Callable[..., Driven], monkeypatch: pytest.MonkeyPatch
) -> None:
    bridge = drive(None)
    send_no_beat(bridge)
    bridge.robot.move(linear=0.3)
    wait_until(lambda: robot.drives)
    check, awake = bridge._guard.check, guard.now
    slept = 0.0

    def suspended_then() -> None:
        nonlocal slept
        check()
        slept = 5.0

    monkeypatch.setattr(guard, "now", lambda: awake() + slept)
    with monkeypatch.context() as patched:
        patched.setattr(bridge._guard, "check", suspended_then)
        bridge._guard._turn(threading.Event())
    bridge.robot.move(linear=0.4)
    wait_until(lambda: robot.stands)
    assert speeds(robot) == [0.3, 0.0]
    (told,) = texts(bridge)
    assert told.startswith("This program was suspended for 5.")


def test_a_guard_is_found_however_narrow_the_terminal_is(
    robot: Robot, drive: Callable[..., Driven], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "20")
    drive(Stopper(wheels.halt, {"port": port_of(robot)}))
    assert len(guards(os.getpid())) == 1


def test_the_stopper_of_another_robot_is_another_guard(robot: Robot, drive: Callable[..., Driven]) -> None:
    bridge = drive(Stopper(wheels.halt, {"port": 9}))
    wait_until(lambda: ready(bridge))
    first = guards(os.getpid())
    bridge.kind = Stopper(wheels.halt, {"port": port_of(robot)})
    wait_until(lambda: guards(os.getpid()) not in ([], first))
    wait_until(lambda: ready(bridge) and len(guards(os.getpid())) == 1)
    bridge.robot.move(linear=0.3)
    wait_until(lambda: 0.3 in speeds(robot))
    suspend(bridge, robot)


def test_a_stopper_that_is_made_again_each_time_is_the_same_one(
    robot: Robot, drive: Callable[..., Driven], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []

    def stopper(bridge: Driven) -> Stopper:
        asked.append(bridge)
        return Stopper(lambda port: wheels.halt(port), {"port": bridge.port})

    monkeypatch.setattr(Driven, "stopper", stopper)
    bridge = drive(None)
    wait_until(lambda: ready(bridge))
    first, before = guards(os.getpid()), len(asked)
    wait_until(lambda: len(asked) > before + 3)
    assert guards(os.getpid()) == first
    bridge.robot.move(linear=0.3)
    wait_until(lambda: 0.3 in speeds(robot))
    suspend(bridge, robot)


def test_a_guard_that_crashes_is_told_and_another_one_is_started(
    robot: Robot, drive: Callable[..., Driven], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(guard, "_STEADY", 0.0)
    bridge = drive(Stopper(wheels.halt, {"port": port_of(robot)}))
    (process,) = guards(os.getpid())
    os.kill(process, signal.SIGKILL)
    told = "The guard process ended by itself (exit code -9). Another one is started."
    wait_until(lambda: texts(bridge) == [told])
    wait_until(lambda: guards(os.getpid()) not in ([], [process]))
    bridge.robot.move(linear=0.3)
    wait_until(lambda: 0.3 in speeds(robot))
    suspend(bridge, robot)


def test_a_guard_that_crashes_at_once_is_told_and_arming_starts_another_one(
    robot: Robot, drive: Callable[..., Driven], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(guard, "_STEADY", 60.0)
    bridge = drive(Stopper(wheels.halt, {"port": port_of(robot)}))
    (process,) = guards(os.getpid())
    os.kill(process, signal.SIGKILL)
    wait_until(lambda: "ended by itself" in bridge.failsafe)
    assert bridge.failsafe.startswith(UNGUARDED[:-1])
    assert "Disarm and arm the robot" in texts(bridge)[0]
    bridge.disarm()
    bridge.arm()
    wait_until(lambda: ready(bridge))
    assert bridge.failsafe == bridge.guarded_by


@pytest.mark.parametrize(
    ("kind", "why"),
    [
        (Stopper("nowhere:Nothing"), "No module named 'nowhere'"),
        (Stopper("bridges.wheels:Brakes"), "has no attribute 'Brakes'"),
        (Stopper(wheels.Wheels, {"port": 9}), "refused"),
        (Stopper(wheels.Wheels, {"prot": 9}), "prot"),
        (Stopper(threading.Lock().acquire), "cannot be sent to another process"),
        (Stopper(wheels.Wheels, {"port": object()}), "cannot be sent to another process"),
        (BridgeError("Its battery is flat."), "Its battery is flat."),
    ],
    ids=["no module", "no class", "no robot", "arguments", "no function", "no data", "a fault"],
)
def test_a_guard_that_cannot_reach_the_robot_is_told_and_the_robot_is_armed(
    robot: Robot, drive: Callable[..., Driven], monkeypatch: pytest.MonkeyPatch, kind: Any, why: str
) -> None:
    monkeypatch.setattr(guard, "_CONNECT", 60.0)  # or a process that starts slowly is told first
    bridge = drive(kind)
    wait_until(lambda: why in bridge.failsafe, bridge.failsafe)
    assert bridge.failsafe.startswith(UNGUARDED[:-1])
    wait_until(lambda: len(texts(bridge)) == 1)
    assert texts(bridge)[0].startswith("The robot is not guarded. ")
    bridge.robot.move(linear=0.3)
    wait_until(lambda: 0.3 in speeds(robot))


def test_a_robot_that_can_be_reached_again_is_guarded_again(
    robot: Robot, drive: Callable[..., Driven], tmp_path: Path
) -> None:
    found = tmp_path / "found"
    bridge = drive(Stopper(_when_found, {"file": str(found), "port": port_of(robot)}))
    wait_until(lambda: ready(bridge))
    bridge.robot.move(linear=0.3)
    wait_until(lambda: 0.3 in speeds(robot))
    bridge._guard._end.set()
    wait_until(lambda: bridge._guard._process.problem())  # type: ignore[union-attr]
    found.touch()
    wait_until(lambda: robot.stands)


def _when_found(file: str, port: int) -> None:
    from pathlib import Path

    from bridges import wheels

    if not Path(file).exists():
        raise BridgeError("The robot is out of reach.")
    wheels.halt(port)


def test_arming_and_disarming_leaves_no_process_no_thread_and_no_descriptor(
    robot: Robot, drive: Callable[..., Driven]
) -> None:
    bridge = drive(Stopper(wheels.halt, {"port": port_of(robot)}))
    before = 0
    for round_ in range(51):
        bridge.arm()
        bridge.disarm()
        if round_ == 0:
            wait_until(lambda: not guards(os.getpid()))
            wait_until(lambda: not _threads())
            before = _descriptors()
    wait_until(lambda: not guards(os.getpid()))
    wait_until(lambda: not _threads())
    assert _descriptors() <= before, "what other tests left behind may have been closed"
    assert texts(bridge) == []


def _threads() -> list[str]:
    return [thread.name for thread in threading.enumerate() if thread.name.startswith("guard")]


def _descriptors() -> int:
    return len(os.listdir("/proc/self/fd" if os.path.exists("/proc/self/fd") else "/dev/fd"))


def test_no_process_guards_a_robot_without_a_stopper_and_arming_says_so(
    robot: Robot, drive: Callable[..., Driven]
) -> None:
    bridge = drive(None)
    assert bridge.failsafe == UNGUARDED
    assert texts(bridge, "armed")[0].endswith(UNGUARDED)
    assert guards(os.getpid()) == []


def test_no_process_guards_a_robot_in_a_browser(
    robot: Robot, drive: Callable[..., Driven], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "platform", "emscripten")
    bridge = drive(Stopper(wheels.halt, {"port": port_of(robot)}))
    assert "A page of a browser has neither processes nor threads." in texts(bridge, "armed")[0]
    assert guards(os.getpid()) == []
    bridge.robot.move(linear=0.3)
    wait_until(lambda: 0.3 in speeds(robot))
