"""The description of a world: immutable values with a lossless JSON form.

A world is a *floor* (what the light sensor sees), *solids* (fixed, pushable and moving obstacles),
*robots* and *zones* (named regions that mean nothing to the physics). The floor and the solids are separate
things: a line is not an obstacle and a wall does not cast a shadow. Lengths are metres, angles radians,
counter-clockwise from the x axis, greys 0 (black) to 255 (white).

These values do not change: :class:`~lrp_jupyter.sim.simulation.Simulation` runs a world.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from itertools import pairwise
from typing import Any, TypeVar

VERSION = 1

DIRECTIONS = ("front", "front_left", "left", "back_left", "back", "back_right", "right", "front_right")
"""The names of the directions in which sensors face, every 45° counter-clockwise."""

Point = tuple[float, float]
Pose = tuple[float, float, float]
Json = dict[str, Any]


class WorldError(ValueError):
    """A text, file or object is not a valid world; the message begins with the place of the mistake."""


@dataclass(frozen=True, slots=True)
class PathStroke:
    """A polyline on the floor, with round ends; a single point is a dot.

    Parameters
    ----------
    path : tuple of (x, y)
        At least one point.
    width : float
        Metres.
    grey : float
        0 (black) to 255 (white).
    """

    path: tuple[Point, ...]
    width: float = 0.03
    grey: float = 0


@dataclass(frozen=True, slots=True)
class ArcStroke:
    """An arc on the floor: centre x, centre y, radius, first angle, last angle (radians)."""

    arc: tuple[float, float, float, float, float]
    width: float = 0.03
    grey: float = 0


@dataclass(frozen=True, slots=True)
class CircleStroke:
    """A ring on the floor: centre x, centre y, radius of the middle of the line."""

    circle: tuple[float, float, float]
    width: float = 0.03
    grey: float = 0


Stroke = PathStroke | ArcStroke | CircleStroke


@dataclass(frozen=True, slots=True)
class FloorSpec:
    """The floor as light sensors see it: strokes painted in order on an even grey."""

    grey: float = 255
    strokes: tuple[Stroke, ...] = ()


@dataclass(frozen=True, slots=True)
class Patrol:
    """A path that a solid moves along by itself, at an even speed and without end; nothing can stop it.

    Parameters
    ----------
    path : tuple of (x, y)
        The points that its middle passes through, in metres from where it starts; the start comes first by
        itself.
    speed : float
        m/s.
    closed : bool
        Whether it returns from the last point straight to the start, and so goes round. Otherwise it goes
        back the way it came, to and fro.
    """

    path: tuple[Point, ...]
    speed: float = 0.2
    closed: bool = False

    def points(self, start: Point) -> tuple[Point, ...]:
        """Return the points of the patrol of a solid that starts at a point; a closed one also ends there."""
        points = (start, *((start[0] + x, start[1] + y) for x, y in self.path))
        return (*points, start) if self.closed else points

    def at(self, seconds: float) -> Point:
        """Return where it is after a time, from where it starts."""
        points = self.points((0.0, 0.0))
        if not self.closed:
            points += points[-2::-1]
        legs = list(pairwise(points))
        lengths = [math.dist(*leg) for leg in legs]
        way = self.speed * seconds % sum(lengths)
        for ((x, y), (end_x, end_y)), length in zip(legs, lengths, strict=True):
            if way <= length and length > 0:
                share = way / length
                return x + (end_x - x) * share, y + (end_y - y) * share
            way -= length
        return 0.0, 0.0


@dataclass(frozen=True, slots=True)
class BoxSolid:
    """A solid box: fixed, pushable, or moving by itself.

    Parameters
    ----------
    box : tuple
        Centre x, centre y, length along x, length along y, before turning by `angle`.
    angle : float
        Radians.
    push : float or None
        Coefficient of friction on the floor of a box that can be pushed; ``None``: it cannot.
    patrol : Patrol or None
        How it moves by itself; ``None``: it does not.
    name : str
        Its name for graders and in messages.
    """

    box: tuple[float, float, float, float]
    angle: float = 0
    push: float | None = None
    name: str = ""
    patrol: Patrol | None = None


@dataclass(frozen=True, slots=True)
class DiscSolid:
    """A round solid: centre x, centre y, radius; otherwise like :class:`BoxSolid`."""

    circle: tuple[float, float, float]
    angle: float = 0
    push: float | None = None
    name: str = ""
    patrol: Patrol | None = None


Solid = BoxSolid | DiscSolid


def can_move(solid: Solid) -> bool:
    """Return whether a solid does not always stay where it is: it can be pushed, or moves by itself."""
    return solid.push is not None or solid.patrol is not None


@dataclass(frozen=True, slots=True)
class CircleZone:
    """A round region: centre x, centre y, radius."""

    circle: tuple[float, float, float]

    def contains(self, x: float, y: float) -> bool:
        """Whether the point lies in the region."""
        cx, cy, radius = self.circle
        return (x - cx) ** 2 + (y - cy) ** 2 <= radius**2


@dataclass(frozen=True, slots=True)
class BoxZone:
    """A rectangular region along the axes: centre x, centre y, length along x, length along y."""

    box: tuple[float, float, float, float]

    def contains(self, x: float, y: float) -> bool:
        """Whether the point lies in the region."""
        cx, cy, width, height = self.box
        return abs(x - cx) <= width / 2 and abs(y - cy) <= height / 2


Zone = CircleZone | BoxZone
_Shape = TypeVar("_Shape", bound=Solid | Zone)


def middle_of(shape: Solid | Zone) -> Point:
    """Return the middle of a solid, where it starts, or of a zone."""
    return shape.box[:2] if isinstance(shape, BoxSolid | BoxZone) else shape.circle[:2]


def put_at(shape: _Shape, middle: Point) -> _Shape:
    """Return a solid or a zone with its middle at another place."""
    if isinstance(shape, BoxSolid | BoxZone):
        return replace(shape, box=(*middle, *shape.box[2:]))
    return replace(shape, circle=(*middle, shape.circle[2]))


@dataclass(frozen=True, slots=True)
class Noise:
    """A robot's imperfections, drawn once per tick: standard deviations, and a chance.

    Parameters
    ----------
    motor : float
        Of each wheel's speed, as a fraction of it (0.2 is 20 %).
    light : float
        Grey levels.
    distance : float
        Metres.
    gyro : float
        Radians.
    odom : float
        Of the way driven and the angle turned since the last tick, as a fraction of them; it adds up.
    dropout : float
        Chance (0 to 1) in each tick that the distance sensors fail: for ten ticks, they then see nothing.
    """

    motor: float = 0
    light: float = 0
    distance: float = 0
    gyro: float = 0
    odom: float = 0
    dropout: float = 0


@dataclass(frozen=True, slots=True)
class RobotSpec:
    """A round robot on two wheels.

    Parameters
    ----------
    pose : tuple
        x, y, heading where it starts.
    radius : float
        Of its body.
    light : tuple of (forward, left)
        Positions of the light sensors, from the middle of the robot.
    bumper : bool
        Whether it has a bumper bar in front.
    distance : tuple of (bearing, range)
        Rays from the rim of the body; they see solids up to `range` metres.
    limits : tuple
        Greatest speeds, in m/s and rad/s.
    noise : Noise
        None by default.
    wheels : tuple
        How fast the left and the right wheel turn, as a fraction of what they are told: 0.9 is a weak one.
    name : str
        Its name, by which programs address it if it is not the first one: ``robot.NAME.move(…)``.
    """

    pose: Pose
    radius: float = 0.08
    light: tuple[Point, ...] = ((0.06, 0.0),)
    bumper: bool = True
    distance: tuple[Point, ...] = ((0.0, 2.0),)
    limits: tuple[float, float] = (0.5, 4.0)
    noise: Noise = Noise()
    wheels: tuple[float, float] = (1.0, 1.0)
    name: str = ""


@dataclass(frozen=True, slots=True)
class World:
    """The description of a world. Compares by value; :meth:`to_json` is lossless.

    Parameters
    ----------
    size : tuple
        Length along x and y; the origin is the lower left corner.
    robots : tuple of RobotSpec
        At least one; the first one is the ``robot`` of a program.
    floor : FloorSpec
        White by default.
    solids : tuple of Solid
        Fixed, pushable and moving obstacles.
    zones : mapping of str to Zone
        Named regions, for graders.
    seed : int
        Of all noise in this world.
    open : bool
        Whether one can drive out of it; otherwise its edge is a wall.
    name : str
        Its name in views.
    """

    size: tuple[float, float]
    robots: tuple[RobotSpec, ...]
    floor: FloorSpec = FloorSpec()
    solids: tuple[Solid, ...] = ()
    zones: Mapping[str, Zone] = field(default_factory=dict, hash=False)
    seed: int = 0
    open: bool = False
    name: str = ""

    @property
    def robot_names(self) -> tuple[str, ...]:
        """The names of the robots; those without one are ``robot``, ``robot2`` and so on, by their place."""
        return tuple(
            robot.name or f"robot{number if number > 1 else ''}"
            for number, robot in enumerate(self.robots, start=1)
        )

    def to_dict(self) -> Json:
        """Return plain data, as :func:`~lrp_jupyter.sim.world_reading.read_world` reads it."""
        return {
            "version": VERSION,
            **_plain(self, keep=("size", "seed", "floor", "solids", "robots", "zones")),
        }

    def to_json(self, indent: int | None = None) -> str:
        """Return the world as JSON text (1-2 kB for the bundled ones)."""
        separators = None if indent else (",", ":")
        return json.dumps(self.to_dict(), indent=indent, separators=separators, allow_nan=False)


_ORDER = ("name", "size", "seed", "open", "floor", "solids", "robots", "zones")


def _plain(value: object, keep: tuple[str, ...] = ()) -> Any:
    """Convert dataclasses into dicts without the fields that have their default, except `keep`."""
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    if not hasattr(value, "__dataclass_fields__"):
        return value
    known = fields(value)  # type: ignore[arg-type]
    if isinstance(value, World):
        known = tuple(sorted(known, key=lambda known_field: _ORDER.index(known_field.name)))
    return {
        known_field.name: _plain(getattr(value, known_field.name))
        for known_field in known
        if known_field.name in keep or getattr(value, known_field.name) != known_field.default
    }
