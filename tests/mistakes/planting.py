"""A mistake, the kinds of mistakes, and how they are planted at random places of correct programs."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache

from .sources import Source, line_of, sources

PER_KIND = 14


@dataclass(frozen=True)
class Mistake:
    """A program with one mistake, and the same program without it.

    `lines` are those of the wrong text at which a reader looks for it: mostly one.
    """

    kind: str
    program: str
    wrong: str
    right: str
    lines: frozenset[int]


@dataclass(frozen=True)
class Slip:
    """A change of a text that is a mistake: replacements of ``text[start:end]``.

    The mistake is at the first of them, or at `at` (offsets in the right text).
    """

    edits: tuple[tuple[int, int, str], ...]
    at: tuple[int, ...] = ()
    right: str = ""
    """Another right text than the program's."""


def slip(start: int, end: int, text: str, *at: int) -> Slip:
    """One replacement."""
    return Slip(((start, end, text),), at)


Planter = Callable[[Source], Iterator[Slip]]
KINDS: dict[str, Planter] = {}


def kind(name: str) -> Callable[[Planter], Planter]:
    """Register a function that yields all places where a kind of mistake can be made."""

    def register(planter: Planter) -> Planter:
        assert name not in KINDS
        KINDS[name] = planter
        return planter

    return register


def applied(text: str, edits: tuple[tuple[int, int, str], ...]) -> str:
    for start, end, new in sorted(edits, key=lambda edit: edit[:2], reverse=True):
        text = text[:start] + new + text[end:]
    return text


def _mistake(name: str, source: Source, found: Slip) -> Mistake:
    edits = sorted(found.edits)
    right = found.right or source.text
    wrong = applied(right, tuple(edits))

    def place(offset: int) -> int:
        """Where an offset of the right text is in the wrong one; if text begins there, its first word."""
        new = next((new for start, _, new in edits if start == offset), "")
        before = sum(len(new) - (end - start) for start, end, new in edits if start < offset)
        return offset + before + len(new) - len(new.lstrip())

    at = [place(offset) for offset in found.at or [edits[0][0]]]
    return Mistake(name, source.name, wrong, right, frozenset(line_of(wrong, each) for each in at))


def _changes(found: Slip, source: Source) -> bool:
    text = found.right or source.text
    return any(text[start:end] != new for start, end, new in found.edits)


def plant(name: str, count: int = PER_KIND, seed: int = 0) -> list[Mistake]:
    """Some mistakes of a kind, at random places of as many programs as possible."""
    chance = random.Random(f"{seed} {name}")
    places = []
    for source in sources():
        slips = [each for each in KINDS[name](source) if _changes(each, source)]
        chance.shuffle(slips)
        if slips:
            places.append((source, slips))
    chance.shuffle(places)
    found = []
    while places and len(found) < count:
        for source, slips in places:
            found.append(_mistake(name, source, slips.pop()))
        places = [place for place in places if place[1]]
    return found[:count]


@cache
def corpus(count: int = PER_KIND, seed: int = 0) -> dict[str, list[Mistake]]:
    """The planted mistakes by kind."""
    return {name: plant(name, count, seed) for name in KINDS}
