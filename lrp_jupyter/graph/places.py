"""Where states stand: a first arrangement, and free places for what comes later.

No layered algorithm is stable under edits (one edge more, and every node moves), so an
arrangement is made once; afterwards a state keeps its place, and a new one takes the free place
nearest to its neighbours.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations
from typing import NamedTuple

from lrp_jupyter.graph.ordering import order
from lrp_jupyter.graph.state_graph import ANY

__all__ = ["Box", "arrange", "free_place", "is_dense", "layers", "left_of"]

Point = tuple[float, float]
Link = tuple[str, str]
Size = tuple[float, float]

GAP_X, GAP_Y = 76.0, 60.0
"""Least room between two states, so that an arrow and its label fit, in px."""
LAYER = 108.0
"""From the middle of one layer to the middle of the next, in px."""
GRID = 20.0
TALL = 9
"""Layers in a column when a tall arrangement is folded."""
SMALL = 12
"""States up to which swapping neighbours is tried."""


class Box(NamedTuple):
    """A rectangle by its middle, in px; y grows downwards."""

    x: float
    y: float
    width: float
    height: float

    def overlaps(self, other: Box, gap_x: float = 0.0, gap_y: float = 0.0) -> bool:
        """Whether two boxes come nearer than the gaps."""
        return (
            abs(self.x - other.x) * 2 < self.width + other.width + 2 * gap_x
            and abs(self.y - other.y) * 2 < self.height + other.height + 2 * gap_y
        )

    def holds(self, point: Point, margin: float = 0.0) -> bool:
        """Whether a point is inside, or nearer than `margin`."""
        return (
            abs(point[0] - self.x) < self.width / 2 + margin
            and abs(point[1] - self.y) < self.height / 2 + margin
        )

    def inside(self, point: Point, margin: float) -> Point:
        """Return the point of the box, at least `margin` from its border, that is nearest to a point."""
        x, y = max(0.0, self.width / 2 - margin), max(0.0, self.height / 2 - margin)
        return (
            max(self.x - x, min(self.x + x, point[0])),
            max(self.y - y, min(self.y + y, point[1])),
        )

    def crossed_by(self, start: Point, end: Point, margin: float = 0.0) -> bool:
        """Whether a straight line touches it."""
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


def is_dense(names: Sequence[str], links: Sequence[Link]) -> bool:
    """Whether there are so many edges that layers would tell nothing: more than 2.5 per state."""
    return len(links) > 2.5 * len(names)


def arrange(sizes: Mapping[str, Size], links: Sequence[Link], starts: Sequence[str] = ()) -> dict[str, Point]:
    """Arrange a machine for the first time.

    Layers by longest path, the start state first and ``*`` at the left; an ellipse in the order of
    the text where edges are dense.

    Parameters
    ----------
    sizes : mapping of str to (float, float)
        Width and height of every node in px, in the order of the text.
    links : sequence of (str, str)
        One for each edge; both ends are in `sizes`.
    starts : sequence of str
        Start states.

    Returns
    -------
    dict of str to (float, float)
        The middle of every node, in px.
    """
    states = [name for name in sizes if name != ANY]
    if not states:
        return {ANY: (0.0, 0.0)} if ANY in sizes else {}
    if is_dense(list(sizes), links):
        places = _ellipse(states, sizes, len(links))
    else:
        places = _layered(states, sizes, links, starts)
    if ANY in sizes:
        places[ANY] = left_of(places, sizes, links)
    return {name: (round(x, 1), round(y, 1)) for name, (x, y) in places.items()}


def _ellipse(states: Sequence[str], sizes: Mapping[str, Size], links: int) -> dict[str, Point]:
    count = len(states)
    widest = max(sizes[name][0] for name in states)
    crowd = math.sqrt(max(1.0, links / count / 2.5))
    height = max(90.0, 24.0 * count * crowd + 50.0 * crowd)
    width = max(height * 1.4, (widest + GAP_X) * count / (2 * math.pi))
    turn = 2 * math.pi / count
    return {
        name: (width * math.sin(turn * index), -height * math.cos(turn * index))
        for index, name in enumerate(states)
    }


def left_of(places: Mapping[str, Point], sizes: Mapping[str, Size], links: Iterable[Link]) -> Point:
    """Say where ``*`` belongs: left of everything, as high as the states that it leads to."""
    left = min(x - sizes[name][0] / 2 for name, (x, _) in places.items())
    targets = {target: places[target][1] for source, target in links if source == ANY and target in places}
    ys = list(targets.values()) or [y for _, y in places.values()]
    # from the height of two states side by side one arrow would run into the first of them
    above = LAYER if len(set(ys)) < len(ys) and targets else 0.0
    return left - GAP_X - sizes[ANY][0] / 2, (min(ys) + max(ys)) / 2 - above


def layers(names: Sequence[str], links: Iterable[Link], starts: Sequence[str] = ()) -> dict[str, int]:
    """Give each node its layer: the length of the longest path to it, without going in circles.

    Circles are opened where a walk from the start states, then from ``*``, then in the order of the text
    comes back to where it is; no edge leads into a start state.
    """
    forward = _forward_links(names, links, starts)
    level = dict.fromkeys(names, 0)
    waiting = {name: sum(target == name for _, target in forward) for name in names}
    ready = [name for name in names if not waiting[name]]
    while ready:
        source = ready.pop(0)
        for origin, target in forward:
            if origin == source:
                level[target] = max(level[target], level[source] + 1)
                waiting[target] -= 1
                if not waiting[target]:
                    ready.append(target)
    return level


def _forward_links(names: Sequence[str], links: Iterable[Link], starts: Sequence[str]) -> list[Link]:
    """Links without those that close a circle, each once."""
    after: dict[str, list[str]] = {name: [] for name in names}
    for source, target in dict.fromkeys(links):
        if source != target and source in after and target in after and target not in starts:
            after[source].append(target)
    entered = {target for targets in after.values() for target in targets}
    roots = [name for name in names if name in starts]
    roots += [name for name in names if name == ANY]
    roots += [name for name in names if name not in entered]
    forward: list[Link] = []
    done: set[str] = set()
    for root in [*roots, *names]:
        path: dict[str, list[str]] = {}
        if root not in done:
            path[root] = list(after[root])
        while path:  # a walk in depth, without recursion: machines may be long
            source = next(reversed(path))
            if not path[source]:
                done.add(source)
                del path[source]
                continue
            target = path[source].pop(0)
            if target in path:
                continue
            forward.append((source, target))
            if target not in done:
                path[target] = list(after[target])
    return forward


def _layered(
    states: Sequence[str], sizes: Mapping[str, Size], links: Sequence[Link], starts: Sequence[str]
) -> dict[str, Point]:
    names = [*([ANY] if ANY in sizes else []), *states]
    level = layers(names, links, starts or states[:1])
    across = order(names, links, level)
    if ANY in across and 2 * across[ANY] > min(across.values()) + max(across.values()):
        across = {name: -x for name, x in across.items()}  # `*` will stand at the left
    by_level: dict[int, list[str]] = {}
    for name in states:
        by_level.setdefault(level[name], []).append(name)
    rows = [sorted(by_level[depth], key=lambda name: across[name]) for depth in sorted(by_level)]
    places = _coordinates(rows, sizes, links)
    if len(states) <= SMALL:
        rows, places = _improved(rows, places, sizes, links)
    return _fold(places, sizes, rows) if len(rows) >= TALL * 1.5 else places


def _coordinates(
    rows: Sequence[Sequence[str]], sizes: Mapping[str, Size], links: Sequence[Link]
) -> dict[str, Point]:
    """Put each node above the middle of its neighbours, in the given order and with room between."""
    near: dict[str, list[str]] = {name: [] for row in rows for name in row}
    for a, b in dict.fromkeys((min(link), max(link)) for link in links):
        if a != b and a in near and b in near:
            near[a].append(b)
            near[b].append(a)
    weights = {name: float(len(others)) or 0.001 for name, others in near.items()}
    across = {name: 0.0 for row in rows for name in row}
    for _ in range(6):
        for row in (*rows, *reversed(rows)):
            middle = sum(across[name] * weights[name] for name in row) / sum(weights[name] for name in row)
            wanted = [
                sum(across[other] for other in near[name]) / len(near[name]) if near[name] else middle
                for name in row
            ]
            across.update(zip(row, _apart(wanted, row, sizes, weights), strict=True))
    return {name: (across[name], depth * LAYER) for depth, row in enumerate(rows) for name in row}


def _apart(
    wanted: Sequence[float], row: Sequence[str], sizes: Mapping[str, Size], weights: Mapping[str, float]
) -> list[float]:
    """Move nodes as little as possible (weighted least squares) until they have room, in their order."""
    offset, offsets = 0.0, []
    for i, name in enumerate(row):
        if i:
            offset += (sizes[row[i - 1]][0] + sizes[name][0]) / 2 + GAP_X
        offsets.append(offset)
    pools: list[tuple[float, float, int]] = []  # nodes side by side: mean, weight, how many
    for name, want, shift in zip(row, wanted, offsets, strict=True):
        mean, weight, count = want - shift, weights[name], 1
        while pools and pools[-1][0] > mean:
            other, heavy, others = pools.pop()
            mean = (mean * weight + other * heavy) / (weight + heavy)
            weight, count = weight + heavy, count + others
        pools.append((mean, weight, count))
    flat = [mean for mean, _, count in pools for _ in range(count)]
    return [mean + shift for mean, shift in zip(flat, offsets, strict=True)]


def _improved(
    rows: list[list[str]], places: dict[str, Point], sizes: Mapping[str, Size], links: Sequence[Link]
) -> tuple[list[list[str]], dict[str, Point]]:
    """Swap neighbours inside a layer while that makes the picture better."""
    best = _badness(places, sizes, links)
    for _ in range(2):
        for depth, row in enumerate(rows):
            for i, j in combinations(range(len(row)), 2):
                swapped = list(row)
                swapped[i], swapped[j] = swapped[j], swapped[i]
                trial = [*rows[:depth], swapped, *rows[depth + 1 :]]
                moved = _coordinates(trial, sizes, links)
                badness = _badness(moved, sizes, links)
                if badness < best - 1.0:
                    best, rows, places, row = badness, trial, moved, swapped
    return rows, places


def _badness(places: Mapping[str, Point], sizes: Mapping[str, Size], links: Sequence[Link]) -> float:
    """Length of the edges, how often they cross, and how often they run into a node."""
    ends = dict(places)
    if ANY in sizes:
        ends[ANY] = left_of(places, sizes, links)
    pairs = [pair for pair in dict.fromkeys(tuple(sorted(link)) for link in links) if pair[0] != pair[1]]
    total = 0.0
    for k, (a, b) in enumerate(pairs):
        total += math.dist(ends[a], ends[b])
        for name, point in places.items():
            if name not in (a, b):
                total += 150.0 * Box(*point, *sizes[name]).crossed_by(ends[a], ends[b], 6.0)
        for c, d in pairs[:k]:
            if not {a, b} & {c, d}:
                total += 120.0 * _cross(ends[a], ends[b], ends[c], ends[d])
    return total


def _cross(a: Point, b: Point, c: Point, d: Point) -> bool:
    def turn(p: Point, q: Point, r: Point) -> float:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    return turn(a, b, c) * turn(a, b, d) < 0 and turn(c, d, a) * turn(c, d, b) < 0


def _fold(
    places: Mapping[str, Point], sizes: Mapping[str, Size], rows: Sequence[Sequence[str]]
) -> dict[str, Point]:
    """Fold a tall arrangement into columns, up and down in turn, so that neighbours stay near."""
    left = min(x - sizes[name][0] / 2 for name, (x, _) in places.items())
    right = max(x + sizes[name][0] / 2 for name, (x, _) in places.items())
    wide = right - left + 1.5 * GAP_X
    tall = math.ceil(math.sqrt(len(rows) * wide / LAYER))  # about as wide as high
    tall = math.ceil(len(rows) / math.ceil(len(rows) / tall))
    folded = {}
    for depth, row in enumerate(rows):
        column, down = divmod(depth, tall)
        for name in row:
            x = places[name][0]
            if column % 2:
                x = left + right - x
            folded[name] = (x + column * wide, (tall - 1 - down if column % 2 else down) * LAYER)
    return folded


def free_place(
    size: Size, towards: Sequence[Point], taken: Sequence[Box], lines: Sequence[tuple[Point, Point]] = ()
) -> Point:
    """Find the free place nearest to some points.

    Parameters
    ----------
    size : (float, float)
        Width and height of what wants a place, in px.
    towards : sequence of (float, float)
        Places of its neighbours.
    taken : sequence of Box
        What it must keep away from.
    lines : sequence of (point, point)
        Edges that it should not stand on.
    """
    if not towards:
        towards = [(0.0, 0.0)]
    x0 = sum(x for x, _ in towards) / len(towards)
    y0 = sum(y for _, y in towards) / len(towards)
    best: tuple[float, Point] | None = None
    ring = 0
    while best is None or ring * GRID <= best[0]:  # nothing on a wider ring can cost less
        for i, j in _ring(ring):
            x, y = round(x0 + i * GRID, 1), round(y0 + j * GRID, 1)
            box = Box(x, y, *size)
            if any(box.overlaps(other, GAP_X, GAP_Y) for other in taken):
                continue
            cost = math.hypot(x - x0, y - y0) + (6.0 if y < y0 else 0.0) + (3.0 if x < x0 else 0.0)
            cost += 60.0 * sum(box.crossed_by(start, end, 8.0) for start, end in lines)
            for point in towards:
                cost += 40.0 * sum(
                    other.crossed_by(point, (x, y)) for other in taken if not other.holds(point)
                )
            if best is None or cost < best[0]:
                best = (cost, (x, y))
        ring += 1
    return best[1]


def _ring(radius: int) -> list[tuple[int, int]]:
    if radius == 0:
        return [(0, 0)]
    steps = range(-radius, radius + 1)
    edge = [(i, j) for i in steps for j in (radius, -radius)]
    return edge + [(i, j) for j in steps[1:-1] for i in (radius, -radius)]
