"""Which brackets of a text are wrong.

When brackets do not match, or a form stands where it cannot, some bracket is missing or too much, and
everything behind it seems misplaced. This search finds the cheapest explanation: it reads the brackets from
left to right and keeps, for every nesting that is still plausible, the least cost of getting there. Leaving
out a ``)``, or putting one in, costs most; a form that stands in the wrong kind of form costs more than one
bracket; indentation that does not fit costs a little, and so decides between equals.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from lrp_jupyter.language.tokens import LEGAL

__all__ = ["Bracket", "Repair", "repair"]

_BRACKET = 2.0  # one bracket left out or put in
_MISPLACED = 3.0
_OUTDENTED = 0.4  # a form that begins no further right than the one it stands in
_UNEVEN = 0.2  # a form that does not begin below its sibling
_CLOSING = 0.3  # a `)` that begins a line, but not below the form it closes
_LATER = 1e-6  # of several `)` in a row leave out the last
_WIDTH = 16  # nestings kept
_MARGIN = 4.0  # those that cost this much more than the best are given up


class Bracket(NamedTuple):
    """A bracket of a form, for the search.

    ``keyword`` is empty for a closing one and ``?`` for an unknown keyword; ``column`` is where it stands if it
    is the first in its line, else -1; ``indent`` is that of its line.
    """

    keyword: str
    column: int
    indent: int


class Repair(NamedTuple):
    """What to do with the brackets, which are named by their index in the sequence.

    ``extra``: closing ones that are too much; ``unclosed``: pairs of an opening one and the bracket before which
    its ``)`` is missing (the length of the sequence at the end of the text).
    """

    extra: tuple[int, ...]
    unclosed: tuple[tuple[int, int], ...]


class _Open(NamedTuple):
    keyword: str
    indent: int
    index: int
    sibling: int  # column of the form that it contained last, -1 if none


_Stack = tuple[_Open, ...]
_Edits = tuple[int, int, "_Edits"] | None  # (opening or -1, bracket, those before)
_ROOT = _Open("program", -1, -1, -1)


def repair(sequence: Sequence[Bracket]) -> Repair:
    """Find the cheapest way to make brackets match and forms stand where they may."""
    stacks: dict[tuple[int, ...], tuple[float, _Stack, _Edits]] = {(-1,): (0.0, (_ROOT,), None)}
    for index, bracket in enumerate(sequence):
        found: dict[tuple[int, ...], tuple[float, _Stack, _Edits]] = {}
        step = _open if bracket.keyword else _close
        for key, (cost, stack, edits) in stacks.items():
            for new_key, candidate in step(key, cost, stack, edits, index, bracket):
                if new_key not in found or candidate[0] < found[new_key][0]:
                    found[new_key] = candidate
        if len(found) > 1:
            limit = min(cost for cost, _, _ in found.values()) + _MARGIN
            kept = sorted(
                (item for item in found.items() if item[1][0] <= limit), key=lambda item: item[1][0]
            )
            found = dict(kept[:_WIDTH])
        stacks = found
    count = len(sequence)
    ends = ((cost + _BRACKET * (len(stack) - 1), stack, edits) for cost, stack, edits in stacks.values())
    _, stack, edits = min(ends, key=lambda end: end[0])
    unclosed = [(entry.index, count) for entry in stack[1:]]
    extra = []
    while edits:
        opening, index, edits = edits
        if opening < 0:
            extra.append(index)
        else:
            unclosed.append((opening, index))
    return Repair(tuple(sorted(extra)), tuple(sorted(unclosed)))


_Step = list[tuple[tuple[int, ...], tuple[float, _Stack, _Edits]]]


def _open(
    key: tuple[int, ...], cost: float, stack: _Stack, edits: _Edits, index: int, bracket: Bracket
) -> _Step:
    """Let a form begin here, or after closing one or more of those around it."""
    steps: _Step = []
    while True:
        parent = stack[-1]
        total = cost
        if parent.keyword != "?" and bracket.keyword != "?":
            total += 0 if bracket.keyword in LEGAL.get(parent.keyword, ()) else _MISPLACED
        if bracket.column >= 0:
            total += _OUTDENTED if bracket.column <= parent.indent else 0
            total += _UNEVEN if parent.sibling not in (-1, bracket.column) else 0
            parent = parent._replace(sibling=bracket.column)
        entry = _Open(bracket.keyword, bracket.indent, index, -1)
        steps.append(((*key, index), (total, (*stack[:-1], parent, entry), edits)))
        if len(stack) == 1:
            return steps
        cost += _BRACKET
        edits = (stack[-1].index, index, edits)
        stack = stack[:-1]
        key = key[:-1]


def _close(
    key: tuple[int, ...], cost: float, stack: _Stack, edits: _Edits, index: int, bracket: Bracket
) -> _Step:
    """Let a ``)`` be too much, close the innermost form, or one around it if indentation speaks for that."""
    steps: _Step = [(key, (cost + _BRACKET - index * _LATER, stack, (-1, index, edits)))]
    while len(stack) > 1:
        fits = bracket.column < 0 or bracket.column == stack[-1].indent
        steps.append((key[:-1], (cost if fits else cost + _CLOSING, stack[:-1], edits)))
        if bracket.column < 0 or fits:
            break
        cost += _BRACKET
        edits = (stack[-1].index, index, edits)
        stack = stack[:-1]
        key = key[:-1]
    return steps
