"""An emulated brick, and a bridge that is connected to it by a wire: without threads, in the test's time.

What needs the loopback makes a brick that serves it, by `make_brick`.
"""

from __future__ import annotations

import math
import socket
from collections.abc import Callable, Iterator
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
from bridges.ev3 import brick as bricks
from bridges.ev3.brick import Brick, Hands
from support.ports import free_port
from support.waiting import no_thread_left

from lrp_jupyter.bridges.ev3 import EV3Bridge
from lrp_jupyter.bridges.ev3.client import BrickClient
from lrp_jupyter.bridges.ev3.link import BrickLink
from lrp_jupyter.bridges.link import Stage
from lrp_jupyter.errors import BridgeError

MODULES = ("bridge", "client", "finding", "lines", "link", "usb")


@pytest.fixture(scope="session")
def emulation() -> ModuleType:
    return bricks


@pytest.fixture
def clock() -> Hands:
    """The time of the motors, and of the slices in which they turn on."""
    return Hands()


@pytest.fixture
def air() -> Hands:
    """The time in which a brick that is reached by a wire must answer, and in which a reading grows old."""
    return Hands()


@pytest.fixture(autouse=True)
def _nothing_is_left_behind() -> Iterator[None]:
    with no_thread_left():
        yield


@pytest.fixture
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have a brick on the loopback that the machine holds up be waited for."""
    monkeypatch.setattr(BrickClient.request, "__defaults__", (60.0,))
    monkeypatch.setattr(BrickClient.command, "__defaults__", (60.0,))
    monkeypatch.setattr("lrp_jupyter.bridges.ev3.lines._OPEN_TIME", 60.0)
    monkeypatch.setattr(EV3Bridge, "stop_timeout", 60.0)


@pytest.fixture
def make_brick() -> Iterator[Callable[..., Brick]]:
    """Make bricks; at the end each must have understood whatever it was sent."""
    made = []

    def make(*args: Any, **options: Any) -> Brick:
        made.append(Brick(*args, **options))
        return made[-1]

    yield make
    for brick in made:
        brick.close()
    for brick in made:
        assert brick.violations == [], "the brick did not understand something"


def equip(brick: Brick) -> Brick:
    """Plug in sensors."""
    brick.sensors[0].type, brick.sensors[0].values = 16, {0: 0.0, 1: 3.0}
    brick.sensors[1].type, brick.sensors[1].values = 29, {0: 42.0, 1: 7.0, 2: 5.0}
    brick.sensors[2].type, brick.sensors[2].values = 30, {0: 25.5}
    return brick


@pytest.fixture
def brick(make_brick: Callable[..., Brick], clock: Hands) -> Brick:
    return equip(make_brick(clock=clock, serves=False))


@pytest.fixture
def client(brick: Brick, wired: None, air: Hands) -> Iterator[BrickClient]:
    client = BrickClient(brick.wire(air))
    yield client
    client.close()


@pytest.fixture
def free_udp_port() -> int:
    return free_port(socket.SOCK_DGRAM)


@pytest.fixture
def wired(brick: Brick, air: Hands, monkeypatch: pytest.MonkeyPatch) -> None:
    """Have the brick found at the end of a wire, and read in turns that a test makes."""

    def connect(*_: object, **_options: object) -> BrickClient:
        if not brick.plugged:
            raise BridgeError("No EV3 brick was found. It refused.")
        return BrickClient(brick.wire(air))

    for name in MODULES:
        monkeypatch.setattr(f"lrp_jupyter.bridges.ev3.{name}.time", SimpleNamespace(monotonic=air))
    monkeypatch.setattr("lrp_jupyter.bridges.ev3.bridge.connect", connect)
    monkeypatch.setattr(BrickLink, "_run", lambda link: link._turn() if link._stage is Stage.OPENING else 0)
    monkeypatch.setattr(EV3Bridge, "stop_timeout", None)


@pytest.fixture
def make_bridge(wired: None, clock: Hands) -> Iterator[Callable[..., EV3Bridge]]:
    """Make a bridge; its slices are in the time of the motors."""
    made: list[EV3Bridge] = []

    def make(host: str | None = "127.0.0.1", **options: Any) -> EV3Bridge:
        made.append(EV3Bridge(host, **options))
        made[-1].clock = clock  # type: ignore[method-assign]
        return made[-1]

    yield make
    for bridge in made:
        bridge.close()


@pytest.fixture
def bridge(make_bridge: Callable[..., EV3Bridge]) -> EV3Bridge:
    """An open, armed bridge to the brick."""
    bridge = make_bridge()
    bridge.open()
    bridge.arm()
    return bridge


@pytest.fixture
def fresh(bridge: EV3Bridge) -> Callable[[], None]:
    """Read the brick."""
    return lambda: (bridge.link._turn(), None)[1]


@pytest.fixture
def passes(clock: Hands, fresh: Callable[[], None]) -> Callable[[float], None]:
    """Let the brick's time pass in steps of at most 0.3 s, each of which the bridge notices."""

    def passes(seconds: float) -> None:
        steps = math.ceil(seconds / 0.3)
        for _ in range(steps):
            clock.now += seconds / steps
            fresh()

    return passes


@pytest.fixture
def until(bridge: EV3Bridge) -> Callable[[Callable[[], object]], None]:
    """Read the brick until something is so."""

    def until(holds: Callable[[], object]) -> None:
        for _ in range(100):
            if holds():
                return
            bridge.link._turn()
        raise AssertionError("it did not happen")

    return until
