"""The bridge to the Lego Mindstorms EV3 with its stock firmware. Paper: §7.2."""

from lrp_jupyter.bridges.ev3.bridge import EV3Bridge

__all__ = ["EV3Bridge"]
