"""Positions of states from one edit to the next, and free positions for new states.

No layered algorithm is stable under edits (one more edge, and every node moves), so an arrangement is
computed once; afterwards a state keeps its position, and a new one is placed at the free position nearest
to its neighbours. A position belongs to a name, whatever has that name: a state, the missing end of a
dangling transition, or for a while nothing.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from heapq import heappop, heappush
from itertools import combinations, islice

from lrp_jupyter.graph.arrangement import GAP_X, GAP_Y, Link, arrange, left_of
from lrp_jupyter.graph.geometry import CELL, Cells, Point, Rect, Size
from lrp_jupyter.graph.layout_parts import Layout, Position
from lrp_jupyter.graph.state_graph import ANY

RESERVED = 30.0  # s: time for which the position of a removed state stays free
USUAL: Size = (80.0, 36.0)  # px: size reserved for a removed state
GRID = 20.0  # px: distance between the positions that are tried for a new state
ROOM = 30.0  # px: room between a state that grows and its neighbours
ROUNDS = 40  # how often states are moved apart, at most
STRETCH = 2.0  # how much nearer the longer direction of a panel is, at most
EFFORT = 200_000  # how many nodes and edges are compared, at most, to find free positions for new nodes

Line = tuple[Point, Point]


def keep_positions(
    sizes: Mapping[str, Size],
    states: Sequence[str],
    links: Sequence[Link],
    starts: Sequence[str],
    previous: Layout | None,
    moved: Mapping[str, Sequence[float]],
    now: float,
    panel: Size | None,
    insides: Mapping[str, Point],
) -> dict[str, Position]:
    """Compute a position for every node: its old one, the one it was moved to, or a free one.

    `sizes`: width and height of every node in px, in the order of the text.
    `states`: those of them that are states of the program.
    `links`: one for each arrow between two of them.
    `starts`, `previous`, `moved`, `now`, `panel`: as for :func:`~lrp_jupyter.graph.layout.layout`.
    `insides`: for the states in which machines are drawn, the centre of these, in their own coordinates.
    First those of `sizes` in their order, then those that are reserved.
    """
    positions: dict[str, Position] = {}
    if previous is not None:
        retyped = _retyped(previous, states) or _retyped_end(previous, states, links)
        positions = _kept(previous, sizes, retyped, now)
    first = not any(name in positions for name in sizes)
    for name, (x, y) in insides.items():
        if name in positions and "inside" in (before := positions[name]):
            before["x"] = round(before["x"] + x - before["inside"][0], 1)
            before["y"] = round(before["y"] + y - before["inside"][1], 1)
    for name, (x, y) in moved.items():
        positions[name] = Position(x=round(float(x), 1), y=round(float(y), 1))
        if name not in sizes:
            positions[name]["gone"] = now
    taken = Cells(CELL)
    for name, position in positions.items():
        taken.add(Rect(position["x"], position["y"], *sizes.get(name, USUAL)))
    if first:
        for name, (x, y) in arrange(sizes, links, starts, panel).items():
            mine = Rect(x, y, *sizes[name])
            if name not in positions and not any(
                mine.overlaps(other, 8.0, 8.0) for other in taken.near(mine, 8.0)
            ):
                positions[name] = Position(x=x, y=y)
                taken.add(mine)
    _add_new(positions, sizes, [link for link in links if link[0] != link[1]], taken, panel)
    for name, inside in insides.items():
        positions[name]["inside"] = inside
    if insides:
        _make_room(positions, sizes)
    ordered = [*sizes, *(name for name in positions if name not in sizes)]
    return {name: positions[name] for name in ordered}


def _make_room(positions: dict[str, Position], sizes: Mapping[str, Size]) -> None:
    """Move states out of those that have grown over them, the smaller one of two, by the shortest way."""
    by_size = sorted(sizes, key=lambda name: -sizes[name][0] * sizes[name][1])
    for _ in range(ROUNDS):
        boxes = {name: Rect(positions[name]["x"], positions[name]["y"], *sizes[name]) for name in by_size}
        meeting = [(a, b) for a, b in combinations(by_size, 2) if boxes[a].overlaps(boxes[b], ROOM, ROOM)]
        if not meeting:
            return
        for large, small in meeting:
            a, b = (Rect(positions[name]["x"], positions[name]["y"], *sizes[name]) for name in (large, small))
            x = (a.width + b.width) / 2 + ROOM - abs(a.x - b.x)
            y = (a.height + b.height) / 2 + ROOM - abs(a.y - b.y)
            moved = positions[small]
            if 0 < x < y:
                moved["x"] = round(b.x + math.copysign(x, b.x - a.x), 1)
            elif 0 < y <= x:
                moved["y"] = round(b.y + math.copysign(y, b.y - a.y), 1)


def _kept(
    previous: Layout, sizes: Mapping[str, Size], renamed: Mapping[str, str], now: float
) -> dict[str, Position]:
    """Return the positions of the last layout that are still valid."""
    positions: dict[str, Position] = {}
    for name, position in previous["places"].items():
        kept = Position(x=position["x"], y=position["y"])
        if "inside" in position:
            kept["inside"] = position["inside"]
        new = renamed.get(name, name)
        if new not in sizes:
            kept["gone"] = position.get("gone", now)
            if now - kept["gone"] >= RESERVED:
                continue
        if new not in positions or name in renamed:  # a renamed state goes before a missing end of that name
            positions[new] = kept
    return positions


def _retyped(previous: Layout, states: Sequence[str]) -> dict[str, str]:
    """Return the state whose name is being edited, the only one that differs, as {old: new}."""
    old = [shape["name"] for shape in previous["states"] if shape["kind"] == "state"]
    if len(old) != len(states):
        return {}
    changed = [(a, b) for a, b in zip(old, states, strict=True) if a != b]
    if len(changed) != 1 or changed[0][1] in old:
        return {}
    return dict(changed)


def _retyped_end(previous: Layout, states: Sequence[str], links: Sequence[Link]) -> dict[str, str]:
    """Return the missing end of an arrow whose name is being edited, the only one that differs."""
    drawn = (arrow for arrow in previous["transitions"] if arrow["kind"] != "exit" or arrow["lands"])
    arrows = [(arrow["source"], arrow["destination"]) for arrow in drawn]
    if len(arrows) != len(links):
        return {}
    pairs = zip(arrows, links, strict=True)
    changed = {(a, b) for pair in pairs for a, b in zip(*pair, strict=True) if a != b}
    if len(changed) != 1:
        return {}
    ((old, new),) = changed
    kinds = {shape["name"]: shape["kind"] for shape in previous["states"]}
    return {old: new} if kinds.get(old) == "missing" and new not in kinds and new not in states else {}


def _add_new(
    positions: dict[str, Position],
    sizes: Mapping[str, Size],
    links: Sequence[Link],
    taken: Cells,
    panel: Size | None,
) -> None:
    """Place each node that has no position yet at the free position nearest to its neighbours."""
    names = list(sizes)
    if all(name in positions for name in names):
        return
    number = {name: i for i, name in enumerate(names)}
    neighbours: dict[str, list[str]] = {name: [] for name in names}
    for a, b in links:
        neighbours[a].append(b)
        neighbours[b].append(a)
    standing = {name: (positions[name]["x"], positions[name]["y"]) for name in names if name in positions}
    lines = {(a, b): (standing[a], standing[b]) for a, b in links if a in standing and b in standing}
    waiting = [name for name in names if name not in standing]
    # those that have a neighbour in place go first, so that the others can go beside them
    ready = [number[name] for name in waiting if any(other in standing for other in neighbours[name])]
    later = iter(waiting)
    effort = EFFORT
    while len(standing) < len(names):
        name = names[heappop(ready)] if ready else next(later)
        if name in standing:
            continue
        near = [standing[other] for other in neighbours[name] if other in standing]
        if name == ANY and standing:
            near = [left_of(standing, sizes, links)]
        elif not near:
            before = (one for one in reversed(names[: number[name]]) if one in standing and one != ANY)
            near = [standing[one] for one in islice(before, 1)]
        place, effort = free_place(sizes[name], near, taken, list(lines.values()), effort, panel)
        if place is None:
            _add_below(positions, {name: sizes[name] for name in names if name not in standing}, links)
            return
        x, y = standing[name] = place
        positions[name] = Position(x=x, y=y)
        taken.add(Rect(x, y, *sizes[name]))
        for other in neighbours[name]:
            if other in standing:
                lines[name, other] = (x, y), standing[other]
            else:
                heappush(ready, number[other])


def _add_below(positions: dict[str, Position], sizes: Mapping[str, Size], links: Sequence[Link]) -> None:
    """Arrange nodes by themselves, below all others: a simpler drawing of what would take too long."""
    inside = [link for link in links if link[0] in sizes and link[1] in sizes]
    places = arrange(sizes, inside, ())
    left = min((place["x"] for place in positions.values()), default=0.0)
    low = max((place["y"] for place in positions.values()), default=0.0) + 2 * CELL
    x0 = left - min(x for x, _ in places.values())
    y0 = low - min(y for _, y in places.values())
    positions.update(
        {name: Position(x=round(x + x0, 1), y=round(y + y0, 1)) for name, (x, y) in places.items()}
    )


def free_place(
    size: Size,
    towards: Sequence[Point],
    taken: Cells,
    lines: Sequence[Line],
    effort: int,
    panel: Size | None,
) -> tuple[Point | None, int]:
    """Return the free position nearest to some points, and the effort that is left.

    `size`: width and height of the node to place, in px.
    `towards`: positions of its neighbours.
    `taken`: rectangles to keep away from.
    `lines`: edges that it should not cover.
    `effort`: how many nodes and edges may be compared. If that is not enough to find a position, there is
        none.
    `panel`: width and height of the panel that shows it: in a wide one a position beside is nearer than one
        below.
    """
    wide = min(STRETCH, max(1 / STRETCH, panel[0] / panel[1])) if panel else 1.0
    along, down = max(1.0, 1 / wide), max(1.0, wide)
    towards = towards or [(0.0, 0.0)]
    x0 = sum(x for x, _ in towards) / len(towards)
    y0 = sum(y for _, y in towards) / len(towards)
    best: tuple[float, Point] | None = None
    near: Sequence[Line] = ()
    reach = -1  # the rings for which `near` holds the lines
    ring = 0
    while effort > 0 and (best is None or ring * GRID <= best[0]):  # none on a wider ring can cost less
        if ring > reach:
            effort -= len(lines)
            reach = 2 * ring + 8
            square = Rect(x0, y0, 2 * reach * GRID + size[0] + 2.0, 2 * reach * GRID + size[1] + 2.0)
            near = [line for line in lines if square.crossed_by(*line, 8.0)]
        for i, j in _ring(ring):
            if effort <= 0:
                break
            x, y = round(x0 + i * GRID, 1), round(y0 + j * GRID, 1)
            cost = math.hypot((x - x0) * along, (y - y0) * down) + 6.0 * (y < y0) + 3.0 * (x < x0)
            if best is not None and cost >= best[0]:
                continue
            box = Rect(x, y, *size)
            effort -= 1
            if any(box.overlaps(other, GAP_X, GAP_Y) for other in taken.near(box, GAP_X)):
                continue
            effort -= len(near)
            cost += 60.0 * sum(box.crossed_by(start, end, 8.0) for start, end in near)
            for point in towards:
                between = set(taken.along(point, (x, y)))
                effort -= 5 + len(between) + int(math.dist(point, (x, y)) / CELL)
                cost += 40.0 * sum(
                    other.crossed_by(point, (x, y)) for other in between if not other.holds(point)
                )
            if best is None or cost < best[0]:
                best = (cost, (x, y))
        ring += 1
    return (None if best is None else best[1]), effort


def _ring(radius: int) -> list[tuple[int, int]]:
    if radius == 0:
        return [(0, 0)]
    steps = range(-radius, radius + 1)
    edge = [(i, j) for i in steps for j in (radius, -radius)]
    return edge + [(i, j) for j in steps[1:-1] for i in (radius, -radius)]
