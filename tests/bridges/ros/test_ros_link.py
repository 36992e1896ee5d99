"""The link of a ROS robot with a transport that is in the test's hand."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping
from typing import Any

import pytest
from support.waiting import until

from lrp_jupyter.bridges import link
from lrp_jupyter.bridges.bridge import ConnectionState
from lrp_jupyter.bridges.ros.channel import Channel
from lrp_jupyter.bridges.ros.definitions import KNOWN, Definition
from lrp_jupyter.bridges.ros.kept import LastMessage
from lrp_jupyter.bridges.ros.link import Receive, TopicLink, Transport
from lrp_jupyter.bridges.ros.ros_request import RosRequest
from lrp_jupyter.bridges.ros.setup import Direction, Wire


class Slow(Transport):
    """A robot whose list of topics comes when the test wants it."""

    place = "slow"

    def __init__(self) -> None:
        super().__init__()
        self.asked, self.answer = threading.Event(), threading.Event()
        self.disconnected = 0

    def connect(self) -> None:
        """Nothing to connect."""

    def disconnect(self) -> None:
        self.disconnected += 1

    def topics(self) -> Mapping[str, str]:
        self.asked.set()
        assert self.answer.wait(60)
        return {}

    def define(self, type_: str) -> Mapping[str, Definition]:
        return KNOWN

    def taken(self, topic: str) -> bool:
        return False

    def join(
        self, topic: str, type_: str, direction: Direction, receive: Receive, every: bool = False
    ) -> object:
        return topic

    def announce(self, topic: str, type_: str, keeps: int) -> object:
        return topic

    def hear(self, handle: object, every: bool) -> None:
        """Nothing comes."""

    def leave(self, handle: object) -> None:
        raise RuntimeError("The middleware is gone.")

    def send(self, handle: object, values: Mapping[str, Any], urgent: bool) -> None:
        """Nothing arrives anywhere."""


@pytest.fixture
def slow() -> Slow:
    return Slow()


@pytest.fixture
def reports() -> list[ConnectionState]:
    return []


@pytest.fixture
def searching(slow: Slow, reports: list[ConnectionState]) -> Iterator[TopicLink]:
    """A link that waits for the topics."""

    def report(state: ConnectionState, _sentence: str) -> None:
        reports.append(state)

    channels = (Channel(Wire("odom", "subscription", "/odom", "nav_msgs/Odometry")),)
    found = TopicLink(
        lambda: slow, "slow", lambda: channels, report, lambda _channel: None, lambda _sentence: None
    )
    found.search()
    assert slow.asked.wait(60)
    yield found
    slow.answer.set()
    found.close()


def test_a_link_that_was_closed_reports_nothing_any_more(
    searching: TopicLink, slow: Slow, reports: list[ConnectionState], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(link, "_JOIN", 0.01)
    searching.close()  # it does not wait for the robot
    slow.answer.set()
    assert searching.has_ended(within=60)
    assert reports == []


def test_what_cannot_be_left_keeps_no_connection_open(
    searching: TopicLink, slow: Slow, reports: list[ConnectionState]
) -> None:
    slow.answer.set()
    until(lambda: reports == [ConnectionState.WAITING])
    searching.close()
    assert searching.has_ended(within=60)
    assert slow.disconnected


def test_what_a_topic_keeps_is_no_news_when_it_comes_again_and_other_messages_are(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now = [100.0]
    monkeypatch.setattr("lrp_jupyter.bridges.ros.kept.time.monotonic", lambda: now[0])
    last = LastMessage()
    last.renew()
    assert last.is_news("press")  # nothing had come
    assert last.is_news("press")
    last.renew()
    last.renew()  # before the first copy is there
    assert [last.is_news("press") for _ in range(4)] == [False, False, True, True]
    last.renew()
    assert [last.is_news(text) for text in ("go", "go", "press")] == [True, True, True]
    last.renew()
    now[0] += 1  # it keeps nothing
    assert last.is_news("press")


def test_a_request_that_was_lost_stays_lost_in_the_panel_when_the_robot_tells_of_it_later() -> None:
    request = RosRequest()
    request.tell("active", reason="It drives.")
    request.tell("lost", reason="The line is cut.")
    assert not request.is_over
    request.tell("active")
    request.tell("cancelled")
    assert request.is_over
    assert request.outcome == "lost: The line is cut."
