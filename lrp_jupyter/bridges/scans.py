"""What a range scanner sees, as a value that is asked for the nearest distance in a sector.

Angles are those of REP 103: 0 straight ahead, positive to the left. What counts as a distance is REP 117's.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from lrp_jupyter.bridges.message import real_number
from lrp_jupyter.errors import BridgeError

_SLACK = 0.01  # degrees by which a ray may lie beside a sector: the angles on a wire are rounded
_FEW = 8  # rays of which each is named


class Scanned:
    """A scan with the fields of ``sensor_msgs/LaserScan``; the base of the values that are one."""

    __slots__ = ()
    QUESTIONS = ("nearest",)

    def nearest(self, right: float = -180, left: float = 180) -> float:
        """Return the nearest distance (m) in a sector, from right to left in degrees; inf: none in reach."""
        right, left = real_number(right, "nearest(right)"), real_number(left, "nearest(left)")
        if right > left:
            raise BridgeError(
                f"A sector begins at the right and goes to the left: write `nearest({left:g}, {right:g})` for"
                f" what lies between them, or `nearest({right:g}, {left + 360:g})` for all the rest."
            )
        scan: Any = self
        angles = self._angles()
        inside = _inside(angles, right, left)
        if not inside:
            raise BridgeError(f"No ray of the scan lies between {right:g}° and {left:g}°: {_sight(angles)}.")
        low, high = self._reach()
        found = math.inf
        for number in inside:
            distance = scan.ranges[number]
            if distance == -math.inf:  # something is too near to be measured
                return low
            if low <= distance <= high and distance < found:
                found = distance
        return found

    def _angles(self) -> tuple[float, ...]:
        """Return the angle of each ray, in degrees."""
        scan: Any = self
        return _even(scan.angle_min, scan.angle_increment, len(scan.ranges))

    def _reach(self) -> tuple[float, float]:
        """Return the smallest and the greatest distance that can be measured."""
        scan: Any = self
        return scan.range_min, scan.range_max or math.inf  # 0: it was not set


@dataclass(frozen=True, slots=True)
class RayScan(Scanned):
    """A scan by single rays: the angle of each, in radians, and the distance along it."""

    angles: tuple[float, ...]
    ranges: tuple[float, ...]

    def _angles(self) -> tuple[float, ...]:
        return _in_degrees(self.angles)

    def _reach(self) -> tuple[float, float]:
        return 0.0, math.inf


@lru_cache(maxsize=32)
def _even(first: float, step: float, count: int) -> tuple[float, ...]:
    return tuple(math.degrees(first + number * step) for number in range(count))


@lru_cache(maxsize=32)
def _in_degrees(angles: tuple[float, ...]) -> tuple[float, ...]:
    return tuple(map(math.degrees, angles))


@lru_cache(maxsize=64)
def _inside(angles: tuple[float, ...], right: float, left: float) -> tuple[int, ...]:
    """Return the numbers of the rays in a sector; a whole turn more or less is the same angle."""
    width = left - right + 2 * _SLACK
    return tuple(number for number, angle in enumerate(angles) if (angle - right + _SLACK) % 360 <= width)


def _sight(angles: tuple[float, ...]) -> str:
    if not angles:
        return "it is empty"
    if len(angles) <= _FEW:
        rays = ", ".join(f"{angle:.4g}°" for angle in sorted(angles))
        return f"there is only one, at {rays}" if len(angles) == 1 else f"they are at {rays}"
    low, high = min(angles), max(angles)
    return f"there are {len(angles)}, from {low:.4g}° to {high:.4g}°"
