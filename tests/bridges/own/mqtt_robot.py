"""A robot behind an MQTT broker, as an ESP32 would be: ``python mqtt_robot.py PORT SPEED``."""

from __future__ import annotations

import json
import sys
import threading
from pathlib import Path
from typing import Any

import paho.mqtt.client as mqtt

sys.path.append(str(Path(__file__).parents[2]))

from support.simulated import SimulatedRobot, ready

from lrp_jupyter.sim.world_inputs import DriveBy, TurnBy


def main(port: int, speed: float) -> None:
    robot = SimulatedRobot(speed)
    client = mqtt.Client(mqtt.CallbackAPIVersion.VERSION2)

    def connected(client: mqtt.Client, *_: Any) -> None:
        client.subscribe([("robot/cmd_vel", 0), ("robot/task", 0)])

    def drive(_client: mqtt.Client, _data: object, message: mqtt.MQTTMessage) -> None:
        command = json.loads(message.payload)
        if message.topic == "robot/cmd_vel":
            robot.drive(command["linear"], command["angular"])
        elif "drive_by" in command:
            robot.ask(DriveBy(command["drive_by"], number=command["number"]))
        else:
            robot.ask(TurnBy(command["turn_by"], number=command["number"]))

    listens = threading.Event()
    client.on_connect, client.on_message = connected, drive
    client.on_subscribe = lambda *_: listens.set()
    client.reconnect_delay_set(1, 1)
    client.connect("127.0.0.1", port)
    client.loop_start()
    listens.wait()
    ready(robot)

    told: list[tuple[int, str]] = []

    def publish(light: int, bumper: bool, odom: tuple[float, float, float]) -> None:
        errand = robot.errand
        if errand is not None and told[-1:] != [(errand.what.number, errand.status)]:
            outcome = {"number": errand.what.number, "status": errand.status, "reason": errand.reason}
            client.publish("robot/outcome", json.dumps(outcome | {"feedback": errand.left(odom)}))
            if not errand.is_active:
                told.append((errand.what.number, errand.status))
        client.publish("robot/light", light)
        client.publish("robot/bumper", int(bumper))
        client.publish("robot/odom", json.dumps(dict(zip(("x", "y", "theta"), odom, strict=True))))

    robot.run(publish)
    client.disconnect()
    client.loop_stop()


if __name__ == "__main__":
    main(int(sys.argv[1]), float(sys.argv[2]))
