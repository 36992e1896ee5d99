"""The back ends of the ROS bridge, i.e. the ways to communicate with ROS, by their names."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from lrp_jupyter.bridges.ros.link import Transport
from lrp_jupyter.bridges.ros.rosbridge import RosbridgeTransport
from lrp_jupyter.bridges.ros.rospy import RospyTransport
from lrp_jupyter.errors import BridgeError, did_you_mean

__all__ = ["PORTS", "check_backend", "make_transport"]

PORTS: Mapping[str, int] = {"rosbridge": 9090, "rospy": 11311}
"""The back ends with the port at which each finds its robot."""


def check_backend(name: str) -> str:
    """Return the name of a back end.

    Raises
    ------
    BridgeError
        There is none of that name.
    """
    if name not in PORTS:
        names = " and ".join(f"`{known}`" for known in PORTS)
        raise BridgeError(f"There is no back end `{name}`, only {names}.{did_you_mean(name, PORTS)}")
    return name


def make_transport(backend: str, address: tuple[str, int], warn: Callable[[str], None]) -> Transport:
    """Return a transport that is not connected yet.

    Parameters
    ----------
    backend : str
    address : tuple of str and int
        Host and port; an empty host: this machine or, with rospy, the value of ``ROS_MASTER_URI``.
    warn : callable
        Called with a sentence for each complaint of the robot's side.
    """
    host, port = address
    if backend == "rospy":
        return RospyTransport(f"http://{host}:{port}" if host else "")
    return RosbridgeTransport(f"ws://{host or '127.0.0.1'}:{port}", warn)
