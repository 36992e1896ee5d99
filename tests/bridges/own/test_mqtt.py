"""The bridge to MQTT: a real broker, and behind it a simulated robot as a process of its own."""

from __future__ import annotations

import json
import signal
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any

import pytest
from bridges.own.conftest import EXAMPLES, WAYS, Broker, OfARobot, does_tasks, drives_and_senses
from support.ports import free_port
from support.waiting import until

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.discovery import make_bridge
from lrp_jupyter.errors import BridgeError

mqtt = pytest.importorskip("paho.mqtt.client")

MQTT = str(EXAMPLES / "mqtt.py")

Driving = Callable[..., "subprocess.Popen[str]"]


class Listener:
    """Another client of the broker: hears what is published, and publishes."""

    def __init__(self, port: int) -> None:
        self.heard: dict[str, list[Any]] = {}
        self.client = mqtt.Client(mqtt.CallbackAPIVersion.VERSION2)
        self.client.on_connect = lambda client, *_: client.subscribe("robot/+")
        self.client.on_message = self._note
        listens = threading.Event()
        self.client.on_subscribe = lambda *_: listens.set()
        self.client.reconnect_delay_set(1, 1)
        self.client.connect("127.0.0.1", port)
        self.client.loop_start()
        assert listens.wait(60)

    def _note(self, _client: object, _data: object, message: Any) -> None:
        with suppress(ValueError):
            self.heard.setdefault(message.topic.removeprefix("robot/"), []).append(
                json.loads(message.payload)
            )

    def last(self, topic: str) -> Any:
        return self.heard.get(topic, [None])[-1]

    def publish(self, topic: str, payload: str, retain: bool = False) -> None:
        self.client.publish(f"robot/{topic}", payload, 1, retain).wait_for_publish(60)

    def close(self) -> None:
        self.client.disconnect()
        self.client.loop_stop()


@pytest.fixture
def listener(broker: Broker) -> Iterator[Listener]:
    listener = Listener(broker.port)
    yield listener
    listener.close()


@pytest.fixture
def bridge(broker: Broker) -> Iterator[Bridge]:
    """Open and armed; what it was told is not old, however long a test is held up."""
    bridge = make_bridge(MQTT, port=broker.port)
    bridge.fed.clock = lambda: 0.0
    bridge.open()
    bridge.arm()
    yield bridge
    bridge.close()


@pytest.mark.slow
class TestMqtt(OfARobot):
    broker: Broker

    @classmethod
    def start(cls) -> None:
        cls.broker = Broker(cls.processes)
        cls.robot = cls.processes.robot("mqtt", cls.broker.port, 1.0)
        cls.told = cls.processes.told(cls.robot)

    def make(self) -> Bridge:
        return make_bridge(MQTT, port=self.broker.port)

    def cut(self) -> None:
        self.broker.kill()

    def restore(self) -> None:
        self.robot.send_signal(signal.SIGCONT)
        if self.broker.process.poll() is not None:
            self.broker.start()


@pytest.mark.slow
def test_it_drives_as_it_is_told_and_says_what_it_senses(broker, processes, bridge):
    told = processes.told(processes.robot("mqtt", broker.port, 1.0))
    drives_and_senses(bridge, lambda: told)


@pytest.mark.slow
def test_a_program_with_tasks_runs_as_in_the_simulator(broker, processes):
    told = processes.told(processes.robot("mqtt", broker.port, 4.0))
    does_tasks(MQTT, lambda: told, port=broker.port)


@pytest.mark.slow
def test_a_broker_that_dies_is_a_lost_robot_and_one_that_comes_back_is_found(broker, bridge):
    bridge.robot.move(linear=0.2)
    sent = sent_by(bridge)
    broker.kill()
    until(lambda: bridge.status.state == "lost", "it was not noticed")
    assert f"The MQTT broker at localhost:{broker.port} is gone" in bridge.status.sentence
    with pytest.raises(BridgeError, match="is gone"):
        bridge.robot.move(linear=0.2)
    del sent[:]
    broker.start()
    until(lambda: bridge.status.state != "lost", "it was not found again")
    still = {"linear": 0.0, "angular": 0.0}
    assert sent, "nothing was sent"
    assert all(command == still for command in sent), "an old command was sent again"
    listener = Listener(broker.port)
    bridge.robot.move(linear=0.1)
    until(lambda: listener.last("cmd_vel") == {"linear": 0.1, "angular": 0.0}, "the next command is held up")
    listener.close()


