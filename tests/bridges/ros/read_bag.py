"""Print what a bag has, one JSON object a line, by rosbag's own API: `/usr/bin/python3 read_bag.py BAG`."""

from __future__ import annotations

import json
import sys

import rosbag

with rosbag.Bag(sys.argv[1]) as bag:
    for topic, message, time in bag.read_messages():
        fields = {name: getattr(message, name) for name in message.__slots__}
        if header := fields.pop("header", None):
            fields["stamp"] = header.stamp.to_sec()
        line = json.dumps({"topic": topic, "time": time.to_sec(), **fields})
        sys.stdout.write(f"{line}\n")
