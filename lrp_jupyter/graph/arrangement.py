"""The first arrangement of a machine: layers of states, ordered so that few arrows cross.

Sugiyama's method: layers by the longest path, the order inside the layers by sweeps, then the coordinates.
Machines with many arrows per state are an ellipse in the order of the text. (No library does it:
python-igraph's layout crashed the whole process on some graphs, and a crash would take a notebook's kernel
along.)
"""

from __future__ import annotations

import math
from bisect import bisect_right, insort
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import accumulate, combinations, pairwise

from lrp_jupyter.graph.geometry import Point, Rect, Size
from lrp_jupyter.graph.state_graph import ANY

Link = tuple[str, str]
Node = tuple[int, int]  # number of a name and 0, or of an edge (from -1 down) and the layer that it passes

GAP_X, GAP_Y = 76.0, 60.0  # px: least room between two states, so that an arrow and its label fit
LAYER = 108.0  # px: from the middle of one layer to the middle of the next
LABEL_GAP = 124.0  # px: room between two layers beside each other, for an arrow and its label
AROUND = 90.0  # px: width and height of what is around the states: frame, name and labels
LEGIBLE = 9.0 / 11.5  # scale at which labels are 9 px high: what would be shown smaller is scrolled
WELL = 0.87  # scale at which narrow layers fill the panel
CLEARLY = 1.1  # how much larger layers beside each other must be shown than layers below each other
TALL = 13  # layers above which an arrangement is folded into columns in any panel
SMALL = 12  # states up to which swapping neighbours is tried
SWEEPS, FEW_SWEEPS = 12, 4  # that improve the order in the layers; few for over PASSED places
PASSED = 2_000  # places that edges may have in the layers that they pass; longer edges have none


def is_dense(names: Sequence[str], links: Sequence[Link]) -> bool:
    """Return whether there are too many edges for layers to help: more than 2.5 per state."""
    return len(links) > 2.5 * len(names)


def arrange(
    sizes: Mapping[str, Size], links: Sequence[Link], starts: Sequence[str] = (), panel: Size | None = None
) -> dict[str, Point]:
    """Arrange a machine for the first time: return the middle of every node, in px.

    Layers by longest path, the start state first and ``*`` at the left; an ellipse in the order of
    the text where edges are dense.

    `sizes`: width and height of every node in px, in the order of the text.
    `links`: one for each edge; both ends are in `sizes`.
    `panel`: width and height of the panel that shows it, in px: the layers lie below or beside each other,
        are narrow ones, or turn back in columns, whichever is shown larger.
    """
    states = [name for name in sizes if name != ANY]
    if not states:
        return {ANY: (0.0, 0.0)} if ANY in sizes else {}
    if is_dense(list(sizes), links):
        places = _with_any(_ellipse(states, sizes, len(links), panel), sizes, links)
    else:
        places = _layered(states, sizes, links, starts, panel)
    return {name: (round(x, 1), round(y, 1)) for name, (x, y) in places.items()}


def _ellipse(
    states: Sequence[str], sizes: Mapping[str, Size], links: int, panel: Size | None
) -> dict[str, Point]:
    count = len(states)
    widest = max(sizes[name][0] for name in states)
    crowd = math.sqrt(max(1.0, links / count / 2.5))
    height = max(90.0, 24.0 * count * crowd + 50.0 * crowd)
    shape = min(2.2, max(0.8, panel[0] / panel[1])) if panel else 1.4
    width = max(height * shape, (widest + GAP_X) * count / (2 * math.pi))
    turn = 2 * math.pi / count
    return {
        name: (width * math.sin(turn * index), -height * math.cos(turn * index))
        for index, name in enumerate(states)
    }


def _with_any(places: dict[str, Point], sizes: Mapping[str, Size], links: Sequence[Link]) -> dict[str, Point]:
    """Return positions with that of ``*``, if there is one."""
    return {**places, ANY: left_of(places, sizes, links)} if ANY in sizes else places


def left_of(places: Mapping[str, Point], sizes: Mapping[str, Size], links: Iterable[Link]) -> Point:
    """Return the position of ``*``: left of everything, at the height of the states that it leads to."""
    left, _ = _extent(places, sizes)
    targets = {target: places[target][1] for source, target in links if source == ANY and target in places}
    ys = list(targets.values()) or [y for _, y in places.values()]
    # from the height of two states side by side one arrow would run into the first of them
    above = LAYER if len(set(ys)) < len(ys) and targets else 0.0
    return left - GAP_X - sizes[ANY][0] / 2, (min(ys) + max(ys)) / 2 - above


