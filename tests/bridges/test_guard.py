"""A robot stands although the program that drives it is dead or suspended."""

from __future__ import annotations

import gc
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from itertools import count

import pytest
from bridges import wheels
from bridges.dying import (
    PATIENT,
    PROGRAM,
    CommandLine,
    Kernel,
    Robot,
    StandsStill,
    does_not_drive_on,
    guards,
    kill,
    lives,
    on_wheels,
    suspend,
)
from support.robots import Bare
from support.waiting import until

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.guarding import guard
from lrp_jupyter.bridges.guarding.guard import UNGUARDED, Stopper
from lrp_jupyter.errors import BridgeError

pytestmark = pytest.mark.slow  # each starts processes of its own


@pytest.fixture(scope="module")
def standing() -> Iterator[Callable[[], Robot]]:
    with on_wheels() as standing:
        yield standing


@pytest.fixture
def robot(standing: Callable[[], Robot]) -> Robot:
    """The robot behind a socket, which stands."""
    return standing()


def port_of(robot: Robot) -> int:
    return int(robot.arguments[-1].partition("=")[2])


class TestARobotBehindASocket(StandsStill):
    """Its stopper is a bridge of a module."""


def test_a_robot_of_a_notebook_is_guarded_until_its_kernel_is_killed(robot, tmp_path):
    kernel = Kernel(robot, tmp_path)
    try:
        robot.is_driven()
        does_not_drive_on(robot, suspend(kernel, robot))
        kernel.run(f"bridge.disarm()\n{PATIENT}\nbridge.arm()\nsession.resume()")
        until(lambda: robot.drives, "it does not go on when the user says so")
        kill(kernel, robot)
    finally:
        kernel.end()


def test_ctrl_c_stops_the_robot_and_ends_the_guard(robot, tmp_path):
    driver = CommandLine(robot, tmp_path, before=PATIENT)
    try:
        robot.is_driven()
        (process,) = guards(driver.pid)
        os.killpg(driver.pid, signal.SIGINT)  # as a terminal does
        assert driver.process.wait(60) == 130
        robot.is_stopped()
        until(lambda: not lives(process), "the guard lingers")
    finally:
        driver.end()


_HELD = """
(machine m
  (state drive (running [robot.move(linear=0.2)]))
  (state held (running [__import__("ctypes").PyDLL(None).sleep(600)])) ; it keeps the interpreter lock
  (ontime 200 drive -> held))
(spawn m drive)
"""


@pytest.mark.skipif(os.name != "posix", reason="the call is one of POSIX")
def test_a_robot_stands_while_a_call_of_c_keeps_the_interpreter_lock(robot, tmp_path):
    driver = CommandLine(robot, tmp_path, _HELD)
    try:
        robot.is_driven()
        robot.is_stopped()
    finally:
        driver.end()


