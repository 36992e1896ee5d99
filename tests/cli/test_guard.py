"""``lrp guard`` watches the commands of a robot, whatever brings them."""

from __future__ import annotations

import threading
import time

import pytest

from lrp_jupyter.cli import guard
from lrp_jupyter.errors import BridgeError


class Commanded:
    """A robot that is commanded on a topic where everyone hears everything, the guard its own stops, too."""

    def __init__(self, over: threading.Event) -> None:
        self.heard = (0.0, False)
        self.stops = 0
        self.is_away = False
        self._over, self._looks = over, 0

    def drive(self, ago: float = 0.0) -> None:
        self.heard = (time.monotonic() - ago, True)

    def state(self) -> str:
        """Return a sentence; the guard asks for it at each look, and ends after a hundred."""
        self._looks += 1
        if self._looks == 100:
            self._over.set()
        return "The robot is away." if self.is_away else "Connected."

    def stop(self) -> None:
        if self.is_away:
            self.is_away = False  # the next one gets through
            raise BridgeError("The robot is away.")
        self.stops += 1
        self.heard = (time.monotonic(), False)

    def close(self) -> None:
        pass


@pytest.fixture
def over() -> threading.Event:
    return threading.Event()


@pytest.fixture
def robot(over: threading.Event, monkeypatch: pytest.MonkeyPatch) -> Commanded:
    monkeypatch.setattr(guard, "_LOOK", 0.001)
    return Commanded(over)


def test_a_robot_that_joins_late_still_gets_a_stop(robot: Commanded, over: threading.Event) -> None:
    robot.drive(ago=1)
    said: list[str] = []
    guard.watch(robot, 0.5, said.append, over)
    assert robot.stops == 20, "hearing the first one says nothing about the robot"
    assert [text for text in said if "is stopped" in text] == [
        "No command for 0.5 s, and the last one moves the robot. It is stopped."
    ]


def test_a_stop_that_cannot_be_sent_is_tried_again(robot: Commanded, over: threading.Event) -> None:
    robot.drive(ago=1)
    robot.is_away = True
    guard.watch(robot, 0.5, lambda _text: None, over)
    assert robot.stops == 20


def test_a_robot_that_is_commanded_again_is_left_alone(
    robot: Commanded, over: threading.Event, monkeypatch: pytest.MonkeyPatch
) -> None:
    stops: list[None] = []
    monkeypatch.setattr(robot, "stop", lambda: stops.append(robot.drive(ago=-60)))  # its driver is back
    robot.drive(ago=1)
    guard.watch(robot, 0.5, lambda _text: None, over)
    assert len(stops) == 1


def test_a_robot_that_stands_is_never_stopped(robot: Commanded, over: threading.Event) -> None:
    robot.heard = (time.monotonic() - 1, False)
    guard.watch(robot, 0.5, lambda _text: None, over)
    assert robot.stops == 0
