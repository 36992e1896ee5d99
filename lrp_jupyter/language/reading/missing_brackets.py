"""Search for the wrong brackets of a text.

When brackets do not match, or a form is where it is not allowed, a bracket is missing or superfluous, and
everything after it seems misplaced. This search finds the cheapest explanation: it reads the brackets from
left to right and keeps, for every nesting that is still plausible, the least cost of reaching it. Removing
or inserting a bracket costs most; a form in the wrong kind of form costs more than one bracket; indentation
that does not fit costs a little, and so decides between equals.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

from lrp_jupyter.language.reading.tokens import LEGAL

_BRACKET = 2.0  # one bracket removed or inserted
_MISPLACED = 3.0
_OUTDENTED = 0.4  # a form that begins no further right than the enclosing one
_UNEVEN = 0.2  # a form that does not begin below its sibling
_CLOSING = 0.3  # a `)` that begins a line, but not below the form it closes
_CUT_OFF = 0.5  # a `)` before a part, such as a block, of which nothing around it has any
_LATER = 1e-6  # of several `)` in a row, remove the last
_LOST = 1.9  # a `(` inserted before a keyword that begins a line
_CLOSED_AT_ONCE = 6
_WIDTH = 12  # nestings kept
_MARGIN = 4.0  # those that cost this much more than the best are dropped


class Bracket(NamedTuple):
    """A bracket of a form, for the search.

    `keyword`: empty for a closing bracket, ``?`` for an unknown keyword.
    `column`: its column if it is the first in its line, else -1.
    `indent`: indentation of its line.
    `lost`: whether there is no ``(``, but a keyword begins the line, so that a ``(`` may be missing.
    `followed`: whether something other than a bracket comes next.
    """

    keyword: str
    column: int
    indent: int
    lost: bool = False
    followed: bool = False


class BracketRepair(NamedTuple):
    """The repair of the brackets, which are identified by their position in the sequence.

    `extra`: closing brackets that are superfluous.
    `lost`: keywords that need a ``(``.
    `unclosed`: an opening bracket, and the one before which its ``)`` is missing (the length of the sequence
        at the end).
    """

    extra: tuple[int, ...]
    lost: tuple[int, ...]
    unclosed: tuple[tuple[int, int], ...]


class _Open(NamedTuple):
    keyword: str
    indent: int
    position: int
    sibling: int  # column of the form that it contained last, -1 if none


_Stack = tuple[_Open, ...]
_Edits = tuple[str, int, int, "_Edits"] | None  # kind, position, for an unclosed one before which; the others
_Candidate = tuple[float, _Stack, _Edits]
_Stacks = dict[tuple[int, ...], _Candidate]
_ROOT = _Open("program", -1, -1, -1)
_OF_FORMS = frozenset({"program", "machine", "state"})  # after their names, they contain nothing but forms


def repair(sequence: Sequence[Bracket]) -> BracketRepair:
    """Return the cheapest repair after which brackets match and forms are where they are allowed.

    Text between two top-level forms at the left margin that is correct by itself is not changed.
    """
    margins = [
        index
        for index, (keyword, column, _, lost, _) in enumerate(sequence)
        if keyword in LEGAL["program"] and not column and not lost
    ]
    cuts = sorted({0, *margins, len(sequence)})
    wrong = [(start, end) for start, end in pairwise(cuts) if not _is_right(sequence[start:end])]
    return _search(sequence, wrong[0][0], wrong[-1][1]) if wrong else BracketRepair((), (), ())


def _is_right(sequence: Sequence[Bracket]) -> bool:
    around = ["program"]
    for keyword, _, _, lost, _ in sequence:
        if lost:
            continue
        if not keyword:
            if len(around) == 1:
                return False
            around.pop()
        else:
            if not _may_stand(keyword, around[-1]):
                return False
            around.append(keyword)
    return len(around) == 1


def _may_stand(keyword: str, around: str) -> bool:
    return "?" in (keyword, around) or keyword in LEGAL.get(around, ())


def _search(sequence: Sequence[Bracket], start: int, end: int) -> BracketRepair:
    """Search between two positions, at which the top level is assumed."""
    stacks: _Stacks = {(-1,): (0.0, (_ROOT,), None)}
    for index in range(start, end):
        bracket = sequence[index]
        found: _Stacks = dict(stacks) if bracket.lost else {}
        step = _open if bracket.keyword else _close
        for key, (cost, stack, edits) in stacks.items():
            for new_key, candidate in step(key, cost, stack, edits, index, bracket):
                if new_key not in found or candidate[0] < found[new_key][0]:
                    found[new_key] = candidate
        if len(found) > 1:
            limit = min([candidate[0] for candidate in found.values()]) + _MARGIN
            kept = [item for item in found.items() if item[1][0] <= limit]
            kept.sort(key=lambda item: item[1][0])
            found = dict(kept[:_WIDTH])
        stacks = found
    ends = ((cost + _BRACKET * (len(stack) - 1), stack, edits) for cost, stack, edits in stacks.values())
    _, stack, edits = min(ends, key=lambda candidate: candidate[0])
    unclosed = [(entry.position, end) for entry in stack[1:]]
    extra, lost = [], []
    while edits:
        kind, position, before, edits = edits
        if kind == "extra":
            extra.append(position)
        elif kind == "lost":
            lost.append(position)
        else:
            unclosed.append((position, before))
    return BracketRepair(tuple(sorted(extra)), tuple(sorted(lost)), tuple(sorted(unclosed)))


_Key = tuple[int, ...]
_Step = list[tuple[_Key, _Candidate]]


def _around(
    key: _Key, cost: float, stack: _Stack, edits: _Edits, index: int
) -> Iterator[tuple[_Key, float, _Stack, _Edits]]:
    """Yield the nesting as it is, then with more and more of its innermost forms closed here."""
    for _ in range(_CLOSED_AT_ONCE):
        yield key, cost, stack, edits
        if len(stack) == 1:
            break
        cost += _BRACKET
        edits = ("unclosed", stack[-1].position, index, edits)
        stack = stack[:-1]
        key = key[:-1]


def _open(key: _Key, cost: float, stack: _Stack, edits: _Edits, index: int, bracket: Bracket) -> _Step:
    """Return the nestings if a form begins here, possibly after closing some of those around it."""
    keyword, column, indent, lost, _ = bracket
    if lost:
        cost += _LOST
        edits = ("lost", index, 0, edits)
    steps: _Step = []
    for inside, total, forms, done in _around(key, cost, stack, edits, index):
        parent = forms[-1]
        if not _may_stand(keyword, parent.keyword):
            total += _MISPLACED
        if column >= 0:
            if column <= parent.indent:
                total += _OUTDENTED
            if parent.sibling not in (-1, column):
                total += _UNEVEN
            parent = parent._replace(sibling=column)
        entry = _Open(keyword, indent, index, -1)
        steps.append(((*inside, index), (total, (*forms[:-1], parent, entry), done)))
    return steps


def _close(key: _Key, cost: float, stack: _Stack, edits: _Edits, index: int, bracket: Bracket) -> _Step:
    """Return the nestings if a ``)`` is superfluous or closes the innermost form or one around it."""
    column = bracket.column
    steps: _Step = [(key, (cost + _BRACKET - index * _LATER, stack, ("extra", index, 0, edits)))]
    for inside, total, forms, done in _around(key, cost, stack, edits, index):
        if len(forms) == 1:
            break
        fits = column < 0 or column == forms[-1].indent
        if bracket.followed and forms[-2].keyword in _OF_FORMS:
            total += _CUT_OFF
        steps.append((inside[:-1], (total if fits else total + _CLOSING, forms[:-1], done)))
        if fits:
            break
    return steps
