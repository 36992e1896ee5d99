"""A node that publishes transforms: `transforms_node.py static|moving`, with what is written to it.

Each line is JSON: a list of [PARENT, CHILD, X, Y, YAW]. It has tf's own broadcasters.
"""

from __future__ import annotations

import json
import math
import sys

import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped

rospy.init_node("transforms", anonymous=True, disable_rosout=True, disable_rostime=True)
broadcaster = {"static": tf2_ros.StaticTransformBroadcaster, "moving": tf2_ros.TransformBroadcaster}
publish = broadcaster[sys.argv[1]]()
sys.stdout.write("ready\n")
sys.stdout.flush()
for line in sys.stdin:
    transforms = []
    for parent, child, x, y, yaw in json.loads(line):
        one = TransformStamped()
        one.header.frame_id, one.child_frame_id, one.header.stamp = parent, child, rospy.Time.now()
        one.transform.translation.x, one.transform.translation.y = x, y
        one.transform.rotation.z, one.transform.rotation.w = math.sin(yaw / 2), math.cos(yaw / 2)
        transforms.append(one)
    publish.sendTransform(transforms)
