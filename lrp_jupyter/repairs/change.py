"""A change of a program that may repair it: edits of its text, and words for it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from lrp_jupyter.errors import Edit, edited
from lrp_jupyter.live.why.wording import listed


class Topic(NamedTuple):
    """What a change is about; changes of one number have the same; `number`: its place among its kind."""

    kind: str
    number: int


@dataclass(frozen=True)
class Change:
    """One change.

    `phrase`: what it is, as the subject of a sentence: ```lightlim` 121 instead of 128``.
    `size`: how far it is from the program: for a number, how many times it is doubled or halved.
    `value`: the new number; None if it changes something else.
    """

    topic: Topic
    edits: tuple[Edit, ...]
    lines: tuple[int, ...]
    phrase: str
    size: float
    value: float | None = None

    def apply(self, text: str) -> str:
        """Return the text after the change."""
        return edited(text, self.edits)

    @property
    def subject(self) -> str:
        """The phrase, with the lines: ``… (lines 7 and 8)``."""
        lines = [str(line) for line in sorted(set(self.lines))]
        return f"{self.phrase} ({'lines' if lines[1:] else 'line'} {listed(lines, 'and')})"
