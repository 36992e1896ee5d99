"""A real ROS 1 on loopback, a rosbridge server on top of it, and a server of topics in memory.

Debian's packages are used as they are: `rosmaster`, `rostopic` and `topic_tools` as programs of the
system, and the Python modules through a folder of links to just these (the whole of dist-packages
on the path would break other packages).
"""

from __future__ import annotations

import contextlib
import gc
import importlib.util
import itertools
import math
import os
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
import warnings
from collections import Counter
from collections.abc import Callable, Collection, Iterator
from pathlib import Path
from queue import Queue
from typing import Any, Self
from urllib.parse import urlsplit

import pytest
from bridges.ros.rosbridge_server import MemoryGraph, RosbridgeServer
from support.ports import free_port
from support.waiting import no_thread_left, until

from lrp_jupyter.bridges.ros import RosBridge, link, rosapi, rosbridge, websocket
from lrp_jupyter.bridges.ros.definitions import HEADERS, KNOWN

HERE = Path(__file__).parent
_STOPPER = RosBridge.stopper
DEBIAN = Path("/usr/lib/python3/dist-packages")
MODULES = (
    *("rospy", "rosgraph", "rosgraph_msgs", "roslib", "rospkg", "roscpp", "genpy", "genmsg"),
    *("catkin", "catkin_pkg", "pyparsing", "dateutil", "docutils", "six.py", "defusedxml"),
    *("std_msgs", "geometry_msgs", "nav_msgs", "sensor_msgs", "actionlib_msgs"),
    *("actionlib", "move_base_msgs", "std_srvs", "rosservice", "rosmsg", "rosbag"),
    *("tf2_msgs", "tf2_py", "tf2_ros"),
)
_NEEDED = ("rospy", "nav_msgs", "actionlib", "move_base_msgs", "std_srvs", "rosservice", "tf2_ros")
PROGRAMS = (
    *("/usr/bin/rosmaster", "/usr/bin/rostopic", "/usr/bin/rosbag", "/usr/bin/roslaunch"),
    "/usr/lib/topic_tools/relay",
)


# -- topics in memory -----------------------------------------------------------------------------


@pytest.fixture
def graph() -> MemoryGraph:
    graph = MemoryGraph({**KNOWN, **HEADERS[1]})
    graph.types |= {
        "/odom": "nav_msgs/Odometry",
        "/light": "std_msgs/UInt8",
        "/cmd_vel": "geometry_msgs/Twist",
    }
    graph.others |= {"/cmd_vel"}
    graph.publishers |= {"/odom": ["/robot"], "/light": ["/robot"]}
    return graph


@pytest.fixture
def serve(graph: MemoryGraph) -> Iterator[Callable[..., RosbridgeServer]]:
    """Start a server for the topics in memory."""
    servers = []

    def start(port: int = 0, rosapi: bool = True, encryption: Any = None) -> RosbridgeServer:
        servers.append(RosbridgeServer(graph, port, rosapi, encryption))
        return servers[-1]

    yield start
    for server in servers:
        server.close()


@pytest.fixture
def server(serve: Callable[..., RosbridgeServer]) -> RosbridgeServer:
    return serve()


class Wire:
    """A stretch of network between bridge and server that can be held up, cut, or cut in two.

    It may also be slow: `delay` seconds each way.
    """

    def __init__(self, port: int) -> None:
        self.target = port
        self.delay = 0.0
        self._held = threading.Event()
        self._passed, self._limit = 0, math.inf  # bytes of the server
        self._ends: list[tuple[socket.socket, socket.socket]] = []
        self._threads: list[threading.Thread] = []
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._listener.getsockname()[1]
        self._start(self._accept)

    def hold(self) -> None:
        """Nothing passes from now on; nothing is lost either."""
        self._held.set()

    def release(self) -> None:
        self._held.clear()

    def hold_after(self, count: float) -> None:
        """Pass on this many more bytes of the server, then nothing until it may be more."""
        self._limit = (self._passed if self._limit == math.inf else self._limit) + count

    @property
    def is_held(self) -> bool:
        """Whether all has passed that may."""
        return self._passed == self._limit

    def cut(self) -> None:
        """End what is connected now."""
        self._limit = math.inf
        self._held.clear()
        for end in self._sockets():
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        with contextlib.suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        self.cut()
        for thread in self._threads:
            thread.join(60)
        for end in self._sockets():
            end.close()

    def _sockets(self) -> list[socket.socket]:
        return [end for pair in tuple(self._ends) for end in pair]

    def _start(self, work: Callable[..., None], *arguments: Any) -> None:
        self._threads.append(threading.Thread(target=work, args=arguments, name="wire", daemon=True))
        self._threads[-1].start()

    def _accept(self) -> None:
        while True:
            try:
                near, _ = self._listener.accept()
            except OSError:
                return
            try:
                far = socket.create_connection(("127.0.0.1", self.target))
            except OSError:  # no server: behave as if there were none here
                near.close()
                continue
            self._ends.append((near, far))
            self._start(self._pass, near, far, False)
            self._start(self._pass, far, near, True)

    def _pass(self, source: socket.socket, target: socket.socket, from_server: bool) -> None:
        under_way: Queue[tuple[float, bytes]] = Queue()
        self._start(self._deliver, under_way, target, from_server)
        try:
            while data := source.recv(65536):
                under_way.put((time.monotonic() + self.delay, data))
        except OSError:
            pass
        under_way.put((0.0, b""))

    def _deliver(
        self, under_way: Queue[tuple[float, bytes]], target: socket.socket, from_server: bool
    ) -> None:
        tick = threading.Event()
        try:
            while True:
                due, data = under_way.get()
                if not data:
                    break
                tick.wait(max(0.0, due - time.monotonic()))
                while data:
                    left = min(len(data), self._limit - self._passed) if from_server else len(data)
                    if self._held.is_set() or not left:
                        tick.wait(0.005)
                        continue
                    target.sendall(data[: int(left)])
                    data = data[int(left) :]
                    self._passed += int(left) if from_server else 0
        except OSError:
            pass
        for end in [end for pair in self._ends if target in pair for end in pair]:
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)


