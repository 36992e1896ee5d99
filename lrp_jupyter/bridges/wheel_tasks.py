"""The tasks of all robots on two wheels: drive a way, turn, drive to a point, say a text.

One set of names, arguments and limits, so that the same program drives the simulated robot and a brick.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from lrp_jupyter.bridges.interface import Interface
from lrp_jupyter.bridges.tasks import Task
from lrp_jupyter.sim.world_inputs import FARTHEST, ByItself, DriveBy, DriveTo, Say, TurnBy, checked

ERRANDS: Mapping[type, str] = {DriveBy: "drive_by", TurnBy: "turn_by", DriveTo: "drive_to", Say: "say"}
"""What a robot can be asked for, with the names of its tasks."""
TURNS = -4 * math.pi, 4 * math.pi
"""Angles that a robot is probably asked to turn by: up to two turns."""


def add_errands(
    bridge: Interface,
    begin: Callable[[Task, ByItself], object],
    cancel: Callable[[Task], object],
    limits: tuple[float, float],
    robot: int = 0,
    prefix: str = "",
    saying: str = "say a text",
    farthest: float = FARTHEST,
) -> None:
    """Add the tasks of one robot.

    `begin`: starts one, in place of another one that drives.
    `limits`: its greatest speeds, in m/s and rad/s.
    `robot`, `prefix`: its number in its world, and what its members begin with.
    `farthest`: how far it can probably drive, in m.
    """

    def drive_by(task: Task, metres: float, speed: float = 0.2) -> None:
        begin(task, DriveBy(metres, speed, robot, task.number, _corrected(task)))

    def turn_by(task: Task, radians: float, speed: float = 1.0) -> None:
        begin(task, TurnBy(radians, speed, robot, task.number, _corrected(task)))

    def drive_to(task: Task, x: float, y: float, speed: float = 0.2) -> None:
        begin(task, DriveTo(x, y, speed, robot, task.number))

    def say(task: Task, text: object = "") -> None:
        begin(task, Say(str(text), robot, task.number))

    def check_speed(speed: float, **_way: float) -> None:
        checked(DriveBy(0.0, speed), limits)

    def check_text(text: object) -> None:
        checked(Say(str(text)), limits)

    add = partial(bridge.add_task, cancel=cancel, check=check_speed, replaces=True, mover=prefix)
    way, turning = ({"speed": most} for most in limits)
    in_metres = _measured("m", ("metres", "x", "y"), (-farthest, farthest))
    in_radians = _measured("rad", ("radians",), TURNS)
    doc = "drive straight on, in m, backwards if negative; `speed` in m/s"
    add(f"{prefix}drive_by", drive_by, doc=doc, limits={"metres": FARTHEST, **way}, **in_metres)
    doc = "turn on the spot, in rad, to the right if negative; `speed` in rad/s"
    add(f"{prefix}turn_by", turn_by, doc=doc, limits={"radians": FARTHEST, **turning}, **in_radians)
    doc = "turn to a point of `odom` and drive there, in m; `speed` in m/s"
    add(f"{prefix}drive_to", drive_to, doc=doc, limits={"x": FARTHEST, "y": FARTHEST, **way}, **in_metres)
    bridge.add_task(f"{prefix}say", say, cancel, saying, check=check_text, moves=False, replaces=True)


def _measured(unit: str, names: tuple[str, ...], likely: tuple[float, float]) -> dict[str, Any]:
    units = {**dict.fromkeys(names, unit), "speed": f"{unit}/s"}
    return {"likely": dict.fromkeys(names, likely), "units": units}


def _corrected(task: Task) -> int:
    """Return the number of the request that a task replaces while it is under way; 0: of none."""
    return 0 if task.replaced is None else task.replaced.number
