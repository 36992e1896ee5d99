"""A ROS robot for the tests: the simulator behind topics, `python robot_node.py SPEED WORLD`.

It subscribes to `/cmd_vel` (Twist) and publishes `/odom` (Odometry), `/light` (UInt8, 0 black ... 255
white) and `/bumper` (UInt8, 1 pressed). With a SPEED of 0 its time passes on `/until` (Float64, s).
"""

from __future__ import annotations

import sys
from pathlib import Path

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64, UInt8

sys.path.append(str(Path(__file__).parents[2]))

from support.simulated import Odom, RosRobot, ready


def main(speed: float, world: str) -> None:
    robot = RosRobot(speed, world)
    at_once = {"queue_size": 1, "tcp_nodelay": True}
    rospy.init_node("robot", disable_signals=True, disable_rosout=True, disable_rostime=True)
    rospy.Subscriber("/cmd_vel", Twist, lambda m: robot.drive(m.linear.x, m.angular.z), **at_once)
    rospy.Subscriber("/until", Float64, lambda m: robot.go_on(m.data), **at_once)
    odom = rospy.Publisher("/odom", Odometry, **at_once)
    light = rospy.Publisher("/light", UInt8, **at_once)
    bumper = rospy.Publisher("/bumper", UInt8, **at_once)

    def publish(brightness: int, pressed: bool, pose: Odom) -> None:
        odom.publish(robot.odometry(Odometry(), pose))
        light.publish(UInt8(robot.brightness(brightness)))
        bumper.publish(UInt8(pressed))

    ready(robot)
    robot.run(publish)


if __name__ == "__main__":
    main(float(sys.argv[1]), sys.argv[2])
