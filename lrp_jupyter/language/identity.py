"""What becomes of each element of a program when an edit or a rename makes another program of it.

Whatever is kept per element (issues, counts, a selection, a breakpoint) is carried over by one map,
:class:`Successors`: from an element of the old program to the element of the new one, or to nothing.

Paper: §6.1, footnote 5 (identity of transitions).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeVar

from lrp_jupyter.language.program import Element, Path, Program
from lrp_jupyter.language.resolution import resolve

__all__ = ["Successors", "after_rename", "is_inside"]

_Kept = TypeVar("_Kept")


@dataclass(frozen=True, slots=True)
class Successors:
    """Which element of a new program each element of the old one became.

    Parameters
    ----------
    moved : mapping of Element to Element
        The elements of the old program that have another path or label now.
    gone : tuple of Element
        The outermost ones that the new program does not have; all that was inside them is gone too.
    """

    moved: Mapping[Element, Element] = field(default_factory=dict)
    gone: tuple[Element, ...] = ()

    def of(self, element: Element) -> Element | None:
        """Return what an element of the old program is now; None if it is gone."""
        now = self.moved.get(element)
        if now is None and not any(is_inside(element, other) for other in self.gone):
            return element
        return now

    def path(self, kind: str, path: Path) -> Path | None:
        """Return the path of definition that an element of the old program has now; None if it is gone."""
        if not self.moved and not self.gone:
            return path
        now = self.of(Element(kind, path))
        return None if now is None else now.path

    def carry(self, kept: Mapping[Element, _Kept]) -> dict[Element, _Kept]:
        """Return what is kept for elements of the old program, by the elements of the new one."""
        carried = {}
        for element, value in kept.items():
            now = self.of(element)
            if now is not None:
                carried[now] = value
        return carried


def is_inside(element: Element, other: Element) -> bool:
    """Whether an element is the other one, or stands in it."""
    return element == other or (
        other.kind in ("machine", "state") and element.path[: len(other.path)] == other.path
    )


def after_rename(old: Program, new: Program) -> Successors:
    """Return what an explicit rename makes of each element: the two programs have the same form."""
    before, after = resolve(old).elements(), resolve(new).elements()
    pairs = zip(before, after, strict=True)
    return Successors({one: other for one, other in pairs if (one, one.label) != (other, other.label)})
