"""The record of a graded run: a sample for each tick, the events, the faults."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from lrp_jupyter.bridges.safety import Notice
from lrp_jupyter.bridges.sim import SimBridge
from lrp_jupyter.interpreter.events import TraceEvent
from lrp_jupyter.interpreter.frame import matches
from lrp_jupyter.interpreter.interpreter import Interpreter
from lrp_jupyter.interpreter.issues import Issue
from lrp_jupyter.language.program import Path
from lrp_jupyter.sim.world import World

__all__ = ["RunRecord", "Sample"]

_STILL = 0.002  # m; a robot at rest may drift this far in one period


class Sample(NamedTuple):
    """The robot at one tick.

    Parameters
    ----------
    time : float
        Seconds.
    x, y, heading : float
        Metres, metres, radians.
    lights : tuple of int
        0 black … 255 white.
    bumper : bool
    touched : frozenset of str
        Names of the solids touched since the tick before; `edge` is the edge of the world.
    solids : tuple of (x, y, angle)
    active : tuple of paths
    command : tuple of float
        The commanded speeds: m/s, rad/s.
    """

    time: float
    x: float
    y: float
    heading: float
    lights: tuple[int, ...]
    bumper: bool
    touched: frozenset[str]
    solids: tuple[tuple[float, float, float], ...]
    active: tuple[Path, ...]
    command: tuple[float, float]

    def distance(self, other: Sample) -> float:
        """Return the distance between the robot in two samples, in metres."""
        return math.hypot(self.x - other.x, self.y - other.y)

    def moved(self, before: Sample) -> bool:
        """Return whether the robot has moved since another sample."""
        return before.distance(self) > _STILL or abs(before.heading - self.heading) > 0.02


@dataclass
class RunRecord:
    """One run of a program in a world, the input of the criteria.

    Attributes
    ----------
    still_since : float
        The time since which the robot has stood still without trying to move.
    """

    world: World
    samples: list[Sample] = field(default_factory=list)
    events: list[TraceEvent] = field(default_factory=list)
    issues: tuple[Issue, ...] = ()
    notices: tuple[Notice, ...] = ()
    commands: int = 0
    still_since: float = 0.0
    _touches: dict[str, list[Sample]] = field(default_factory=dict)  # by the name of the solid

    def sample(self, bridge: SimBridge, interpreter: Interpreter) -> None:
        """Record the tick that has just ended; must be called on the loop's thread."""
        robot = bridge.simulation.robot
        x, y, heading = robot.pose
        sample = Sample(
            interpreter.now,
            x,
            y,
            heading,
            robot.readings.lights,
            bool(robot.readings.bumper),
            bridge.touched,
            tuple(thing.pose for thing in bridge.simulation.solids),
            interpreter.active,
            robot.command,
        )
        if not self.samples or any(sample.command) or sample.moved(self.samples[-1]):
            self.still_since = sample.time
        self.samples.append(sample)
        for solid in sample.touched:
            self._touches.setdefault(solid, []).append(sample)

    @property
    def seconds(self) -> float:
        """Length of the run, in seconds of its own time."""
        return self.samples[-1].time if self.samples else 0.0

    @property
    def driven(self) -> float:
        """Length of the path driven, in metres."""
        return sum(a.distance(b) for a, b in zip(self.samples, self.samples[1:], strict=False))

    def inside(self, zone: str) -> Iterator[Sample]:
        """Yield the samples at which the middle of the robot was in a zone."""
        region = self.world.zones[zone]
        return (sample for sample in self.samples if region.contains(sample.x, sample.y))

    def touches(self, solid: str) -> Iterator[Sample]:
        """Yield the samples at which a solid was touched."""
        return iter(self._touches.get(solid, ()))

    def entries(self, state: str | Path) -> list[TraceEvent]:
        """Return the events in which a state was entered."""
        return [event for event in self.events if event.kind == "entered" and matches(state, event.path)]

    def count(self, kind: str) -> int:
        """Return the number of events of a kind."""
        return sum(event.kind == kind for event in self.events)
