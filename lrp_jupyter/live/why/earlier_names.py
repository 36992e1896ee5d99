"""The names that elements had at another time: edits and renames change them."""

from __future__ import annotations

from collections.abc import Iterable

from lrp_jupyter.language.program import Element, Path
from lrp_jupyter.language.successors import Successors


class Names:
    """The names that elements had at one tick; infinity stands for the present.

    `moves`: for each edit that changed the paths of elements, the tick before it and the map.
    """

    def __init__(self, moves: Iterable[tuple[int, Successors]], tick: float) -> None:
        self._tick = tick
        self._later = [
            (after, {new: old for old, new in successors.moved.items()})
            for after, successors in moves
            if after >= tick
        ]
        self._earlier = [(after, dict(successors.moved)) for after, successors in moves if after < tick]

    def of(self, kind: str, path: Path, at: float) -> Path:
        """Return the path, at this tick, of an element whose path right after tick `at` is given."""
        element = Element(kind, path)
        for after, moved in reversed(self._later):
            if after < at:
                element = moved.get(element, element)
        for after, moved in self._earlier:
            if after >= at:
                element = moved.get(element, element)
        return element.path
