"""What was done to a robot from outside its program: values, so that a run can be recorded and replayed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

__all__ = ["CommandsHeld", "RobotArmed", "RobotCommanded", "RobotStopped", "WorldLoaded"]


@dataclass(frozen=True, slots=True)
class RobotStopped:
    """The robot was stopped."""


@dataclass(frozen=True, slots=True)
class CommandsHeld:
    """The robot was stopped in the middle of the next tick: of its commands, only so many are sent."""

    sent: int


@dataclass(frozen=True, slots=True)
class RobotArmed:
    """The robot was armed, or disarmed."""

    armed: bool


@dataclass(frozen=True, slots=True)
class RobotCommanded:
    """A command was given by hand: the method's name, and its arguments as they were after limits."""

    name: str
    arguments: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class WorldLoaded:
    """Another world was loaded; `world` is its JSON form, noise included."""

    world: Mapping[str, Any]
