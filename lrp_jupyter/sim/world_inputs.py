"""The inputs of a running world: values, so that a run can be recorded and replayed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from lrp_jupyter.sim.world import Point, Pose, World
from lrp_jupyter.sim.world_edits import Draw, WorldEdit


@dataclass(frozen=True, slots=True)
class Latch:
    """Read all sensors and draw the noise of this tick."""


@dataclass(frozen=True, slots=True)
class Drive:
    """Command the speeds of a robot, in m/s and rad/s; they hold until the next command."""

    linear: float = 0.0
    angular: float = 0.0
    robot: int = 0


@dataclass(frozen=True, slots=True)
class Pen:
    """Lower or lift a robot's pen."""

    down: bool = True
    grey: float = 200
    width: float = 0.006
    robot: int = 0


@dataclass(frozen=True, slots=True)
class Lamp:
    """Switch a robot's lamp on or off."""

    on: bool = True
    robot: int = 0


@dataclass(frozen=True, slots=True)
class PlaceRobot:
    """Move a robot by hand to a pose, at rest."""

    pose: Pose
    robot: int = 0


@dataclass(frozen=True, slots=True)
class PlaceSolid:
    """Move a solid by hand to a pose, at rest."""

    pose: Pose
    solid: int


@dataclass(frozen=True, slots=True)
class ResetWorld:
    """Reset the world to its start and erase trails."""


Input = Latch | Drive | Pen | Lamp | PlaceRobot | PlaceSolid | WorldEdit | ResetWorld


def check_input(what: Input, world: World) -> Input:
    """Return an input with its numbers clamped: speeds to the robot's limits, positions to the world.

    Raises ValueError: no such robot or solid, a number that is not finite, or an edit that is not possible.
    """
    match what:
        case Drive(linear, angular, robot):
            spec = world.robots[_index(robot, world.robots, "robot")]
            _finite(linear, angular)
            most, most_turning = spec.limits
            return Drive(_clamp(linear, -most, most), _clamp(angular, -most_turning, most_turning), robot)
        case Pen(down, grey, width, robot):
            _index(robot, world.robots, "robot")
            _finite(grey, width)
            return Pen(down, _clamp(grey, 0.0, 255.0), _clamp(width, 0.001, 0.2), robot)
        case Lamp(_, robot):
            _index(robot, world.robots, "robot")
            return what
        case PlaceRobot(pose, robot):
            _index(robot, world.robots, "robot")
            return PlaceRobot(_inside(pose, world.size), robot)
        case PlaceSolid(pose, solid):
            _index(solid, world.solids, "solid")
            return PlaceSolid(_inside(pose, world.size), solid)
        case Draw(path, width, grey):
            if not path:
                raise ValueError("A stroke needs at least one point.")
            _finite(width, 0 if grey is None else grey, *(number for point in path for number in point))
            points = tuple((_clamp(x, 0.0, world.size[0]), _clamp(y, 0.0, world.size[1])) for x, y in path)
            return Draw(points, _clamp(width, 0.001, 1.0), None if grey is None else _clamp(grey, 0.0, 255.0))
        case WorldEdit():
            what.edited(world)
            return what
        case _:
            return what


def _index(index: int, things: Sequence[object], noun: str) -> int:
    if not 0 <= index < len(things):
        raise ValueError(f"There is no {noun} {index}: the world has {len(things)}.")
    return index


def _inside(pose: Pose, size: Point) -> Pose:
    x, y, angle = pose
    _finite(x, y, angle)
    width, height = size
    return _clamp(x, 0.0, width), _clamp(y, 0.0, height), float(angle)


def _finite(*numbers: float) -> None:
    for number in numbers:
        if not math.isfinite(number):
            raise ValueError(f"Expected a finite number, not {number!r}.")


def _clamp(number: float, low: float, high: float) -> float:
    return float(min(high, max(low, number)))
