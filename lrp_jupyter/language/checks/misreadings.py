"""Valid Python that does not mean what it seems to, recognised from a block's text alone."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator
from itertools import chain
from typing import Any

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.blocks.names_in_blocks import Offsets
from lrp_jupyter.language.checks.contradictions import contradictions
from lrp_jupyter.language.checks.uses import SIGNS
from lrp_jupyter.language.python.block_suite import children
from lrp_jupyter.language.source import Diagnosis


def misreadings(tree: ast.Module, places: Offsets, shift: int) -> tuple[Diagnosis, ...]:
    """Return what is probably misread in a block, with offsets in its text, which differ by `shift`."""
    found: list[Diagnosis] = []
    level: list[ast.AST] = [tree]
    while level:
        after: list[ast.AST] = []
        for node in level:
            finder = _FINDERS.get(type(node))
            if finder is not None:
                found += finder(node, places)
            if not isinstance(node, ast.JoinedStr):  # positions inside one are wrong before Python 3.12
                after += children([node])
        level = after
    return tuple(diagnosis.shifted(shift) for diagnosis in found)


def _between(first: ast.AST, second: ast.AST, places: Offsets) -> tuple[int, str]:
    """Return the offset after a node, and the text from there to another one."""
    start = places.end_of(first)
    return start, places.source[start : places.start_of(second)]


def _text(node: ast.AST, places: Offsets) -> str:
    return " ".join(places.source[places.start_of(node) : places.end_of(node)].split())


def _is_literal(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and type(node.value) in (int, float, str)


def _assign(node: ast.Assign, places: Offsets) -> Iterator[Diagnosis]:
    start, between = _between(node.targets[-1], node.value, places)
    if isinstance(node.value, ast.UnaryOp) and isinstance(node.value.op, ast.UAdd | ast.USub):
        at = places.start_of(node.value)
        sign = places.source[at]
        after = places.source[at + 1 : at + 2]
        if between.endswith("=") and after.isspace():  # `x =+ 1`
            message = f"`={sign}` assigns a number with a sign. Write `{sign}=` to change the value."
            edit = Edit(start + len(between) - 1, at + 1, f"{sign}=")
            yield Diagnosis(at - 1, at + 1, "LRP518", message, (edit,))
    if not isinstance(node.targets[-1], ast.Tuple | ast.List):
        yield from _comma(node.value, places)


def _comma(node: ast.expr, places: Offsets) -> Iterator[Diagnosis]:
    """Find `0,5` and `5,`, which are not numbers."""
    if not isinstance(node, ast.Tuple) or places.source[places.start_of(node)] == "(":
        return
    start, end = places.start_of(node), places.end_of(node)
    text = places.source[start:end]
    if len(node.elts) == 1 and _is_literal(node.elts[0]):
        last = places.end_of(node.elts[0])
        message = f"The comma after `{_text(node.elts[0], places)}` makes a tuple of it. Remove the comma."
        yield Diagnosis(start, end, "LRP518", message, (Edit(last, end, ""),))
    elif len(node.elts) == 2 and text.replace(",", "", 1).isdigit():
        point = text.replace(",", ".")
        message = f"A decimal number has a point. Write `{point}`."
        yield Diagnosis(start, end, "LRP518", message, (Edit(start, end, point),))


def _halved(node: ast.expr, places: Offsets) -> Iterator[Diagnosis]:
    """Find `x < 0,5`, a comparison and a number."""
    if isinstance(node, ast.Tuple) and len(node.elts) == 2 and isinstance(node.elts[0], ast.Compare):
        first, second = node.elts[0].comparators[-1], node.elts[1]
        start, between = _between(first, second, places)
        if between == "," and _text(first, places).isdigit() and _text(second, places).isdigit():
            point = f"{_text(first, places)}.{_text(second, places)}"
            message = f"A decimal number has a point. Write `{point}`."
            edit = Edit(start, start + 1, ".")
            yield Diagnosis(places.start_of(first), places.end_of(second), "LRP518", message, (edit,))


def _annotated(node: ast.AnnAssign, places: Offsets) -> Iterator[Diagnosis]:
    annotation = node.annotation
    is_value = isinstance(annotation, ast.Constant) and isinstance(annotation.value, int | float | str)
    if node.value is None and is_value:
        start, between = _between(node.target, node.annotation, places)
        at = start + between.index(":")
        edit = Edit(start, places.start_of(node.annotation), " = ")
        yield Diagnosis(at, at + 1, "LRP518", "`:` does not assign. Write `=`.", (edit,))


def _statement(node: ast.Expr, places: Offsets) -> Iterator[Diagnosis]:
    value = node.value
    yield from _halved(value, places)
    if isinstance(value, ast.Tuple) and len(value.elts) == 1 and places.source[places.start_of(value)] != "(":
        last, end = places.end_of(value.elts[0]), places.end_of(value)
        message = "The comma at the end makes a tuple of this. Remove it."
        yield Diagnosis(end - 1, end, "LRP518", message, (Edit(last, end, ""),))
    if isinstance(value, ast.UnaryOp) and isinstance(value.operand, ast.UnaryOp):
        inner = value.operand
        sign = {ast.UAdd: "+", ast.USub: "-"}.get(type(value.op))
        start, first = places.start_of(value), places.start_of(inner.operand)
        if sign and places.source[start:first] == 2 * sign and isinstance(inner.operand, ast.Name):
            end = places.end_of(inner.operand)
            message = f"Python has no `{2 * sign}`. Write `{inner.operand.id} {sign}= 1`."
            edits = (Edit(start, first, ""), Edit(end, end, f" {sign}= 1"))
            yield Diagnosis(start, end, "LRP518", message, edits)


def _compare(node: ast.Compare, places: Offsets) -> Iterator[Diagnosis]:
    left = node.left
    for sign, right in zip(node.ops, node.comparators, strict=True):
        if isinstance(sign, ast.Is | ast.IsNot) and (_is_literal(left) or _is_literal(right)):
            start, between = _between(left, right, places)
            meant = "==" if isinstance(sign, ast.Is) else "!="
            at = start + len(between) - len(between.lstrip())
            word = between.strip()
            message = f"`{' '.join(word.split())}` does not compare values. Write `{meant}`."
            edit = Edit(at, at + len(word), meant)
            yield Diagnosis(at, at + len(word), "LRP528", message, (edit,))
        yield from _comma(right, places)
        left = right


def _alternatives(node: ast.BoolOp, places: Offsets) -> Iterator[Diagnosis]:
    """Find `x == 1 or 2`."""
    first, *others = node.values
    if not isinstance(first, ast.Compare) or len(first.ops) != 1:
        return
    wrong = [other for other in others if _is_literal(other)]
    sign, word = SIGNS.get(type(first.ops[0])), "or" if isinstance(node.op, ast.Or) else "and"
    if not wrong or sign is None or (word == "and" and sign not in ("==", "!=")):  # `x > 1 and 5` is a value
        return
    left = _text(first.left, places)
    meant = "and" if sign == "!=" else word
    value = _text(wrong[0], places)
    message = f"`{value}` is not compared with anything. Write `{meant} {left} {sign} {value}`."
    edits = []
    if word == meant == "or":
        edits = [Edit(places.start_of(other), places.start_of(other), f"{left} {sign} ") for other in wrong]
    start, end = places.start_of(wrong[0]), places.end_of(wrong[0])
    yield Diagnosis(start, end, "LRP527", message, tuple(edits))


def _unfilled(node: ast.Constant, places: Offsets) -> Iterator[Diagnosis]:
    """Find `"light {robot.light.data}"`, which is no f-string."""
    start, end = places.start_of(node), places.end_of(node)
    is_plain = places.source[start : start + 1] in ("'", '"')
    if is_plain and _FILLED.search(str(node.value)) and not places.source.startswith(".format", end):
        message = "Braces are filled in only if `f` stands before the quote. Write `f` there."
        yield Diagnosis(start, end, "LRP518", message, (Edit(start, start, "f"),))


def _power(node: ast.BinOp, places: Offsets) -> Iterator[Diagnosis]:
    right = node.right
    if isinstance(node.op, ast.BitXor) and isinstance(right, ast.Constant) and right.value in (2, 3, 0.5):
        start, between = _between(node.left, right, places)
        at = start + between.find("^")
        if "^" in between:
            message = "`^` combines bits. Write `**` for a power."
            yield Diagnosis(at, at + 1, "LRP518", message, (Edit(at, at + 1, "**"),))


_FILLED = re.compile(r"\{robot\.\w+(\.\w+)*(:[^{}]*)?\}")
_FINDERS: dict[type[ast.AST], Callable[[Any, Offsets], Iterator[Diagnosis]]] = {
    ast.Assign: _assign,
    ast.AugAssign: lambda node, places: _comma(node.value, places),
    ast.AnnAssign: _annotated,
    ast.Expr: _statement,
    ast.Compare: lambda node, places: chain(_compare(node, places), contradictions(node, places)),
    ast.BoolOp: lambda node, places: chain(_alternatives(node, places), contradictions(node, places)),
    ast.Constant: _unfilled,
    ast.BinOp: _power,
}
