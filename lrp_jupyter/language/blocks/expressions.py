"""Evaluation of a condition's expression that keeps the value of every part.

An answer to "why is this not true?" shows the parts that decide, so the tree of the expression is evaluated
node by node as in Python: operands of `and` and `or` from the left, and only those that are needed.
"""

from __future__ import annotations

import ast
import builtins
import math
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

from lrp_jupyter.errors import NotAValue
from lrp_jupyter.language.blocks.block import read
from lrp_jupyter.language.blocks.builtin_names import degrees
from lrp_jupyter.language.blocks.companions import asked_at_once

Lookup = Callable[[str], Any]

_BINARY: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
    ast.Pow: operator.pow,
    ast.LShift: operator.lshift,
    ast.RShift: operator.rshift,
    ast.BitOr: operator.or_,
    ast.BitXor: operator.xor,
    ast.BitAnd: operator.and_,
    ast.MatMult: operator.matmul,
}
_COMPARISONS: dict[type, Callable[[Any, Any], Any]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Is: operator.is_,
    ast.IsNot: operator.is_not,
    ast.In: lambda left, right: left in right,
    ast.NotIn: lambda left, right: left not in right,
}
_UNARY: dict[type, Callable[[Any], Any]] = {
    ast.Not: operator.not_,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
    ast.Invert: operator.invert,
}
_NAMES = "abs all any bool divmod float int isinstance len max min pow range round sorted str sum tuple"
_PURE = frozenset(
    [getattr(builtins, name) for name in _NAMES.split()]
    + [value for value in vars(math).values() if callable(value)]
    + [degrees]
)
"""Functions that change nothing and depend on their arguments only."""


class UnknownValueError(Exception):
    """The value of a part of an expression is not known; the argument says why, in a sentence."""


@dataclass(frozen=True, slots=True)
class Evaluation:
    """An expression and its parts with their values.

    `values`: the value of every name, attribute, call and arithmetic part that was evaluated, by its text, in
        the order of evaluation; without constants, and what was only asked for an attribute.
    `decides`: the text of the part that determined the result: a comparison, or the smallest part that is
        one operand of `and`, `or` and `not`.
    `decided`: the value of that part: below a `not`, the opposite of the whole.
    `is_whole`: whether that part is the whole expression.
    """

    value: object
    values: Mapping[str, object] = field(default_factory=dict)
    decides: str = ""
    decided: object = None
    is_whole: bool = True


def expression_of(text: str) -> ast.expr | None:
    """Return the tree of a block that is one expression; None for any other block."""
    try:
        tree = read(text).tree
    except SyntaxError:
        return None
    body = tree.body
    return body[0].value if len(body) == 1 and isinstance(body[0], ast.Expr) else None


def names_in(expression: ast.expr) -> frozenset[str]:
    """Return all names in an expression."""
    return frozenset(node.id for node in ast.walk(expression) if isinstance(node, ast.Name))


def evaluate(expression: ast.expr, lookup: Lookup, *, calls: bool = False) -> Evaluation:
    """Evaluate an expression.

    `calls`: whether functions with possible side effects are called; otherwise their value is not known.
    Raises UnknownValueError: a part's value is not known. Raises what `lookup` and the expression raise.
    """
    evaluator = _Evaluator(lookup, calls)
    value = evaluator.of(expression)
    part = evaluator.deciding(expression)
    decided = evaluator.known[id(part)]
    return Evaluation(value, evaluator.values, _text(part), decided, part is expression)


class _Evaluator:
    def __init__(self, lookup: Lookup, calls: bool) -> None:
        self.values: dict[str, object] = {}
        self.known: dict[int, object] = {}  # the values of the nodes, by id
        self._lookup = lookup
        self._calls = calls

    def of(self, node: ast.expr) -> Any:
        value = self._of(node)
        self.known[id(node)] = value
        if isinstance(node, (ast.Name, ast.Attribute, ast.Subscript, ast.Call, ast.BinOp)):
            text = _text(node)
            if not callable(value) and text not in self.values:
                self.values[text] = value
        return value

    def _of(self, node: ast.expr) -> Any:
        match node:
            case ast.Constant(value):
                return value
            case ast.Name(name):
                return self._lookup(name)
            case ast.Attribute() if (path := asked_at_once(node)) and isinstance(
                robot := self._lookup("robot"), NotAValue
            ):
                return getattr(robot, path)
            case ast.Attribute(inner, name):
                value = getattr(self.of(inner), name)
                self.values.pop(_text(inner), None)  # what it was asked for says more
                return value
            case ast.BoolOp(connective, operands):
                for operand in operands:
                    result = self.of(operand)
                    if bool(result) is isinstance(connective, ast.Or):
                        break
                return result
            case ast.Compare(left, comparisons, others):
                before = self.of(left)
                for comparison, other in zip(comparisons, others, strict=True):
                    after = self.of(other)
                    result = _COMPARISONS[type(comparison)](before, after)
                    if not result:
                        break
                    before = after
                return result
            case ast.UnaryOp(kind, operand):
                return _UNARY[type(kind)](self.of(operand))
            case ast.BinOp(left, kind, right):
                return _BINARY[type(kind)](self.of(left), self.of(right))
            case ast.IfExp(test, body, other):
                return self.of(body if self.of(test) else other)
            case ast.Subscript(inner, index) if not isinstance(index, ast.Slice):
                return self.of(inner)[self.of(index)]
            case ast.Tuple(elements):
                return tuple(self.of(element) for element in elements)
            case ast.List(elements):
                return [self.of(element) for element in elements]
            case ast.Call(function, arguments, []) if not any(isinstance(a, ast.Starred) for a in arguments):
                call = self.of(function)
                if not (self._calls or _is_pure(call)):
                    raise UnknownValueError(f"`{_text(node)}` calls a function.")
                return call(*[self.of(argument) for argument in arguments])
        raise UnknownValueError(f"`{_text(node)}` is not evaluated again.")

    def deciding(self, node: ast.expr) -> ast.expr:
        match node:
            case ast.BoolOp(kind, operands):
                known = [each for each in operands if id(each) in self.known]
                last = bool(self.known[id(known[-1])]) is isinstance(kind, ast.Or)
                return self.deciding(known[-1]) if last else node
            case ast.UnaryOp(ast.Not(), operand):
                return self.deciding(operand)
        return node


@lru_cache(maxsize=2_000)  # a condition is evaluated for many ticks
def _text(node: ast.expr) -> str:
    """Return an expression as text; `ast.unparse` adds parentheses to operands that need none."""
    match node:
        case ast.BoolOp(connective, operands):
            is_or = isinstance(connective, ast.Or)
            return (" or " if is_or else " and ").join(
                f"({_text(each)})" if _binds_less(each, is_or) else _text(each) for each in operands
            )
        case ast.UnaryOp(ast.Not(), operand):
            return f"not ({_text(operand)})" if _binds_less(operand, False) else f"not {_text(operand)}"
    return ast.unparse(node)


def _binds_less(node: ast.expr, is_or: bool) -> bool:
    """Return whether an operand of `or`, or of `and` and `not`, needs parentheses."""
    is_and = isinstance(node, ast.BoolOp) and isinstance(node.op, ast.And)
    return isinstance(node, (ast.IfExp, ast.Lambda, ast.BoolOp)) and not (is_or and is_and)


def _is_pure(function: object) -> bool:
    """Return whether a function changes nothing; of a reading's, its class says so."""
    asked = type(getattr(function, "__self__", None))
    try:
        return getattr(function, "__name__", "") in getattr(asked, "QUESTIONS", ()) or function in _PURE
    except TypeError:  # it cannot be hashed
        return False