_KILLED_AT_ONCE = """
import os
import signal
from bridges.wheels import WheelsBridge
{patient}
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
        pytest.param("while not bridge._guard._process.reaches: pass", id="right after the first command"),
    ],
)
def test_a_program_that_is_killed_at_once_leaves_neither_a_moving_robot_nor_a_guard(robot, meanwhile):
    code = _KILLED_AT_ONCE.format(patient=PATIENT, port=port_of(robot), meanwhile=meanwhile)
    done = subprocess.run([sys.executable, "-c", code], env=robot.environment, stdout=subprocess.PIPE)
    assert done.returncode == -signal.SIGKILL
    until(lambda: robot.told == [0.3, 0.0])
    until(lambda: not lives(int(done.stdout)), "a guard lingers")


def test_a_child_that_holds_the_pipe_open_keeps_no_guard_alive(robot):
    code = _KILLED_AT_ONCE.format(
        patient=PATIENT, port=port_of(robot), meanwhile="if not os.fork(): signal.pause()"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code], env=robot.environment, stdout=subprocess.PIPE, start_new_session=True
    )
    try:
        assert process.wait(60) == -signal.SIGKILL
        assert process.stdout is not None
        with process.stdout:
            guarding = int(process.stdout.readline())
        until(lambda: robot.stands)
        until(lambda: not lives(guarding), "the guard lingers")
    finally:
        os.killpg(process.pid, signal.SIGKILL)


# -- in this process ------------------------------------------------------------------------------


class Driven(wheels.WheelsBridge, offered=False):
    """The robot behind a socket, with any stopper."""

    kind: Stopper | BaseException | None = None

    def stopper(self) -> Stopper | None:
        if isinstance(self.kind, BaseException):
            raise self.kind
        return self.kind


@pytest.fixture
def drive(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Driven]]:
    """Open and arm a bridge to the robot, with a stopper; no limit ends what the machine holds up."""
    for limit in ("_CONNECT", "_HELP"):
        monkeypatch.setattr(guard, limit, 60.0)
    bridges: list[Driven] = []

    def build(kind: Stopper | BaseException | None, of: type[Driven] = Driven) -> Driven:
        bridge = of(port_of(robot))
        bridge.kind = kind
        bridges.append(bridge)
        bridge.open()
        bridge.arm()
        return bridge

    yield build
    for bridge in bridges:
        bridge.close()
    until(lambda: not guards(os.getpid()), "a guard lingers")


def texts(bridge: Bridge, kind: str = "guard") -> list[str]:
    return [notice.text for notice in bridge.safety.notices if notice.kind == kind]


def ready(bridge: Bridge) -> bool:
    process = bridge._guard._process
    return process is not None and process.reaches


def die(bridge: Bridge) -> None:
    """Have the guard process hear no more of this one, as when it is dead."""
    send_no_beat(bridge)
    assert bridge._guard._process is not None
    bridge._guard._process._pipe.close()


def send_no_beat(bridge: Bridge) -> None:
    thread = bridge._guard._thread
    assert thread is not None
    bridge._guard._end.set()
    thread.join()


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
def test_a_class_a_function_and_a_bridge_stop_the_robot(robot, drive, target):
    bridge = drive(Stopper(target, {"port": port_of(robot)}))
    until(lambda: ready(bridge), bridge.failsafe)
    bridge.robot.move(linear=0.3)
    until(lambda: 0.3 in robot.told)
    die(bridge)
    robot.is_stopped()
    process = bridge._guard._process
    until(lambda: process.stopped.is_set())
    bridge.robot.move(linear=0.4)  # comes too late
    (told,) = texts(bridge)
    assert "suspended for" in told
    assert "the guard stopped the robot" in told
    bridge.arm()
    bridge.robot.move(linear=0.2)
    until(lambda: 0.2 in robot.told)
    assert robot.told[:3] == [0.3, 0.0, 0.2]


def test_nothing_moves_before_the_robot_is_guarded(robot, monkeypatch):
    bridge = Driven(port_of(robot))
    bridge.kind = Stopper(wheels.halt, {"port": port_of(robot)})
    bridge.open()
    reached, start = threading.Event(), guard.Guard.start

    def slow_start(ours: guard.Guard) -> None:
        start(ours)
        assert reached.wait(60)

    monkeypatch.setattr(guard.Guard, "start", slow_start)
    arming = threading.Thread(target=bridge.arm)
    arming.start()
    until(lambda: ready(bridge))
    bridge.robot.move(linear=0.3)
    assert texts(bridge, "disarmed") == ["`move` was not sent: the robot is disarmed."]
    reached.set()
    arming.join()
    bridge.robot.move(linear=0.4)
    until(lambda: robot.told == [0.4])
    bridge.close()


@pytest.mark.parametrize("target", [wheels.halt, wheels.WheelsBridge])
def test_a_robot_that_stands_is_left_to_others(robot, drive, target):
    bridge = drive(Stopper(target, {"port": port_of(robot)}))
    until(lambda: ready(bridge))
    bridge.robot.move(linear=0.3)
    bridge.robot.move(linear=0.0)
    bridge.robot.move(linear=0.3)
    bridge.stop_all()
    until(lambda: robot.told == [0.3, 0.0, 0.3, 0.0])
    with socket.create_connection(("127.0.0.1", port_of(robot))) as another:
        another.sendall(b"0.5\n")
        until(lambda: robot.drives)
        process = bridge._guard._process
        assert process is not None
        until(lambda: not bridge._guard._moved, "a beat says so")
        die(bridge)
        until(lambda: process.is_gone, "it has nothing to do")
        another.sendall(b"0.6\n")
        until(lambda: 0.6 in robot.told)
    assert robot.told[-3:] == [0.0, 0.5, 0.6]


def test_the_stopper_of_another_robot_is_another_guard(robot, drive):
    bridge = drive(Stopper(wheels.halt, {"port": 9}))
    until(lambda: ready(bridge))
    first = guards(os.getpid())
    bridge.kind = Stopper(wheels.halt, {"port": port_of(robot)})
    until(lambda: guards(os.getpid()) not in ([], first))
    until(lambda: ready(bridge) and len(guards(os.getpid())) == 1)
    bridge.robot.move(linear=0.3)
    until(lambda: 0.3 in robot.told)
    die(bridge)
    robot.is_stopped()


def test_a_stopper_that_is_another_one_each_time_is_no_guard(robot, drive, monkeypatch):
    ports = count(port_of(robot))
    monkeypatch.setattr(Driven, "stopper", lambda _: Stopper(wheels.halt, {"port": next(ports)}))
    bridge = drive(None)
    assert bridge.failsafe.endswith("The robot is not guarded: The stopper has changed.")
    assert UNGUARDED[:-1] in texts(bridge, "armed")[0]


def test_a_stopper_that_is_made_again_each_time_is_the_same_one(robot, drive, monkeypatch):
    asked = []

    def stopper(bridge: Driven) -> Stopper:
        asked.append(bridge)
        return Stopper(lambda port: wheels.halt(port), {"port": bridge.port})

    monkeypatch.setattr(Driven, "stopper", stopper)
    bridge = drive(None)
    until(lambda: ready(bridge))
    first, before = guards(os.getpid()), len(asked)
    until(lambda: len(asked) > before + 3)
    assert guards(os.getpid()) == first
    bridge.robot.move(linear=0.3)
    until(lambda: 0.3 in robot.told)
    die(bridge)
    robot.is_stopped()


@pytest.mark.parametrize(
    ("blow", "fate"),
    [
        (signal.SIGKILL, "The guard process ended by itself (exit code -9)."),
        (signal.SIGSTOP, "The guard process does not answer."),
    ],
    ids=["killed", "suspended"],
)
def test_a_guard_that_fails_is_told_and_another_one_takes_its_place(robot, drive, blow, fate):
    bridge = drive(Stopper(wheels.halt, {"port": port_of(robot)}))
    (first,) = guards(os.getpid())
    os.kill(first, blow)
    until(lambda: texts(bridge)[:2] == [f"{fate} Another one is started.", "The robot is guarded again."])
    assert ready(bridge)
    until(lambda: not lives(first), "it could stop the robot at any time")
    assert bridge.failsafe == bridge.guarded_by
    bridge.robot.move(linear=0.3)
    until(lambda: 0.3 in robot.told)
    die(bridge)
    robot.is_stopped()


def test_a_guard_that_comes_after_arming_says_who_stops_the_robot_now(robot, drive):
    bridge = drive(None)
    assert "Nothing stops the robot" in texts(bridge, "armed")[-1]
    bridge.kind = Stopper(wheels.halt, {"port": port_of(robot)})
    until(lambda: texts(bridge) == [bridge.guarded_by])


def test_a_robot_whose_guard_cannot_be_replaced_is_stopped_and_disarmed(robot, drive, monkeypatch):
    bridge = drive(Stopper(wheels.halt, {"port": port_of(robot)}))
    bridge.robot.move(linear=0.3)
    until(lambda: robot.drives)
    monkeypatch.setattr(guard, "_CONNECT", 1.0)
    monkeypatch.setattr(sys, "executable", "no/python")
    os.kill(*guards(os.getpid()), signal.SIGKILL)
    robot.is_stopped()
    until(lambda: "Arm it to go on." in texts(bridge)[-1])
    assert texts(bridge)[-1].startswith(
        "The robot was disarmed, because it is not guarded any more. The guard"
    )
    assert "cannot be started" in texts(bridge)[-1]
    bridge.robot.move(linear=0.4)
    assert 0.4 not in robot.told
    bridge.arm()
    assert texts(bridge, "armed")[-1].startswith("`driven` is armed: commands move the robot. Nothing stops")
    bridge.robot.move(linear=0.5)
    until(lambda: 0.5 in robot.told)


@pytest.mark.parametrize("error", [SystemExit("It has quit."), KeyboardInterrupt("It has quit.")])
def test_a_stopper_that_raises_whatever_it_likes_is_told_and_asked_again(robot, drive, error):
    bridge = drive(Stopper(wheels.halt, {"port": port_of(robot)}))
    until(lambda: ready(bridge))
    kind, bridge.kind = bridge.kind, error
    until(lambda: texts(bridge) == [f"The robot is not guarded. {type(error).__name__}: It has quit."])
    bridge.kind = kind
    until(lambda: texts(bridge)[1:] == ["The robot is guarded again."])


def test_a_guard_whose_stop_raises_whatever_it_likes_tries_again(robot, drive):
    calls: list[int] = []

    def stop(port: int) -> None:
        calls.append(port)
        if len(calls) == 1:
            raise SystemExit("It has quit.")
        wheels.halt(port)

    bridge = drive(Stopper(stop, {"port": port_of(robot)}))
    until(lambda: ready(bridge))
    bridge.robot.move(linear=0.3)
    until(lambda: robot.drives)
    die(bridge)
    robot.is_stopped()


def test_a_robot_whose_arming_is_interrupted_is_not_armed(robot, drive, monkeypatch):
    def interrupt(_: guard.Guard, __: threading.Event) -> bool:
        raise KeyboardInterrupt

    bridge = drive(Stopper(wheels.halt, {"port": port_of(robot)}))
    bridge.disarm()
    monkeypatch.setattr(guard.Guard, "_turn", interrupt)
    with pytest.raises(KeyboardInterrupt):
        bridge.arm()
    bridge.robot.move(linear=0.3)
    assert not bridge.safety.armed
    assert not bridge._guard.is_on
    assert not any(robot.told)


def test_a_lost_robot_is_not_disarmed_because_its_guard_has_lost_it_too(robot, drive, monkeypatch):
    bridge = drive(Stopper(wheels.halt, {"port": port_of(robot)}))
    monkeypatch.setattr(guard, "_CONNECT", 0.2)
    bridge.set_status("lost", "The radio is silent.")
    looked = []
    monkeypatch.setattr(bridge, "unguarded", lambda why: (looked.append(why), Driven.unguarded(bridge, why)))
    with monkeypatch.context() as patched:
        patched.setattr(sys, "executable", "no/python")
        os.kill(*guards(os.getpid()), signal.SIGKILL)
        until(lambda: len(looked) > 2)
    assert bridge.safety.armed
    until(lambda: ready(bridge))


def test_a_module_of_the_current_folder_is_not_in_the_way_of_the_guard(robot, drive, tmp_path, monkeypatch):
    (tmp_path / "struct.py").write_text("raise SystemExit(7)")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend("")
    bridge = drive(Stopper(wheels.halt, {"port": port_of(robot)}))
    assert (ready(bridge), texts(bridge)) == (True, [])


class Unstoppable(Driven, offered=False):
    """A robot that this process cannot stop; its guard can, over a connection of its own."""

    stop_timeout = 0.1
    go = threading.Event()

    def stop(self) -> None:
        if self.kind is not None and self.kind.target is wheels.halt:
            self.go.wait(60)
        raise OSError("The cable is loose.")


@pytest.mark.parametrize("target", [wheels.halt, wheels.Wheels], ids=["hangs", "raises"])
@pytest.mark.parametrize("end", ["stop_all", "disarm", "close"])
def test_what_this_process_cannot_stop_the_guard_does(robot, drive, monkeypatch, target, end):
    bridge = drive(Stopper(target, {"port": port_of(robot)}), Unstoppable)
    bridge.robot.move(linear=0.3)
    until(lambda: robot.drives)
    getattr(bridge, end)()
    robot.is_stopped()
    assert not bridge.in_motion
    assert texts(bridge, "fault") == []
    (told,) = texts(bridge)
    assert told.startswith("The guard process has stopped the robot. This one could not: ")


@pytest.mark.parametrize("end", ["disarm", "close"])
def test_a_guard_that_is_dismissed_before_the_robot_stands_stops_it_first(robot, drive, monkeypatch, end):
    bridge = drive(Stopper(wheels.Wheels, {"port": port_of(robot)}), Unstoppable)
    bridge.robot.move(linear=0.3)
    until(lambda: robot.drives)
    (process,) = guards(os.getpid())
    monkeypatch.setattr(guard._Process, "stop", lambda _: False)  # it is too slow to tell
    getattr(bridge, end)()
    robot.is_stopped()
    until(lambda: not lives(process), "the guard lingers")


_FORKED = """
import os
from bridges.wheels import WheelsBridge

