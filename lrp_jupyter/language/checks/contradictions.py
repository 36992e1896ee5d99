"""526: comparisons of one value that contradict each other, or of which one is always true."""

from __future__ import annotations

import ast
import math
from collections import defaultdict
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

from lrp_jupyter.language.blocks.names_in_blocks import Offsets
from lrp_jupyter.language.checks.uses import MIRRORED, SIGNS, number_of
from lrp_jupyter.language.source import Diagnosis


class _Bound(NamedTuple):
    """``x < 50`` is an upper bound, `is_open`, as 50 is not below it."""

    number: float
    is_upper: bool
    is_open: bool


def contradictions(node: ast.BoolOp | ast.Compare, places: Offsets) -> Iterator[Diagnosis]:
    """Yield what is never true, as ``x < 50 and x > 100``, or always true, as ``x < 100 or x > 50``."""
    parts = node.values if isinstance(node, ast.BoolOp) else [node]
    is_or = isinstance(node, ast.BoolOp) and isinstance(node.op, ast.Or)
    if isinstance(node, ast.Compare) and len(node.ops) < 2:
        return
    bounds: dict[str, list[_Bound]] = defaultdict(list)
    for part in parts:
        if isinstance(part, ast.Compare) and not (is_or and len(part.ops) > 1):
            for name, bound in _bounds(part):
                bounds[name].append(bound)
    for name, several in bounds.items():
        lower = [each for each in several if not each.is_upper]
        upper = [each for each in several if each.is_upper]
        if not lower or not upper:
            continue
        strictest = (min, max) if is_or else (max, min)
        above, below = strictest[0](lower, key=_place), strictest[1](upper, key=_place)
        is_gap = above.number > below.number
        meets = above.number == below.number
        start, end = places.start_of(node), places.end_of(node)
        if is_or and not is_gap and not (meets and above.is_open and below.is_open):
            what = f"Every number is above {above.number:g} or below {below.number:g}"
            yield Diagnosis(start, end, "LRP526", f"{what}, so this is always true. Write `and`.", ())
        elif not is_or and (is_gap or (meets and (above.is_open or below.is_open))):
            what = f"`{name}` cannot be above {above.number:g} and below {below.number:g}"
            remedy = "Write `or`" if isinstance(node, ast.BoolOp) else "Swap the numbers"
            yield Diagnosis(start, end, "LRP526", f"{what}, so this is never true. {remedy}.", ())


def _place(bound: _Bound) -> float:
    return bound.number


def _bounds(node: ast.Compare) -> Iterator[tuple[str, _Bound]]:
    """Yield the bounds that a comparison sets for names and readings."""
    operands = [node.left, *node.comparators]
    for (left, right), operator in zip(pairwise(operands), node.ops, strict=True):
        sign = SIGNS.get(type(operator), "")
        for value, other, written in ((left, right, sign), (right, left, MIRRORED.get(sign, ""))):
            number = number_of(other)
            if written in MIRRORED and number is not None and math.isfinite(number) and _is_plain(value):
                yield ast.unparse(value), _Bound(number, "<" in written, "=" not in written)


def _is_plain(node: ast.expr) -> bool:
    """Return whether an expression has the same value wherever it stands in a condition."""
    while isinstance(node, ast.Attribute):
        node = node.value
    return isinstance(node, ast.Name)
