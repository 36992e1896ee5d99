"""The paths of arrows: quadratic arcs from border to border, and loops on top.

Edges are routed again each time; only states keep their positions.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from lrp_jupyter.graph.geometry import CELL, Cells, Point, Rect

Pair = tuple[str, str]
Chord = tuple[Point, Point]

OPPOSITE, PARALLEL = 22.0, 26.0  # px: distance between the middles of opposite and of parallel arrows
TIP = 9.0  # px: length of an arrow's head
CLEAR = 7.0  # px: distance of an arrow from states that it passes
DETOURS = (0.0, 28.0, -28.0, 52.0, -52.0, 84.0, -84.0, 124.0, -124.0, 176.0, -176.0, 240.0, -240.0)
PORT = 5.5  # px: distance of an arrow's end from the middle of a port
SAMPLES = 16
STEP = 36.0  # px, at most, between the points at which an arrow is tested: no state fits between two


@dataclass
class Route:
    """The path of one arrow; `d`, `head` and `mark` are SVG path data."""

    d: str  # of the shaft
    head: str
    points: list[Point]  # along the shaft, evenly by parameter, from source to target
    side: int = 1  # better for its label: 1 is the right hand (of a walker, y grows downwards), -1 the left
    mark: str = ""  # the cross on a broken arrow
    obstacles: list[Rect] = field(default_factory=list)  # what of it no label may cover
    middle: float = 0.5  # parameter of the best place for its label


def bends(forward: int, backward: int) -> tuple[list[float], list[float]]:
    """Return how far the middles of the arrows that lead each way between two states leave the straight line.

    px, positive to the right hand of the arrow's own direction.
    """
    if forward and backward:
        there, back = ([OPPOSITE / 2 + PARALLEL * i for i in range(n)] for n in (forward, backward))
        return there, back
    middle = (forward + backward - 1) / 2
    spread = [PARALLEL * (i - middle) for i in range(forward + backward)]
    return (spread, []) if forward else ([], spread)


def number(value: float) -> str:
    """Return a coordinate as text, with one decimal at most."""
    text = f"{value:.1f}"
    return text[:-2] if text.endswith(".0") else text


def _path(command: str, *points: Point) -> str:
    text = command
    for x, y in points:
        text += f"{x:.1f} {y:.1f} "
    return text.replace(".0 ", " ")[:-1]  # as `number` writes them


def _quadratic(p: Point, c: Point, q: Point, t: float) -> Point:
    a, b, d = (1 - t) * (1 - t), 2 * t * (1 - t), t * t
    return a * p[0] + b * c[0] + d * q[0], a * p[1] + b * c[1] + d * q[1]


def _around(p: Point, c: Point, q: Point) -> Rect:
    (left, _, right), (top, _, bottom) = sorted((p[0], c[0], q[0])), sorted((p[1], c[1], q[1]))
    return Rect((left + right) / 2, (top + bottom) / 2, right - left, bottom - top)


def _part(p: Point, c: Point, q: Point, start: float, end: float) -> tuple[Point, Point, Point]:
    """Return the piece of a quadratic arc between two parameters, as three points."""
    first, last = _quadratic(p, c, q, start), _quadratic(p, c, q, end)
    along = (p[0] + (c[0] - p[0]) * start, p[1] + (c[1] - p[1]) * start)
    beyond = (c[0] + (q[0] - c[0]) * start, c[1] + (q[1] - c[1]) * start)
    return first, (along[0] + (beyond[0] - along[0]) * end, along[1] + (beyond[1] - along[1]) * end), last


def _leaving(box: Rect, p: Point, c: Point, q: Point) -> float:
    """Compute the parameter at which an arc that starts inside a box leaves it."""
    leaving = 1.0
    for start, control, end, middle, reach in (
        (p[0], c[0], q[0], box.x, box.width / 2),
        (p[1], c[1], q[1], box.y, box.height / 2),
    ):
        square, half = start - 2 * control + end, control - start  # square t² + 2 half t + start
        for way in (start - middle - reach, start - middle + reach):
            root = half * half - square * way
            if root >= 0:
                root = math.sqrt(root)
                for divisor in (root - half, -root - half):
                    if divisor and 0.0 < way / divisor < leaving:
                        leaving = way / divisor
    return leaving


def _head(base: Point, tip: Point) -> str:
    length = math.hypot(tip[0] - base[0], tip[1] - base[1]) or 1.0
    x, y = (tip[0] - base[0]) / length, (tip[1] - base[1]) / length
    back = (tip[0] - TIP * x, tip[1] - TIP * y)
    half = TIP * 0.42
    left, right = (back[0] + half * y, back[1] - half * x), (back[0] - half * y, back[1] + half * x)
    return _path("M", tip, right, left) + "Z"


def obstacles(boxes: Iterable[Rect]) -> Cells:
    """Register the obstacles of arrows, for :func:`chords` and :func:`detour`."""
    cells = Cells(CELL, CLEAR)
    for box in boxes:
        cells.add(box)
    return cells


def chords(boxes: Mapping[str, Rect], cells: Cells, pairs: Mapping[Pair, int]) -> dict[Pair, Chord]:
    """Spread the arrows of each state along its sides, in the order of where they lead.

    `cells`: the same as :func:`obstacles`.
    `pairs`: how many arrows run between two states, both ways together; each pair once.
    Inside the two boxes: where the straight line between them begins and ends.
    """
    sides: dict[tuple[str, bool, bool], list[tuple[float, Pair, int]]] = {}
    ends: dict[tuple[str, Pair], Point] = {}
    for pair, count in pairs.items():
        source, target = (boxes[name] for name in pair)
        start, stop = (source.x, source.y), (target.x, target.y)
        if any(
            box is not source and box is not target and box.crossed_by(start, stop)
            for box in cells.along(start, stop)
        ):
            ends[pair[0], pair], ends[pair[1], pair] = start, stop  # it will go a long way round
            continue
        for name, other in (pair, pair[::-1]):
            box, end = boxes[name], boxes[other]
            x, y = end.x - box.x, end.y - box.y
            across = abs(x) * box.height < abs(y) * box.width  # leaves through the top or the bottom
            slope = x / abs(y) if across else y / (abs(x) or 1.0)
            sides.setdefault((name, across, (y if across else x) > 0), []).append((slope, pair, count))
    for (name, across, _), leaving in sides.items():
        box = boxes[name]
        room = (box.width if across else box.height) * 0.7
        total = sum(count for *_, count in leaving) * OPPOSITE
        step = OPPOSITE * min(1.0, room / total)
        at = -step * sum(count for *_, count in leaving) / 2
        for _, pair, count in sorted(leaving):
            middle = at + step * count / 2
            at += step * count
            ends[name, pair] = (box.x + middle, box.y) if across else (box.x, box.y + middle)
    return {pair: (ends[pair[0], pair], ends[pair[1], pair]) for pair in pairs}


def detour(
    source: Rect, target: Rect, offsets: Sequence[float], cells: Cells, chord: Chord | None = None
) -> float:
    """Compute how far all arrows between two states are bent together to pass the states between.

    `offsets`: what :func:`bends` returns for each arrow, px, positive to the right hand on the way from
        `source` to `target`.
    `cells`: all states, as :func:`obstacles`.
    `chord`: from where to where; by default from middle to middle.
    px, to be added to each offset; 0 where the way is clear, and the least evil where none is.
    """
    length = math.dist((source.x, source.y), (target.x, target.y))
    samples = max(SAMPLES, math.ceil(length / STEP))
    choices = [*DETOURS, 0.3 * length, -0.3 * length, 0.5 * length, -0.5 * length]
    best, least = 0.0, math.inf
    for choice in choices:
        cost = abs(choice)
        for offset in offsets:
            if cost < least:
                p, c, q = _bent(source, target, offset, choice, chord)
                around = _around(p, c, q)
                if around.width * around.height < SAMPLES * CELL * CELL and all(
                    box is source or box is target for box in cells.near(around)
                ):
                    continue
                for i in range(samples):
                    point = _quadratic(p, c, q, (i + 0.5) / samples)
                    for box in cells.at(point):
                        if box is not source and box is not target and box.holds(point, CLEAR):
                            cost += 60.0
        if cost < least:
            best, least = choice, cost
        if least <= abs(choice):
            break
    return best


def _bent(
    source: Rect, target: Rect, offset: float, around: float, chord: Chord | None
) -> tuple[Point, Point, Point]:
    """Return an arc from inside one box to inside another; parallel arcs run side by side."""
    p, q = chord or ((source.x, source.y), (target.x, target.y))
    length = math.dist(p, q) or 1.0
    x, y = (p[1] - q[1]) / length, (q[0] - p[0]) / length  # to the right hand

    def shifted(point: Point, box: Rect) -> Point:  # the ends keep apart too, as far as the box is wide
        room = 0.3 * (abs(x) * box.width + abs(y) * box.height)
        shift = max(-room, min(room, 0.6 * offset))
        return box.inside((point[0] + x * shift, point[1] + y * shift), 4.0)

    middle = ((p[0] + q[0]) / 2 + x * (offset + around), (p[1] + q[1]) / 2 + y * (offset + around))
    p, q = shifted(p, source), shifted(q, target)
    return p, (2 * middle[0] - (p[0] + q[0]) / 2, 2 * middle[1] - (p[1] + q[1]) / 2), q


def arc(
    source: Rect,
    target: Rect,
    offset: float,
    around: float = 0.0,
    *,
    chord: Chord | None = None,
    broken: bool = False,
) -> Route:
    """Route an arrow from border to border.

    `offset`, `around`: how far the middle leaves the straight line, px, positive to the right hand: among
        arrows between the same states, and by the :func:`detour` of all of them.
    `chord`: from where to where; by default from middle to middle.
    `broken`: whether it leads nowhere: there is a gap with a cross in the middle, and no head.
    """
    p, c, q = _bent(source, target, offset, around, chord)
    start = _leaving(source, p, c, q)
    end = 1.0 - _leaving(target, q, c, p)
    if end <= start:  # states that touch or overlap, because someone dragged them there
        start, end = 0.4, 0.6
    return _drawn(*_part(p, c, q, start, end), 1 if offset + around >= 0 else -1, broken)


def _drawn(p: Point, c: Point, q: Point, side: int, broken: bool) -> Route:
    length = math.hypot(q[0] - p[0], q[1] - p[1]) or 1.0
    points = [_quadratic(p, c, q, i / SAMPLES) for i in range(SAMPLES + 1)]
    if broken:
        gap = min(0.25, 11.0 / length)
        first, second = _part(p, c, q, 0.0, 0.5 - gap), _part(p, c, q, 0.5 + gap, 1.0)
        middle = _quadratic(p, c, q, 0.5)
        d = "".join(_path("M", a) + _path("Q", b, e) for a, b, e in (first, second))
        return Route(d, "", points, side, _cross_at(middle), [Rect(*middle, 12.0, 12.0)])
    base = max(0.0, 1.0 - 0.8 * TIP / length)
    a, b, e = _part(p, c, q, 0.0, base)
    return Route(_path("M", a) + _path("Q", b, e), _head(e, q), points, side)


def straight(source: Rect, target: Point, *, broken: bool = False) -> Route:
    """Route an arrow straight from a state to a point."""
    p = (source.x, source.y)
    c = ((p[0] + target[0]) / 2, (p[1] + target[1]) / 2)
    stop = 1.0 - PORT / (math.dist(p, target) or 1.0)
    return _drawn(*_part(p, c, target, _leaving(source, p, c, target), stop), 1, broken)


def loop(box: Rect, index: int = 0, count: int = 1, *, broken: bool = False) -> Route:
    """Route an arrow from a state to itself, on top; several are placed side by side.

    `index`, `count`: which of how many loops of this state.
    `broken`: whether it can never fire: it has a cross and no head.
    """
    step = min(34.0, 0.9 * box.width / count)
    x = box.x + step * (index - (count - 1) / 2)
    half, rise = min(11.0, step * 0.34), 36.0
    top = box.y - box.height / 2
    p, q = (x - half, top), (x + half, top)
    c, e = (x - half * 1.8, top - rise), (x + half * 1.8, top - rise)
    points = [_cubic(p, c, e, q, i / SAMPLES) for i in range(SAMPLES + 1)]
    # the best place for the label is left of the first one and right of the last one
    middle = 0.5 if count == 1 else 0.3 + 0.4 * index / (count - 1)
    if broken:
        crossed = _cubic(p, c, e, q, 0.5)
        d = _path("M", p) + _path("C", c, e, q)
        return Route(d, "", points, -1, _cross_at(crossed), [Rect(*crossed, 12.0, 12.0)], middle)
    base = _cubic(p, c, e, q, 1.0 - 0.25 * TIP / rise)
    return Route(_path("M", p) + _path("C", c, e, base), _head(base, q), points, -1, middle=middle)


def _cross_at(point: Point) -> str:
    x, y = point
    return "".join(_path("M", (x - 4, y - 4 * k)) + _path("L", (x + 4, y + 4 * k)) for k in (1, -1))


def _cubic(p: Point, c: Point, e: Point, q: Point, t: float) -> Point:
    s = 1 - t
    k = (s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t)
    return (
        k[0] * p[0] + k[1] * c[0] + k[2] * e[0] + k[3] * q[0],
        k[0] * p[1] + k[1] * c[1] + k[2] * e[1] + k[3] * q[1],
    )
