"""The bridge to ROS 1 and 2: topics as members of `robot`. Paper: §7.1."""

from lrp_jupyter.bridges.ros.bridge import RosBridge

__all__ = ["RosBridge"]
