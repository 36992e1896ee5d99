"""A node that publishes the time: what it reads, a number of seconds in each line, as it comes."""

from __future__ import annotations

import sys

import rospy
from rosgraph_msgs.msg import Clock

rospy.init_node("world", disable_signals=True, disable_rosout=True, disable_rostime=True)
publisher = rospy.Publisher("/clock", Clock, queue_size=1000, latch=True)
sys.stdout.write("ready\n")
sys.stdout.flush()
for line in sys.stdin:
    publisher.publish(Clock(rospy.Time.from_sec(float(line))))
