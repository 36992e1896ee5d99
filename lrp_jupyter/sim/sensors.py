"""What a robot perceives in one loop: one frozen value, read once and seen by the whole loop."""

from __future__ import annotations

import math
from dataclasses import dataclass
from random import Random
from typing import TYPE_CHECKING, NamedTuple

import pymunk

from lrp_jupyter.sim.floor import LiveFloor
from lrp_jupyter.sim.world import Point, Pose

if TYPE_CHECKING:
    from lrp_jupyter.sim.robot import Robot

__all__ = ["Odometer", "Readings", "light_spots", "sense"]


@dataclass(frozen=True, slots=True)
class Readings:
    """What a robot's sensors say in one loop, as plain ``int`` and ``float``.

    Parameters
    ----------
    lights : tuple of int
        One grey per light sensor, 0 (black) to 255 (white).
    bumper : int
        1 if the bumper was pressed at any moment since the last loop, else 0.
    distances : tuple of float
        Metres from the rim of the robot to the next solid, one per ray; ``inf``: nothing in range.
    gyro : float
        Radians turned since the start, counter-clockwise, not wrapped.
    odom : tuple of float
        x and y (metres) and theta (radians) according to the wheels, from where the robot started.
    """

    lights: tuple[int, ...] = ()
    bumper: int = 0
    distances: tuple[float, ...] = ()
    gyro: float = 0.0
    odom: Pose = (0.0, 0.0, 0.0)


class Odometer(NamedTuple):
    """Adds up the way as the wheels see it: being lifted and put down elsewhere goes unnoticed."""

    seen: Pose  # in the world, at the last loop
    pose: Pose = (0.0, 0.0, 0.0)  # by the wheels

    def lifted(self, here: Pose, there: Pose) -> Odometer:
        """Return the odometer after a move by hand; the way up to `here` still counts."""
        turn = there[2] - here[2]
        dx, dy = _turned(here[0] - self.seen[0], here[1] - self.seen[1], turn)
        return self._replace(seen=(there[0] - dx, there[1] - dy, self.seen[2] + turn))

    def advanced(self, here: Pose, noise: float, random: Random) -> Odometer:
        """Return the odometer after the way since the last loop."""
        x, y, theta = self.pose
        dx, dy = _turned(here[0] - self.seen[0], here[1] - self.seen[1], theta - self.seen[2])
        turn = here[2] - self.seen[2]
        if noise:
            scale = 1.0 + random.gauss(0.0, noise)
            dx, dy, turn = dx * scale, dy * scale, turn * (1.0 + random.gauss(0.0, noise))
        return Odometer(here, (x + dx, y + dy, theta + turn))


def sense(robot: Robot, floor: LiveFloor, space: pymunk.Space, random: Random, bumped: bool) -> Readings:
    """Read all sensors of a robot, drawing the noise that it has, and advance its odometer."""
    noise, pose = robot.spec.noise, robot.pose
    lights = tuple(
        _grey(floor.light(*spot) + _error(random, noise.light))
        for spot in light_spots(pose, robot.spec.light)
    )
    distances = tuple(
        _ray(robot, space, pose, ray) + _error(random, noise.distance) for ray in robot.spec.distance
    )
    gyro = pose[2] - robot.spec.pose[2] + _error(random, noise.gyro)
    odometer = robot.memory.odometer.advanced(pose, noise.odom, random)
    robot.memory.odometer = odometer
    return Readings(lights, int(bumped), tuple(max(0.0, way) for way in distances), gyro, odometer.pose)


def light_spots(pose: Pose, places: tuple[Point, ...]) -> list[Point]:
    """Return where the light sensors of a robot at `pose` look at the floor."""
    x, y, angle = pose
    return [(x + dx, y + dy) for dx, dy in (_turned(*place, angle) for place in places)]


def _ray(robot: Robot, space: pymunk.Space, pose: Pose, ray: Point) -> float:
    x, y, angle = pose
    bearing, reach = ray
    length = robot.spec.radius + reach
    end = (x + math.cos(angle + bearing) * length, y + math.sin(angle + bearing) * length)
    hit = space.segment_query_first((x, y), end, 0.0, robot.sight)
    return math.inf if hit is None else hit.alpha * length - robot.spec.radius


def _grey(grey: float) -> int:
    return min(255, max(0, round(grey)))


def _error(random: Random, deviation: float) -> float:
    return random.gauss(0.0, deviation) if deviation else 0.0


def _turned(x: float, y: float, angle: float) -> Point:
    cos, sin = math.cos(angle), math.sin(angle)
    return cos * x - sin * y, sin * x + cos * y
