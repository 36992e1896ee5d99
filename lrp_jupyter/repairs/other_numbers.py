"""Other values of a number that may repair a program: by factors, and on either side of what was seen."""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Iterable, Iterator

from lrp_jupyter.errors import Edit, Finding
from lrp_jupyter.repairs.change import Change, Topic
from lrp_jupyter.repairs.numbers import Number, Numbers
from lrp_jupyter.repairs.witness import Evidence

_FACTORS = (2, 0.5, -1, 10, 0.1, 1.25, 0.8, 5, 0.2, -0.5, -2)
_SECONDS = 100  # ms; a shorter delay may be meant in seconds
_SIGN, _TO_ZERO, _FROM_ZERO = 2.0, 2.0, 3.5  # how far the other sign is, and nothing, in doublings
_QUANTILES = (0.5, 0.1, 0.9, 0.25, 0.75, 0, 1)
_COMPARED = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
}


def distance(old: float, new: float) -> float:
    """Return how often a number is doubled or halved to become another one."""
    if old == new:
        return 0.0
    if not old or not new:
        return _TO_ZERO if old else _FROM_ZERO
    other = _SIGN if (old < 0) != (new < 0) else 0.0
    return other + abs(math.log2(abs(new / old)))


def rounded(value: float, digits: int, is_whole: bool) -> float:
    """Return a number with few digits; `is_whole`: without a fraction, if that is not too coarse."""
    if not value or not math.isfinite(value):
        return 0
    found = float(f"{value:.{digits}g}")
    return int(found) if found.is_integer() and (is_whole or abs(found) >= 10) else found


def written(value: float) -> str:
    """Return a number as a program writes it."""
    return str(int(value)) if float(value).is_integer() and abs(value) < 1e15 else repr(float(value))


def change_of(numbers: Numbers, index: int, value: float) -> Change:
    """Return the change of a number to another value."""
    number, new = numbers.found[index], written(value)
    old = numbers.text[slice(*number.span)]
    unit = " ms" if number.is_delay else ""
    if number.name:
        after = " after" if number.element.kind == "transition" else ""
        phrase = f"`{number.name}`{after} {new}{unit} instead of {old}{unit}"
    else:
        phrase = f"`{numbers.shown(number, new)}` instead of {numbers.called(index)}"
    line, edits = numbers.drawn.program.place(number.span.start)[0], (Edit(*number.span, new),)
    return Change(Topic("number", index), edits, (line,), phrase, distance(number.value, value), value)


def values_of(numbers: Numbers, index: int, evidence: Evidence) -> list[float]:
    """Return the values to try, the likeliest first; none if the number was not used in the failed run."""
    number = numbers.found[index]
    if evidence.used and index not in evidence.used:
        return []
    if _is_truth(numbers, number, evidence):
        return []
    whole = number.is_delay or (isinstance(number.value, int) and abs(number.value) > 1)
    factors, seen = list(_by_factors(number)), _beside_what_was_seen(number, evidence)
    wanted = [*seen[:1], *factors[:3], *seen[1:3], *factors[3:5], *seen[3:], *factors[5:]]
    values = list(dict.fromkeys(rounded(value, 2, whole) for value in wanted))
    if number.is_delay:
        never = _never_fired(number, evidence)
        values = [each for each in map(round, values) if each > 0 and not (never and each > number.value)]
    return [each for each in values if each != number.value and _differs(numbers, number, each, evidence)]


def doubt_of(numbers: Numbers, index: int, evidence: Evidence, findings: Iterable[Finding] = ()) -> float:
    """Return how much a number is to be doubted: in doublings that a change of it may be larger.

    A check complains of it; its comparison had always the same result; its delay was far from over, or made
    something end that others waited for.
    """
    number = numbers.found[index]
    place = numbers.drawn.program.place
    begin, end = place(number.span.start), place(number.span.end)
    told = any(
        (begin[0], each.column) <= begin and end <= (each.end_line, each.end_column)
        for each in findings
        if each.line == begin[0]
    )
    doubts = (
        3.0 * (told or (number.is_delay and number.value <= 0)),
        0.7 * _is_constant(numbers, number, evidence),
        0.5 * _is_far(numbers, number, evidence),
        0.1 * (number.is_delay and not _never_fired(number, evidence)),
    )
    return sum(doubts)


