"""Labels: the widths of their texts, estimated without a font, and their positions beside the arrows.

The widths are those of DejaVu Sans, wider than the fonts that most systems choose: a text never needs more
room than estimated here. Labels are placed in one greedy pass, in the order of the text.
"""

from __future__ import annotations

import math
import re
import unicodedata
from collections import defaultdict
from collections.abc import Iterable, Sequence
from functools import lru_cache
from itertools import accumulate, pairwise, takewhile

from lrp_jupyter.graph.geometry import Cells, Point, Rect
from lrp_jupyter.graph.routes import SAMPLES, Route
from lrp_jupyter.language.program import Spawn, Transition

STATE_FONT, LABEL_FONT = 13.0, 11.5  # px: font sizes of states' names, and of everything else
LABEL_LINE = 13.5  # px: from one line of a label to the next
WIDEST_LABEL = 150.0  # px
GAP = 5.0  # px: room between a line and its label
POINTS = 40_000  # of arrows that labels avoid, about: one every 11 px, but farther apart in large pictures


class _Obstacles(Cells):
    """Obstacles that labels avoid: rectangles, and points of arrows."""

    def __init__(self) -> None:
        super().__init__(48.0)
        self._points: defaultdict[tuple[float, float], list[tuple[int, float, float]]] = defaultdict(list)

    def add_line(self, owner: int, points: Sequence[Point], apart: float) -> None:
        """Register points of an arrow, about so far apart; it is given by some of its points."""
        size, cells = self.size, self._points
        for (x, y), (right, down) in pairwise(points):
            steps = round(math.dist((x, y), (right, down)) / apart) or 1
            across, along = (right - x) / steps, (down - y) / steps
            for step in range(steps):
                left, top = x + across * step, y + along * step
                cells[left // size, top // size].append((owner, left, top))

    def cost(self, box: Rect, owner: int) -> float:
        """Return the cost of a label at this position: other boxes count most, then others' lines."""
        total = 1000.0 * sum(box.overlaps(other, 2.0, 1.0) for other in self.near(box))
        return total + 40.0 * self._lines(box, owner, 1.0)

    def lines_between(self, box: Rect, point: Point, owner: int) -> int:
        """Count the points of others' lines between a label and its own line."""
        left, right = min(box.x, point[0]), max(box.x, point[0])
        top, bottom = min(box.y, point[1]), max(box.y, point[1])
        way = Rect((left + right) / 2, (top + bottom) / 2, right - left, bottom - top)
        return self._lines(way, owner, 2.0)

    def _lines(self, box: Rect, owner: int, margin: float) -> int:
        x, y = box.x, box.y
        right, down = box.width / 2 + margin, box.height / 2 + margin
        return sum(
            line != owner and abs(left - x) < right and abs(top - y) < down
            for cell in self.cells(box)
            for line, left, top in self._points.get(cell, ())
        )


def arrow_text(transition: Transition) -> str:
    """Return the text of an arrow in one line: when it fires, or its name where that is too long."""
    text = " ".join(transition.arrow_text.split())
    if transition.name and text_width(text, LABEL_FONT) > WIDEST_LABEL:
        return str(transition.name) + (_EFFECT if text.endswith(_EFFECT) else "")
    return text


_EFFECT = " /"  # the end of an arrow's text that tells of an effect


def settings_text(spawn: Spawn) -> str:
    """Return the values that a spawn gives to variables of its machine: ``side 1, keep 0.25``."""
    values = ((each.name, " ".join(each.initial.text.split())) for each in spawn.settings)
    return ", ".join(f"{name} {re.sub(_SIGN, MINUS, value)}" for name, value in values)


_SIGN, MINUS = re.compile(r"^-(?=[.\d])"), "\N{MINUS SIGN}"


def place_labels(
    routes: Sequence[Route], sizes: Sequence[tuple[float, float]], obstacles: Iterable[Rect]
) -> list[Rect]:
    """Place a label beside each arrow in one greedy pass; a placed one is an obstacle for the next.

    `sizes`: width and height of each label, in px.
    `obstacles`: states and other things that no label may cover.
    """
    cells = _Obstacles()
    for box in obstacles:
        cells.add(box)
    length = sum(math.dist(*part) for route in routes for part in pairwise(route.points[::4]))
    apart = max(11.0, length / POINTS)
    for index, route in enumerate(routes):
        for box in route.obstacles:
            cells.add(box)
        cells.add_line(index, route.points, apart)
    labels = []
    for index, (route, size) in enumerate(zip(routes, sizes, strict=True)):
        best: tuple[float, Rect] | None = None
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
        cells.add(best[1])
        labels.append(best[1])
    return labels


def beside(route: Route, size: tuple[float, float]) -> Rect:
    """Return the place of a label beside its arrow, whatever else is there."""
    _, at, far, side = _seats(route.middle)[0]
    return _seat(route, size, at, far, side)


@lru_cache(maxsize=32)
def _seats(middle: float) -> list[tuple[float, int, float, int]]:
    """Return the possible positions of a label, cheapest first: price, point of the path, distance, side.

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


def _seat(route: Route, size: tuple[float, float], at: int, far: float, side: int) -> Rect:
    x, y = route.points[at]
    if side:
        before, after = route.points[at - 1], route.points[at + 1]
        way = (after[0] - before[0], after[1] - before[1])
        length = (math.hypot(*way) or 1.0) * side * route.side
        right = (-way[1] / length, way[0] / length)
        # the nearest corner of the label just clears the line
        reach = abs(right[0]) * size[0] / 2 + abs(right[1]) * size[1] / 2 + GAP + far
        x, y = x + right[0] * reach, y + right[1] * reach
    return Rect(round(x, 1), round(y, 1), *size)


_WIDTHS = {  # in thousandths of the font size
    300: "ijlIJ'",
    330: " !,./:;\\|f",
    410: '()[]-rt"`',
    530: "?_^*s",
    590: "Fcvxyzk",
    640: "abdeghnopquLEPTY0123456789${}",
    700: "ABCKSVXZR",
    790: "DGHNOQUw+<=>~&#",
    870: "M",
    990: "mW%@",
}
_WIDTH = {character: width for width, characters in _WIDTHS.items() for character in characters}
ELLIPSIS = "…"


def text_width(text: str, size: float) -> float:
    """Estimate the width of a line of text in a font of this size, both in px."""
    return sum(map(_character_width, text)) * size / 1000


def _character_width(character: str) -> int:
    known = _WIDTH.get(character)
    if known is not None:
        return known
    if unicodedata.combining(character):
        return 0
    return 1000 if unicodedata.east_asian_width(character) in "WF" else 790


def shorten(text: str, size: float, width: float) -> str:
    """Return the text in one line; of one wider than `width` px an ellipsis replaces the middle.

    Names with a common beginning differ at their ends, and so do conditions.
    """
    line = " ".join(text.split())
    if len(line) * size <= width or text_width(line, size) <= width:  # no character is wider than high
        return line
    room = width - text_width(ELLIPSIS, size)
    begin = _fitting(line, size, room / 2)
    end = _fitting(line[::-1], size, room - text_width(line[:begin], size))
    return line[:begin].rstrip() + ELLIPSIS + line[len(line) - end :].lstrip()


def _fitting(line: str, size: float, width: float) -> int:
    """Return how many of the first characters have room."""
    widths = accumulate(text_width(character, size) for character in line)
    return sum(1 for _ in takewhile(lambda end: end <= width, widths))
