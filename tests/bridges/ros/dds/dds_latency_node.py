"""The other side of the benchmark of the latency on Cyclone DDS: `python dds_latency_node.py COUNT`."""

from __future__ import annotations

import os
import sys
import threading
from pathlib import Path

from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from dds_robot_node import QOS, Twist, UInt8, loopback

sys.path += [str(Path(__file__).parents[1]), str(Path(__file__).parents[3])]

from latency_node import Stopwatch, answer
from support.waiting import until


def main(count: int) -> None:
    number = int(os.environ["ROS_DOMAIN_ID"])
    domain = Domain(number, loopback())
    participant = DomainParticipant(number)
    light = DataWriter(participant, Topic(participant, "rt/light", UInt8), QOS)
    commands = DataReader(participant, Topic(participant, "rt/cmd_vel", Twist), QOS)

    def show(value: int) -> None:
        until(light.get_matched_subscriptions)  # or it hears nothing of this one
        light.write(UInt8(value))

    stopwatch = Stopwatch(show)

    def listen() -> None:
        while True:
            for command in commands.take_iter(timeout=duration(milliseconds=100)):
                stopwatch.command(command.linear.x)

    threading.Thread(target=listen, daemon=True).start()
    answer(stopwatch, count)
    del domain
    os._exit(0)  # a thread still waits for commands


if __name__ == "__main__":
    main(int(sys.argv[1]))
