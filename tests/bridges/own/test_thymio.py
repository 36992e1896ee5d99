"""The bridge to the Thymio: tdmclient's own server with a simulated robot."""

from __future__ import annotations

import signal
import socket
import subprocess
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from bridges.own.conftest import EXAMPLES, Processes, free_port, reaches

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.conformance import BridgeConformance
from lrp_jupyter.bridges.discovery import make_bridge
from lrp_jupyter.errors import BridgeError
from lrp_jupyter.live.clock import MonotonicClock
from lrp_jupyter.live.session import Session
from lrp_jupyter.programs import load

pytest.importorskip("tdmclient")

THYMIO = str(EXAMPLES / "thymio.py")
FASTER = 2.0  # both the robot's time and the program's

Until = Callable[..., None]
Driving = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture
def port() -> int:
    return free_port()


@pytest.mark.slow
class TestThymio(BridgeConformance):
    moves = True

    @pytest.fixture(autouse=True)
    def _connected(self, processes: Processes, port: int) -> None:
        self.processes, self.port = processes, port
        self.start()

    def start(self) -> None:
        self.robot = self.processes.robot("thymio", self.port, 1.0)
        self.told = self.processes.told(self.robot)

    def make_bridge(self) -> Bridge:
        return make_bridge(THYMIO, port=self.port)

    def has_moved(self, bridge: Bridge) -> bool:
        return any(told != "drives 0.000 0.000" for told in self.told)

    def silence(self) -> None:
        self.robot.send_signal(signal.SIGSTOP)

    def cut(self) -> None:
        self.processes.end(self.robot)

    def restore(self) -> None:
        if self.robot.poll() is None:
            self.robot.send_signal(signal.SIGCONT)
        else:
            self.start()


@pytest.mark.slow
def test_the_unchanged_follower_goes_there_and_back(processes: Processes, port: int) -> None:
    processes.robot("thymio", port, FASTER)
    with Session(load("follower"), THYMIO, port=port, clock=MonotonicClock(FASTER)) as session:
        session.bridge.arm()
        session.start()
        assert reaches(session, "bumpback")
        assert reaches(session, "end")
        assert not session.issues


@pytest.mark.slow
def test_a_device_manager_that_ends_is_a_lost_robot_and_one_that_starts_is_found(
    processes: Processes, port: int, until: Until
) -> None:
    manager = processes.robot("thymio", port, 1.0)
    bridge = make_bridge(THYMIO, port=port)
    bridge.open()
    try:
        processes.end(manager)
        until(lambda: bridge.status.state == "lost", "it was not noticed")
        processes.robot("thymio", port, 1.0)
        until(lambda: bridge.status.state != "lost", "it was not found again")
    finally:
        bridge.close()


@pytest.mark.slow
def test_the_guard_stops_the_robot_when_this_process_is_killed(
    processes: Processes, port: int, driving: Driving, until: Until
) -> None:
    told = processes.told(processes.robot("thymio", port, 1.0))
    driving(told, "thymio.py", port=port).kill()
    until(lambda: told[-1] == "drives 0.000 0.000", "nobody stopped it")


@pytest.mark.slow
def test_a_stop_that_the_robot_did_not_get_is_not_counted(
    processes: Processes, port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    def unplugged(self: Any, linear: float = 0.0, angular: float = 0.0) -> None:
        raise BrokenPipeError

    processes.robot("thymio", port, 1.0)
    bridge = make_bridge(THYMIO, port=port)
    monkeypatch.setattr(type(bridge), "move", unplugged)
    stopper = bridge.stopper()
    assert stopper is not None
    assert callable(stopper.target)
    with pytest.raises(BridgeError, match="did not take the stop"):
        stopper.target(**stopper.arguments)


@pytest.mark.slow
def test_a_robot_that_another_program_uses_is_told(processes: Processes, port: int) -> None:
    processes.robot("thymio", port, 1.0)
    first, second = (make_bridge(THYMIO, port=port) for _ in range(2))
    first.open()
    try:
        with pytest.raises(BridgeError, match="has no Thymio that is free"):
            second.open()
    finally:
        first.close()


def test_where_no_device_manager_is_it_is_said_what_to_start(port: int) -> None:
    with pytest.raises(BridgeError, match=r"No device manager answers at 127\.0\.0\.1:\d+ .*Thymio Suite"):
        make_bridge(THYMIO, port=port).open()


@pytest.fixture
def stranger() -> Iterator[int]:
    """A server that is no device manager, and says nothing."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        yield listener.getsockname()[1]


def test_a_server_that_says_nothing_is_told_in_bounded_time(stranger: Any) -> None:
    with pytest.raises(BridgeError, match="has no Thymio that is free"):
        make_bridge(THYMIO, port=stranger).open()


def test_a_brightness_that_is_no_number_is_told_with_its_name() -> None:
    with pytest.raises(BridgeError, match=r"`bright.*white`"):
        make_bridge(THYMIO, bright="white")
