"""Labels beside arrows: one greedy pass, in the order of the text."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from functools import lru_cache
from itertools import pairwise

from lrp_jupyter.graph.places import Box, Point
from lrp_jupyter.graph.routes import SAMPLES, Route

__all__ = ["place_labels"]

GAP = 5.0
"""Room between a line and its label, in px."""


class _Cells:
    """Boxes and points by the cells of a coarse grid, to look only at what is near."""

    SIZE = 48.0

    def __init__(self) -> None:
        self._boxes: dict[tuple[int, int], list[Box]] = {}
        self._points: dict[tuple[int, int], list[tuple[int, Point]]] = {}

    def _cells(self, box: Box) -> list[tuple[int, int]]:
        size = self.SIZE
        columns = range(
            math.floor((box.x - box.width / 2) / size), math.floor((box.x + box.width / 2) / size) + 1
        )
        rows = range(
            math.floor((box.y - box.height / 2) / size), math.floor((box.y + box.height / 2) / size) + 1
        )
        return [(i, j) for i in columns for j in rows]

    def add_box(self, box: Box) -> None:
        for cell in self._cells(box):
            self._boxes.setdefault(cell, []).append(box)

    def add_point(self, owner: int, point: Point) -> None:
        cell = (math.floor(point[0] / self.SIZE), math.floor(point[1] / self.SIZE))
        self._points.setdefault(cell, []).append((owner, point))

    def cost(self, box: Box, owner: int) -> float:
        """How badly a label would stand here: other boxes count most, then others' lines."""
        total = 0.0
        for cell in self._cells(box):
            for other in self._boxes.get(cell, ()):
                if box.overlaps(other, 2.0, 1.0):
                    total += 1000.0
            for line, point in self._points.get(cell, ()):
                if box.holds(point, 1.0):
                    total += 0.0 if line == owner else 40.0
        return total

    def lines_between(self, box: Box, point: Point, owner: int) -> int:
        """How many points of others' lines are between a label and its own line."""
        left, right = min(box.x, point[0]), max(box.x, point[0])
        top, bottom = min(box.y, point[1]), max(box.y, point[1])
        way = Box((left + right) / 2, (top + bottom) / 2, right - left, bottom - top)
        return sum(
            line != owner and way.holds(other, 2.0)
            for cell in self._cells(way)
            for line, other in self._points.get(cell, ())
        )


def place_labels(
    routes: Sequence[Route], sizes: Sequence[tuple[float, float]], obstacles: Iterable[Box]
) -> list[Box]:
    """Place a label beside each arrow in one greedy pass; a placed one is an obstacle for the next.

    Parameters
    ----------
    routes : sequence of Route
    sizes : sequence of (float, float)
        Width and height of each label, in px.
    obstacles : iterable of Box
        States and other things that no label may cover.
    """
    cells = _Cells()
    for box in obstacles:
        cells.add_box(box)
    for index, route in enumerate(routes):
        for box in route.obstacles:
            cells.add_box(box)
        for one, other in pairwise(route.points):
            steps = max(1, round(math.dist(one, other) / 11.0))
            for step in range(steps):
                part = step / steps
                cells.add_point(
                    index, (one[0] + (other[0] - one[0]) * part, one[1] + (other[1] - one[1]) * part)
                )
    labels = []
    for index, (route, size) in enumerate(zip(routes, sizes, strict=True)):
        best: tuple[float, Box] | None = None
        for price, at, far, side in _seats(route.middle):
            if best is not None and price >= best[0]:
                break
            box = _seat(route, size, at, far, side)
            cost = price + cells.cost(box, index)
            if far:
                cost += 40.0 * cells.lines_between(box, route.points[at], index)
            if side == 0:  # a short arrow must not vanish behind its own label
                cost += 60.0 * sum(box.holds(point) for point in route.points) / SAMPLES
            if best is None or cost < best[0]:
                best = (cost, box)
        assert best is not None
        cells.add_box(best[1])
        labels.append(best[1])
    return labels


@lru_cache(maxsize=32)
def _seats(middle: float) -> list[tuple[float, int, float, int]]:
    """Where a label may stand, cheapest first: price, at which point of the way, how far off, which side.

    Side 1 is the route's own, -1 the other, 0 on the line itself, which the label's halo hides.
    """
    beside = [
        (far + (4.0 if side < 0 else 0.0), far, side) for far in (0.0, 10.0, 24.0, 44.0) for side in (1, -1)
    ]
    return sorted(
        (30.0 * abs(at / SAMPLES - middle) + price, at, far, side)
        for at in range(2, SAMPLES - 1)
        for price, far, side in [(12.0, 0.0, 0), *beside]
    )


def _seat(route: Route, size: tuple[float, float], at: int, far: float, side: int) -> Box:
    x, y = route.points[at]
    if side:
        before, after = route.points[at - 1], route.points[at + 1]
        way = (after[0] - before[0], after[1] - before[1])
        length = (math.hypot(*way) or 1.0) * side * route.side
        right = (-way[1] / length, way[0] / length)
        # the nearest corner of the label just clears the line
        reach = abs(right[0]) * size[0] / 2 + abs(right[1]) * size[1] / 2 + GAP + far
        x, y = x + right[0] * reach, y + right[1] * reach
    return Box(round(x, 1), round(y, 1), *size)