@pytest.fixture
def wire(server: Any) -> Iterator[Wire]:
    """The way to the server."""
    wire = Wire(server.port)
    yield wire
    wire.close()


@pytest.fixture
def make(server: Any, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., RosBridge]]:
    """Make bridges to the topics in memory, which try again soon; they are closed in the end."""
    monkeypatch.setattr(link, "_AGAIN", 0.05)
    monkeypatch.setattr(rosapi, "_SOON", 0.05)
    monkeypatch.setattr(rosapi, "_RARELY", 0.1)
    monkeypatch.setattr(rosbridge.RosbridgeTransport, "period", 0.05)
    bridges = []

    def build(**options: Any) -> RosBridge:
        bridges.append(
            RosBridge(
                **{
                    "backend": "rosbridge",
                    "host": "127.0.0.1",
                    "port": server.port,
                    "patience": 60.0,
                    **options,
                }
            )
        )
        return bridges[-1]

    yield build
    for bridge in bridges:
        bridge.close()


@pytest.fixture
def ros(make: Callable[..., RosBridge]) -> RosBridge:
    """A bridge to the topics in memory, open and armed."""
    bridge = make()
    bridge.open()
    bridge.arm()
    return bridge


class Clock:
    """The time of the rosbridge client, which passes when a test lets it."""

    def __init__(self) -> None:
        self.now = 1000.0
        self._reads: Counter[threading.Thread] = Counter()

    def monotonic(self) -> float:
        self._reads[threading.current_thread()] += 1
        return self.now

    def was_seen(self) -> None:
        """Wait until each pair of connections has looked at the time again, after whatever had arrived."""
        before = Counter(self._reads)
        sockets = [thread for thread in before if thread.name == "rosbridge"]
        until(lambda: all(self._reads[each] > before[each] + 8 or not each.is_alive() for each in sockets))


@pytest.fixture(autouse=True)
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    """Nothing is late in this process unless a test lets time pass, or sets a limit.

    No guard watches this process, either: it rightly stops a robot whose program is held up for a second, and
    is tested with other programs.
    """
    clock = Clock()
    monkeypatch.setattr(websocket, "time", clock)
    monkeypatch.setattr(rosbridge, "time", clock)
    monkeypatch.setattr(RosBridge, "stopper", lambda _bridge: None)
    for name, seconds in (
        ("rosapi._FIRST", 20.0),
        ("bridge._ANSWER", 20.0),
        ("bridge._ANSWER_ALL", 20.0),
        ("goal_topics._SILENT", 60.0),
        ("goal_topics._AGAIN", 5.0),
        ("rospy._ANSWER", 5.0),
        ("rospy._MEET", 5.0),
    ):
        monkeypatch.setattr(f"lrp_jupyter.bridges.ros.{name}", seconds)
    return clock


@pytest.fixture
def guarded(monkeypatch: pytest.MonkeyPatch) -> None:
    """A guard watches this process after all."""
    monkeypatch.setattr(RosBridge, "stopper", _STOPPER)


@pytest.fixture(autouse=True)
def _no_thread_left() -> Iterator[None]:
    """Rospy's one node, with its threads, belongs to the process."""
    ours = ("ROS", "rosbridge", "lrp", "stop the robot")
    with no_thread_left(lambda thread: thread.name.startswith(ours)):
        yield


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Ignore rospy's warnings: it is for an older Python, and leaves sockets to the garbage collector."""
    for item in items:
        if item.get_closest_marker("ros") is not None:
            for ignored in (
                "ignore::DeprecationWarning:(rospy|rosgraph|roslib|genpy|catkin)",
                "ignore::ResourceWarning",
                "ignore::pytest.PytestUnraisableExceptionWarning",
            ):
                item.add_marker(pytest.mark.filterwarnings(ignored))


