"""ROS 2's wire on the loopback interface, in a domain of each test's own, and two counterparts on it.

One is a stranger: Fast DDS, in C++ (`peer`), compiled once. The other is a robot of our own simulator on
Cyclone DDS, in a process of its own (`dds_robot_node.py`).
"""

from __future__ import annotations

import importlib.util
import json
import os
import shutil
import socket
import sys
from collections.abc import Callable, Iterator
from itertools import count
from pathlib import Path
from typing import Any

import pytest
from bridges.ros.conftest import Compiling
from support.waiting import until

from lrp_jupyter.bridges.ros import RosBridge, link

HERE = Path(__file__).parent
PACKAGES = ("cyclonedds", "rosbags")
PROGRAMS = ("fastddsgen", "g++")
LIBRARIES = ("-lfastrtps", "-lfastcdr")
LIBRARY = Path("/usr/include/fastdds/dds/domain/DomainParticipant.hpp")

MISSING = [name for name in PACKAGES if importlib.util.find_spec(name) is None]
if MISSING and os.environ.get("CI", "").lower() == "true":
    raise RuntimeError(f"The extra `ros2` is missing: {', '.join(MISSING)}")

_numbers = count(1 + os.getpid() % 90)


def refuse(missing: list[str], what: str) -> None:
    """Skip a test on a person's machine, and fail it where everything must be there."""
    if missing:
        reason = f"{what}: {', '.join(missing)}"
        if os.environ.get("CI", "").lower() == "true":
            pytest.fail(reason)
        pytest.skip(reason)


@pytest.fixture(scope="class")
def domain() -> Iterator[int]:
    """A domain that nobody else uses on this machine; nothing leaves the loopback interface."""
    refuse(MISSING, "The extra `ros2` is missing")
    with socket.socket() as held, pytest.MonkeyPatch.context() as patch:
        number = next(n for n in (1 + each % 100 for each in _numbers) if _is_free(n, held))
        for name in ("CYCLONEDDS_URI", "AMENT_PREFIX_PATH", "ROS_DISTRO", "ROS_STATIC_PEERS"):
            patch.delenv(name, raising=False)
        patch.setenv("ROS_LOCALHOST_ONLY", "1")
        patch.setenv("ROS_DOMAIN_ID", str(number))
        yield number


def _is_free(domain: int, held: socket.socket) -> bool:
    """Whether no participant is there, and no other test holds the domain, as this one does then: by TCP."""
    address = "127.0.0.1", 7400 + 250 * domain + 10
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.bind(address)
        held.bind(address)
    except OSError:
        return False
    return True


@pytest.fixture(autouse=True)
def _time_to_be_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """The machine may be loaded, and a peer tells of itself every 3 s."""
    if not MISSING:
        monkeypatch.setattr("lrp_jupyter.bridges.ros.dds._FIND", 20.0)


@pytest.fixture
def make(domain: int, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., RosBridge]]:
    """Make bridges to the domain, which try again soon; they are closed in the end."""
    monkeypatch.setattr(link, "_AGAIN", 0.05)
    bridges = []

    def build(**options: Any) -> RosBridge:
        bridges.append(RosBridge(backend="dds", **options))
        return bridges[-1]

    yield build
    for bridge in bridges:
        bridge.close()


@pytest.fixture
def connect(make: Callable[..., RosBridge]) -> Callable[..., RosBridge]:
    """Open and arm a bridge to the domain."""

    def build(**options: Any) -> RosBridge:
        bridge = make(**options)
        bridge.open()
        bridge.arm()
        return bridge

    return build


# -- a robot of our own -----------------------------------------------------------------------------


@pytest.fixture(scope="class")
def robot(domain: int, processes: Any) -> Callable[..., Any]:
    """Start the simulator behind topics, in another process; it may be silent for as long as its lease."""
    script = str(HERE / "dds_robot_node.py")

    def start(speed: float = 1.0, world: str = "line", lease: float = 10) -> Any:
        processes.end_all()
        return processes.start(sys.executable, script, str(speed), world, str(lease), ready=True)

    return start


# -- a stranger ---------------------------------------------------------------------------------------


@pytest.fixture(scope="session", autouse=True)
def _compiling(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[tuple[Path, Compiling | None]]:
    """Compile the Fast DDS peer from the beginning, as one unit: most of the time goes into the headers."""
    folder, source = tmp_path_factory.mktemp("peer"), HERE / "peer"
    here = (item for item in request.session.items if item.path.parent == HERE)
    names = {name for item in here for name in getattr(item, "fixturenames", ())}
    if "stranger" not in names or any(shutil.which(name) is None for name in PROGRAMS):
        yield folder, None
        return
    included = [part for unit in ("ros2.cxx", "ros2PubSubTypes.cxx") for part in ("-include", unit)]
    generate = ["fastddsgen", "-replace", "-d", str(folder), str(source / "ros2.idl")]
    build = ["g++", "-std=c++17", "-I.", *included, str(source / "peer.cpp"), "-o", "peer", *LIBRARIES]
    with Compiling(folder, generate, build) as compiling:
        yield folder, compiling


@pytest.fixture(scope="session")
def stranger(_compiling: tuple[Path, Compiling | None]) -> Path:
    """Return the Fast DDS peer."""
    missing = [name for name in PROGRAMS if shutil.which(name) is None]
    refuse(missing + [str(LIBRARY)] * (not LIBRARY.exists()), "Fast DDS is not installed")
    folder, compiling = _compiling
    assert compiling is not None
    compiling.wait()
    return folder / "peer"


class Peer:
    """A running peer: what it is told to do, and what it says."""

    def __init__(self, processes: Any, *command: str) -> None:
        self._processes = processes
        self._process = processes.start(*command)
        self._lines = processes.lines(self._process)
        until(lambda: self.said("ready"), what="the peer did not start")

    def do(self, *lines: str) -> None:
        """Have it obey, one line after the other; return when it has."""
        for line in lines:
            before = len(self.said("done"))
            self._process.stdin.write(f"{line}\n")
            self._process.stdin.flush()
            until(lambda before=before: len(self.said("done")) > before, what=f"not obeyed: {line}")

    def said(self, key: str) -> list[dict[str, Any]]:
        """Return what it has said so far, of one kind."""
        lines = [json.loads(line) for line in tuple(self._lines) if line.endswith("}")]
        return [line for line in lines if key in line]

    def got(self, topic: str) -> list[dict[str, Any]]:
        return [line for line in self.said("got") if line["got"] == topic]

    def speeds(self) -> list[float]:
        return [line["linear"][0] for line in self.got("rt/cmd_vel")]

    def kill(self) -> None:
        self._processes.end(self._process)


@pytest.fixture
def peer(domain: int, stranger: Path, processes: Any) -> Callable[..., Peer]:
    """Start a peer; others believe that it is gone when it is silent for as many seconds as its lease."""

    def start(*lines: str, typed: bool = True, lease: int = 10) -> Peer:
        command = (str(stranger), str(domain), str(lease), "typed" if typed else "plain")
        peer = Peer(processes, *command)
        peer.do("writer ros_discovery_info reliable transient_local", *lines)
        return peer

    return start
