"""Paths as spawned, told as paths of the text.

What runs is named by the way it was spawned; what is drawn is named by where it is defined. The two
differ where a machine is spawned from elsewhere than the state that holds it.
"""

from __future__ import annotations

from lrp_jupyter.language.program import Path, Program, path_text
from lrp_jupyter.language.resolution import resolve

__all__ = ["Paths"]


class Paths:
    """Tells where in a program's text something that runs is defined."""

    def __init__(self, program: Program) -> None:
        self.machine = resolve(program).defined

    def member(self, spawned: Path) -> Path:
        """Give the path of a state or variable: the last name is its own, the rest is its machine."""
        return (*self.machine(spawned[:-1]), spawned[-1]) if len(spawned) > 1 else spawned

    def lit(self, active: tuple[Path, ...]) -> list[str]:
        """Every active state, the outer ones too, each once, in order."""
        every = (path[:end] for path in active for end in range(2, len(path) + 1, 2))
        return list(dict.fromkeys(path_text(self.member(path)) for path in every))