# -- a real ROS 1 ---------------------------------------------------------------------------------


class Compiling:
    """A program that is compiled while tests run which do not need it."""

    def __init__(self, folder: Path, *commands: list[str]) -> None:
        self._process = subprocess.Popen(
            " && ".join(map(shlex.join, commands)),
            shell=True,
            cwd=folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.communicate()

    def wait(self) -> None:
        output, _ = self._process.communicate(timeout=300)
        assert self._process.returncode == 0, output


class Processes:
    """Programs that were started, each in a group of its own; all are ended in the end."""

    def __init__(self, environment: dict[str, str], folder: Path) -> None:
        self.environment, self.folder = environment, folder
        self._logs: dict[subprocess.Popen[str], Path] = {}  # of what is running
        self._numbers = itertools.count()
        self._listeners: dict[subprocess.Popen[str], tuple[threading.Thread, list[str]]] = {}

    def start(self, *command: str, ready: bool = False) -> subprocess.Popen[str]:
        path = self.folder / f"{next(self._numbers)}.log"
        with path.open("w") as log:
            process = subprocess.Popen(
                command,
                env=self.environment,
                cwd=self.folder,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=log,
                text=True,
                start_new_session=True,
            )
        self._logs[process] = path
        if ready:
            assert process.stdout is not None
            assert process.stdout.readline().strip() == "ready", self.log(process)
        return process

    def lines(self, process: subprocess.Popen[str]) -> list[str]:
        """What a program prints from the first call on, as it comes."""
        if process in self._listeners:
            return self._listeners[process][1]
        lines: list[str] = []

        def listen() -> None:
            assert process.stdout is not None
            for line in process.stdout:
                lines.append(line.strip())

        self._listeners[process] = threading.Thread(target=listen, name="listen", daemon=True), lines
        self._listeners[process][0].start()
        return lines

    def log(self, process: subprocess.Popen[str]) -> str:
        return self._logs[process].read_text()

    def end(self, process: subprocess.Popen[str]) -> None:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait(10)
        if process in self._listeners:
            self._listeners.pop(process)[0].join(1)  # a child of its own may hold the pipe open
        for stream in (process.stdin, process.stdout):
            if stream is not None:
                stream.close()

    def end_all(self, but: Collection[subprocess.Popen[str]] = ()) -> None:
        for process in reversed([each for each in self._logs if each not in but]):
            self.end(process)
            del self._logs[process]


@pytest.fixture(scope="class")
def processes(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Processes]:
    """Programs around a test, or the tests of a class, with the environment that it has set."""
    running = Processes(dict(os.environ), tmp_path_factory.mktemp("programs"))
    yield running
    running.end_all()


class Ros(Processes):
    """A master, which can be killed and started again, and the programs around it.

    Some are kept from one test to the next, with the master, as long as that is the same one.
    """

    def __init__(self, environment: dict[str, str], folder: Path, master_port: int) -> None:
        super().__init__(environment, folder)
        self.master_port, self.rosbridge_port = master_port, free_port()
        self._kept: dict[tuple[str, ...], subprocess.Popen[str]] = {}
        self._is_shaken = False

    @contextlib.contextmanager
    def around_a_test(self) -> Iterator[Ros]:
        """End what a test starts and does not keep, and have the master forget it."""
        if self._master not in self._kept:
            self.start_master()
        try:
            yield self
        finally:
            if self._is_shaken:
                self._kept.clear()
            self._is_shaken = False
            self._kept = {command: each for command, each in self._kept.items() if each.poll() is None}
            self.end_all(but=self._kept.values())
            if self._kept:
                self._forget_the_dead()
            _collect()

    def keep(self, *command: str) -> subprocess.Popen[str]:
        """Return a program that lasts; start it unless it is there."""
        kept = self._kept.get(command)
        if kept is None or kept.poll() is not None:
            kept = self._kept[command] = self.start(*command, ready=True)
        return kept

    def _forget_the_dead(self) -> None:
        """Unregister the nodes that were killed, as `rosnode cleanup` does."""
        import rosgraph

        master, dead = rosgraph.Master("/tests"), {}
        state = master.getSystemState()
        for node in {node for section in state for _name, nodes in section for node in nodes}:
            address = master.lookupNode(node)
            if not _answers(urlsplit(address).port or 0):
                dead[node] = address
        for section, kind in zip(state, ("Publisher", "Subscriber", "Service"), strict=True):
            for name, nodes in section:
                for node in dead.keys() & nodes:
                    address = master.lookupService(name) if kind == "Service" else dead[node]
                    getattr(rosgraph.Master(node), f"unregister{kind}")(name, address)

    @property
    def _master(self) -> tuple[str, ...]:
        return "/usr/bin/rosmaster", "--core", "-p", str(self.master_port)

    def start_master(self) -> None:
        self._kept[self._master] = self.start(*self._master)
        until(lambda: _answers(self.master_port), "the master did not start")

    def kill_master(self) -> None:
        self._is_shaken = True
        self.end(self._kept[self._master])

    def signal_master(self, number: int) -> None:
        self._is_shaken = True
        os.killpg(self._kept[self._master].pid, number)

    @property
    def _server(self) -> tuple[str, ...]:
        return sys.executable, str(HERE / "rosbridge_server.py"), str(self.rosbridge_port)

    def start_rosbridge(self) -> int:
        self.keep(*self._server)
        return self.rosbridge_port

    def kill_rosbridge(self) -> None:
        self.end(self._kept[self._server])

    def start_robot(self, speed: float = 1.0, world: str = "line") -> subprocess.Popen[str]:
        return self.start(sys.executable, str(HERE / "robot_node.py"), str(speed), world, ready=True)

    def subscribers(self, topic: str) -> list[str]:
        import rosgraph

        _publishers, subscribers, _services = rosgraph.Master("/tests").getSystemState()
        return [node for name, nodes in subscribers if name == topic for node in nodes]


def _answers(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


@pytest.fixture(scope="session")
def ros_home(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[dict[str, str], Path, int]]:
    """Make ROS importable, and return its environment: one port for all masters, as rospy has one."""
    missing = [str(path) for path in map(Path, PROGRAMS) if not path.exists()]
    missing += [name for name in MODULES if not (DEBIAN / name).exists() and name in _NEEDED]
    if sys.version_info[:2] != (3, 11):
        missing.append("Debian's Python 3.11")
    if missing:
        reason = f"ROS is not installed: {', '.join(missing)}"
        if os.environ.get("CI", "").lower() == "true":
            pytest.fail(reason)
        pytest.skip(reason)
    folder = tmp_path_factory.mktemp("ros")
    modules = folder / "modules"
    modules.mkdir()
    for name in MODULES:
        if (DEBIAN / name).exists() and importlib.util.find_spec(name.removesuffix(".py")) is None:
            (modules / name).symlink_to(DEBIAN / name)
    port = free_port()
    settings = {
        "ROS_MASTER_URI": f"http://127.0.0.1:{port}",
        "ROS_HOSTNAME": "127.0.0.1",
        "ROS_HOME": str(folder),
        "ROS_LOG_DIR": str(folder / "log"),
    }
    with pytest.MonkeyPatch.context() as patch:
        for name, value in settings.items():
            patch.setenv(name, value)
        patch.syspath_prepend(str(modules))
        path = os.pathsep.join(filter(None, (str(modules), os.environ.get("PYTHONPATH"))))
        yield {**os.environ, "PYTHONPATH": path, "PYTHONUNBUFFERED": "1"}, folder, port
        rospy = sys.modules.get("rospy")
        if rospy is not None:
            rospy.signal_shutdown("the tests are over")
            for proxy in rospy.core._xmlrpc_cache.values():
                proxy("close")()
            _collect()
    shutil.rmtree(folder, ignore_errors=True)


@pytest.fixture(scope="session")
def programs(ros_home: tuple[dict[str, str], Path, int]) -> Iterator[Ros]:
    environment, folder, port = ros_home
    ros = Ros(environment, folder, port)
    gc.collect()
    gc.freeze()  # the garbage of each test is found without what the others need
    yield ros
    gc.unfreeze()
    ros.end_all()
    _collect()


def _collect() -> None:
    """Collect rospy's garbage here, so that it does not affect other tests."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        gc.collect()


@pytest.fixture
def real(programs: Ros) -> Iterator[Ros]:
    """A real master, and what is started around it."""
    with programs.around_a_test():
        yield programs


@pytest.fixture(scope="class")
def lasting(programs: Ros) -> Iterator[Ros]:
    """A master for all tests of a class; never together with `real`."""
    with programs.around_a_test():
        yield programs


@pytest.fixture(params=["rosbridge", "rospy"])
def backend(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def connect(real: Ros, backend: str) -> Iterator[Callable[..., RosBridge]]:
    """Open and arm a bridge to the real ROS."""
    bridges = []

    def build(**options: Any) -> RosBridge:
        port = real.start_rosbridge() if backend == "rosbridge" else real.master_port
        bridge = RosBridge(backend=backend, host="127.0.0.1", port=port, **options)
        bridges.append(bridge)
        bridge.open()
        bridge.arm()
        return bridge

    yield build
    for bridge in bridges:
        bridge.close()