def _never_fired(number: Number, evidence: Evidence) -> bool:
    is_own = number.element.kind == "transition"
    return is_own and bool(evidence.used) and number.element.path not in evidence.fired


def _is_far(numbers: Numbers, number: Number, evidence: Evidence) -> bool:
    """Return whether a delay was never over, and the states in which it began were left long before."""
    arrow = numbers.drawn.names.arrow(number.element)
    if arrow is None or not _never_fired(number, evidence):
        return False
    home = number.element.path[:-1]
    stays = [evidence.stayed.get((*home, name), 0) for name in arrow.scope.states if arrow.noun.leaves(name)]
    return max(stays, default=0) * 1000 < number.value / 2


def _results(numbers: Numbers, comparison: int, evidence: Evidence, moved: float = 0.0) -> list[bool]:
    """Return the results of a comparison, if its right side had been greater; none if they are not known."""
    compare = _COMPARED.get(numbers.comparisons[comparison].operator)
    pairs = evidence.compared.get(comparison, ())
    return [compare(left, right + moved) for left, right in pairs] if compare else []


def _is_constant(numbers: Numbers, number: Number, evidence: Evidence) -> bool:
    """Return whether the comparisons in which a number is had one result each, though more was compared."""
    results = [_results(numbers, comparison, evidence) for comparison, _ in number.links]
    return bool(results) and all(len(each) > 1 and len(set(each)) == 1 for each in results)


def _by_factors(number: Number) -> Iterator[float]:
    value = number.value
    if value and number.is_delay:
        if abs(value) < _SECONDS:
            yield abs(value) * 1000
        yield from (abs(value) * factor for factor in (1, *_FACTORS) if factor > 0)
    elif value:
        yield from (value * factor for factor in _FACTORS)


def _beside_what_was_seen(number: Number, evidence: Evidence) -> list[float]:
    """Return values in the middle of what the number was compared with, then towards its ends, and beyond.

    Each is the value with which the two sides that were compared would have been equal.
    """
    pairs = ((sign, each) for place, sign in number.links for each in evidence.compared.get(place, ()))
    seen = sorted({number.value + sign * (left - right) for sign, (left, right) in pairs})
    if not seen:
        return []
    margin = max(0.02 * (seen[-1] - seen[0]), 0.01 * abs(seen[-1]), 0.01)
    inside = [seen[round(share * (len(seen) - 1))] for share in _QUANTILES]
    return [*inside, seen[0] - margin, seen[-1] + margin]


def _is_truth(numbers: Numbers, number: Number, evidence: Evidence) -> bool:
    """Return whether the number is compared with what is true or false only, as a bumper is."""
    if not number.is_alone or number.value not in (0, 1):
        return False
    pairs = evidence.compared.get(number.links[0].comparison, [])
    return bool(pairs) and all({left, right} <= {0.0, 1.0} for left, right in pairs)


def _differs(numbers: Numbers, number: Number, value: float, evidence: Evidence) -> bool:
    """Return whether the failed run would have been another with this value, as far as that is known."""
    if not number.is_alone or not evidence.used:
        return True
    comparison, sign = number.links[0]
    before = _results(numbers, comparison, evidence)
    moved = sign * (value - number.value)
    return not before or before != _results(numbers, comparison, evidence, moved)


def nicest(low: float, high: float, is_whole: bool) -> float:
    """Return a round number in the middle of a range, by its logarithm where that is possible."""
    if low * high > 0:
        sign = 1 if low > 0 else -1
        first, last = sorted((abs(low), abs(high)))
        middle, inner = sign * math.sqrt(first * last), (last / first) ** 0.25
        begin, end = sorted((middle / inner, middle * inner))
    else:
        middle = (low + high) / 2
        begin, end = middle - (high - low) / 4, middle + (high - low) / 4
    for digits in (1, 2, 3):
        candidate = rounded(middle, digits, is_whole)
        if begin <= candidate <= end:
            return candidate
    return rounded(middle, 4, is_whole)