def _layered(
    states: Sequence[str],
    sizes: Mapping[str, Size],
    links: Sequence[Link],
    starts: Sequence[str],
    panel: Size | None,
) -> dict[str, Point]:
    names = [*([ANY] if ANY in sizes else []), *states]
    level = layers(names, links, starts or states[:1])
    rows = _ordered(states, names, links, level)
    below, *folded = (_with_any(places, sizes, links) for places in _down(rows, sizes, links, panel))
    if panel is None:
        return below
    right = _with_any(_right(rows, sizes, links), sizes, links)
    narrow_rows = _ordered(names, names, links, _narrowed(level, sizes, links, panel[0] / WELL - AROUND))
    best, largest = below, _scale(below, sizes, panel)
    for places in (right, *_down(narrow_rows, sizes, links, panel), *folded):
        scale = _scale(places, sizes, panel)
        if scale > CLEARLY * largest:
            best, largest = places, scale
    return best


def _ordered(
    shown: Sequence[str], names: Sequence[str], links: Sequence[Link], level: Mapping[str, int]
) -> list[list[str]]:
    """Return the rows of some of the names, each from left to right; ``*`` is in the left half."""
    across = order(names, links, level)
    if ANY in across and 2 * across[ANY] > min(across.values()) + max(across.values()):
        across = {name: -x for name, x in across.items()}
    by_level: dict[int, list[str]] = {}
    for name in shown:
        by_level.setdefault(level[name], []).append(name)
    return [sorted(by_level[depth], key=lambda name: across[name]) for depth in sorted(by_level)]


def _narrowed(
    level: Mapping[str, int], sizes: Mapping[str, Size], links: Sequence[Link], room: float
) -> dict[str, int]:
    """Return layers as wide as the room allows: what leads to nothing just below goes a layer down."""
    found = dict(level)
    for depth in range(len(sizes)):
        row = [name for name in found if found[name] == depth]
        width = sum(sizes[name][0] + GAP_X for name in row) - GAP_X
        for name in reversed(row):
            follows = [found[target] for source, target in links if source == name]
            if width > room and len(row) > 1 and depth + 1 not in follows:
                found[name] = depth + 1
                width -= sizes[name][0] + GAP_X
                row.remove(name)
    return found


def _down(
    rows: list[list[str]], sizes: Mapping[str, Size], links: Sequence[Link], panel: Size | None
) -> list[dict[str, Point]]:
    """Return positions in layers below each other, unless that is too tall, and folded into columns."""
    places = _coordinates(rows, sizes, links)
    if sum(map(len, rows)) <= SMALL:
        rows, places = _improved(rows, places, sizes, links)
    folded = _fold(places, sizes, rows, panel)
    return [folded] if len(rows) > TALL else [places, folded]


def _right(rows: list[list[str]], sizes: Mapping[str, Size], links: Sequence[Link]) -> dict[str, Point]:
    """Return positions in layers beside each other, with room for labels between them."""
    lying = {name: (height, width) for name, (width, height) in sizes.items()}
    places = _coordinates(rows, lying, links)
    if sum(map(len, rows)) <= SMALL:
        rows, places = _improved(rows, places, lying, links)
    found: dict[str, Point] = {}
    left = 0.0
    for row in rows:
        widest = max(sizes[name][0] for name in row)
        found.update({name: (left + widest / 2, places[name][0]) for name in row})
        left += widest + LABEL_GAP
    return found


def _scale(places: Mapping[str, Point], sizes: Mapping[str, Size], panel: Size) -> float:
    """Compute how large an arrangement is shown; where it is scrolled, by how much of it is in view."""
    width, height = (
        max(at[i] + sizes[name][i] / 2 for name, at in places.items())
        - min(at[i] - sizes[name][i] / 2 for name, at in places.items())
        + AROUND
        for i in (0, 1)
    )
    scale = min(1.0, panel[0] / width, panel[1] / height)
    if scale >= LEGIBLE:
        return scale
    return LEGIBLE * min(1.0, panel[0] / (LEGIBLE * width)) * min(1.0, panel[1] / (LEGIBLE * height))


# -- layers ------------------------------------------------------------------------------------------


def layers(names: Sequence[str], links: Iterable[Link], starts: Sequence[str] = ()) -> dict[str, int]:
    """Return the layer of each node: the length of the longest path to it that contains no cycle.

    Circles are opened where a walk from the start states, then from ``*``, then in the order of the text
    comes back to where it is; no edge leads into a start state.
    """
    after = _forward_links(names, links, starts)
    level = dict.fromkeys(names, 0)
    waiting = Counter(target for targets in after.values() for target in targets)
    ready = [name for name in names if not waiting[name]]
    for source in ready:  # grows while it is walked
        for target in after[source]:
            level[target] = max(level[target], level[source] + 1)
            waiting[target] -= 1
            if not waiting[target]:
                ready.append(target)
    return level


