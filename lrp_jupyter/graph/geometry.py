"""Rectangles, and a grid that finds those near a point without testing all of them."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from math import floor
from typing import NamedTuple

Point = tuple[float, float]
Size = tuple[float, float]

CELL = 96.0  # px: width of a cell, about that of a state


class Rect(NamedTuple):
    """A rectangle by its centre, in px; y grows downwards."""

    x: float
    y: float
    width: float
    height: float

    def overlaps(self, other: Rect, gap_x: float = 0.0, gap_y: float = 0.0) -> bool:
        """Return whether two rectangles come nearer than the gaps."""
        return (
            abs(self.x - other.x) * 2 < self.width + other.width + 2 * gap_x
            and abs(self.y - other.y) * 2 < self.height + other.height + 2 * gap_y
        )

    def holds(self, point: Point, margin: float = 0.0) -> bool:
        """Return whether a point is inside, or nearer than `margin`."""
        return (
            abs(point[0] - self.x) < self.width / 2 + margin
            and abs(point[1] - self.y) < self.height / 2 + margin
        )

    def inside(self, point: Point, margin: float) -> Point:
        """Return the point of the rectangle, at least `margin` from its border, nearest to a point."""
        x, y = max(0.0, self.width / 2 - margin), max(0.0, self.height / 2 - margin)
        return max(self.x - x, min(self.x + x, point[0])), max(self.y - y, min(self.y + y, point[1]))

    def crossed_by(self, start: Point, end: Point, margin: float = 0.0) -> bool:
        """Return whether a straight line touches it."""
        low, high = 0.0, 1.0
        for here, there, middle, extent in (
            (start[0], end[0], self.x, self.width / 2 + margin),
            (start[1], end[1], self.y, self.height / 2 + margin),
        ):
            way = there - here
            if way == 0:
                if abs(here - middle) >= extent:
                    return False
                continue
            near, far = sorted(((middle - extent - here) / way, (middle + extent - here) / way))
            low, high = max(low, near), min(high, far)
        return low < high


class Cells:
    """Rectangles by the cells of a square grid; each is registered in every cell that it reaches into.

    px: `size` of a cell; `margin` by which rectangles count as larger on every side.
    """

    def __init__(self, size: float, margin: float = 0.0) -> None:
        self.size = size
        self.margin = margin
        self._rects: dict[tuple[int, int], list[Rect]] = {}

    def add(self, rect: Rect) -> None:
        """Register a rectangle."""
        for cell in self.cells(rect, self.margin):
            self._rects.setdefault(cell, []).append(rect)

    def cells(self, rect: Rect, margin: float = 0.0) -> Iterator[tuple[int, int]]:
        """Return the cells that a rectangle reaches into."""
        size, x, y = self.size, rect.width / 2 + margin, rect.height / 2 + margin
        columns = range(floor((rect.x - x) / size), floor((rect.x + x) / size) + 1)
        rows = range(floor((rect.y - y) / size), floor((rect.y + y) / size) + 1)
        return product(columns, rows)

    def at(self, point: Point) -> list[Rect]:
        """Return the rectangles in the cell of a point."""
        return self._rects.get((floor(point[0] / self.size), floor(point[1] / self.size)), [])

    def near(self, rect: Rect, margin: float = 0.0) -> Iterator[Rect]:
        """Yield the rectangles in the cells of another one; some of them more than once."""
        for cell in self.cells(rect, margin):
            yield from self._rects.get(cell, ())

    def along(self, start: Point, end: Point) -> Iterator[Rect]:
        """Yield the rectangles in the cells that a straight line passes; some of them more than once."""
        size, rects = self.size, self._rects
        if not rects:
            return
        (x, y), (right, last) = sorted((start, end))
        slope = (last - y) / (right - x) if right > x else 0.0
        row = floor(y / size)
        for column in range(floor(x / size), floor(right / size) + 1):
            edge = (column + 1) * size
            until = floor((y + slope * (edge - x) if edge < right else last) / size)
            for passed in range(row, until + 1) if row <= until else range(until, row + 1):
                yield from rects.get((column, passed), ())
            row = until
