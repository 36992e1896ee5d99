"""The back ends of the ROS bridge, i.e. the ways to communicate with ROS, by their names."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from lrp_jupyter.bridges.ros.link import Transport
from lrp_jupyter.bridges.ros.rclpy import RclpyTransport
from lrp_jupyter.bridges.ros.rosbridge import RosbridgeTransport
from lrp_jupyter.bridges.ros.rospy import RospyTransport
from lrp_jupyter.bridges.ros.setup import parse_address
from lrp_jupyter.errors import BridgeError, did_you_mean

__all__ = ["PORTS", "check_backend", "make_transport", "read_address"]

PORTS: Mapping[str, int] = {"rosbridge": 9090, "rospy": 11311, "rclpy": 0}
"""The back ends with the port at which each finds its robot; 0: it needs no address."""


def check_backend(name: str) -> str:
    """Return the name of a back end.

    Raises
    ------
    BridgeError
        There is none of that name.
    """
    if name not in PORTS:
        names = ", ".join(f"`{known}`" for known in PORTS)
        raise BridgeError(f"There is no back end `{name}`; there are {names}.{did_you_mean(name, PORTS)}")
    return name


def read_address(backend: str, host: str | None, port: int | str | None) -> tuple[str, int]:
    """Return the host, which may be empty, and the port at which a back end finds its robot.

    Raises
    ------
    BridgeError
        It is not an address, or there is one where robots are found without.
    """
    if PORTS[backend]:
        return parse_address(host, port, PORTS[backend])
    if host or port:
        raise BridgeError(
            f"The back end `{backend}` takes no address: it finds every node of its domain."
            " Set `ROS_DOMAIN_ID` instead."
        )
    return "", 0


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
    if backend == "rclpy":
        return RclpyTransport()
    return RosbridgeTransport(f"ws://{host or '127.0.0.1'}:{port}", warn)
