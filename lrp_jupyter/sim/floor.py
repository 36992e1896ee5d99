"""The floor as light sensors see it: strokes, queried analytically, point by point.

A stroke is cut into pieces (segments and arcs). Each piece is entered into the cells of a grid
that it can touch, so that a query visits the few pieces of one cell, however long trails have
become. Marks are only ever appended: the floor at an earlier moment is a prefix. The
description has a grid of its own below that of the marks, so that a stroke that is drawn costs little
more than itself, and a copy of a world finds it ready.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

from lrp_jupyter.sim.world import ArcStroke, CircleStroke, FloorSpec, PathStroke, Point, Stroke

SPOT = 0.002  # m: radius of the spot over which a light sensor averages
_CELL = 0.05  # m
_REACH = _CELL * math.sqrt(0.5) + SPOT


@dataclass(frozen=True, slots=True, eq=False)
class Paint:
    """The paint of one stroke.

    Ink only darkens: a light trail does not rub out the line below it. Other paint covers.
    """

    half: float
    grey: float
    ink: bool


@dataclass(frozen=True, slots=True, eq=False)
class Segment:
    """A piece of a line on the floor, in m: its beginning, its vector, and the square of its length."""

    x: float
    y: float
    dx: float
    dy: float
    square: float

    def distance(self, x: float, y: float) -> float:
        """Return the distance of a point, in m."""
        x -= self.x
        y -= self.y
        if self.square == 0.0:
            return math.sqrt(x * x + y * y)
        along = (x * self.dx + y * self.dy) / self.square
        along = 0.0 if along < 0.0 else 1.0 if along > 1.0 else along
        x -= along * self.dx
        y -= along * self.dy
        return math.sqrt(x * x + y * y)

    def ends(self) -> tuple[float, float, float, float]:
        """Return both ends: x, y, x, y."""
        return self.x, self.y, self.x + self.dx, self.y + self.dy

    def bounds(self) -> tuple[float, float, float, float]:
        """Return left, bottom, right and top."""
        right, top = self.x + self.dx, self.y + self.dy
        return min(self.x, right), min(self.y, top), max(self.x, right), max(self.y, top)


@dataclass(frozen=True, slots=True, eq=False)
class _Arc:
    x: float
    y: float
    radius: float
    first: float  # the arc runs counter-clockwise from here …
    sweep: float  # … over this angle, 0 to a full turn

    def distance(self, x: float, y: float) -> float:
        x -= self.x
        y -= self.y
        turned = (math.atan2(y, x) - self.first) % (2 * math.pi)
        if turned <= self.sweep:
            return abs(math.sqrt(x * x + y * y) - self.radius)
        return min(
            math.hypot(x - self.radius * math.cos(end), y - self.radius * math.sin(end))
            for end in (self.first, self.first + self.sweep)
        )

    def bounds(self) -> tuple[float, float, float, float]:
        return self.x - self.radius, self.y - self.radius, self.x + self.radius, self.y + self.radius


_Piece = Segment | _Arc
_Cells = dict[tuple[float, float], list[tuple[Paint, list[_Piece]]]]
Mark = tuple[int, Paint, Segment]  # step, how, what


class LiveFloor:
    """The floor of a running world: its description, and the marks that pens have left on it, oldest first.

    The list of marks that it begins with is kept and appended to.
    """

    def __init__(self, floor: FloorSpec, marks: list[Mark] | None = None) -> None:
        self.marks: list[Mark] = [] if marks is None else marks
        self.raster: tuple[tuple[int, int, int], list[list[bool]]] | None = None  # kept for sketches
        self._strokes: tuple[Stroke, ...] = ()
        self._painted: _Cells = {}
        self._trails: _Cells = {}
        self.paint(floor)
        for _, paint, piece in self.marks:
            _enter(self._trails, paint, piece)

    def paint(self, floor: FloorSpec) -> None:
        """Change the description, below the marks. More strokes than before cost those and a copy."""
        known = len(self._strokes)
        if known and floor.strokes[:known] == self._strokes:
            if more := floor.strokes[known:]:
                self._painted = {
                    cell: [(paint, [*pieces]) for paint, pieces in groups]
                    for cell, groups in self._painted.items()
                }
                _enter_strokes(self._painted, more)
        else:
            self._painted = _cells_of(tuple(floor.strokes))
        self.grey, self._strokes, self.raster = float(floor.grey), floor.strokes, None

    def ink(self, paint: Paint, start: Point, end: Point, step: int) -> None:
        """Draw one piece of a pen's trail."""
        piece = _segment(start, end)
        self.marks.append((step, paint, piece))
        _enter(self._trails, paint, piece)

    def light(self, x: float, y: float) -> float:
        """Return the mean grey of the spot around a point, 0 to 255."""
        grey, cell = self.grey, (x // _CELL, y // _CELL)
        for cells in (self._painted, self._trails):
            for paint, pieces in cells.get(cell, ()):
                nearest = pieces[0].distance(x, y)
                for piece in pieces[1:]:
                    nearest = min(nearest, piece.distance(x, y))
                if nearest < paint.half + SPOT:
                    share = _share((paint.half - nearest) / SPOT) - _share((-paint.half - nearest) / SPOT)
                    if not paint.ink or paint.grey < grey:
                        grey += (paint.grey - grey) * share
        return grey


def distance_to(floor: FloorSpec, x: float, y: float) -> float:
    """Return the distance from a point to the middle of the nearest stroke, in metres, or ``inf``."""
    return min((piece.distance(x, y) for piece in _all_pieces(floor)), default=math.inf)


@lru_cache(maxsize=8)
def _all_pieces(floor: FloorSpec) -> list[_Piece]:
    return [piece for stroke in floor.strokes for piece in _pieces(stroke)]


@lru_cache(maxsize=8)
def _cells_of(strokes: tuple[Stroke, ...]) -> _Cells:
    """Return the cells of strokes; shared by all worlds that begin with them, so none may change it."""
    cells: _Cells = {}
    _enter_strokes(cells, strokes)
    return cells


def _enter_strokes(cells: _Cells, strokes: Iterable[Stroke]) -> None:
    for stroke in strokes:
        paint = Paint(stroke.width / 2, stroke.grey, False)
        for piece in _pieces(stroke):
            _enter(cells, paint, piece)


def _enter(cells: _Cells, paint: Paint, piece: _Piece) -> None:
    """Enter a piece into all cells that it can touch."""
    wide = paint.half + SPOT
    left, bottom, right, top = piece.bounds()
    for column in range(math.floor((left - wide) / _CELL), math.floor((right + wide) / _CELL) + 1):
        for row in range(math.floor((bottom - wide) / _CELL), math.floor((top + wide) / _CELL) + 1):
            if piece.distance((column + 0.5) * _CELL, (row + 0.5) * _CELL) <= paint.half + _REACH:
                groups = cells.setdefault((float(column), float(row)), [])
                if groups and groups[-1][0] is paint:
                    groups[-1][1].append(piece)
                else:
                    groups.append((paint, [piece]))


def _share(depth: float) -> float:
    """Return the share of the spot on this side of an edge, `depth` radii beyond its middle."""
    if depth >= 1.0:
        return 1.0
    if depth <= -1.0:
        return 0.0
    return 0.5 + (depth * math.sqrt(1.0 - depth * depth) + math.asin(depth)) / math.pi


def _segment(start: Point, end: Point) -> Segment:
    dx, dy = end[0] - start[0], end[1] - start[1]
    return Segment(start[0], start[1], dx, dy, dx * dx + dy * dy)


def _pieces(stroke: Stroke) -> list[_Piece]:
    match stroke:
        case PathStroke(path=path):
            ends = path[1:] or path  # a single point is a dot
            return [_segment(start, end) for start, end in zip(path, ends, strict=False)]
        case ArcStroke(arc=(x, y, radius, first, last)):
            return [_Arc(x, y, radius, min(first, last), abs(last - first))]
        case CircleStroke(circle=(x, y, radius)):
            return [_Arc(x, y, radius, 0.0, 2 * math.pi)]
