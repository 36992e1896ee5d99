"""The bridge to a hub with Pybricks: the hub's own program on stand-ins, at the other end of a pipe."""

from __future__ import annotations

import asyncio
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from types import SimpleNamespace
from typing import Any, ClassVar

import pytest
from bridges.own.conftest import EXAMPLES, HERE, does_tasks, drives_and_senses
from support.waiting import until

from lrp_jupyter.bridges.bridge import Bridge
from lrp_jupyter.bridges.conformance import BridgeConformance
from lrp_jupyter.bridges.discovery import make_bridge
from lrp_jupyter.errors import BridgeError

bleak = pytest.importorskip("bleak")

PYBRICKS = str(EXAMPLES / "pybricks.py")
SERVICE = "c5f50001-8280-46da-89f4-6d8051e4aeef"
CHANNEL = "c5f50002-8280-46da-89f4-6d8051e4aeef"
PIECE = 7  # bytes of an event: lines come in pieces


class Hub:
    """A hub and the air between: what bleak's client and scanner are to a program."""

    speed: ClassVar[float] = 1.0
    patience: ClassVar[float] = 1.0
    near: ClassVar[tuple[str, ...]] = ("Pybricks Hub",)
    last: ClassVar[Hub]

    def __init__(self, device: Any) -> None:
        assert device.name in self.near
        self.process: asyncio.subprocess.Process | None = None
        self.is_connected = False
        self.told: list[str] = []
        Hub.last = self

    @classmethod
    async def find_device_by_filter(cls, wanted: Callable[..., bool], timeout: float) -> Any:
        seen = SimpleNamespace(service_uuids=[SERVICE])
        devices = [SimpleNamespace(name=name) for name in cls.near]
        return next((device for device in devices if wanted(device, seen)), None)

    async def connect(self) -> None:
        self.is_connected = True

    async def start_notify(self, channel: str, callback: Callable[[object, bytearray], object]) -> None:
        assert channel == CHANNEL
        self.callback = callback

    async def write_gatt_char(self, channel: str, data: bytes, response: bool) -> None:
        assert channel == CHANNEL
        if data == b"\x01":
            pipes = dict.fromkeys(("stdin", "stdout", "stderr"), asyncio.subprocess.PIPE)
            command = (sys.executable, HERE / "pybricks_robot.py", self.speed, self.patience)
            self.process = await asyncio.create_subprocess_exec(*map(str, command), **pipes)
            self.listening = asyncio.gather(self.listen(), self.note())
        else:
            assert data[:1] == b"\x06"
            assert self.process is not None
            assert self.process.stdin is not None
            self.process.stdin.write(data[1:])

    async def listen(self) -> None:
        assert self.process is not None
        assert self.process.stdout is not None
        while piece := await self.process.stdout.read(PIECE):
            self.callback(None, bytearray(b"\x01" + piece))
        self.is_connected = False

    async def note(self) -> None:
        """Note what the robot is told, as it says it beside."""
        assert self.process is not None
        assert self.process.stderr is not None
        async for line in self.process.stderr:
            self.told.append(line.decode().strip())

    def send_signal(self, number: signal.Signals) -> None:
        assert self.process is not None
        with suppress(ProcessLookupError):
            self.process.send_signal(number)

    async def disconnect(self) -> None:
        self.is_connected = False
        if self.process is not None:
            self.send_signal(signal.SIGKILL)
            await self.process.wait()
            await self.listening
            self.process._transport.close()  # type: ignore[attr-defined]


@pytest.fixture(autouse=True)
def _air(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bleak, "BleakClient", Hub)
    monkeypatch.setattr(bleak, "BleakScanner", Hub)
    monkeypatch.setattr(Hub, "speed", 1.0)
    monkeypatch.setattr(Hub, "near", ("Pybricks Hub",))


@pytest.fixture
def bridge() -> Iterator[Bridge]:
    """Open and armed."""
    bridge = make_bridge(PYBRICKS)
    bridge.open()
    bridge.arm()
    yield bridge
    bridge.close()


@pytest.mark.slow
class TestPybricks(BridgeConformance):
    moves = True

    def make_bridge(self) -> Bridge:
        return make_bridge(PYBRICKS)

    def has_moved(self, bridge: Bridge) -> bool:
        return any(told != "drives 0.000 0.000" for told in Hub.last.told)

    def silence(self) -> None:
        Hub.last.send_signal(signal.SIGSTOP)

    def cut(self) -> None:
        Hub.last.send_signal(signal.SIGKILL)

    def restore(self) -> None:
        Hub.last.send_signal(signal.SIGCONT)


@pytest.mark.slow
def test_a_hub_that_is_switched_off_is_lost_and_found_when_it_is_on_again(bridge):
    def failures() -> int:
        notices = bridge.safety.notices
        return sum(each.count for each in notices if "may not have stopped" in each.text)

    bridge.robot.move(linear=0.2)
    Hub.last.send_signal(signal.SIGKILL)
    until(lambda: "fault" in [notice.kind for notice in bridge.safety.notices], "it was not noticed")
    until(lambda: bridge.status.state != "lost", "it was not found again")
    assert failures() == 1, "the lost one; the one that was found stands by itself"
    bridge.robot.move(linear=0.1)


@pytest.mark.slow
def test_a_program_with_tasks_runs_as_in_the_simulator(monkeypatch):
    monkeypatch.setattr(Hub, "patience", 100.0)  # it is no matter of half a second that nothing comes
    does_tasks(PYBRICKS, lambda: Hub.last.told)


@pytest.mark.slow
def test_the_hub_ends_a_task_when_nothing_more_comes_and_says_so(bridge):
    bridge.robot.turn_by(100)
    until(lambda: "turns by 100.007" in Hub.last.told, "it does not turn")
    until(lambda: Hub.last.told[-1] == "drives 0.000 0.000", "it turns on")

    def has_failed() -> bool:
        bridge.begin_tick(0.0, 0.1)
        bridge.end_tick(0.0)
        return bridge.robot.turn_by.failed

    until(has_failed, "the hub does not say that it has stopped")
    assert bridge.robot.turn_by.reason == "The hub has heard nothing for 0.6 s."


@pytest.mark.slow
def test_a_task_under_way_goes_on_for_as_long_as_there_are_ticks(bridge):
    bridge.robot.turn_by(1.5)

    def is_over() -> bool:
        bridge.begin_tick(0.0, 0.1)
        bridge.end_tick(0.0)
        return not bridge.robot.turn_by.active

    until(is_over, "it does not end")
    assert bridge.robot.turn_by.succeeded


@pytest.mark.slow
def test_it_drives_as_it_is_told_and_the_hub_stops_it_when_nothing_more_comes(bridge):
    drives_and_senses(bridge, lambda: Hub.last.told)
    until(lambda: Hub.last.told[-1:] == ["drives 0.000 0.000"], "it drives on")


def test_where_no_hub_is_near_it_is_said_to_switch_it_on(monkeypatch):
    monkeypatch.setattr(Hub, "near", ())
    with pytest.raises(BridgeError, match=r"No hub `red` with Pybricks is near\. Switch it on\."):
        make_bridge(PYBRICKS, hub="red").open()
