"""``lrp guard``: stops a robot, on its own side, when its program sends no more commands.

A guard process on the computer with the program (`lrp_jupyter.bridges.guarding.guard`) dies with that
computer, and reaches nothing when the network is cut. This one runs on the robot, or beside it.
"""

from __future__ import annotations

import json
import os
import signal
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from importlib import import_module
from typing import Any

import typer

from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.message import moves
from lrp_jupyter.bridges.ros import RosBridge, backends
from lrp_jupyter.bridges.ros.address import parse_address
from lrp_jupyter.bridges.ros.arguments import bridge_options
from lrp_jupyter.bridges.ros.link import GUARD_NODE
from lrp_jupyter.cli.terminal import Writer
from lrp_jupyter.errors import BridgeError

MQTT = "mqtt"
BACKENDS = (backends.AUTO, *backends.BACKENDS, MQTT)
"""The ways to a robot."""

_TAKEN = ("host", "namespace", "remap")  # of what a launch file may say of a node
_PASSED = (
    "node",
    "sim_time",
)  # it is known by the name of all guards, and the time of a robot may stand still
_LOOK = 0.05  # s between two looks, and between two stops
_STOPS = 100  # a message may be lost, or the robot may be connected seconds later than this guard
_CANCELS = 20  # of goals; another client may soon have one of its own
_COMMAND = "command", ", and the last one moved the robot", _STOPS  # what is missed, and so on


def guard_robot(
    backend: str,
    host: str | None,
    topic: str | None,
    type_: str,
    after: float,
    alive: str = "",
    actions: Sequence[str] = (),
    ros_arguments: Sequence[str] = (),
) -> int:
    """Guard a robot until Ctrl-C; return the exit code."""
    robot: RosSide | MqttSide
    if bool(alive) != bool(actions):
        raise BridgeError(
            "--action and --alive go together: name what is cancelled, and who has to be there."
        )
    if backend == MQTT:
        if type_:
            raise BridgeError("--type is for ROS: the messages of MQTT have no types.")
        if actions:
            raise BridgeError("--action is for ROS: MQTT has no actions.")
        if ros_arguments:
            raise BridgeError(f"`{ros_arguments[0]}` is for a node of ROS, and this guard is none.")
        robot = MqttSide(topic or "robot/cmd_vel", host)
    else:
        velocity = topic or ("" if alive else "cmd_vel")
        where: dict[str, Any] = {"backend": backend, "host": host}
        where |= bridge_options(ros_arguments, (*_TAKEN, *_PASSED))
        for name in _PASSED:
            where.pop(name, None)
        robot = RosSide(velocity, type_, alive, actions, **where)
    output = Writer()
    try:
        watch(robot, after, partial(output, _say), threading.Event())
    except KeyboardInterrupt:
        return 128 + signal.SIGINT
    finally:
        robot.close()
        if not output.end(lambda: True):
            os._exit(128 + signal.SIGINT)  # Python would wait until the output is accepted
    return 0


def _say(sentence: str) -> None:
    typer.echo(f"{time.strftime('%H:%M:%S')}  {sentence}")


def watch(
    robot: RosSide | MqttSide, after: float, say: Callable[[str], object], over: threading.Event
) -> None:
    """Stop the robot whenever its last command moves it and none has come for `after` seconds."""
    state, stopped, stops, told = "", 0.0, 0, True
    while not over.wait(_LOOK):
        if robot.state() != state:
            state = robot.state()
            say(state)
        moment, is_moving = robot.heard  # a velocity of zero may be a stop of this guard's own
        if is_moving and time.monotonic() - moment < after:
            stops = 0
        elif is_moving and moment != stopped:
            stopped, stops, told = moment, robot.times, False
        if stops:
            with suppress(BridgeError):  # it is tried until the robot is found again
                robot.stop()
                stops -= 1
                if not told:
                    told = True
                    say(f"No {robot.what} for {after:g} s{robot.why}. It was stopped.")


