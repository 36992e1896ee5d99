"""The inputs of a running world: values, so that a run can be recorded and replayed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

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
class DriveBy:
    """Let a robot drive straight on by itself, backwards if negative; `speed` in m/s.

    `number`: identifies it for who asks; so do those of the others.
    `replaces`: the number of one of the same kind that this one corrects: the way counts from where that one
        began, if the robot is still on it.
    """

    metres: float
    speed: float = 0.2
    robot: int = 0
    number: int = 0
    replaces: int = 0


@dataclass(frozen=True, slots=True)
class TurnBy:
    """Let a robot turn on the spot by itself, counter-clockwise; `speed` in rad/s."""

    radians: float
    speed: float = 1.0
    robot: int = 0
    number: int = 0
    replaces: int = 0


@dataclass(frozen=True, slots=True)
class DriveTo:
    """Let a robot turn to a point and drive there by itself.

    `x`, `y`: in the coordinates of its odometer, in metres.
    `speed`: in m/s.
    """

    x: float
    y: float
    speed: float = 0.2
    robot: int = 0
    number: int = 0


@dataclass(frozen=True, slots=True)
class Say:
    """Let a robot say a text, for as long as that takes; an empty one ends what it says."""

    text: str
    robot: int = 0
    number: int = 0


@dataclass(frozen=True, slots=True)
class Cancel:
    """End what a robot does by itself, if it still does that of a number; it stands."""

    number: int
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


ByItself = DriveBy | TurnBy | DriveTo | Say
"""What a robot does for a while, and is asked for once."""

ByProgram = Drive | Pen | Lamp | ByItself | Cancel
"""What a program does, in the middle of a tick."""

Input = Latch | ByProgram | PlaceRobot | PlaceSolid | WorldEdit | ResetWorld

FARTHEST = 1000.0  # m, as worlds are large, or rad
LONGEST_TEXT = 200


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
        case Lamp(_, robot) | Cancel(_, robot):
            _index(robot, world.robots, "robot")
            return what
        case DriveBy() | TurnBy() | DriveTo() | Say():
            return checked(what, world.robots[_index(what.robot, world.robots, "robot")].limits)
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


def checked(what: ByItself, limits: tuple[float, float]) -> ByItself:
    """Return what a robot is to do by itself, with its speed clamped to the robot's limits, in m/s and rad/s.

    Raises ValueError: a number is not finite or too large, a speed is not positive, or a text is too long.
    """
    most, most_turning = limits
    match what:
        case DriveBy(metres, speed):
            return replace(what, metres=_within(metres, "m"), speed=_speed(speed, most))
        case TurnBy(radians, speed):
            return replace(what, radians=_within(radians, "rad"), speed=_speed(speed, most_turning))
        case DriveTo(x, y, speed):
            return replace(what, x=_within(x, "m"), y=_within(y, "m"), speed=_speed(speed, most))
        case Say(text):
            if len(text) > LONGEST_TEXT:
                raise ValueError(f"A text has at most {LONGEST_TEXT} characters, not {len(text)}.")
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


def _within(number: float, unit: str) -> float:
    _finite(number)
    if abs(number) > FARTHEST:
        raise ValueError(f"{number:g} {unit} is too far: the farthest is {FARTHEST:g} {unit}.")
    return float(number)


def _speed(speed: float, most: float) -> float:
    _finite(speed)
    if speed <= 0:
        raise ValueError(f"`speed` must be greater than 0, not {speed:g}: the way says in which direction.")
    return min(float(speed), most)


def _clamp(number: float, low: float, high: float) -> float:
    return float(min(high, max(low, number)))
