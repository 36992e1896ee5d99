"""The order of nodes inside their layers, so that few edges cross.

The classic sweeps of Sugiyama's method: every node goes to the middle of its neighbours in the layer
before, down and up in turn, and the best order of all sweeps counts. An edge over several layers gets a
place in each layer that it passes. (No library does it: python-igraph's layout crashed the whole process
on some graphs, and a crash would take a notebook's kernel along.)
"""

from __future__ import annotations

import itertools
from bisect import bisect_right, insort
from collections.abc import Iterable, Mapping, Sequence

__all__ = ["order"]

_SWEEPS = 12

Node = tuple[int, int]
"""Number of a name and 0, or number of an edge (from -1 down) and the layer that it passes."""


def order(
    names: Sequence[str], links: Iterable[tuple[str, str]], level: Mapping[str, int]
) -> dict[str, float]:
    """Order nodes inside their layers.

    Parameters
    ----------
    names : sequence of str
        In the order of the text, which decides where nothing else does.
    links : iterable of (str, str)
        Directions and links inside a layer do not matter.
    level : mapping of str to int
        The layer of each name, from 0.

    Returns
    -------
    dict of str to float
        The place of each name across its layer, in units of one place; the middle of a layer is 0.
    """
    rows, above, below = _rows(names, links, level)
    best, fewest = rows, _crossings(rows, below)
    for sweep in range(_SWEEPS):
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
    """Give the layers in the order of the text, and each node's neighbours above and below."""
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
    for edge, (top, bottom) in enumerate(sorted(ends, key=lambda end: (number[end[0]], number[end[1]])), 1):
        passed = [(-edge, depth) for depth in range(level[top] + 1, level[bottom])]
        for node in passed:
            rows[node[1]].append(node)
        chain: list[Node] = [(number[top], 0), *passed, (number[bottom], 0)]
        for upper, lower in itertools.pairwise(chain):
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
    for upper, lower in itertools.pairwise(rows):
        place = {node: i for i, node in enumerate(lower)}
        ended: list[int] = []
        for node in upper:
            ends = sorted(place[other] for other in below.get(node, ()))
            crossings += sum(len(ended) - bisect_right(ended, end) for end in ends)
            for end in ends:
                insort(ended, end)
    return crossings
