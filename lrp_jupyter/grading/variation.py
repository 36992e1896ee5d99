"""How the worlds of a challenge differ from seed to seed, so that no program can know where things are."""

from __future__ import annotations

import math
import random
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TypeVar

from lrp_jupyter.errors import LRPError, did_you_mean
from lrp_jupyter.sim.world import (
    ArcStroke,
    CircleStroke,
    FloorSpec,
    PathStroke,
    Solid,
    Stroke,
    World,
    Zone,
    middle_of,
    put_at,
)

FLOOR, ROBOT = "floor", "robot"
_Shape = TypeVar("_Shape", bound=Solid | Zone)


@dataclass(frozen=True)
class Variation:
    """What differs in a world, by how much at most; see :func:`moves`, :func:`shades`, :func:`wears`.

    Parameters
    ----------
    what : tuple of str
        ``"robot"`` (the first one), ``"floor"``, and names of solids and zones: all move together.
    x, y : float
        Metres.
    degrees : float
        Of the robot's heading, and the angle of solids.
    grey : float
        By how much white gets darker, and black lighter.
    speed, wheels : float
        Of the speed at which both wheels of the robot turn, and of each one's own, as fractions of it.
    """

    what: tuple[str, ...]
    x: float = 0.0
    y: float = 0.0
    degrees: float = 0.0
    grey: float = 0.0
    speed: float = 0.0
    wheels: float = 0.0

    def of(self, world: World, chance: random.Random) -> World:
        """Return a world that differs in this.

        Raises
        ------
        LRPError
            The world has no solid or zone of that name; the message suggests the closest one.
        """
        x, y, angle = (chance.uniform(-most, most) for most in (self.x, self.y, math.radians(self.degrees)))
        white, black = (chance.uniform(0, self.grey) for _ in range(2))
        known = {FLOOR, ROBOT, *(solid.name for solid in world.solids), *world.zones}
        for name in self.what:
            if name not in known:
                raise LRPError(
                    f"The world `{world.name}` has nothing named `{name}`.{did_you_mean(name, known)}"
                )
        robot, *others = world.robots
        if ROBOT in self.what:
            at_x, at_y, heading = robot.pose
            robot = replace(robot, pose=(at_x + x, at_y + y, heading + angle))
        if self.speed or self.wheels:
            both, *each = (1 + chance.uniform(-most, most) for most in (self.speed, self.wheels, self.wheels))
            left, right = (both * own * wheel for own, wheel in zip(each, robot.wheels, strict=True))
            robot = replace(robot, wheels=(left, right))
        floor = world.floor
        if FLOOR in self.what:
            floor = FloorSpec(
                max(0, floor.grey - white),
                tuple(_put(stroke, x, y, min(255, stroke.grey + black)) for stroke in floor.strokes),
            )
        return replace(
            world,
            robots=(robot, *others),
            floor=floor,
            solids=tuple(
                replace(_moved(solid, x, y), angle=solid.angle + angle) if solid.name in self.what else solid
                for solid in world.solids
            ),
            zones={
                name: _moved(zone, x, y) if name in self.what else zone for name, zone in world.zones.items()
            },
        )


def moves(*what: str, x: float = 0.0, y: float = 0.0, degrees: float = 0.0) -> Variation:
    """Let things start elsewhere in each run: at most so far to either side, and turned by so much."""
    return Variation(what, x, y, degrees)


def shades(grey: float) -> Variation:
    """Let the floor be darker in some runs, and its lines lighter: each by at most so many of 255 greys."""
    return Variation((FLOOR,), grey=grey)


def wears(speed: float = 0.0, wheels: float = 0.0) -> Variation:
    """Let the robot be faster or slower than it is told, as with another battery, and its wheels uneven.

    Both are fractions of the speed, at most: of both wheels, and of each one by itself.
    """
    return Variation((), speed=speed, wheels=wheels)


def varied(world: World, variations: Iterable[Variation], seed: int) -> World:
    """Return the world of the run with a seed.

    Raises LRPError: a variation names something that the world does not have.
    """
    chance = random.Random(f"{world.name} {seed}")  # a text: other worlds with the same seed differ in it
    for variation in variations:
        world = variation.of(world, chance)
    return world


def _moved(shape: _Shape, x: float, y: float) -> _Shape:
    at_x, at_y = middle_of(shape)
    return put_at(shape, (at_x + x, at_y + y))


def _put(stroke: Stroke, x: float, y: float, grey: float) -> Stroke:
    match stroke:
        case PathStroke(path=path):
            return replace(stroke, path=tuple((a + x, b + y) for a, b in path), grey=grey)
        case ArcStroke(arc=(a, b, radius, first, last)):
            return replace(stroke, arc=(a + x, b + y, radius, first, last), grey=grey)
        case CircleStroke(circle=(a, b, radius)):
            return replace(stroke, circle=(a + x, b + y, radius), grey=grey)
