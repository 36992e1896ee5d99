"""The back ends of the ROS bridge, i.e. the ways to communicate with ROS, and the choice among them.

If none is named, it is the one that the environment is set up for, as in the shell of a person who works with
ROS, since it knows most; otherwise the first that answers.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from importlib.util import find_spec

from lrp_jupyter.bridges.ros.address import domain_number, parse_address
from lrp_jupyter.bridges.ros.client_libraries import lacks_library
from lrp_jupyter.bridges.ros.link import Transport
from lrp_jupyter.bridges.ros.rclpy import RclpyTransport
from lrp_jupyter.bridges.ros.rosbridge import RosbridgeTransport
from lrp_jupyter.bridges.ros.rospy import RospyTransport
from lrp_jupyter.errors import BridgeError, NoAnswerError, did_you_mean

AUTO = "auto"
"""The name that leaves the choice to this module."""

_PORTS: Mapping[str, int] = {"rosbridge": 9090, "rospy": 11311}
_NO_PORT = 1  # no robot has this one
_SCHEMES: Mapping[str, str] = {"ws": "rosbridge", "wss": "rosbridge", "http": "rospy"}
_LIBRARIES: Mapping[str, str] = {
    "rosbridge": "websockets",
    "rospy": "rospy",
    "rclpy": "rclpy",
    "dds": "cyclonedds",
}
_INSTALL: Mapping[str, str] = {
    "rosbridge": ' (`pip install "lrp-jupyter[ros]"`)',
    "dds": ' (`pip install "lrp-jupyter[ros2]"`)',
}

BACKENDS = (*_LIBRARIES,)
"""The back ends, in the order in which they are asked."""


@dataclass(frozen=True, slots=True)
class Choice:
    """A back end, and why it is this one; a person who named it knows."""

    backend: str
    reason: str = ""

    def __str__(self) -> str:
        return f"{self.backend}, because {self.reason}" if self.reason else self.backend


def check_backend(name: str, host: str | None = None, port: int | str | None = None) -> str:
    """Check that a back end, or `AUTO`, exists and that the address fits it; return its name."""
    known = (AUTO, *BACKENDS)
    if name not in known:
        names = ", ".join(f"`{each}`" for each in known)
        raise BridgeError(f"There is no back end `{name}`; there are {names}.{did_you_mean(name, known)}")
    if name == AUTO or name in _PORTS:
        parse_address(host, port, _PORTS.get(name, 1), _schemes(name))
    elif name == "dds":
        if port or parse_address(host, None, _NO_PORT, _schemes(name)).port != _NO_PORT:
            raise BridgeError(
                "The back end `dds` takes a `host` without a port: the ports follow from the domain."
                " Set `domain` instead."
            )
    elif host or port:
        raise BridgeError(
            f"The back end `{name}` takes no address: it finds every node of its domain."
            " Set `ROS_DOMAIN_ID` instead."
        )
    return name


def check_ros2(
    backend: str, domain: int | str | None, messages: str | Iterable[str]
) -> tuple[int | None, tuple[str, ...]]:
    """Return the number of a domain of ROS 2 and the folders with definitions, if the back end takes them."""
    folders = messages.split(os.pathsep) if isinstance(messages, str) else messages
    found = tuple(str(folder) for folder in folders if folder)
    if domain is not None and backend in _PORTS:
        raise BridgeError(f"The back end `{backend}` has no `domain`: it finds its robot by an address.")
    if found and backend not in (AUTO, "dds"):
        raise BridgeError(f"The back end `{backend}` takes no `messages`: ROS knows the types itself.")
    return None if domain is None else domain_number(domain), found


def make_transport(
    backend: str,
    host: str | None,
    port: int | str | None,
    warn: Callable[[str], None],
    domain: int | None = None,
    messages: Iterable[str] = (),
) -> Transport:
    """Return a transport that is not connected yet.

    `host`, `port`: default: this machine or, with rospy, the value of ``ROS_MASTER_URI``.
    `warn`: called with a sentence for each complaint of the robot's side.
    """
    if backend == "rclpy":
        return RclpyTransport(domain)
    if backend == "dds":
        return _import_dds()(domain, parse_address(host, None, _NO_PORT, _schemes(backend)).host, messages)
    address = parse_address(host, port, _PORTS[backend], _schemes(backend))
    if backend == "rospy":
        return RospyTransport(address.url if address.host else "")
    return RosbridgeTransport(address.url, warn)


def _schemes(backend: str) -> tuple[str, ...]:
    """Return what may stand before ``://`` in an address for a back end; the first is the default."""
    return tuple(scheme for scheme, user in _SCHEMES.items() if backend in (AUTO, user))


