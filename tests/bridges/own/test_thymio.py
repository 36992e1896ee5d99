"""The bridge to the Thymio: tdmclient's own server with a simulated robot."""

from __future__ import annotations

import socket
import subprocess
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from bridges.own.conftest import EXAMPLES, OfARobot, drives_and_senses
from support.ports import free_port
from support.waiting import until

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.discovery import make_bridge
from lrp_jupyter.errors import BridgeError

pytest.importorskip("tdmclient")

THYMIO = str(EXAMPLES / "thymio.py")

Driving = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture
def port() -> int:
    return free_port()


@pytest.mark.slow
class TestThymio(OfARobot):
    port = 0

    @classmethod
    def start(cls) -> None:
        cls.port = cls.port or free_port()
        cls.robot = cls.processes.robot("thymio", cls.port, 1.0)
        cls.told = cls.processes.told(cls.robot)

    def make(self) -> Bridge:
        return make_bridge(THYMIO, port=self.port)


@pytest.mark.slow
def test_it_drives_as_it_is_told_and_says_what_it_senses(processes, port):
    told = processes.told(processes.robot("thymio", port, 1.0))
    bridge = make_bridge(THYMIO, port=port)
    bridge.open()
    bridge.arm()
    drives_and_senses(bridge, lambda: told)
    bridge.close()


@pytest.mark.slow
def test_a_device_manager_that_ends_is_a_lost_robot_and_one_that_starts_is_found(processes, port):
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
def test_the_guard_stops_the_robot_when_this_process_is_killed(processes, port, driving):
    told = processes.told(processes.robot("thymio", port, 1.0))
    driving(told, "thymio.py", port=port).kill()
    until(lambda: told[-1] == "drives 0.000 0.000", "it was not stopped")


@pytest.mark.slow
def test_a_stop_that_the_robot_did_not_get_is_not_counted(processes, port, monkeypatch):
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
def test_a_robot_that_another_program_uses_is_told(processes, port):
    processes.robot("thymio", port, 1.0)
    first, second = (make_bridge(THYMIO, port=port) for _ in range(2))
    first.open()
    try:
        with pytest.raises(BridgeError, match="has no Thymio that is free"):
            second.open()
    finally:
        first.close()


def test_where_no_device_manager_is_it_is_said_what_to_start(port):
    with pytest.raises(BridgeError, match=r"No device manager answers at 127\.0\.0\.1:\d+ .*Thymio Suite"):
        make_bridge(THYMIO, port=port).open()


@pytest.fixture
def stranger() -> Iterator[int]:
    """A server that is no device manager, and says nothing."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        yield listener.getsockname()[1]


def test_a_server_that_says_nothing_is_told(stranger, monkeypatch):
    connect = socket.create_connection
    monkeypatch.setattr(socket, "create_connection", lambda where, timeout: connect(where, 0.05))
    with pytest.raises(BridgeError, match="has no Thymio that is free"):
        make_bridge(THYMIO, port=stranger).open()


def test_a_brightness_that_is_no_number_is_told_with_its_name():
    with pytest.raises(BridgeError, match=r"`bright.*white`"):
        make_bridge(THYMIO, bright="white")
