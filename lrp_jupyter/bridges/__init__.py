"""Bridges: from LRP to robot APIs.

Paper: §7.
"""

from lrp_jupyter.bridges.bridge import Bridge, Member, MemberError, NullBridge, Panel, Robot, Twist
from lrp_jupyter.bridges.discovery import choose_bridge, find_bridges, make_bridge, open_bridge
from lrp_jupyter.bridges.guarding.guard import Stopper
from lrp_jupyter.bridges.reconnecting import ReconnectingBridge

__all__ = [
    "Bridge",
    "Member",
    "MemberError",
    "NullBridge",
    "Panel",
    "ReconnectingBridge",
    "Robot",
    "Stopper",
    "Twist",
    "choose_bridge",
    "find_bridges",
    "make_bridge",
    "open_bridge",
]
