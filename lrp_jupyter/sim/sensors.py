"""The sensors of a robot: read once per tick into one immutable value."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from random import Random
from typing import NamedTuple

import pymunk

from lrp_jupyter.sim.floor import LiveFloor
from lrp_jupyter.sim.world import DIRECTIONS, Point, Pose, RobotSpec

_MIDDLE = 0.005  # m: a light sensor nearer to the axis of the robot than this is neither left nor right


class Readings(NamedTuple):
    """The sensor values of a robot in one tick, as plain ``int`` and ``float``.

    `lights`: one grey per light sensor, 0 (black) to 255 (white).
    `bumper`: 1 if the bumper was pressed at any moment since the last tick, else 0.
    `distances`: metres from the rim of the robot to the next solid, one per ray; ``inf``: nothing in range.
    `gyro`: radians turned since the start, counter-clockwise, not wrapped.
    `odom`: x and y (metres) and theta (radians) according to the wheels, from where the robot started.
    `bumps`: what the bumper did since the last tick, oldest first: True pressed, False released.
    """

    lights: tuple[int, ...] = ()
    bumper: int = 0
    distances: tuple[float, ...] = ()
    gyro: float = 0.0
    odom: Pose = (0.0, 0.0, 0.0)
    bumps: tuple[bool, ...] = ()


class Odometer(NamedTuple):
    """Sums up the distance by the wheels, which do not notice being lifted and moved."""

    seen: Pose  # in the world, at the last tick
    pose: Pose = (0.0, 0.0, 0.0)  # by the wheels

    def lifted(self, here: Pose, there: Pose) -> Odometer:
        """Return the odometer after a move by hand; the way up to `here` still counts."""
        turn = there[2] - here[2]
        dx, dy = _turned(here[0] - self.seen[0], here[1] - self.seen[1], turn)
        return self._replace(seen=(there[0] - dx, there[1] - dy, self.seen[2] + turn))

    def advanced(self, here: Pose, noise: float = 0.0, random: Random | None = None) -> Odometer:
        """Return the odometer after the way since the last tick; noise is drawn from `random`."""
        x, y, theta = self.pose
        dx, dy = _turned(here[0] - self.seen[0], here[1] - self.seen[1], theta - self.seen[2])
        turn = here[2] - self.seen[2]
        if noise and random is not None:
            scale = 1.0 + random.gauss(0.0, noise)
            dx, dy, turn = dx * scale, dy * scale, turn * (1.0 + random.gauss(0.0, noise))
        return Odometer(here, (x + dx, y + dy, theta + turn))


def read_lights(spec: RobotSpec, pose: Pose, floor: LiveFloor, random: Random) -> tuple[int, ...]:
    """Return the grey below each light sensor of a robot at `pose`, 0 to 255."""
    greys = [floor.light(x, y) for x, y in light_spots(pose, spec.light)]
    if deviation := spec.noise.light:
        greys = [grey + random.gauss(0.0, deviation) for grey in greys]
    return tuple([min(255, max(0, round(grey))) for grey in greys])


def read_distances(
    spec: RobotSpec, pose: Pose, space: pymunk.Space, seen: pymunk.ShapeFilter, random: Random
) -> tuple[float, ...]:
    """Return the metres from the rim of a robot at `pose` to what each of its rays hits; ``inf``: nothing."""
    distances = [_cast(spec.radius, pose, ray, space, seen) for ray in spec.distance]
    if deviation := spec.noise.distance:
        distances = [distance + random.gauss(0.0, deviation) for distance in distances]
    return tuple([max(0.0, distance) for distance in distances])


def light_spots(pose: Pose, places: tuple[Point, ...]) -> list[Point]:
    """Return the points of the floor below the light sensors of a robot at `pose`."""
    x, y, angle = pose
    cos, sin = math.cos(angle), math.sin(angle)
    return [(x + (cos * ahead - sin * left), y + (sin * ahead + cos * left)) for ahead, left in places]


def ray_directions(rays: Sequence[Point]) -> dict[str, int]:
    """Return the number of the ray in each of eight directions, ``front`` to ``front_right``.

    A direction is 45° wide. Of several rays in it, the one nearest to its middle has the name.
    """
    eighth = math.pi / 4
    turned = [bearing / eighth for bearing, _ in rays]
    return _nearest((DIRECTIONS[round(turn) % 8], abs(turn - round(turn))) for turn in turned)


def light_directions(places: Sequence[Point]) -> dict[str, int]:
    """Return the number of the light sensor on each side: ``left``, ``right``, ``front``, ``back``.

    Those in the middle are ``front`` or ``back``. Of several on a side, the outermost has the name.
    """
    return _nearest(
        ("left" if left > 0 else "right", -abs(left))
        if abs(left) > _MIDDLE
        else ("back" if ahead < 0 else "front", -abs(ahead))
        for ahead, left in places
    )


def _nearest(named: Iterable[tuple[str, float]]) -> dict[str, int]:
    """Return for each name the index of its smallest number."""
    found: dict[str, tuple[float, int]] = {}
    for index, (name, deviation) in enumerate(named):
        found[name] = min(found.get(name, (math.inf, 0)), (deviation, index))
    return {name: index for name, (_, index) in found.items()}


def _cast(radius: float, pose: Pose, ray: Point, space: pymunk.Space, seen: pymunk.ShapeFilter) -> float:
    x, y, angle = pose
    bearing, reach = ray
    length = radius + reach
    end = (x + math.cos(angle + bearing) * length, y + math.sin(angle + bearing) * length)
    hit = space.segment_query_first((x, y), end, 0.0, seen)
    return math.inf if hit is None else hit.alpha * length - radius


def _turned(x: float, y: float, angle: float) -> Point:
    cos, sin = math.cos(angle), math.sin(angle)
    return cos * x - sin * y, sin * x + cos * y
