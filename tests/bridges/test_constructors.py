"""A bridge of one's own is whole, whatever its constructor does."""

from __future__ import annotations

import threading
from dataclasses import dataclass

import pytest

from lrp_jupyter.bridges import ReconnectingBridge
from lrp_jupyter.bridges.bridge import Bridge, ConnectionState
from lrp_jupyter.bridges.interface import Interface, part


class Bare(Bridge, offered=False):
    def open_interface(self) -> None:
        self.sent: list[float] = []
        self.add_method("move", self.move)

    def move(self, linear: float = 0.0) -> None:
        self.sent.append(linear)


class Forgetful(Bare, offered=False):
    def __init__(self, port: int = 7) -> None:
        self.port = port


class TwiceForgetful(Forgetful, offered=False):
    def __init__(self, host: str = "") -> None:
        self.host = host


class Dutiful(Forgetful, offered=False):
    def __init__(self) -> None:
        self.feed("light.data", 3)
        self.arm()
        super().__init__(port=8)


class Slotted(Bare, offered=False):
    __slots__ = ("port",)

    def __init__(self, port: int = 7) -> None:
        self.port = port


@dataclass
class Data(Bare, offered=False):
    port: int = 7


@dataclass(slots=True, eq=False)
class SlottedData(Bare):  # made twice, the second time by `dataclass`
    name = "test-slotted-data"
    port: int = 7


class Reconnecting(ReconnectingBridge, offered=False):
    def __init__(self, port: int = 7) -> None:
        self.port = port
        self.sent: list[float] = []
        self.cut = threading.Event()

    def connect(self) -> None:
        self.add_method("move", lambda linear=0.0: self.sent.append(linear))

    def receive(self) -> None:
        self.cut.wait()

    def disconnect(self) -> None:
        self.cut.set()


FORMS = (Bare, Forgetful, TwiceForgetful, Dutiful, Slotted, Data, SlottedData, Reconnecting)


@pytest.mark.parametrize("form", FORMS)
def test_a_bridge_connects_is_armed_drives_and_stops_whatever_its_constructor_does(form: type) -> None:
    bridge, other = form(), form()
    assert bridge.status.state is ConnectionState.DISCONNECTED
    assert bridge.status.sentence == f"`{form.name}` is not open."
    bridge.open()
    bridge.arm()
    bridge.begin_tick(0.0, 0.1)
    bridge.robot.move(linear=0.2)
    bridge.end_tick(0.0)
    bridge.close()
    assert bridge.sent == [0.2, 0.0]
    assert [command.name for command in bridge.safety.commands] == ["move"]
    assert not other.is_open
    assert not other.safety.commands, "two bridges share nothing"


def test_what_a_constructor_does_before_it_calls_the_one_above_stays() -> None:
    bridge = Dutiful()
    assert (bridge.port, bridge.robot.light.data, bridge.safety.armed) == (8, 3, True)


def test_a_bridge_that_takes_no_options_refuses_them() -> None:
    with pytest.raises(TypeError, match="takes no arguments"):
        Bare(port=7)  # type: ignore[call-arg]


def test_threads_that_use_a_part_first_at_the_same_time_get_the_same_one() -> None:
    both = threading.Barrier(2, timeout=120)

    class Owner:
        def make(self) -> object:
            both.wait()  # both threads have found that there is none
            return object()

        thing = part(make)

    owner, got = Owner(), []
    threads = [threading.Thread(target=lambda: got.append(owner.thing)) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert got == [owner.thing, owner.thing]
    assert isinstance(Interface.safety, part)


def test_a_time_step_that_a_constructor_sets_is_also_the_clock_of_ages() -> None:
    class Paced(Bare, offered=False):
        def __init__(self, step: float) -> None:
            self.time_step = step  # type: ignore[misc]

    paced = Paced(0.02)
    paced.feed("light.data", 7)
    paced.begin_tick(1.5, 0.1)
    assert paced.describe("light.data").age == 1.5
