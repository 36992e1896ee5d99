"""How well mistakes are explained: four figures over planted mistakes."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable
from functools import cache
from typing import NamedTuple

from lrp_jupyter import check
from lrp_jupyter.language.parser import scan
from lrp_jupyter.language.program import Finding, Program

from .planting import Mistake

_NUMBER = re.compile(r"\d+")


class Score(NamedTuple):
    """What the checks say about one mistake.

    Parameters
    ----------
    told : bool
        There is a finding that the right text does not have.
    placed : bool
        The first of those is on a line of the mistake.
    once : bool
        There is exactly one.
    taken_back : bool
        The fix of the first one makes a program equal to the right one.
    """

    told: bool
    placed: bool
    once: bool
    taken_back: bool


@cache
def _right(text: str) -> tuple[Program | None, tuple[Finding, ...]]:
    return scan(text)[0], check(text)


def _same(finding: Finding) -> tuple[str, str]:
    """Return what stays the same of a finding when lines move."""
    return finding.code, _NUMBER.sub("0", finding.message)


def new_findings(mistake: Mistake) -> list[Finding]:
    """Return the findings about a mistake, without those that the right text has, too."""
    before = Counter(map(_same, _right(mistake.right)[1]))
    found = []
    for finding in check(mistake.wrong):
        if before[_same(finding)]:
            before[_same(finding)] -= 1
        else:
            found.append(finding)
    return found


def score(mistake: Mistake) -> Score:
    """Return what the checks say about a mistake."""
    found = new_findings(mistake)
    if not found:
        return Score(False, False, False, False)
    first = found[0]
    taken_back = False
    if first.fix:
        fixed = first.fix.apply(mistake.wrong)
        program = scan(fixed)[0]
        taken_back = program is not None and program == _right(mistake.right)[0]
    return Score(True, first.line in mistake.lines, len(found) == 1, taken_back)


def shares(scores: Iterable[Score]) -> tuple[float, float, float, float]:
    """Return the four figures in percent."""
    rows = list(scores)
    told, placed, once, taken_back = (100 * sum(column) / len(rows) for column in zip(*rows, strict=True))
    return told, placed, once, taken_back
