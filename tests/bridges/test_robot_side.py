"""``lrp guard`` for MQTT: a robot behind a real broker stands when its program sends no more commands."""

from __future__ import annotations

import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from bridges.bounded import bounded, persistently
from bridges.dying import wait_until

from lrp_jupyter.errors import BridgeError

pytestmark = pytest.mark.slow  # each starts processes of its own

MOSQUITTO = shutil.which("mosquitto", path=os.environ["PATH"] + os.pathsep + "/usr/sbin")
TOPIC = "robot/cmd_vel"


@pytest.fixture
def port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@pytest.fixture
def broker(port: int) -> Iterator[Callable[[], Any]]:
    """Start the broker, and end what was started."""
    if MOSQUITTO is None:
        reason = "The broker mosquitto is not installed."
        if os.environ.get("CI", "").lower() == "true":
            pytest.fail(reason)
        pytest.skip(reason)
    started: list[Any] = []

    def start() -> Any:
        started.append(subprocess.Popen([MOSQUITTO, "-p", str(port)], stderr=subprocess.DEVNULL))
        wait_until(lambda: _answers(port), "the broker did not start")
        return started[-1]

    yield start
    for each in started:
        each.kill()
        each.wait()


def _answers(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


class Lines:
    """What ``lrp guard`` prints, as it comes."""

    def __init__(self, *arguments: str) -> None:
        command = [sys.executable, "-m", "lrp_jupyter", "guard", *arguments]
        environment = {**os.environ, "PYTHONWARNINGS": ""}
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
        self.lines: list[str] = []
        self._thread = threading.Thread(target=self._listen)
        self._thread.start()

    def _listen(self) -> None:
        assert self.process.stdout is not None
        with self.process.stdout as stream:
            self.lines.extend(iter(stream.readline, ""))

    def count(self, text: str) -> int:
        return sum(text in line for line in self.lines)

    def end(self) -> int:
        """Press Ctrl-C."""
        self.process.send_signal(signal.SIGINT)
        code = self.process.wait(60)
        self._thread.join()
        return code


@pytest.fixture
def robot(port: int) -> Iterator[Any]:
    """A robot and a program in one client: `commands` are what the robot hears."""
    mqtt = pytest.importorskip("paho.mqtt.client")

    class Robot:
        def __init__(self) -> None:
            self.commands: list[Any] = []
            self.client = mqtt.Client(mqtt.CallbackAPIVersion.VERSION2)
            self.joined = 0
            self.client.on_connect = lambda *_: self.client.subscribe(TOPIC)
            self.client.on_subscribe = self._join
            self.client.on_message = lambda _client, _data, message: self.commands.append(message.payload)
            self.client.reconnect_delay_set(1, 1)

        def connect(self) -> None:
            self.client.connect("127.0.0.1", port)
            self.client.loop_start()
            wait_until(lambda: self.joined == 1, "the robot did not connect")

        def _join(self, *_: Any) -> None:
            self.joined += 1

        def drive(self, **command: Any) -> None:
            self.client.publish(TOPIC, json.dumps(command))

        def told(self, since: int = 0) -> list[Any]:
            return [json.loads(each) for each in self.commands[since:]]

        @property
        def last(self) -> Any:
            return json.loads(self.commands[-1]) if self.commands else None

    robot = Robot()
    yield robot
    robot.client.disconnect()
    robot.client.loop_stop()


@pytest.fixture
def running(broker: Callable[[], Any]) -> Any:
    """A broker."""
    return broker()


@pytest.fixture
def guard(port: int, running: Any, robot: Any) -> Iterator[Lines]:
    """A robot with its guard."""
    robot.connect()
    guard = Lines("--backend", "mqtt", "--host", f"127.0.0.1:{port}", "--topic", TOPIC)
    wait_until(lambda: guard.count("Connected"), "it did not connect")
    yield guard
    if guard.process.poll() is None:
        guard.end()


def test_a_robot_whose_commands_cease_is_stopped_and_the_guard_goes_on(robot: Any, guard: Lines) -> None:
    still = {"linear": 0.0, "angular": 0.0, "gear": "low", "lamps": [0, False]}

    def ceases() -> None:
        before, times = len(robot.commands), guard.count("No command for 0.5 s")
        with bounded(1.5):
            robot.drive(linear=0.2, angular=0.1, gear="low", lamps=[3, True])
            wait_until(lambda: still in robot.told(before))
        wait_until(lambda: guard.count("No command for 0.5 s") == times + 1)

    for _ in range(2):
        persistently(ceases)
    assert guard.end() == 130


def test_a_robot_that_is_commanded_again_and_again_is_left_alone(robot: Any, guard: Lines) -> None:
    def commanded() -> None:
        before, times = len(robot.commands), guard.count("No command")
        end, tick = time.monotonic() + 1.5, threading.Event()
        while time.monotonic() < end:
            robot.drive(linear=0.2)
            tick.wait(0.1)
        robot.drive(linear=0, lamp=0)
        wait_until(lambda: {"linear": 0, "lamp": 0} in robot.told(before))
        end = time.monotonic() + 1
        wait_until(lambda: time.monotonic() > end)
        *others, last = robot.told(before)
        assert all(each == {"linear": 0.2} for each in others), "a robot that is commanded needs no guard"
        assert last == {"linear": 0, "lamp": 0}, "a robot that stands needs no guard"
        assert guard.count("No command") == times

    persistently(commanded)


def test_commands_that_cannot_be_read_are_told_until_there_are_others(robot: Any, guard: Lines) -> None:
    robot.client.publish(TOPIC, b"0.2 0.1")
    wait_until(lambda: guard.count("b'0.2 0.1' on `robot/cmd_vel` is not JSON, so the robot is not guarded."))
    robot.drive(linear=0.2)
    wait_until(lambda: guard.count("Connected") == 2)
    wait_until(lambda: robot.last == {"linear": 0})


def test_a_broker_that_was_away_gets_the_stop_when_it_is_there_again(
    robot: Any, guard: Lines, broker: Callable[[], Any], running: Any
) -> None:
    brokers = [running]

    def goes_away() -> None:
        before, joined, times = len(robot.commands), robot.joined, guard.count("does not answer")
        robot.drive(linear=0.2)
        wait_until(lambda: {"linear": 0.2} in robot.told(before))
        brokers[-1].kill()
        brokers[-1].wait()
        wait_until(lambda: guard.count("does not answer") > times)
        moves = robot.last == {"linear": 0.2}
        guard.process.send_signal(signal.SIGSTOP)  # until the robot is there again to hear it
        try:
            brokers.append(broker())
            wait_until(lambda: robot.joined > joined)
        finally:
            guard.process.send_signal(signal.SIGCONT)
        wait_until(lambda: robot.last == {"linear": 0})
        assert moves, "the guard was sooner than the end of the broker"

    persistently(goes_away)


def test_without_a_broker_it_says_so(port: int) -> None:
    from lrp_jupyter.cli.guard import MqttSide

    pytest.importorskip("paho.mqtt.client")
    with pytest.raises(BridgeError, match="No MQTT broker answers at 127"):
        MqttSide(TOPIC, f"127.0.0.1:{port}")