def sent_by(bridge: Any) -> list[Any]:
    """What a bridge publishes from now on: the robot itself may be there again too late to hear it."""
    sent: list[Any] = []
    publish = bridge.client.publish

    def note(topic: str, payload: str) -> Any:
        sent.append(json.loads(payload))
        return publish(topic, payload)

    bridge.client.publish = note
    return sent


@pytest.mark.slow
def test_a_bridge_that_only_looks_leaves_the_robot_to_its_driver(broker, listener):
    bridge = make_bridge(MQTT, port=broker.port)
    bridge.open()
    assert not bridge.safety.armed
    bridge.robot.move(linear=0.2)
    listener.publish("light", "7")
    until(lambda: bridge.fed.value("light.data") == listener.last("light") == 7, "the light was not heard")
    assert "cmd_vel" not in listener.heard
    bridge.close()


@pytest.mark.slow
@WAYS
@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGSTOP], ids=["killed", "suspended"])
def test_the_broker_stops_the_robot_when_this_process_is(end, driven, broker, processes, driving):
    told = processes.told(processes.robot("mqtt", broker.port, 1.0))
    driving(told, "mqtt.py", driven, port=broker.port).send_signal(end)
    until(lambda: told[-1] == "drives 0.000 0.000", "it was not stopped")


@pytest.mark.slow
def test_what_comes_once_a_minute_holds_nobody_up(bridge, listener):
    for topic, text in (("light", "255"), ("bumper", "0"), ("battery", "7.4")):
        listener.publish(topic, text)
    until(
        lambda: "battery" in dir(bridge.robot) and value_of(bridge, "battery.data") == 7.4, "nothing arrives"
    )
    later = time.monotonic() + 60
    bridge.fed.clock = lambda: later
    listener.publish("light", "254")
    listener.publish("bumper", "1")
    until(lambda: value_of(bridge, "bumper.data") == 1, "nothing arrives")
    bridge.begin_tick(0.0, 0.1)
    bridge.robot.move(linear=0.2)
    until(lambda: listener.last("cmd_vel") == {"linear": 0.2, "angular": 0.0}, "it is held up")


def value_of(bridge: Bridge, name: str) -> object:
    bridge.refresh()
    return bridge.describe(name).value


@pytest.mark.slow
def test_a_reading_that_is_no_number_is_told_and_the_others_come_on(bridge, listener):
    listener.publish("light", "bright")
    words = "`robot/light` sent b'bright'"
    until(lambda: any(words in notice.text for notice in bridge.safety.notices), "it was not told")
    listener.publish("light", "212")
    until(lambda: value_of(bridge, "light.data") == 212, "the next did not arrive")


@pytest.mark.slow
def test_a_reading_that_the_broker_has_kept_is_not_a_reading_of_now(broker, listener):
    listener.publish("light", "7", retain=True)
    bridge = make_bridge(MQTT, port=broker.port)
    bridge.fed.clock = lambda: 0.0
    bridge.open()
    try:
        listener.publish("bumper", "0")
        until(lambda: value_of(bridge, "bumper.data") == 0, "nothing arrives")
        assert bridge.describe("light.data").value is None
    finally:
        bridge.close()


@pytest.mark.slow
def test_a_broker_that_wants_a_password_is_told(processes, tmp_path):
    port = free_port()
    (tmp_path / "closed.conf").write_text(f"listener {port} 127.0.0.1\nallow_anonymous false\n")
    Broker(processes, port, "-c", tmp_path / "closed.conf")
    with pytest.raises(BridgeError, match=rf"What answers at localhost:{port} does not let this bridge in"):
        make_bridge(MQTT, port=port).open()


def test_where_no_broker_is_it_is_said_how_to_start_one():
    with pytest.raises(BridgeError, match=r"No MQTT broker answers at localhost:\d+ .*`mosquitto`"):
        make_bridge(MQTT, port=free_port()).open()


def test_a_port_that_is_no_number_is_told_with_its_name():
    with pytest.raises(BridgeError, match=r"`port.*here`"):
        make_bridge(MQTT, port="here")
