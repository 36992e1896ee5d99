"""The map from the elements of a program to those of the program after an edit or a rename.

All state kept per element is carried over by it: issues, counts, a selection. Paper: §6.1, footnote 5.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

from lrp_jupyter.language.program import Element, Path, Program
from lrp_jupyter.language.resolution import resolve

_Kept = TypeVar("_Kept")


@dataclass(frozen=True, slots=True)
class Successors:
    """Maps each element of an old program to that of a new program.

    `moved`: those whose path or label changed. `gone`: the outermost ones missing from the new program.
    """

    moved: Mapping[Element, Element] = field(default_factory=dict)
    gone: tuple[Element, ...] = ()

    def of(self, element: Element) -> Element | None:
        """Return the new element for an element of the old program; None if it is gone."""
        now = self.moved.get(element)
        if now is None and not any(is_inside(element, other) for other in self.gone):
            return element
        return now

    def path(self, kind: str, path: Path) -> Path | None:
        """Return the new path of definition of an element of the old program; None if it is gone."""
        if not self.moved and not self.gone:
            return path
        now = self.of(Element(kind, path))
        return None if now is None else now.path

    def around(self, states: tuple[Path, ...]) -> tuple[Path, ...]:
        """Return the new paths of the states around an instance; one that is gone keeps its own."""
        return tuple([self.path("state", each) or each for each in states])

    def instance(self, before: Program, path: Path) -> Path:
        """Return the new path, as spawned, of an instance of a machine of the old program, `before`."""
        names = resolve(before)
        machine = self.path("machine", names.defined(path)) or path
        around = self.around(names.around(path))
        return (*[name for state in around for name in state[-2:]], machine[-1])

    def carry(self, kept: Mapping[Element, _Kept]) -> dict[Element, _Kept]:
        """Return values kept for elements of the old program, keyed by the elements of the new one."""
        carried = {}
        for element, value in kept.items():
            now = self.of(element)
            if now is not None:
                carried[now] = value
        return carried


def is_inside(element: Element, other: Element) -> bool:
    """Return whether an element is the other one or inside it."""
    has_parts = other.kind in ("machine", "state")
    return element == other or (has_parts and element.path[: len(other.path)] == other.path)


def after_rename(old: Program, new: Program) -> Successors:
    """Return the map of an explicit rename, which does not change the structure of the program."""
    before, after = resolve(old).elements(), resolve(new).elements()
    pairs = zip(before, after, strict=True)
    return Successors({one: other for one, other in pairs if (one, one.label) != (other, other.label)})


def after_undo(program: Program, undone: Sequence[Successors]) -> Successors:
    """Return the map from the elements of a program to what they were before edits, the last edit first.

    An element that an edit added keeps its path; the caller checks whether the earlier program has it.
    """
    steps = [{new: old for old, new in successors.moved.items()} for successors in undone]
    moved = {}
    for element in resolve(program).elements() if steps else ():
        before = element
        for step in steps:
            before = step.get(before, before)
        if (before, before.label) != (element, element.label):
            moved[element] = before
    return Successors(moved)
