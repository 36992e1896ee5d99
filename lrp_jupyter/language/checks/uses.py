"""The uses of a name in a block, such as `robot`, and what is done with each."""

from __future__ import annotations

import ast
import math
from collections.abc import Iterator
from functools import lru_cache
from typing import Literal, NamedTuple

from lrp_jupyter.language.checks.scanned import ScannedBlock, scanned
from lrp_jupyter.language.program import Span
from lrp_jupyter.language.python.block_suite import children

Role = Literal[
    "read", "called", "assigned", "deleted", "stated", "compared", "computed", "tested", "value", "with"
]
"""What is done: `stated` is a statement without an effect, `value` the value of the block."""


class Argument(NamedTuple):
    """An argument of a call; `name` is empty if it has none, `kind` empty if its value is not a literal."""

    name: str
    span: Span
    value: Span
    kind: str = ""
    root: str = ""
    """The name that its value is, if it is one."""
    text: str = ""
    """Its value, if that is a string."""
    assigns: Span | None = None
    """The sign of ``name := value``."""
    number: float | None = None
    """Its value, if that is a number."""


class RobotCall(NamedTuple):
    """A call: where its parentheses are, and its arguments; `is_open` if some are unpacked."""

    brackets: Span
    arguments: tuple[Argument, ...]
    is_open: bool = False


class Other(NamedTuple):
    """The literal with which something is compared."""

    sign: str
    kind: str
    span: Span
    value: object


class Beside(NamedTuple):
    """What something is compared with: a number, or what has a name; ``20 > x`` is read as ``x < 20``.

    `text`: the number as it is written, of which ``degrees(90)`` is one, too; or ``None``.
    """

    sign: str
    span: Span
    number: float | None
    name: str = ""
    text: str = ""


class NameUse(NamedTuple):
    """A use of a name, with the names after it: ``("light", "data")`` for ``robot.light.data``.

    `beside`: the numbers and names with which it, or its ``abs``, is compared.
    `result`: what is done with what a call returns; ``computed`` if it is kept or something of it is read.
    """

    span: Span
    names: tuple[str, ...]
    spans: tuple[Span, ...]
    role: Role
    call: RobotCall | None = None
    other: Other | None = None
    result: Role = "read"
    beside: tuple[Beside, ...] = ()


SIGNS: dict[type[ast.cmpop], str] = {
    ast.Eq: "==", ast.NotEq: "!=", ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=",
}  # fmt: skip
_EQUALITIES: dict[type[ast.cmpop], str] = {ast.Is: "==", ast.IsNot: "!="}
MIRRORED: dict[str, str] = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}
_NEEDS = (ast.Attribute, ast.Subscript, ast.Compare, ast.Assign, ast.AugAssign, ast.AnnAssign, ast.NamedExpr)
_LITERALS: dict[type, str] = {bool: "truth value", int: "number", float: "number", str: "text"}


@lru_cache(maxsize=20_000)
def uses_of(name: str, text: str) -> tuple[NameUse, ...]:
    """Return the uses of a name in a block, in no particular order; none if the block binds it."""
    block = scanned(text, [name])
    if block is None or any(use.writes and use.name == name for use in block.names.found):
        return ()
    names, parents = names_and_parents(block.tree)
    reader = _Uses(parents, block)
    return tuple(reader.use(each) for each in names if each.id == name and isinstance(each.ctx, ast.Load))


def names_and_parents(tree: ast.AST) -> tuple[list[ast.Name], dict[ast.AST, ast.AST]]:
    """Return the names in a block that have a place, from the outside in, and the parent of each node."""
    names: list[ast.Name] = []
    parents: dict[ast.AST, ast.AST] = {}
    level = [tree]
    while level:
        after: list[ast.AST] = []
        for node in level:
            if isinstance(node, ast.JoinedStr):  # positions inside one are wrong before Python 3.12
                continue
            for child in children([node]):
                parents[child] = node
                after.append(child)
                if isinstance(child, ast.Name):
                    names.append(child)
        level = after
    return names, parents


