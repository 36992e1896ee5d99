"""``lrp guard`` for MQTT: a robot behind a real broker stands when its program sends no more commands."""

from __future__ import annotations

import json
import os
import shutil
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any

import pytest
from support.ports import free_port
from support.waiting import until

from lrp_jupyter.cli.guard_command import MqttSide
from lrp_jupyter.errors import BridgeError

pytestmark = pytest.mark.slow  # each starts processes of its own

MOSQUITTO = shutil.which("mosquitto", path=os.environ["PATH"] + os.pathsep + "/usr/sbin")
TOPIC = "robot/cmd_vel"


@pytest.fixture
def port() -> int:
    return free_port()


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
        until(lambda: _answers(port), "the broker did not start")
        return started[-1]

    yield start
    for each in started:
        each.kill()
        each.wait()


def _answers(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


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
            until(lambda: self.joined == 1, "the robot did not connect")

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
def side(port: int, running: Any, robot: Any) -> Iterator[MqttSide]:
    """The guard's end of the topic of a robot."""
    robot.connect()
    side = MqttSide(TOPIC, f"127.0.0.1:{port}")
    until(lambda: side.state().startswith("Connected"))
    yield side
    side.close()


def test_a_robot_whose_commands_cease_is_stopped_until_ctrl_c(robot, port, running):
    still = {"linear": 0.0, "angular": 0.0, "gear": "low", "lamps": [0, False]}
    robot.connect()
    options = ("--backend", "mqtt", "--host", f"127.0.0.1:{port}", "--topic", TOPIC)
    command = [sys.executable, "-m", "lrp_jupyter", "guard", *options]
    environment = {**os.environ, "PYTHONWARNINGS": ""}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        assert process.stdout is not None
        assert "Connected" in process.stdout.readline()
        for _ in range(2):
            before = len(robot.commands)
            robot.drive(linear=0.2, angular=0.1, gear="low", lamps=[3, True])
            # all of its stops: one that leaves as the next command comes would be the last word
            until(lambda: robot.told(before).count(still) == MqttSide.times)  # noqa: B023
            assert "No command for 0.5 s" in process.stdout.readline()
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 130


@pytest.mark.skipif(os.name != "posix", reason="Windows has other pipes")
def test_a_guard_whose_terminal_is_stuck_stops_the_robot_all_the_same(robot, port, running):
    robot.connect()
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    with suppress(BlockingIOError):
        while True:
            os.write(writer, b" " * 65536)
    os.set_blocking(writer, True)
    options = ("--backend", "mqtt", "--host", f"127.0.0.1:{port}", "--topic", TOPIC)
    command = [sys.executable, "-m", "lrp_jupyter", "guard", *options]
    with subprocess.Popen(command, stdout=writer, stderr=subprocess.DEVNULL) as process:
        robot.client.publish(TOPIC, json.dumps({"linear": 0.2}), retain=True)  # it may connect later
        until(lambda: {"linear": 0.0} in robot.told())
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 130
    os.close(reader)
    os.close(writer)


def test_a_broker_that_refuses_to_be_read_is_told(side):
    from paho.mqtt.packettypes import PacketTypes
    from paho.mqtt.reasoncodes import ReasonCode

    refusal = ReasonCode(PacketTypes.SUBACK, identifier=0x87)
    side._client.on_subscribe(side._client, None, 1, [refusal], None)
    refused = "does not let this guard read `robot/cmd_vel` (Not authorized)."
    assert side.state().endswith(refused)
    with pytest.raises(BridgeError, match="does not let this guard read"):
        side.stop()


@pytest.mark.parametrize(
    "payload",
    [b"0.2 0.1", b"\xff", b"[" * 100_000, b"[" * 700 + b"1" + b"]" * 700],
    ids=["a text", "bytes", "deep", "less deep"],
)
def test_commands_that_cannot_be_read_are_told_until_there_are_others(robot, side, payload):
    robot.client.publish(TOPIC, payload)
    told = f"{payload[:40]!r} on `robot/cmd_vel` cannot be read as JSON, so the robot is not guarded."
    until(lambda: side.state() == told, side.state)
    robot.drive(linear=0.2)
    until(lambda: side.state().startswith("Connected"))
    assert side.heard[1]
    side.stop()
    until(lambda: robot.commands[-1:] == [b'{"linear": 0.0}'])  # it may yet have to hear what cannot be read


def test_a_broker_that_was_away_gets_the_stop_when_it_is_there_again(robot, side, broker, running):
    robot.drive(linear=0.2)
    until(lambda: side.heard[1] and robot.last == {"linear": 0.2})
    running.kill()
    running.wait()
    until(lambda: "does not answer" in side.state())
    with pytest.raises(BridgeError, match="does not answer"):  # so it is tried again
        side.stop()
    broker()
    until(lambda: robot.joined == 2 and side.state().startswith("Connected"))
    side.stop()
    until(lambda: robot.last == {"linear": 0})


def test_without_a_broker_it_says_so(port):
    pytest.importorskip("paho.mqtt.client")
    with pytest.raises(BridgeError, match="No MQTT broker answers at 127"):
        MqttSide(TOPIC, f"127.0.0.1:{port}")