class RosSide:
    """A velocity topic of ROS, or a topic on which its program says that it is there, with actions.

    An empty type is that of the live topic.
    """

    what, why, times = _COMMAND

    def __init__(
        self, topic: str, type_: str, alive: str = "", actions: Sequence[str] = (), **where: Any
    ) -> None:
        wire = {"topic": topic, "type": type_}
        self._alive = bool(alive)
        if alive:
            self.what, self.why = "message of its program", ", and the robot may be busy with a goal"
            self.times = _CANCELS
        setup = {
            "subscriptions": {"heard": alive or wire},
            "publishers": {"move": wire} if topic else {},
            "actions": {f"action{number}": action for number, action in enumerate(actions)},
        }
        self._bridge = RosBridge(**where, setup=setup, node=GUARD_NODE, sim_time=False)
        self._heard = (0.0, False)
        self._bridge.open()

    @property
    def heard(self) -> tuple[float, bool]:
        """When the last command came (possibly before a loss), by `time.monotonic`, and whether it moves."""
        for channel in self._bridge.wiring.channels:
            if channel.wire.direction == "subscription" and channel.latest is not None:
                is_moving = self._alive or moves(channel.latest.value._as_dict())
                self._heard = (channel.latest.time, is_moving)
        return self._heard

    def state(self) -> str:
        """Return a sentence about the connection."""
        return self._bridge.status.sentence

    def stop(self) -> None:
        """Send a velocity of zero."""
        status = self._bridge.status
        if status.state is ConnectionState.LOST or not self._bridge.stop_all():
            raise BridgeError(status.sentence)

    def close(self) -> None:
        """End the connection; `Bridge.close` would stop a robot that is commanded."""
        self._bridge.close_interface()


class MqttSide:
    """A topic of an MQTT broker, with JSON: the zero has the form of the last command."""

    what, why, times = _COMMAND

    def __init__(self, topic: str, host: str | None) -> None:
        try:
            mqtt: Any = import_module("paho.mqtt.client")
        except ImportError:
            raise BridgeError(
                'MQTT needs the package `paho-mqtt`. Install it with `pip install "lrp-jupyter[mqtt]"`.'
            ) from None
        address = parse_address(host or "localhost", None, 1883, ("mqtt",))
        self._topic, self._place = topic, str(address)
        self._still = "{}"  # the last command with all its numbers zero
        self._unread = ""  # what came last, if it cannot be read
        self._refused = ""  # why the broker has not accepted the subscription
        self._hears = False  # a command before the broker has accepted the subscription is missed
        self.heard = (0.0, False)
        self._client = client = mqtt.Client(mqtt.CallbackAPIVersion.VERSION2)
        client.on_connect = lambda *_: client.subscribe(topic)
        client.on_subscribe = self._accept
        client.on_disconnect = lambda *_: setattr(self, "_hears", False)
        client.on_message = self._hear
        client.reconnect_delay_set(1, 1)
        try:
            client.connect(address.host, address.port, keepalive=2)
        except OSError as error:
            raise BridgeError(f"No MQTT broker answers at {self._place} ({error}).") from error
        client.loop_start()

    def _accept(self, _client: object, _data: object, _id: int, codes: list[Any], _: object) -> None:
        self._hears = not codes[0].is_failure
        self._refused = str(codes[0]) if codes[0].is_failure else ""

    def _hear(self, _client: object, _data: object, message: Any) -> None:
        is_moving = False
        try:
            command = json.loads(message.payload)
            is_moving, self._still, self._unread = moves(command), json.dumps(_zero(command)), ""
        except (ValueError, RecursionError):
            self._unread = repr(message.payload[:40])
        self.heard = (time.monotonic(), is_moving)

    def state(self) -> str:
        """Return a sentence about the connection."""
        if self._refused:
            why = f"does not let this guard read `{self._topic}` ({self._refused})."
            return f"The MQTT broker at {self._place} {why}"
        if not self._hears:
            return f"The MQTT broker at {self._place} does not answer."
        if self._unread:
            return f"{self._unread} on `{self._topic}` cannot be read as JSON, so the robot is not guarded."
        return f"Connected to the MQTT broker at {self._place}."

    def stop(self) -> None:
        """Publish the last command with all its numbers zero."""
        if not self._hears:
            raise BridgeError(self.state())
        self._client.publish(self._topic, self._still)

    def close(self) -> None:
        """End the connection."""
        self._client.disconnect()
        self._client.loop_stop()


def _zero(value: Any) -> Any:
    """Return a value of JSON with all its numbers zero."""
    if isinstance(value, dict):
        return {name: _zero(each) for name, each in value.items()}
    if isinstance(value, list):
        return [_zero(each) for each in value]
    return type(value)(0) if isinstance(value, (int, float)) else value
