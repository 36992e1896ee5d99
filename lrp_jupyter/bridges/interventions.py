"""What was done to a robot from outside its program: values, so that a run can be recorded and replayed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class RobotStopped:
    """The robot was stopped."""


@dataclass(frozen=True, slots=True)
class CommandsHeld:
    """Only the first commands of the next tick are sent."""

    sent: int  # how many
    blind: str = ""  # why those that move the robot are held back: data are too old; empty if it was stopped
    lost: str = ""  # why later ones are refused: the robot does not answer; empty if it answers


@dataclass(frozen=True, slots=True)
class RobotArmed:
    """The robot was armed, or disarmed."""

    armed: bool


@dataclass(frozen=True, slots=True)
class MembersChanged:
    """The robot has other members from the next tick on: their descriptions, as in a recording."""

    members: tuple[Mapping[str, Any], ...]


@dataclass(frozen=True, slots=True)
class RobotCommanded:
    """A command was given by hand: the method's name, and its arguments as they were after limits."""

    name: str
    arguments: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class WorldLoaded:
    """Another world was loaded; `world` is its JSON form, noise included."""

    world: Mapping[str, Any]
