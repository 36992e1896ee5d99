"""``lrp guard`` watches the commands of a robot, whatever brings them; by a clock that its looking turns."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import pytest

from lrp_jupyter.cli import guard_command as guard
from lrp_jupyter.errors import BridgeError


class Commanded:
    """A robot that is commanded on a topic where everyone hears everything, the guard its own stops, too."""

    what, why, times = guard.MqttSide.what, guard.MqttSide.why, guard.MqttSide.times

    def __init__(self) -> None:
        self.now, self.heard = 100.0, (0.0, False)
        self.stops: list[float] = []
        self.said: list[str] = []
        self.is_away = False
        self.commands: list[float] = []

    def state(self) -> str:
        return "The robot is away." if self.is_away else "Connected."

    def stop(self) -> None:
        if self.is_away:
            self.is_away = False  # the next one gets through
            raise BridgeError("The robot is away.")
        self.stops.append(self.now)
        self.heard = (self.now, False)

    def close(self) -> None:
        pass

    def wait(self, seconds: float) -> bool:
        """Let the guard look again; commands come meanwhile."""
        self.now += seconds
        if self.commands and self.commands[0] <= self.now:
            self.heard = (self.commands.pop(0), True)
        return self.now > 110

    def is_guarded(self, *commands: float, say: Callable[[str], object] | None = None) -> None:
        """Be commanded to drive at these seconds, and guarded for ten."""
        self.commands = [self.now + at for at in commands]
        guard.watch(self, 0.5, say or self.said.append, self)  # type: ignore[arg-type]


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch) -> Commanded:
    robot = Commanded()
    monkeypatch.setattr(guard, "time", SimpleNamespace(monotonic=lambda: robot.now))
    return robot


def test_a_robot_is_stopped_half_a_second_after_the_last_command_and_may_join_late(robot: Commanded) -> None:
    robot.is_guarded(0.1, 0.5, 0.9)
    assert robot.stops[0] == pytest.approx(101.4, abs=0.06)
    assert len(robot.stops) == 100, "hearing the first one says nothing about the robot"
    assert robot.said == [
        "Connected.",
        "No command for 0.5 s, and the last one moved the robot. It was stopped.",
    ]


def test_a_robot_that_is_commanded_in_time_is_left_alone(robot: Commanded) -> None:
    robot.is_guarded(*(0.4 * number for number in range(26)))
    assert robot.stops == []


def test_a_stop_that_cannot_be_sent_is_tried_again(robot: Commanded) -> None:
    robot.is_away = True
    told = lambda sentence: robot.said.append(f"{len(robot.stops)} stops: {sentence}")  # noqa: E731
    robot.is_guarded(0.1, say=told)
    assert len(robot.stops) == 100
    assert robot.said[-1].startswith("1 stops: No command"), "nothing is said before it is true"


def test_a_driver_that_is_back_ends_the_stops(robot: Commanded) -> None:
    robot.is_guarded(0.1, *(0.8 + 0.4 * number for number in range(26)))
    assert robot.stops
    assert robot.stops[-1] < 100.9


def test_a_robot_that_stands_is_never_stopped(robot: Commanded) -> None:
    robot.heard = (robot.now - 1, False)
    robot.is_guarded()
    assert robot.stops == []
