"""A node that counts when a line is written to it: `counting_node.py TOPIC COUNT RATE`; RATE 0: latched."""

from __future__ import annotations

import sys
import time

import rospy
from std_msgs.msg import UInt32

topic, count, rate = sys.argv[1], int(sys.argv[2]), float(sys.argv[3])
rospy.init_node("counting", anonymous=True, disable_rosout=True, disable_rostime=True)
publisher = rospy.Publisher(topic, UInt32, queue_size=None if rate else 1, latch=not rate)
if not rate:
    publisher.publish(count)
sys.stdout.write("ready\n")
sys.stdout.flush()
sys.stdin.readline()
while rate and publisher.get_num_connections() == 0:
    time.sleep(0.01)
began = time.monotonic()
for number in range(count if rate else 0):
    publisher.publish(number)
    left = began + (number + 1) / rate - time.monotonic()
    if left > 0:
        time.sleep(left)
sys.stdin.readline()