def _forward_links(
    names: Sequence[str], links: Iterable[Link], starts: Collection[str]
) -> dict[str, list[str]]:
    """Return where each name leads, each target once, without the links that close a cycle."""
    after: dict[str, list[str]] = {name: [] for name in names}
    first = frozenset(starts)
    for source, target in dict.fromkeys(links):
        if source != target and source in after and target in after and target not in first:
            after[source].append(target)
    entered = {target for targets in after.values() for target in targets}
    roots = [name for name in names if name in first]
    roots += [name for name in names if name == ANY]
    roots += [name for name in names if name not in entered]
    forward: dict[str, list[str]] = {name: [] for name in names}
    seen: set[str] = set()
    for root in [*roots, *names]:
        if root in seen:
            continue
        seen.add(root)
        open_names = {root}
        path = [(root, iter(after[root]))]
        while path:  # a walk in depth, without recursion: machines may be long
            source, targets = path[-1]
            target = next(targets, "")
            if not target:
                open_names.discard(source)
                path.pop()
            elif target not in open_names:
                forward[source].append(target)
                if target not in seen:
                    seen.add(target)
                    open_names.add(target)
                    path.append((target, iter(after[target])))
    return forward


# -- order inside the layers -------------------------------------------------------------------------


def order(
    names: Sequence[str], links: Iterable[tuple[str, str]], level: Mapping[str, int]
) -> dict[str, float]:
    """Return the place of each node across its layer, in units of one place; the middle of a layer is 0.

    `names`: in the order of the text, which decides where nothing else does.
    `links`: directions and links inside a layer do not matter.
    """
    rows, above, below = _rows(names, links, level)
    best, fewest = rows, _crossings(rows, below)
    places = sum(map(len, rows))
    for sweep in range(SWEEPS if places <= PASSED else FEW_SWEEPS):
        if not fewest:
            break
        rows = _swept(rows, above) if sweep % 2 == 0 else _swept(rows[::-1], below)[::-1]
        crossings = _crossings(rows, below)
        if crossings < fewest:
            best, fewest = rows, crossings
    return {
        names[number]: place - (len(row) - 1) / 2
        for row in best
        for place, (number, _) in enumerate(row)
        if number >= 0
    }


def _rows(
    names: Sequence[str], links: Iterable[tuple[str, str]], level: Mapping[str, int]
) -> tuple[list[list[Node]], dict[Node, list[Node]], dict[Node, list[Node]]]:
    """Return the layers in the order of the text, and each node's neighbours above and below."""
    rows: list[list[Node]] = [[] for _ in range(max((level[name] for name in names), default=-1) + 1)]
    number = {name: i for i, name in enumerate(names)}
    for name in names:
        rows[level[name]].append((number[name], 0))
    ends = {
        tuple(sorted(link, key=lambda name: level[name]))
        for link in links
        if level[link[0]] != level[link[1]]
    }
    above: dict[Node, list[Node]] = {}
    below: dict[Node, list[Node]] = {}
    shortest = sorted(ends, key=lambda end: (level[end[1]] - level[end[0]], number[end[0]], number[end[1]]))
    passed_by = accumulate(level[bottom] - level[top] - 1 for top, bottom in shortest)
    shown = [end for end, places in zip(shortest, passed_by, strict=True) if places <= PASSED]
    for edge, (top, bottom) in enumerate(sorted(shown, key=lambda end: (number[end[0]], number[end[1]])), 1):
        passed = [(-edge, depth) for depth in range(level[top] + 1, level[bottom])]
        for node in passed:
            rows[node[1]].append(node)
        chain: list[Node] = [(number[top], 0), *passed, (number[bottom], 0)]
        for upper, lower in pairwise(chain):
            below.setdefault(upper, []).append(lower)
            above.setdefault(lower, []).append(upper)
    return rows, above, below


def _swept(rows: list[list[Node]], before: Mapping[Node, list[Node]]) -> list[list[Node]]:
    """Move every node to the middle of its neighbours in the layer before; those without stay."""
    swept: list[list[Node]] = []
    places: dict[Node, float] = {}
    for row in rows:
        middle = (len(row) - 1) / 2
        wanted = {}
        for place, node in enumerate(row):
            near = before.get(node)
            wanted[node] = sum(places[other] for other in near) / len(near) if near else place - middle
        row = sorted(row, key=lambda node: wanted[node])
        places.update({node: place - middle for place, node in enumerate(row)})
        swept.append(row)
    return swept


