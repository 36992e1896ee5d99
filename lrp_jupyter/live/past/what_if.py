"""What if a different program ran from some moment? Two courses from there, and their first difference."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from itertools import zip_longest
from operator import attrgetter

from lrp_jupyter.language.program import Path, path_text
from lrp_jupyter.live.past.timeline import Happening, happenings, lanes_of_shared, present
from lrp_jupyter.live.running.loop import Loop

Waypoint = tuple[float, float, float, float]
"""A time in seconds, x and y in metres, and a heading in radians."""

_NAMES = {"edge": "the edge of the world", "robot": "another robot"}
_SAME = 1e-9  # m, rad
_VERBS = {
    "entered": ("is entered", "is not entered", "is"),
    "ended": ("ends", "does not end", "does"),
    "command": ("is commanded", "is not commanded", "is"),
    "restart": ("restarts", "does not restart", "does"),
}


@dataclass(frozen=True, slots=True)
class Touch:
    """The robot touched a solid at a time, in seconds; `text` is a sentence about it."""

    time: float
    solid: str
    text: str

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True, slots=True)
class Course:
    """The course of a run.

    `happenings`: its happenings, including the states active at the beginning.
    `tick`: the tick after which it began.
    `way`: the poses of a simulated robot after each tick; empty for other robots.
    `touch`: the first contact with a solid that the robot did not touch at the beginning.
    `others`: the poses of other robots in the same world after each tick, by name.
    `solids`: the poses of movable solids at the end, by number.
    """

    happenings: tuple[Happening, ...]
    tick: int
    way: tuple[Waypoint, ...] = ()
    touch: Touch | None = None
    others: Mapping[str, tuple[Waypoint, ...]] = field(default_factory=dict)
    solids: tuple[tuple[int, tuple[float, float, float]], ...] = ()


@dataclass(frozen=True, slots=True)
class Divergence:
    """The first difference between two courses, in words.

    `lane`: the machine in which it is, as spawned; empty if it is in none.
    """

    tick: int
    time: float
    text: str
    lane: Path = field(default=(), compare=False)

    def __str__(self) -> str:
        return f"{self.time:.1f} s: {self.text}"


@dataclass(frozen=True, slots=True)
class WhatIf:
    """A comparison of two courses from the same moment.

    `tick`: the tick after which the courses begin.
    `begin`, `end`: seconds of the run.
    `recorded`: the course with the original program, recorded or continued.
    `changed`: the course with the changed program.
    `divergence`: the first difference; None if there is none.
    `open_loop`: whether the recorded readings of a real robot were fed, whatever the program commanded.
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
            return f"There is no difference up to {self.end:.1f} s, where the comparison ends."
        return f"First difference at {self.divergence}"


class Observation:
    """Watches a run, tick by tick, from its present moment."""

    def __init__(self, loop: Loop) -> None:
        self._loop = loop
        self._tick = tick = loop.interpreter.tick
        self._way: list[Waypoint] = []
        self._others: dict[str, list[Waypoint]] = {}
        self._touch: Touch | None = None
        self._world = loop.bridge.simulated
        self._touching = frozenset[str]() if self._world is None else self._world.touched
        self._present = present(loop.interpreter.history.state(tick), tick, loop.timing.now)

    def watch(self) -> bool:
        """Record the effects of a tick; never ends the run."""
        now, world = self._loop.timing.now, self._world
        if world is None:
            return False
        self._way.append((now, *world.pose))
        for name, place in world.others.items():
            self._others.setdefault(name, []).append((now, *place))
        touched = world.touched
        if self._touch is None and (new := touched - self._touching):
            solid = min(new)
            name = _NAMES.get(solid, f"`{solid}`")
            self._touch = Touch(now, solid, f"The robot touches {name} at {now:.1f} s.")
        self._touching &= touched  # a solid can be touched again after losing contact
        return False

    def course(self) -> Course:
        """Return the observed course."""
        told = (*self._present, *happenings(self._loop, self._tick, gap=True))
        others = {name: tuple(way) for name, way in self._others.items()}
        solids = () if self._world is None else self._world.movable
        return Course(told, self._tick, tuple(self._way), self._touch, others, solids)


def divergence(recorded: Course, changed: Course) -> Divergence | None:
    """Return the first difference between two courses from the same moment, or None."""
    first = first_event(recorded.happenings, changed.happenings)
    for name, way in {"": changed.way, **changed.others}.items():
        other = recorded.others.get(name, ()) if name else recorded.way
        for tick, (before, after) in enumerate(zip(other, way, strict=False), changed.tick + 1):
            if first is not None and after[0] >= first.time:
                break
            if any(abs(a - b) > _SAME for a, b in zip(before, after, strict=True)):
                who = f"`{name}`" if name else "The robot"
                first = Divergence(tick, after[0], f"{who} takes a different path.")
                break
    return first


_told = attrgetter("time", "kind", "lane", "state", "call")
"""The features of a happening that are equal in two programs with the same behaviour."""


def first_event(recorded: Iterable[Happening], changed: Iterable[Happening]) -> Divergence | None:
    """Return the first thing that happened in one of two runs and not in the other, or None."""
    before = [each for each in recorded if each.kind in _VERBS]
    after = [each for each in changed if each.kind in _VERBS]
    shared = lanes_of_shared([*before, *after])

    def what(each: Happening) -> str:
        return _what(each, each.lane in shared)

    for old, new in zip_longest(before, after):
        if old is not None and new is not None and _told(old) == _told(new):
            continue
        if new is None or (old is not None and old.tick < new.tick):
            _, does_not, does = _VERBS[old.kind]
            text = f"{what(old)} {does_not}; in the original run it {does}."
            return Divergence(old.tick, old.time, text, old.lane)
        now, _, does = _VERBS[new.kind]
        text = f"{what(new)} {now}; in the original run it {does} not."
        if old is not None and (new.tick, new.kind, new.lane) == (old.tick, old.kind, old.lane):
            text = f"{what(new)} {now} instead of {what(old)}."
        return Divergence(new.tick, new.time, text, new.lane)
    return None


def _what(each: Happening, is_shared: bool) -> str:
    """Return what a happening is about; of a machine that ran in several places, also where."""
    match each.kind:
        case "entered":
            return f"`{each.state[-1]}` in `{path_text(each.lane)}`" if is_shared else f"`{each.state[-1]}`"
        case "ended":
            return f"`{path_text(each.lane) if is_shared else each.lane[-1]}`"
        case "command":
            return each.call
    return "The program"
