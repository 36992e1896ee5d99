"""A ROS robot for the tests: the simulator behind topics, `python robot_node.py SPEED WORLD`.

It subscribes to `/cmd_vel` (Twist) and publishes `/odom` (Odometry), `/light` (UInt8, 0 black ... 255
white) and `/bumper` (UInt8, 1 pressed). It prints when it was told another speed, by `time.monotonic`.

With a SPEED of 0 its time passes when it is told on `/until` (Float64, s) how far, at once. The odometry
tells it, as its frame, and the command that the robot obeys; the light has its last four bits, in steps.
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
from std_msgs.msg import Float64, UInt8

from lrp_jupyter.sim.simulation import STEP, Simulation

_EVERY = 4  # physics steps between two messages
_LATE = 0.05  # s


def main(speed: float, world: str) -> None:
    simulation = Simulation(world)
    wanted, until, news = [(0.0, 0.0)], [0.0], threading.Event()

    def drive(message: Any) -> None:
        speed, before = (message.linear.x, message.angular.z), wanted[0]
        wanted[0] = speed
        news.set()
        if speed[0] != before[0]:
            sys.stdout.write(f"{time.monotonic()} {speed[0]}\n")
            sys.stdout.flush()

    def go_on(message: Any) -> None:
        until[0] = message.data
        news.set()

    rospy.init_node("robot", disable_signals=True, disable_rosout=True, disable_rostime=True)
    rospy.Subscriber("/cmd_vel", Twist, drive, queue_size=1, tcp_nodelay=True)
    rospy.Subscriber("/until", Float64, go_on, queue_size=1, tcp_nodelay=True)
    topics = {
        name: rospy.Publisher(f"/{name}", kind, queue_size=1, tcp_nodelay=True)
        for name, kind in (("odom", Odometry), ("light", UInt8), ("bumper", UInt8))
    }
    gone = threading.Event()
    threading.Thread(target=lambda: (sys.stdin.read(), gone.set(), news.set()), daemon=True).start()
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    began = time.monotonic()
    while not gone.is_set():
        news.clear()
        command = wanted[0]
        simulation.drive(*command)
        simulation.step(_EVERY if speed else max(0, round(until[0] / STEP) - simulation.steps))
        readings = simulation.latch()
        x, y, theta = readings.odom
        odom = Odometry()
        odom.header.frame_id = str(simulation.steps)
        odom.pose.pose.position.x, odom.pose.pose.position.y = x, y
        odom.pose.pose.orientation.z, odom.pose.pose.orientation.w = math.sin(theta / 2), math.cos(theta / 2)
        odom.twist.twist.linear.x, odom.twist.twist.angular.z = command
        light = readings.lights[0]
        topics["odom"].publish(odom)
        topics["light"].publish(UInt8(light if speed else light & ~15 | simulation.steps & 15))
        topics["bumper"].publish(UInt8(readings.bumper))
        if not speed:
            news.wait()
            continue
        ahead = began + simulation.steps * STEP / speed - time.monotonic()
        if ahead < -_LATE:  # a robot that was held up is slow: it does not race on with an old command
            began -= ahead
        gone.wait(max(0.0, ahead))


if __name__ == "__main__":
    main(float(sys.argv[1]), sys.argv[2])
