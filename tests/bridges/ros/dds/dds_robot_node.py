"""A ROS 2 robot for the tests: the simulator behind topics, `python dds_robot_node.py SPEED WORLD LEASE`.

Like `robot_node.py`, on Cyclone DDS and in the domain of the environment, with nothing of the bridge: its
types are written down here as IDL, field by field. Others believe that it is gone after LEASE silent seconds.
"""

import os
import sys
import threading
from dataclasses import dataclass
from dataclasses import field as default
from pathlib import Path

from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float64, int32, uint8, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

sys.path.append(str(Path(__file__).parents[3]))

from support.simulated import Odom, RosRobot, ready

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
    robot = RosRobot(speed, world)
    number = int(os.environ["ROS_DOMAIN_ID"])
    domain = Domain(number, loopback(lease))
    participant = DomainParticipant(number)
    commands = DataReader(participant, Topic(participant, "rt/cmd_vel", Twist), QOS)
    goals = DataReader(participant, Topic(participant, "rt/until", Float64), QOS)
    odom = DataWriter(participant, Topic(participant, "rt/odom", Odometry), QOS)
    light = DataWriter(participant, Topic(participant, "rt/light", UInt8), QOS)
    bumper = DataWriter(participant, Topic(participant, "rt/bumper", UInt8), QOS)

    def listen() -> None:
        while not robot.gone.wait(0.001):
            for command in commands.take(10):
                if isinstance(command, Twist):
                    robot.drive(command.linear.x, command.angular.z)
            for goal in goals.take(10):
                if isinstance(goal, Float64):
                    robot.go_on(goal.data)

    def publish(brightness: int, pressed: bool, pose: Odom) -> None:
        odom.write(robot.odometry(Odometry(), pose))
        light.write(UInt8(robot.brightness(brightness)))
        bumper.write(UInt8(int(pressed)))

    listener = threading.Thread(target=listen)
    listener.start()
    ready(robot)
    robot.run(publish)
    listener.join()
    del domain


if __name__ == "__main__":
    main(float(sys.argv[1]), sys.argv[2], float(sys.argv[3]))
