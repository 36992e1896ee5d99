"""Where states stand from one edit to the next.

A place belongs to a name, whatever has that name: a state, the missing end of a dangling
transition, or for a while nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from lrp_jupyter.graph.places import Box, Link, Size, arrange, free_place, left_of
from lrp_jupyter.graph.shapes import Layout, Place
from lrp_jupyter.graph.state_graph import ANY

__all__ = ["RESERVED", "remembered_places"]

RESERVED = 30.0
"""How long the place of a removed state stays free, in seconds."""
USUAL: Size = (80.0, 36.0)
"""Room kept for a removed state, in px."""


def remembered_places(
    sizes: Mapping[str, Size],
    states: Sequence[str],
    links: Sequence[Link],
    starts: Sequence[str],
    previous: Layout | None,
    pinned: Mapping[str, Sequence[float]],
    renamed: Mapping[str, str],
    now: float,
) -> dict[str, Place]:
    """Give every node a place: its old one, the one it was dragged to, or a free one.

    Parameters
    ----------
    sizes : mapping of str to (float, float)
        Width and height of every node in px, in the order of the text.
    states : sequence of str
        Those of them that are states of the program.
    links : sequence of (str, str)
        One for each arrow between two of them.
    starts, previous, pinned, renamed, now
        As for :func:`~lrp_jupyter.graph.layout.layout`.

    Returns
    -------
    dict of str to Place
        First those of `sizes` in their order, then those that are kept free.
    """
    places: dict[str, Place] = {}
    if previous is not None:
        places = _kept(previous, sizes, renamed or _retyped(previous, states), now)
    for name, (x, y) in pinned.items():
        if name in sizes:
            places[name] = Place(x=round(float(x), 1), y=round(float(y), 1), pinned=True)
    if all(place.get("pinned") for name, place in places.items() if name in sizes):
        for name, (x, y) in arrange(sizes, links, starts).items():
            mine = Box(x, y, *sizes[name])
            if name not in places and not any(mine.overlaps(box, 8.0, 8.0) for box in _taken(places, sizes)):
                places[name] = Place(x=x, y=y)
    _settle(places, sizes, [link for link in links if link[0] != link[1]])
    ordered = [*sizes, *(name for name in places if name not in sizes)]
    return {name: places[name] for name in ordered}


def _kept(
    previous: Layout, sizes: Mapping[str, Size], renamed: Mapping[str, str], now: float
) -> dict[str, Place]:
    """Places of the last layout that still count."""
    places: dict[str, Place] = {}
    for name, place in previous["places"].items():
        kept = Place(x=place["x"], y=place["y"])
        if place.get("pinned"):
            kept["pinned"] = True
        new = renamed.get(name, name)
        if new not in sizes:
            kept["gone"] = place.get("gone", now)
            if now - kept["gone"] >= RESERVED:
                continue
        if new not in places or name in renamed:  # a renamed state goes before a missing end of that name
            places[new] = kept
    return places


def _retyped(previous: Layout, states: Sequence[str]) -> dict[str, str]:
    """Find the state whose name is being typed: the only one that differs, in the same order."""
    old = [shape["name"] for shape in previous["states"] if shape["kind"] == "state"]
    if len(old) != len(states):
        return {}
    changed = [(a, b) for a, b in zip(old, states, strict=True) if a != b]
    if len(changed) != 1 or changed[0][1] in old:
        return {}
    return dict(changed)


def _taken(places: Mapping[str, Place], sizes: Mapping[str, Size]) -> list[Box]:
    return [Box(place["x"], place["y"], *sizes.get(name, USUAL)) for name, place in places.items()]


def _settle(places: dict[str, Place], sizes: Mapping[str, Size], links: Sequence[Link]) -> None:
    """Give the nodes that have no place yet the free one nearest to their neighbours."""
    names = list(sizes)
    waiting = [name for name in names if name not in places]
    while waiting:
        # first those that have a neighbour in place already: the others then follow them
        name = max(waiting, key=lambda one: (_has_neighbour(one, links, places), -names.index(one)))
        waiting.remove(name)
        standing = {one: (places[one]["x"], places[one]["y"]) for one in names if one in places}
        near = [standing[other] for pair in links if name in pair for other in pair if other in standing]
        if name == ANY and standing:
            near = [left_of(standing, sizes, links)]
        elif not near:
            before = [one for one in names[: names.index(name)] if one in standing and one != ANY]
            near = [standing[one] for one in before[-1:]]
        lines = [
            (standing[a], standing[b]) for a, b in dict.fromkeys(links) if a in standing and b in standing
        ]
        x, y = free_place(sizes[name], near, _taken(places, sizes), lines)
        places[name] = Place(x=x, y=y)


def _has_neighbour(name: str, links: Iterable[Link], places: Mapping[str, Place]) -> bool:
    return any(name in pair and (pair[0] in places or pair[1] in places) for pair in links)
