"""A ROS robot for the tests: the simulator behind topics, `python robot_node.py SPEED WORLD`.

It subscribes to `/cmd_vel` (Twist) and publishes `/odom` (Odometry), `/light` (UInt8, 0 black ... 255
white) and `/bumper` (UInt8, 1 pressed). It prints when it was told another speed, by `time.monotonic`.

The frame of the odometry is the robot's time, in seconds. With a SPEED of `inf` it passes at once after each
command, for a little longer than until the next one, and then hardly.
"""

from __future__ import annotations

import math
import sys
import threading
import time
from typing import Any

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import UInt8

from lrp_jupyter.sim.simulation import STEP, Simulation

_EVERY = 4  # physics steps between two messages
_LATE = 0.05  # s
_LEAD = 0.12  # s of the robot that pass after a command, at an infinite speed
_CREEP = 0.1  # s of wall time for each further step


def main(speed: float, world: str) -> None:
    simulation = Simulation(world)
    wanted, heard, news = [(0.0, 0.0)], [0.0], threading.Event()

    def drive(message: Any) -> None:
        speed, before = (message.linear.x, message.angular.z), wanted[0]
        wanted[0], heard[0] = speed, simulation.steps * STEP
        news.set()
        if speed[0] != before[0]:
            sys.stdout.write(f"{time.monotonic()} {speed[0]}\n")
            sys.stdout.flush()

    rospy.init_node("robot", disable_signals=True, disable_rosout=True, disable_rostime=True)
    rospy.Subscriber("/cmd_vel", Twist, drive, queue_size=1, tcp_nodelay=True)
    topics = {
        name: rospy.Publisher(f"/{name}", kind, queue_size=1, tcp_nodelay=True)
        for name, kind in (("odom", Odometry), ("light", UInt8), ("bumper", UInt8))
    }
    gone = threading.Event()
    threading.Thread(target=lambda: (sys.stdin.read(), gone.set()), daemon=True).start()
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    began = time.monotonic()
    while not gone.is_set():
        simulation.drive(*wanted[0])
        simulation.step(_EVERY)
        readings = simulation.latch()
        x, y, theta = readings.odom
        odom = Odometry()
        odom.header.frame_id = str(simulation.steps * STEP)
        odom.pose.pose.position.x, odom.pose.pose.position.y = x, y
        odom.pose.pose.orientation.z, odom.pose.pose.orientation.w = math.sin(theta / 2), math.cos(theta / 2)
        topics["odom"].publish(odom)
        topics["light"].publish(UInt8(readings.lights[0]))
        topics["bumper"].publish(UInt8(readings.bumper))
        ahead = began + simulation.steps * STEP / speed - time.monotonic()
        if ahead < -_LATE:  # a robot that was held up is slow: it does not race on with an old command
            began -= ahead
        if speed < math.inf:
            gone.wait(max(0.0, ahead))
        elif simulation.steps * STEP > heard[0] + _LEAD:
            news.wait(_CREEP)
            news.clear()


if __name__ == "__main__":
    main(float(sys.argv[1]), sys.argv[2])
