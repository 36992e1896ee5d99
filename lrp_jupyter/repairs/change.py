"""A change of a program that may repair it: edits of its text, and words for it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from lrp_jupyter.errors import Edit, edited


class Topic(NamedTuple):
    """What a change is about; changes of one number have the same.

    `number`: its place among those of its kind.
    `what`: in words, after "changing": ``lightlim``.
    """

    kind: str
    number: int
    what: str


@dataclass(frozen=True)
class Change:
    """One change.

    `phrase`: what it is, as the subject of a sentence: ```lightlim` 121 instead of 128``.
    `size`: how far it is from the program: for a number, how many times it is doubled or halved.
    `value`: the new number; None if it is no number.
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
        """The phrase, with the lines."""
        return f"{self.phrase} ({lines_text(self.lines)})"


def lines_text(lines: Sequence[int]) -> str:
    """Return ``line 7`` or ``lines 7 and 8``."""
    found = sorted(set(lines))
    return f"line {found[0]}" if len(found) == 1 else f"lines {joined(map(str, found), 'and')}"


def joined(words: Iterable[str], last: str) -> str:
    """Return words as a list in a sentence: ``a, b or c``."""
    found = list(words)
    return found[0] if len(found) == 1 else f"{', '.join(found[:-1])} {last} {found[-1]}"
