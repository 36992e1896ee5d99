"""A world with a time of its own: it publishes what it reads, a topic and a number of seconds in each line.

On any topic but `/clock`, that is the time stamp of a message.
"""

from __future__ import annotations

import sys

import rospy
from geometry_msgs.msg import PointStamped
from rosgraph_msgs.msg import Clock

rospy.init_node("world", disable_signals=True, disable_rosout=True, disable_rostime=True)
topics = {
    "/clock": rospy.Publisher("/clock", Clock, queue_size=1000, latch=True),
    "/seen": rospy.Publisher("/seen", PointStamped, queue_size=1000, latch=True),
}
sys.stdout.write("ready\n")
sys.stdout.flush()
for line in sys.stdin:
    topic, seconds = line.split()
    time = rospy.Time.from_sec(float(seconds))
    message = Clock(time) if topic == "/clock" else PointStamped()
    if topic != "/clock":
        message.header.stamp = time
    topics[topic].publish(message)
