"""The smallest changes between two texts, by lines and, within them, by words."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Callable, Iterator
from difflib import SequenceMatcher

Section = tuple[int, str | None]
"""A length, and its replacement; None if it stays."""

_LINE = re.compile(r"[^\r\n]*(?:\r\n|\r|\n)|[^\r\n]+")
_TOKEN = re.compile("[\ud800-\udbff][\udc00-\udfff]|" r"\w+|\s+|[^\w\s]")
_MOST_LINES, _MOST_WORDS = 3_000, 400  # compared at most, because more would take too long

_Compare = Callable[[str, str], Iterator[Section]]


def text_difference(old: str, new: str) -> Iterator[Section]:
    """Return small changes that turn one text into another, section by section of the old one."""
    return _differences(old, new, _by_lines)


def _differences(old: str, new: str, compare: _Compare) -> Iterator[Section]:
    """Compare two texts without their common start and end."""
    start, end = _common(old, new)
    then, now = old[start : len(old) - end], new[start : len(new) - end]
    yield start, None
    yield from compare(then, now) if then and now else [(len(then), now)]
    yield end, None


def _by_lines(old: str, new: str) -> Iterator[Section]:
    for before, after in _pairs(_LINE.findall(old), _LINE.findall(new), _MOST_LINES):
        if len(before) != len(after):
            before, after = ["".join(before)], ["".join(after)]
        for then, now in zip(before, after, strict=True):
            yield from _differences(then, now, _by_words)


def _by_words(old: str, new: str) -> Iterator[Section]:
    for before, after in _pairs(_TOKEN.findall(old), _TOKEN.findall(new), _MOST_WORDS):
        then, now = "".join(before), "".join(after)
        yield len(then), None if then == now else now


def _pairs(old: list[str], new: list[str], most: int) -> Iterator[tuple[list[str], list[str]]]:
    """Yield the parts of two lists that are equal, or that replace each other."""
    if len(old) + len(new) > most:
        yield old, new
        return
    for _, i, j, k, m in SequenceMatcher(None, old, new, autojunk=False).get_opcodes():
        yield old[i:j], new[k:m]


def _common(old: str, new: str) -> tuple[int, int]:
    """Return the lengths of the common start and end of two texts; no character is split."""
    most = min(len(old), len(new))
    start = bisect_left(range(most), True, key=lambda n: old[: n + 1] != new[: n + 1])
    if start and "\ud800" <= old[start - 1] <= "\udbff":
        start -= 1
    most -= start
    end = bisect_left(range(most), True, key=lambda n: old[-n - 1 :] != new[-n - 1 :])
    if end and "\udc00" <= old[-end] <= "\udfff":
        end -= 1
    return start, end
