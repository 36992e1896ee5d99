"""What the guard process does and when, by a clock that its own waiting turns."""

from __future__ import annotations

import os
from collections.abc import Callable
from itertools import pairwise

import pytest

from lrp_jupyter.bridges import guard_process
from lrp_jupyter.errors import BridgeError

LATE = 0.001  # s that a wait takes longer than it was asked to


class Program(guard_process._Watch):
    """A program that sends beats: what happens when. ``d``: it dies; ``e``: it announces its end."""

    def __init__(self, beats: dict[float, str]) -> None:
        self.silence, self.last, self.now = 1.0, 0.0, 0.0
        self.answers: list[float] = []
        self.moves = self.asked = self.ended = self.over = False
        self.wake = self  # type: ignore[assignment]
        self._parent = os.getppid()
        self._beats = dict(sorted(beats.items()))

    def wait(self, seconds: float) -> bool:
        until = self.now + seconds + LATE
        moment = min([until, *list(self._beats)[:1]])
        self.now = max(self.now, moment)
        if beat := self._beats.pop(moment, ""):
            self.moves = self.moves if beat in "de" else beat in "mx"
            self.over, self.ended, self.asked = self.over or beat == "d", beat == "e", beat == "x"
            self.last = self.now
        return bool(beat)

    def clear(self) -> None:
        """There is nothing to clear."""


class Robot:
    """A stopper, with what was done by it: when it was made, and when it stopped the robot."""

    def __init__(self, program: Program, reached: Callable[[float], bool]) -> None:
        self.program, self.reached = program, reached
        self.stops: list[float] = []
        self.tries: list[float] = []
        self.closed = False

    def stop(self) -> None:
        self.tries.append(self.program.now)
        if not self.reached(self.program.now):
            raise BridgeError("It is out of reach.")
        self.stops.append(self.program.now)

    def close(self) -> None:
        self.closed = True


@pytest.fixture
def guarded(monkeypatch: pytest.MonkeyPatch) -> Callable[..., tuple[Robot, list[str]]]:
    """Guard a robot until the program has ended; return it, and what was reported when."""

    def guarded(
        beats: dict[float, str],
        reached: Callable[[float], bool] = lambda _: True,
        connects: Callable[[float], bool] = lambda _: True,
    ) -> tuple[Robot, list[str]]:
        program = Program(beats)
        robot, reports, answers = Robot(program, reached), list[str](), list[str]()

        def report(what: str, sentence: str = "") -> None:
            told = f"{what} {sentence}".rstrip()
            if what in ("ready", "failed"):
                program.answers.append(program.now)
                if told in answers[-1:]:
                    return
                answers.append(told)
            reports.append(f"{program.now:.1f} {told}")

        class Stopper:
            def __init__(self) -> None:
                if not connects(program.now):
                    raise BridgeError("Nobody answers.")
                self.stop, self.close = robot.stop, robot.close

        monkeypatch.setattr(guard_process, "now", lambda: program.now)
        monkeypatch.setattr(guard_process, "_target", lambda _: Stopper)
        guard_process._guard({"arguments": {}}, program, report)
        return robot, reports

    return guarded


def every(seconds: float, end: float, beat: str = "m") -> dict[float, str]:
    return {number * seconds: beat for number in range(1, round(end / seconds) + 1)}


def test_a_robot_is_stopped_a_second_after_the_last_beat_for_a_second(guarded):
    robot, reports = guarded({**every(0.1, 2.0), 10.0: "e"})
    assert robot.stops[0] == pytest.approx(3.0, abs=0.01)
    assert len(robot.stops) == 10, "a single one may be lost"
    assert all(later - sooner == pytest.approx(0.1, abs=0.01) for sooner, later in pairwise(robot.stops))
    assert reports == ["0.0 ready", "3.0 stopped"]
    assert robot.closed


@pytest.mark.parametrize(
    "beats",
    [
        pytest.param(every(0.95, 20.0), id="beats that come in time"),
        pytest.param({**every(0.1, 2.0), 2.1: "s"}, id="a robot that stands"),
        pytest.param({0.1: "s"}, id="a robot that has not moved"),
    ],
)
def test_nothing_else_stops_it(guarded, beats):
    robot, reports = guarded({**beats, 20.5: "e"})
    assert (robot.stops, reports) == ([], ["0.0 ready"])
    assert robot.closed


def test_a_program_that_wakes_up_is_left_to_itself_and_guarded_as_before(guarded):
    robot, reports = guarded({0.1: "m", **{at + 1.35: "m" for at in every(0.1, 1.0)}, 9.0: "e"})
    assert [round(stop, 1) for stop in robot.stops[:5]] == [1.1, 1.2, 1.3, 1.4, 3.4]
    assert reports == ["0.0 ready", "1.1 stopped", "3.4 stopped"]


@pytest.mark.parametrize(("beat", "stops"), [("m", 10), ("s", 0)])
def test_the_death_of_the_program_stops_a_moving_robot_at_once_and_ends_the_guard(guarded, beat, stops):
    robot, _ = guarded({0.1: beat, 0.2: "d"})
    assert len(robot.stops) == stops
    assert all(0.2 <= stop < 1.3 for stop in robot.stops)
    assert robot.closed


def test_the_announced_end_of_the_program_ends_the_guard_without_a_stop(guarded):
    robot, _ = guarded({0.1: "m", 0.2: "e"})
    assert robot.stops == []
    assert robot.closed


def test_a_stop_that_fails_is_tried_again_until_it_succeeds_and_both_are_reported(guarded):
    robot, reports = guarded({0.1: "m", 20.0: "e"}, reached=lambda now: now > 8)
    assert robot.tries[0] == pytest.approx(1.1, abs=0.01)
    assert robot.stops[0] == pytest.approx(8.0, abs=0.3)
    assert len(robot.stops) == 10
    assert [report.partition(" ")[2] for report in reports] == [
        "ready",
        "failed It is out of reach.",
        "stopped",
        "ready",
    ]
    assert reports[1].startswith("6."), "after five seconds"


def test_a_program_that_cannot_stop_its_robot_has_it_stopped_once_and_hears_about_it(guarded):
    robot, reports = guarded({0.1: "m", 0.5: "x", 0.6: "m", 0.7: "s", 5.0: "e"})
    assert robot.stops == [0.5]
    assert reports == ["0.0 ready", "0.5 halted"]
    robot, reports = guarded({0.1: "m", 0.5: "x", 0.7: "s", 5.0: "e"}, reached=lambda _: False)
    assert reports == ["0.0 ready", "0.5 halted It is out of reach."]
    robot, reports = guarded({0.5: "x", 0.7: "s", 9.0: "e"}, connects=lambda now: now > 1)
    assert robot.tries == [], "what was asked of a robot out of reach is not done later"


def test_every_beat_is_answered(guarded):
    robot, _ = guarded({**every(0.1, 2.0), **every(0.5, 8.0, "s"), 8.1: "e"})
    assert robot.program.answers == pytest.approx([0, *sorted({*every(0.1, 2.0), *every(0.5, 8.0)})], abs=0.3)


def test_a_robot_that_cannot_be_reached_is_tried_every_two_seconds_and_stopped_when_it_is_found(guarded):
    asked: list[float] = []

    def connects(now: float) -> bool:
        asked.append(now)
        return now > 5

    robot, reports = guarded({0.1: "m", 20.0: "e"}, connects=connects)
    assert asked == pytest.approx([0, 2, 4, 6], abs=0.3)
    assert [report.partition(" ")[2] for report in reports] == ["failed Nobody answers.", "stopped", "ready"]
    assert robot.stops[0] == pytest.approx(asked[-1])
