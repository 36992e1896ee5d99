"""An emulated brick and a bridge connected to it; what was opened is closed and checked."""

from __future__ import annotations

import importlib.util
import math
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
from bridges.bounded import PatientClock

from lrp_jupyter.bridges.ev3 import EV3Bridge
from lrp_jupyter.bridges.ev3.client import BrickClient
from lrp_jupyter.bridges.ev3.lines import open_tcp


def _load_emulation() -> ModuleType:
    """Import brick.py, which is beside this file and in no package."""
    name = "emulated_ev3_brick"
    if name not in sys.modules:
        spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name("brick.py"))
        assert spec is not None
        assert spec.loader is not None
        sys.modules[name] = module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    return sys.modules[name]


class Hands:
    """A clock that a test moves."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture(scope="session")
def emulation() -> ModuleType:
    return _load_emulation()


@pytest.fixture
def clock() -> Hands:
    return Hands()


@pytest.fixture(autouse=True)
def _nothing_is_left_behind() -> Iterator[None]:
    before = set(threading.enumerate())
    yield
    left = [thread for thread in threading.enumerate() if thread not in before]
    for thread in left:
        thread.join(60)
    assert not [thread for thread in left if thread.is_alive()]


@pytest.fixture(autouse=True)
def patient_clock(_nothing_is_left_behind: None, monkeypatch: pytest.MonkeyPatch) -> Iterator[PatientClock]:
    """The time in which a brick must answer, and a reading grows old: not while this process is held up.

    The thread of the emulated brick is held up with it, and cannot answer.
    """
    clock = PatientClock()
    for name in ("bridge", "client", "finding", "lines", "link", "usb"):
        time_here = SimpleNamespace(monotonic=clock, sleep=time.sleep)
        monkeypatch.setattr(f"lrp_jupyter.bridges.ev3.{name}.time", time_here)
    yield clock
    clock.close()


@pytest.fixture
def make_brick(emulation: ModuleType) -> Iterator[Callable[..., Any]]:
    """Make bricks; at the end each must have understood whatever it was sent."""
    bricks = []

    def make(*args: Any, **options: Any) -> Any:
        bricks.append(emulation.Brick(*args, **options))
        return bricks[-1]

    yield make
    for brick in bricks:
        brick.close()
    for brick in bricks:
        assert brick.violations == [], "the brick did not understand something"


@pytest.fixture
def brick(make_brick: Callable[..., Any], clock: Hands) -> Any:
    """A brick that accepts TCP at once, with its motors in virtual time."""
    brick = make_brick(clock=clock)
    brick.sensors[0].type, brick.sensors[0].values = 16, {0: 0.0, 1: 3.0}
    brick.sensors[1].type, brick.sensors[1].values = 29, {0: 42.0, 1: 7.0, 2: 5.0}
    brick.sensors[2].type, brick.sensors[2].values = 30, {0: 25.5}
    return brick


@pytest.fixture
def client(brick: Any) -> Iterator[BrickClient]:
    client = BrickClient(open_tcp(("127.0.0.1", brick.port)))
    yield client
    client.close()


@pytest.fixture
def free_udp_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@pytest.fixture
def bridge(brick: Any, free_udp_port: int, clock: Hands) -> Iterator[EV3Bridge]:
    """An open, armed bridge to the brick; its slices are in the time of the motors."""
    bridge = EV3Bridge("127.0.0.1", port=brick.port, beacon_port=free_udp_port, patience=0.4)
    bridge.clock = clock  # type: ignore[method-assign]
    bridge.open()
    bridge.arm()
    yield bridge
    bridge.close()


@pytest.fixture
def fresh(bridge: EV3Bridge, until: Callable[..., None]) -> Callable[[], None]:
    """Wait for a reading that was asked for after now."""

    def fresh() -> None:
        for _ in range(2):  # the first one may have been under way
            before = bridge.link.snapshot.time
            until(lambda: bridge.link.snapshot.time > before)  # noqa: B023

    return fresh


@pytest.fixture
def passes(clock: Hands, fresh: Callable[[], None]) -> Callable[[float], None]:
    """Let the brick's time pass in steps of at most 0.3 s, each of which the bridge notices."""

    def passes(seconds: float) -> None:
        fresh()
        steps = math.ceil(seconds / 0.3)
        for _ in range(steps):
            clock.now += seconds / steps
            fresh()

    return passes


@pytest.fixture
def until() -> Callable[..., None]:
    """Wait until something is so; the limit only ends a test that hangs."""

    def until(holds: Callable[[], object], seconds: float = 60.0) -> None:
        deadline = time.monotonic() + seconds
        while not holds():
            assert time.monotonic() < deadline, "it took too long"
            threading.Event().wait(0.002)

    return until