class _Uses:
    def __init__(self, parents: dict[ast.AST, ast.AST], block: ScannedBlock) -> None:
        self.parents, self.block, self.span = parents, block, block.span
        self.last = block.tree.body[-1] if block.tree.body else None

    def use(self, name: ast.Name) -> NameUse:
        node: ast.expr = name
        names, spans = [], []
        while isinstance(parent := self.parents[node], ast.Attribute):
            node = parent
            end = self.span(node).end
            names.append(node.attr)
            spans.append(Span(end - len(node.attr), end))
        use = NameUse(self.span(node), tuple(names), tuple(spans), "read")
        if isinstance(parent, ast.Call) and parent.func is node:
            after = self.parents[parent]
            result = "computed" if isinstance(after, _NEEDS) else self.role(parent, after)
            return use._replace(role="called", call=self.call(parent, use.span.end), result=result)
        if isinstance(parent, ast.Compare):
            return use._replace(
                role="compared", other=self.other(parent, node), beside=self.beside(parent, node)
            )
        return use._replace(role=self.role(node, parent), beside=self._beside_abs(parent))

    def role(self, node: ast.expr, parent: ast.AST) -> Role:
        if isinstance(node, ast.Attribute) and not isinstance(node.ctx, ast.Load):
            return "assigned" if isinstance(node.ctx, ast.Store) else "deleted"
        if isinstance(parent, ast.Expr):
            return "value" if parent is self.last else "stated"
        if isinstance(parent, ast.Return):
            return "value"
        is_signed = isinstance(parent, ast.UnaryOp) and not isinstance(parent.op, ast.Not)
        if is_signed or isinstance(parent, ast.BinOp):
            return "computed"
        if isinstance(parent, ast.BoolOp | ast.UnaryOp | ast.Assert):
            return "tested"
        if isinstance(parent, ast.If | ast.While | ast.IfExp) and parent.test is node:
            return "tested"
        if isinstance(parent, ast.Call) and isinstance(parent.func, ast.Name) and len(parent.args) == 1:
            if parent.func.id in ("bool", "not"):
                return "tested"
            if parent.func.id in ("abs", "round", "int", "float"):
                return "computed"
        return "with" if isinstance(parent, ast.withitem) else "read"

    def call(self, node: ast.Call, start: int) -> RobotCall:
        arguments = [self.argument("", value, self.span(value).start) for value in node.args]
        for keyword in node.keywords:
            if keyword.arg:
                arguments.append(self.argument(keyword.arg, keyword.value, self.span(keyword).start))
        is_open = any(isinstance(value, ast.Starred) for value in node.args)
        is_open |= any(keyword.arg is None for keyword in node.keywords)
        return RobotCall(Span(start, self.span(node).end), tuple(arguments), is_open)

    def argument(self, name: str, value: ast.expr, start: int) -> Argument:
        span, assigns = self.span(value), None
        if isinstance(value, ast.NamedExpr):
            name = value.target.id
            value = value.value
            sign = self.block.source.find(":=", start - self.block.shift) + self.block.shift
            assigns, span = Span(sign, sign + 2), self.span(value)
        root = value.id if isinstance(value, ast.Name) else ""
        text = value.value if isinstance(value, ast.Constant) and isinstance(value.value, str) else ""
        kind, number = _kind(value), number_of(value)
        return Argument(name, Span(start, span.end), span, kind, root, text, assigns, number)

    def other(self, node: ast.Compare, operand: ast.expr) -> Other | None:
        operands = [node.left, *node.comparators]
        place = next(i for i, each in enumerate(operands) if each is operand)
        for other, sign in self._neighbours(node, operands, place):
            if isinstance(other, ast.Constant) and type(other.value) in _LITERALS and type(sign) in SIGNS:
                kind = _LITERALS[type(other.value)]
                return Other(SIGNS[type(sign)], kind, self.span(other), other.value)
        return None

    def beside(self, node: ast.Compare, operand: ast.expr) -> tuple[Beside, ...]:
        operands = [node.left, *node.comparators]
        signs = [SIGNS.get(type(sign), _EQUALITIES.get(type(sign), "")) for sign in node.ops]
        at = next(index for index, each in enumerate(operands) if each is operand)
        around = [(signs[at], operands[at + 1])] if at < len(signs) else []
        around += [(MIRRORED.get(signs[at - 1], signs[at - 1]), operands[at - 1])] if at else []
        return tuple(self._written(sign, other) for sign, other in around if sign)

    def _written(self, sign: str, other: ast.expr) -> Beside:
        number, name = number_of(other), other.id if isinstance(other, ast.Name) else ""
        if isinstance(other, ast.Call) and len(other.args) == 1 and not other.keywords:
            inner = number_of(other.args[0])
            if isinstance(other.func, ast.Name) and other.func.id == "degrees" and inner is not None:
                number = math.radians(inner)
        is_none = isinstance(other, ast.Constant) and other.value is None
        text = ast.unparse(other) if is_none or number is not None else ""
        return Beside(sign, self.span(other), number, name, text)

    def _beside_abs(self, call: ast.AST) -> tuple[Beside, ...]:
        if not (isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "abs"):
            return ()
        around = self.parents[call]
        return self.beside(around, call) if isinstance(around, ast.Compare) else ()

    @staticmethod
    def _neighbours(
        node: ast.Compare, operands: list[ast.expr], place: int
    ) -> Iterator[tuple[ast.expr, ast.cmpop]]:
        if place + 1 < len(operands):
            yield operands[place + 1], node.ops[place]
        if place:
            yield operands[place - 1], node.ops[place - 1]


def number_of(node: ast.AST) -> float | None:
    """Return the number that is written, perhaps with a sign; None for anything else."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
        number = number_of(node.operand)
        return number if number is None or isinstance(node.op, ast.UAdd) else -number
    is_number = isinstance(node, ast.Constant) and type(node.value) in (int, float)
    return node.value if is_number else None  # type: ignore[attr-defined]


def _kind(node: ast.expr) -> str:
    """Return the kind of an argument's value, if it is certain."""
    if isinstance(node, ast.Constant):
        return _LITERALS.get(type(node.value), "None" if node.value is None else "")
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
        return _kind(node.operand) or "number"
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Sub | ast.Mult | ast.Div):
        return "number" if "number" in (_kind(node.left), _kind(node.right)) else ""
    return ""
