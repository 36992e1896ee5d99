"""A ROS 2 robot for the tests: the simulator behind topics, `python dds_robot_node.py SPEED WORLD LEASE`.

Like `robot_node.py`, on Cyclone DDS and in the domain of the environment, with nothing of the bridge: its
types are written down here as IDL, field by field. It prints when it was told another speed. Others believe
that it is gone when it was silent for LEASE seconds.
"""

import math
import os
import sys
import threading
import time
from dataclasses import dataclass
from dataclasses import field as default

from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float64, int32, uint8, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from lrp_jupyter.sim.simulation import STEP, Simulation

_EVERY = 4  # physics steps between two messages
_LATE = 0.05  # s
QOS = Qos(
    Policy.Reliability.Reliable(duration(milliseconds=100)),
    Policy.Durability.Volatile,
    Policy.History.KeepLast(10),
)
_LOOPBACK = (
    '<General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces></General><Discovery>'
    '<ParticipantIndex>auto</ParticipantIndex><Peers><Peer address="127.0.0.1"/></Peers>'
    "<LeaseDuration>{lease}s</LeaseDuration></Discovery>"
)


def loopback(lease: float = 10) -> str:
    """The configuration of a domain that stays on this machine."""
    return _LOOPBACK.format(lease=lease)


@dataclass
class Time(IdlStruct, typename="builtin_interfaces.msg.dds_.Time_"):
    sec: int32 = 0
    nanosec: uint32 = 0


@dataclass
class Header(IdlStruct, typename="std_msgs.msg.dds_.Header_"):
    stamp: Time = default(default_factory=Time)
    frame_id: str = ""


@dataclass
class UInt8(IdlStruct, typename="std_msgs.msg.dds_.UInt8_"):
    data: uint8 = 0


@dataclass
class Float64(IdlStruct, typename="std_msgs.msg.dds_.Float64_"):
    data: float64 = 0.0


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs.msg.dds_.Vector3_"):
    x: float64 = 0.0
    y: float64 = 0.0
    z: float64 = 0.0


@dataclass
class Point(IdlStruct, typename="geometry_msgs.msg.dds_.Point_"):
    x: float64 = 0.0
    y: float64 = 0.0
    z: float64 = 0.0


@dataclass
class Quaternion(IdlStruct, typename="geometry_msgs.msg.dds_.Quaternion_"):
    x: float64 = 0.0
    y: float64 = 0.0
    z: float64 = 0.0
    w: float64 = 1.0


@dataclass
class Twist(IdlStruct, typename="geometry_msgs.msg.dds_.Twist_"):
    linear: Vector3 = default(default_factory=Vector3)
    angular: Vector3 = default(default_factory=Vector3)


@dataclass
class Pose(IdlStruct, typename="geometry_msgs.msg.dds_.Pose_"):
    position: Point = default(default_factory=Point)
    orientation: Quaternion = default(default_factory=Quaternion)


@dataclass
class PoseWithCovariance(IdlStruct, typename="geometry_msgs.msg.dds_.PoseWithCovariance_"):
    pose: Pose = default(default_factory=Pose)
    covariance: array[float64, 36] = default(default_factory=lambda: [0.0] * 36)


@dataclass
class TwistWithCovariance(IdlStruct, typename="geometry_msgs.msg.dds_.TwistWithCovariance_"):
    twist: Twist = default(default_factory=Twist)
    covariance: array[float64, 36] = default(default_factory=lambda: [0.0] * 36)


@dataclass
class Odometry(IdlStruct, typename="nav_msgs.msg.dds_.Odometry_"):
    header: Header = default(default_factory=Header)
    child_frame_id: str = ""
    pose: PoseWithCovariance = default(default_factory=PoseWithCovariance)
    twist: TwistWithCovariance = default(default_factory=TwistWithCovariance)


def main(speed: float, world: str, lease: float) -> None:
    simulation = Simulation(world)
    number = int(os.environ["ROS_DOMAIN_ID"])
    domain = Domain(number, loopback(lease))
    participant = DomainParticipant(number)
    commands = DataReader(participant, Topic(participant, "rt/cmd_vel", Twist), QOS)
    writers = {
        name: DataWriter(participant, Topic(participant, f"rt/{name}", kind), QOS)
        for name, kind in (("odom", Odometry), ("light", UInt8), ("bumper", UInt8))
    }
    goals = DataReader(participant, Topic(participant, "rt/until", Float64), QOS)
    wanted, until = (0.0, 0.0), 0.0
    gone = threading.Event()
    threading.Thread(target=lambda: (sys.stdin.read(), gone.set()), daemon=True).start()
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    began = time.monotonic()
    while not gone.is_set():
        news = False
        for command in commands.take(10):
            if isinstance(command, Twist):
                if command.linear.x != wanted[0]:
                    sys.stdout.write(f"{time.monotonic()} {command.linear.x}\n")
                    sys.stdout.flush()
                wanted, news = (command.linear.x, command.angular.z), True
        for goal in goals.take(10):
            if isinstance(goal, Float64):
                until, news = goal.data, True
        if not (speed or news):
            gone.wait(0.001)
            continue
        simulation.drive(*wanted)
        simulation.step(_EVERY if speed else max(0, round(until / STEP) - simulation.steps))
        readings = simulation.latch()
        x, y, theta = readings.odom
        odom = Odometry()
        odom.header.frame_id = str(simulation.steps)
        odom.pose.pose.position.x, odom.pose.pose.position.y = x, y
        odom.pose.pose.orientation.z, odom.pose.pose.orientation.w = math.sin(theta / 2), math.cos(theta / 2)
        odom.twist.twist.linear.x, odom.twist.twist.angular.z = wanted
        light = readings.lights[0]
        writers["odom"].write(odom)
        writers["light"].write(UInt8(light if speed else light & ~15 | simulation.steps & 15))
        writers["bumper"].write(UInt8(int(readings.bumper)))
        if not speed:
            continue
        ahead = began + simulation.steps * STEP / speed - time.monotonic()
        if ahead < -_LATE:  # a robot that was held up is slow: it does not race on with an old command
            began -= ahead
        gone.wait(max(0.0, ahead))
    del domain


if __name__ == "__main__":
    main(float(sys.argv[1]), sys.argv[2], float(sys.argv[3]))