def _crossings(rows: Sequence[Sequence[Node]], below: Mapping[Node, list[Node]]) -> int:
    crossings = 0
    for upper, lower in pairwise(rows):
        if len(upper) == 1 or len(lower) == 1:
            continue
        place = {node: i for i, node in enumerate(lower)}
        ended: list[int] = []
        for node in upper:
            ends = sorted(place[other] for other in below.get(node, ()))
            crossings += sum(len(ended) - bisect_right(ended, end) for end in ends)
            for end in ends:
                insort(ended, end)
    return crossings


# -- coordinates -------------------------------------------------------------------------------------


def _coordinates(
    rows: Sequence[Sequence[str]], sizes: Mapping[str, Size], links: Sequence[Link]
) -> dict[str, Point]:
    """Place each node above the middle of its neighbours, in the given order and with room between."""
    near: dict[str, list[str]] = {name: [] for row in rows for name in row}
    for a, b in dict.fromkeys((min(link), max(link)) for link in links):
        if a != b and a in near and b in near:
            near[a].append(b)
            near[b].append(a)
    weights = {name: float(len(others)) or 0.001 for name, others in near.items()}
    across = {name: 0.0 for row in rows for name in row}
    for _ in range(6):
        before = dict(across)
        for row in (*rows, *reversed(rows)):
            middle = sum(across[name] * weights[name] for name in row) / sum(weights[name] for name in row)
            wanted = [
                sum(across[other] for other in near[name]) / len(near[name]) if near[name] else middle
                for name in row
            ]
            across.update(zip(row, _apart(wanted, row, sizes, weights), strict=True))
        if across == before:
            break
    down = _depths(rows, sizes)
    return {name: (across[name], down[depth]) for depth, row in enumerate(rows) for name in row}


def _depths(rows: Sequence[Sequence[str]], sizes: Mapping[str, Size]) -> list[float]:
    """Return the middle of each layer."""
    heights = [max(sizes[name][1] for name in row) for row in rows]
    steps = [max(LAYER, (a + b) / 2 + GAP_Y) for a, b in pairwise(heights)]
    return list(accumulate(steps, initial=0.0))


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
    """Return the length of the edges, plus penalties for crossings and for edges through nodes."""
    ends = dict(places)
    if ANY in sizes:
        ends[ANY] = left_of(places, sizes, links)
    pairs = [pair for pair in dict.fromkeys(tuple(sorted(link)) for link in links) if pair[0] != pair[1]]
    total = 0.0
    for k, (a, b) in enumerate(pairs):
        total += math.dist(ends[a], ends[b])
        for name, point in places.items():
            if name not in (a, b):
                total += 150.0 * Rect(*point, *sizes[name]).crossed_by(ends[a], ends[b], 6.0)
        for c, d in pairs[:k]:
            if not {a, b} & {c, d}:
                total += 120.0 * _cross(ends[a], ends[b], ends[c], ends[d])
    return total


def _cross(a: Point, b: Point, c: Point, d: Point) -> bool:
    def turn(p: Point, q: Point, r: Point) -> float:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    return turn(a, b, c) * turn(a, b, d) < 0 and turn(c, d, a) * turn(c, d, b) < 0


def _fold(
    places: Mapping[str, Point], sizes: Mapping[str, Size], rows: Sequence[Sequence[str]], panel: Size | None
) -> dict[str, Point]:
    """Fold a tall arrangement into columns, up and down in turn, so that neighbours stay near."""
    left, right = _extent(places, sizes)
    wide = right - left + 1.5 * GAP_X
    shape = panel[0] / panel[1] if panel else 1.0
    layer = max((b - a for a, b in pairwise(_depths(rows, sizes))), default=LAYER)
    tall = math.ceil(math.sqrt(len(rows) * wide / layer / shape))  # of the panel's shape
    tall = math.ceil(len(rows) / math.ceil(len(rows) / tall))
    folded: dict[str, Point] = {}
    for first in range(0, len(rows), tall):
        is_up = first // tall % 2 == 1
        column = {
            name: (-places[name][0] if is_up else places[name][0], layer * (tall - 1 - at if is_up else at))
            for at, row in enumerate(rows[first : first + tall])
            for name in row
        }
        beside = right + 1.5 * GAP_X - _extent(column, sizes)[0] if folded else 0.0
        folded |= {name: (x + beside, y) for name, (x, y) in column.items()}
        right = _extent(folded, sizes)[1]
    return folded


def _extent(places: Mapping[str, Point], sizes: Mapping[str, Size]) -> tuple[float, float]:
    """Return how far some states reach to the left and to the right."""
    return (
        min(x - sizes[name][0] / 2 for name, (x, _) in places.items()),
        max(x + sizes[name][0] / 2 for name, (x, _) in places.items()),
    )
