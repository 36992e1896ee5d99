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
    """Of the commands of the next tick, only so many are sent.

    `sent`: how many are.
    `blind`: why those that move the robot are not: its data are too old. Empty if it was stopped instead.
    `lost`: why those after them were refused: the robot did not answer. Empty if it did.
    """

    sent: int
    blind: str = ""
    lost: str = ""


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
