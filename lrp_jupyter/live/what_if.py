"""What if another program ran from a moment on? Two courses from the same moment, and where they part."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import zip_longest

from lrp_jupyter.live.loop import Loop
from lrp_jupyter.live.timeline import Happening, happenings, present

__all__ = ["Course", "Divergence", "Observation", "Touch", "Waypoint", "WhatIf", "divergence"]

Waypoint = tuple[float, float, float, float]
"""A time in seconds, x and y in metres, and a heading in radians."""

_NAMES = {"edge": "the edge of the world", "robot": "another robot"}
_SAME = 1e-9  # m, rad
_NOW = {"entered": "is entered", "ended": "ends", "command": "is commanded", "restart": "restarts"}
_NO_LONGER = {
    "entered": "is no longer entered",
    "ended": "no longer ends",
    "command": "is no longer commanded",
    "restart": "no longer restarts",
}


@dataclass(frozen=True, slots=True)
class Touch:
    """The robot touched a solid at a time, in seconds."""

    time: float
    solid: str

    @property
    def name(self) -> str:
        """The solid, as a sentence names it."""
        return _NAMES.get(self.solid, f"`{self.solid}`")

    def __str__(self) -> str:
        return f"The robot touches {self.name} at {self.time:.1f} s."


@dataclass(frozen=True, slots=True)
class Course:
    """How a run went.

    Parameters
    ----------
    happenings : tuple of Happening
        With the states that were active when it began.
    way : tuple of (time, x, y, heading)
        The simulated robot after each tick; empty for another robot.
    touch : Touch or None
        The first time that it touched a solid that it did not touch in the beginning.
    """

    happenings: tuple[Happening, ...]
    way: tuple[Waypoint, ...] = ()
    touch: Touch | None = None


@dataclass(frozen=True, slots=True)
class Divergence:
    """The first difference between two courses, in words."""

    tick: int
    time: float
    text: str

    def __str__(self) -> str:
        return f"{self.time:.1f} s: {self.text}"


@dataclass(frozen=True, slots=True)
class WhatIf:
    """What happens from a moment on.

    Parameters
    ----------
    tick : int
        After which tick the courses begin.
    begin, end : float
        Seconds of the run.
    recorded : Course
        How it went, or goes on if nothing is changed.
    changed : Course
        How it goes with the other program.
    divergence : Divergence or None
        The first difference; None if there is none.
    open_loop : bool
        Whether the recorded readings of a real robot were fed, whatever the program commanded.
    """

    tick: int
    begin: float
    end: float
    recorded: Course
    changed: Course
    divergence: Divergence | None
    open_loop: bool

    def __str__(self) -> str:
        if self.divergence is None:
            return f"Nothing is different until {self.end:.1f} s."
        return f"From {self.divergence}"


class Observation:
    """Watches a run, tick by tick.

    Parameters
    ----------
    loop : Loop
        At the moment where the course begins.
    tick : int
        After which tick that is.
    """

    def __init__(self, loop: Loop, tick: int) -> None:
        self._loop = loop
        self._tick = tick
        self._way: list[Waypoint] = []
        self._touch: Touch | None = None
        self._touching = loop.bridge.touched
        self._present = present(loop.interpreter.history.state(tick), tick, loop.now)

    def watch(self) -> bool:
        """Note what a tick has brought; never ends the run."""
        loop = self._loop
        pose = loop.bridge.pose
        if pose is not None:
            self._way.append((loop.now, *pose))
        touched = loop.bridge.touched
        if self._touch is None and (new := touched - self._touching):
            self._touch = Touch(loop.now, min(new))
        self._touching &= touched  # what it has left can be touched again
        return False

    def course(self) -> Course:
        """Return what was watched."""
        told = (*self._present, *happenings(self._loop, self._tick, gap=True))
        return Course(told, tuple(self._way), self._touch)


def divergence(recorded: Course, changed: Course) -> Divergence | None:
    """Return the first difference between two courses from the same moment, or None."""
    first = _first_event(recorded.happenings, changed.happenings)
    for before, after in zip(recorded.way, changed.way, strict=False):
        if first is not None and after[0] >= first.time:
            break
        if any(abs(a - b) > _SAME for a, b in zip(before, after, strict=True)):
            tick = next((each.tick for each in changed.happenings if each.time >= after[0]), 0)
            return Divergence(tick, after[0], "The robot takes another way.")
    return first


_Told = tuple[float, str, tuple[str, ...], tuple[str, ...], str]


def _told(each: Happening) -> _Told:
    """Return what two runs of different programs have in common if they do the same."""
    command = each.text.split("`")[1] if each.kind == "command" else ""  # without its line
    return each.time, each.kind, each.lane, each.state, command


def _first_event(recorded: Iterable[Happening], changed: Iterable[Happening]) -> Divergence | None:
    before = [each for each in recorded if each.kind in _NOW]
    after = [each for each in changed if each.kind in _NOW]
    for old, new in zip_longest(before, after):
        if old is not None and new is not None and _told(old) == _told(new):
            continue
        if new is None or (old is not None and old.tick < new.tick):
            return Divergence(old.tick, old.time, f"{_what(old)} {_NO_LONGER[old.kind]}.")
        if old is None or new.tick < old.tick or (old.kind, old.lane) != (new.kind, new.lane):
            return Divergence(new.tick, new.time, f"{_what(new)} {_NOW[new.kind]}, unlike before.")
        return Divergence(new.tick, new.time, f"{_what(new)} {_NOW[new.kind]} instead of {_what(old)}.")
    return None


def _what(each: Happening) -> str:
    match each.kind:
        case "entered":
            return f"`{each.state[-1]}`"
        case "ended":
            return f"`{each.lane[-1]}`"
        case "command":
            return f"`{each.text.split('`')[1]}`"
    return "The program"