def choose_backend(
    backend: str, host: str | None = None, port: int | str | None = None, domain: int | None = None
) -> Choice:
    """Return the named back end, else one that is set, else the first that answers within a few seconds."""
    if backend != AUTO:
        return Choice(backend)
    if scheme := _SCHEMES.get((host or "").partition("://")[0]):
        return Choice(scheme, f"`{host}` is an address of its kind")
    complaints: list[str] = []  # about what is set and cannot be used
    chosen = None if host or port else _choose_by_setting(domain, complaints)
    return chosen or _choose_by_answer(host, port, domain, complaints)


def backend_here(backend: str, host: str | None, port: int | str | None, domain: int | None) -> str:
    """Return the back end that is named or set, asking no robot; empty: it depends on who answers."""
    if backend != AUTO or host or port:
        return "" if backend == AUTO else backend
    choice = _choose_by_setting(domain, [])
    return "" if choice is None else choice.backend


def _choose_by_setting(domain: int | None, complaints: list[str]) -> Choice | None:
    ros2 = os.environ.get("ROS_VERSION") == "2", "ROS 2 is set up in this environment"
    ros1 = bool(os.environ.get("ROS_MASTER_URI")), "`ROS_MASTER_URI` is set"
    dds = bool(os.environ.get("ROS_DOMAIN_ID")), "`ROS_DOMAIN_ID` is set"
    settings = [("rclpy", *ros2), ("rospy", *ros1), ("dds", *dds)]
    if domain is not None:
        named = "a `domain` is named"
        settings = [("rclpy", _is_installed("rclpy"), named), ("dds", True, named)]
    for backend, is_set, reason in settings:
        if is_set:
            if not (lack := _lack(backend)):
                return Choice(backend, "; ".join((reason, *complaints)))
            complaints.append(f"{reason}, but {lack}")
    return None


def _lack(backend: str) -> str:
    """Return what a back end lacks here, or an empty text."""
    if backend == "dds":
        return (
            "" if _is_installed(backend) else f"`{_LIBRARIES[backend]}` is not installed{_INSTALL[backend]}."
        )
    return lacks_library(backend)


def _choose_by_answer(
    host: str | None, port: int | str | None, domain: int | None, complaints: list[str]
) -> Choice:
    failures: dict[str, str] = {}
    missing, kind = [], BridgeError
    for backend in BACKENDS:
        if (host or port) and backend not in _PORTS:
            continue
        if not _is_installed(backend):
            missing.append(f"`{_LIBRARIES[backend]}`{_INSTALL.get(backend, '')}")
            continue
        try:
            transport = make_transport(backend, host, port, lambda _complaint: None, domain)
            failures[backend], kind = transport.silence(), NoAnswerError
        except BridgeError as error:  # half of its packages may be there
            failures[backend] = str(error)
            continue
        if not failures[backend]:
            return Choice(backend, "; ".join((f"`{transport.place}` answers", *complaints)))
    parts = [f"{backend}: {why}" for backend, why in failures.items()]
    if missing:
        parts.append(f"Not asked, because Python cannot import them here: {', '.join(missing)}.")
    told = [complaint[0].upper() + complaint[1:] for complaint in complaints]
    raise kind(f"No ROS robot answers. {' '.join((*told, *parts))}")


def _is_installed(backend: str) -> bool:
    library = _LIBRARIES[backend]
    if library in sys.modules:
        return sys.modules[library] is not None
    return find_spec(library) is not None


def _import_dds() -> Callable[..., Transport]:
    try:
        from lrp_jupyter.bridges.ros.dds import DdsTransport
    except Exception as error:  # cyclonedds has errors of its own for a library that cannot be loaded
        raise BridgeError(
            f'The back end `dds` needs two packages ({error}): `pip install "lrp-jupyter[ros2]"`. They are'
            " there for Python 3.11 to 3.13 on Windows, macOS and Linux on PCs; elsewhere, use the back end"
            " `rclpy` or `rosbridge`."
        ) from error
    return DdsTransport