bridge = WheelsBridge({port}, guarded={guarded})
bridge.open()
bridge.arm()
bridge.robot.move(linear=0.2)
if not (child := os.fork()):
    bridge.robot.move(linear=0.4)
    os._exit(0)
os.waitpid(child, 0)
bridge.robot.move(linear=0.3)
bridge.close()
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="Windows has no such copies")
@pytest.mark.parametrize("guarded", [True, False])
def test_a_copy_of_the_program_does_not_drive_its_robot(robot, guarded):
    code = _FORKED.format(port=port_of(robot), guarded=guarded)
    assert subprocess.run([sys.executable, "-c", code], env=robot.environment).returncode == 0
    until(lambda: robot.told == [0.2, 0.3, 0.0], lambda: str(robot.told))


_DROPPED_AT_THE_END = """
import sys
from bridges.wheels import WheelsBridge
from lrp_jupyter import Session

def main():
    session = Session({program!r}, WheelsBridge({port}, guarded=False))
    session.start()
    session.bridge.arm()
    sys.stdin.read()

main()
"""


def test_a_program_that_drops_its_session_and_ends_leaves_no_robot_moving(robot):
    code = _DROPPED_AT_THE_END.format(program=PROGRAM, port=port_of(robot))
    with subprocess.Popen(
        [sys.executable, "-c", code], env=robot.environment, stdin=subprocess.PIPE
    ) as script:
        robot.is_driven()
    assert script.returncode == 0
    robot.is_stopped()


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # nobody closes its socket
def test_a_robot_whose_bridge_is_dropped_while_it_drives_is_stopped(robot):
    def leave_it_driving() -> int:
        bridge = wheels.WheelsBridge(port_of(robot))
        bridge.open()
        bridge.arm()
        bridge.robot.move(linear=0.3)
        robot.is_driven()
        return bridge._guard._process._process.pid

    process = leave_it_driving()
    gc.collect()
    robot.is_stopped()
    until(lambda: not lives(process), "the guard lingers")


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
        (SystemExit("It has quit."), "SystemExit: It has quit."),
    ],
    ids=["no module", "no class", "no robot", "arguments", "no function", "no data", "a fault", "an exit"],
)
def test_a_guard_that_cannot_reach_the_robot_is_told_and_the_robot_is_armed(robot, drive, kind, why):
    bridge = drive(kind)
    until(lambda: why in bridge.failsafe, bridge.failsafe)
    assert bridge.failsafe.startswith(UNGUARDED[:-1])
    until(lambda: len(texts(bridge)) == 1)
    assert texts(bridge)[0].startswith("The robot is not guarded. ")
    bridge.robot.move(linear=0.3)
    until(lambda: 0.3 in robot.told)


def test_arming_and_disarming_leaves_no_process_no_thread_and_no_descriptor(robot, drive):
    bridge = drive(Stopper(wheels.halt, {"port": port_of(robot)}))
    before = 0
    for round_ in range(4):
        bridge.arm()
        bridge.disarm()
        if round_ == 0:
            until(lambda: not guards(os.getpid()))
            until(lambda: not _threads())
            before = _descriptors()
    until(lambda: not guards(os.getpid()))
    until(lambda: not _threads())
    assert _descriptors() <= before, "what other tests left behind may have been closed"
    assert texts(bridge) == []


def _threads() -> list[str]:
    return [thread.name for thread in threading.enumerate() if thread.name.startswith("guard")]


def _descriptors() -> int:
    return len(os.listdir("/proc/self/fd" if os.path.exists("/proc/self/fd") else "/dev/fd"))


def test_a_robot_that_was_armed_and_cannot_be_opened_has_no_guard():
    robot = Bare(hardware=True, notes="open_interface")
    robot.failing["open_interface"] = BridgeError("It is not there.")
    robot.arm()
    with pytest.raises(BridgeError, match="It is not there"):
        robot.open()
    assert not robot._guard.is_on
    robot.disarm()
