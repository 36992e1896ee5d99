"""A robot that speaks MQTT, such as an ESP32 in the same WiFi as this computer.

    pip install paho-mqtt
    lrp run follower --bridge mqtt.py --option host=192.168.4.1

or `%run mqtt.py` in a notebook, then `%lrp bridge mqtt`. The robot publishes `robot/light` (0 dark … 255
bright) and `robot/bumper` (1 pressed) many times a second, and whatever else it has: `robot/battery`, or
`robot/odom` (`{"x": 0.1, "y": 0.0, "theta": 0.0}`). It subscribes to `robot/cmd_vel` and drives as the last
message said: `{"linear": 0.2, "angular": 0.0}`, in m/s and rad/s. Nothing is retained and everything has
QoS 0: an old command or reading is worth nothing.

It subscribes to `robot/task`, too, and does what that asks for by itself: `{"number": 3, "drive_by": 0.3}`,
0.3 m ahead, or `{"number": 4, "turn_by": 1.571}`, a quarter to the left. What becomes of it, it publishes on
`robot/outcome`: `{"number": 3, "status": "succeeded"}`, or `"aborted"` with a `reason`; meanwhile, if it
likes, `"active"` with what is left as `feedback`. Whatever comes on `robot/cmd_vel` ends the task.

Who stops the robot when this process dies? The broker: the *last will* of this connection is a velocity of
zero, which ends a task, too. It is published at once if the process dies, and after 3 s if the computer or
the network does. On the robot's side, `lrp guard --backend mqtt` stops it half a second after the last
velocity; it does not know of tasks. Without its broker, the robot has to stop by itself.

Met in tests: the broker mosquitto 2.0, with a simulated robot behind it. Not met: an ESP32.
"""

import json
import threading
from types import SimpleNamespace

import paho.mqtt.client as mqtt

from lrp_jupyter import Bridge, BridgeError

DRIVES_BY = {"light": "0 dark … 255 bright", "bumper": "1 pressed"}  # it stops when one of these is late
OWN = ("cmd_vel", "task")  # what the robot hears
STILL = json.dumps({"linear": 0.0, "angular": 0.0})


class Mqtt(Bridge):
    """A robot behind an MQTT broker.

    Parameters
    ----------
    host : str
        Where the broker is.
    port : int
        What it listens on.
    topic : str
        What the robot's topics begin with.
    """

    name = "mqtt"
    stops_when_found = True  # in `joined`
    task = None  # the last one

    def __init__(self, host: str = "localhost", port: int = 1883, topic: str = "robot"):
        self.host, self.port, self.topic = host, port, topic

    def open_interface(self):
        for name, doc in DRIVES_BY.items():
            self.feed(f"{name}.data", doc=doc)
        self.add_method("move", self.move, "m/s and rad/s", limits={"linear": 0.5, "angular": 2.0})
        end = self.cancel  # and `mover`: what is begun last has the wheels, a task or `move`
        self.add_task("drive_by", self.drive_by, end, "ahead, in m", limits={"metres": 100}, mover="")
        self.add_task("turn_by", self.turn_by, end, "to the left, in rad", limits={"radians": 100}, mover="")
        self.client = client = mqtt.Client(mqtt.CallbackAPIVersion.VERSION2)
        client.on_connect, client.on_message, client.on_disconnect = self.joined, self.arrived, self.left
        client.on_subscribe = lambda *_: self.answered.set()
        client.will_set(f"{self.topic}/cmd_vel", STILL)
        client.reconnect_delay_set(1, 1)
        self.answered = threading.Event()
        try:
            client.connect(self.host, self.port, keepalive=2)
        except OSError as error:
            raise BridgeError(
                f"No MQTT broker answers at {self.host}:{self.port} ({error}). Start it, for example with"
                " `mosquitto`, or name another `host`."
            ) from error
        client.loop_start()
        if not self.answered.wait(5) or not client.is_connected():
            self.close_interface()
            raise BridgeError(f"What answers at {self.host}:{self.port} does not let this bridge in.")

    def joined(self, client, _data, _flags, reason, _properties):
        if reason.is_failure:
            self.answered.set()
            return
        if self.safety.has_commanded:  # it may be driving since the broker was lost
            client.publish(f"{self.topic}/cmd_vel", STILL)
        client.subscribe(f"{self.topic}/+")
        self.set_status("connected", f"Connected to the MQTT broker at {self.host}:{self.port}.")

    def left(self, _client, _data, _flags, reason, _properties):
        if reason != 0:
            self.set_status("lost", f"The MQTT broker at {self.host}:{self.port} is gone: {reason}.")

    def arrived(self, _client, _data, message):
        name = message.topic.removeprefix(f"{self.topic}/")
        if name in OWN or message.retain:  # what was retained may be of yesterday
            return
        try:
            value = json.loads(message.payload)
            if name in DRIVES_BY:
                self.feed(f"{name}.data", value)
            elif name == "outcome":
                self.tell(**value)
            elif name == "odom":
                self.feed(name, SimpleNamespace(**value), doc="where it is by its wheels: m and rad")
            else:
                self.feed(f"{name}.data", value, doc=f"`{message.topic}`", stale_after=None)
        except (TypeError, ValueError) as error:
            what = f"`{message.topic}` sent {message.payload!r}: {error}."
            self.safety.notice("fault", what, message.topic)

    def tell(self, number, **what):
        if self.task is not None and self.task.number == number:
            self.task.update(**what)

    def move(self, linear=0.0, angular=0.0):
        if self.task is not None:
            self.task.update("aborted", reason="The robot was told something else meanwhile.")
        self.publish("cmd_vel", linear=linear, angular=angular)

    def drive_by(self, task, metres):
        self.ask(task, drive_by=metres)

    def turn_by(self, task, radians):
        self.ask(task, turn_by=radians)

    def ask(self, task, **what):
        self.move()  # for `lrp guard`: a velocity before is over
        self.task = task
        self.publish("task", number=task.number, **what)

    def cancel(self, task):
        self.move()

    def publish(self, topic, **what):
        self.client.publish(f"{self.topic}/{topic}", json.dumps(what)).wait_for_publish(0.5)

    @property
    def failsafe(self):
        return (
            "The MQTT broker stops the robot: at once if this program dies, after 3 s if the computer does."
        )

    def close_interface(self):
        self.client.disconnect()
        self.client.loop_stop()
