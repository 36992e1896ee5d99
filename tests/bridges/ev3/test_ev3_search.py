"""A bridge searches for its brick on the loopback, on a thread of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from support.waiting import until

from lrp_jupyter.bridges.ev3 import EV3Bridge
from lrp_jupyter.bridges.ev3.link import BrickLink
from lrp_jupyter.errors import BridgeError, NoDataYet

pytestmark = pytest.mark.usefixtures("patient")


@pytest.fixture
def searching(make_brick: Callable[..., Any], free_udp_port: int) -> Iterator[Callable[..., EV3Bridge]]:
    """Make bridges that may not find their brick at once."""
    bridges: list[EV3Bridge] = []

    def make(host: str | None = None, **options: Any) -> EV3Bridge:
        bridges.append(EV3Bridge(host, beacon_port=free_udp_port, **{"patience": 0.05, **options}))
        return bridges[-1]

    yield make
    for bridge in bridges:
        bridge.close()


def test_without_an_address_the_panel_asks_and_the_beacon_answers(searching, make_brick, free_udp_port):
    bridge = searching(patience=12)
    panel = bridge.open()
    assert panel is not None
    assert [question.key for question in panel.questions] == ["host"]
    assert bridge.status.state == "waiting for data"
    with pytest.raises(NoDataYet):
        bridge.robot.sensor1.read()
    with pytest.raises(BridgeError, match="No brick is connected"):
        bridge.robot.motorA._bridge.link.command(b"")
    brick = make_brick(free_udp_port)
    until(lambda: bridge.status.state == "connected")
    assert bridge.robot.name == brick.name


def test_an_answered_address_is_connected_to_without_waiting(searching, make_brick):
    brick = make_brick()
    bridge = searching(port=brick.port, patience=12)
    bridge.open()
    bridge.answer("host", "127.0.0.1")
    until(lambda: bridge.status.state == "connected")
    bridge.answer("host", "127.0.0.1")
    assert brick.connections == 1


def test_an_answer_sends_the_search_that_it_ends_nowhere_else(searching, make_brick, monkeypatch):
    brick = make_brick()
    bridge = searching(port=brick.port)
    with monkeypatch.context() as held:
        held.setattr(BrickLink, "search", lambda link: None)  # its thread has not got to run yet
        bridge.open()
    monkeypatch.setattr(bridge, "stop", bridge.link._turn)  # but does now, before it is ended
    bridge.answer("host", "127.0.0.1")
    until(lambda: bridge.status.state == "connected")
    assert brick.connections == 1


def test_a_search_that_finds_nothing_reports_it_and_continues(searching, make_brick, free_udp_port):
    bridge = searching(patience=0.05)
    bridge.open()
    until(lambda: bridge.status.state == "disconnected")
    assert "No beacon" in bridge.status.sentence
    make_brick(free_udp_port)
    until(lambda: bridge.status.state == "connected")
    assert bridge.robot.battery == 87


def test_a_lost_brick_is_not_replaced_by_another_one(searching, make_brick, free_udp_port):
    first = make_brick(free_udp_port)
    bridge = searching(patience=12)
    bridge.open()
    until(lambda: bridge.status.state == "connected")
    other = make_brick(free_udp_port)
    other.serial = "0016539999999"
    first.unplug()
    first.hang_up()
    until(lambda: bridge.status.state == "lost")
    heard = other.beacons
    until(lambda: other.beacons > heard + 3)
    first.plug_in()
    until(lambda: bridge.status.state == "connected")
    assert (first.connections, other.connections, other.answers) == (2, 0, 0)


def test_closing_ends_a_search(searching):
    bridge = searching(patience=600)
    bridge.open()
    bridge.close()
