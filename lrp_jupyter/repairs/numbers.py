"""The numbers in a program's text: where they are, what they are compared with, and how they are shown."""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

from lrp_jupyter.language.checks.scanned import ScannedBlock
from lrp_jupyter.language.edits.drawing import DrawnProgram
from lrp_jupyter.language.program import Element, Name, Span
from lrp_jupyter.language.resolution import Arrow, PlacedBlock, Scope
from lrp_jupyter.language.triggers import Delay

_AMOUNTS = frozenset({"INTEGER", "AMOUNT"})
_Variable = tuple[Scope, str]
_LONGEST = 60  # characters of an expression that is shown around a number


class WrittenComparison(NamedTuple):
    """A comparison of two values: ``text[left] operator text[right]``."""

    left: Span
    right: Span
    operator: type[ast.cmpop]


class Term(NamedTuple):
    """A number that is a term of one side of a comparison; `sign`: with which it counts on the right side."""

    comparison: int
    sign: int


@dataclass(frozen=True)
class Number:
    """A number in a text.

    `shown`: the range of the expression to show it in.
    `name`: the variable that it initialises, or the transition that it delays; may be empty.
    `reads`: where the variable is read; empty if that is not in blocks alone.
    `links`: the comparisons in which it is a term.
    `is_alone`: whether nothing but these comparisons depends on it.
    """

    span: Span
    value: float
    shown: Span
    element: Element
    name: str = ""
    is_delay: bool = False
    reads: tuple[Span, ...] = ()
    links: tuple[Term, ...] = ()
    is_alone: bool = False


class Numbers:
    """The numbers and comparisons of a program, in the order of its blocks.

    Raises LRPSyntaxError: the text is not a valid program.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        self.drawn = drawn = DrawnProgram(text)
        self.found: list[Number] = []
        self.comparisons: list[WrittenComparison] = []
        self._links = defaultdict[Span | _Variable, list[Term]](list)
        self._variables: dict[Span, _Variable] = {}  # of the numbers that initialise one
        self._reads = defaultdict[_Variable, list[Span]](list)
        self._awaited: set[_Variable] = set()  # that delays name
        seen: set[Span] = set()
        for place in drawn.names.all_blocks:
            if place.block.span not in seen:
                seen.add(place.block.span)
                _NumberReader(self, place).read()
        for scope in drawn.names.scopes:
            for arrow in drawn.names.arrows[scope]:
                self._delays(arrow)
        self.found = [self._linked(number) for number in self.found]

    def _linked(self, number: Number) -> Number:
        """Return a number with what all blocks have told of it."""
        variable = self._variables.get(number.span)
        if variable is None:
            links = tuple(self._links[number.span])
            return replace(number, links=links, is_alone=len(links) == 1)
        is_delay = variable in self._awaited
        reads = () if is_delay else tuple(self._reads[variable])
        return replace(number, links=tuple(self._links[variable]), reads=reads, is_delay=is_delay)

    def _delays(self, arrow: Arrow) -> None:
        amounts = [
            Span(*item[1:])
            for item in self.drawn.written(arrow).form.items
            if isinstance(item, tuple) and item[0] in _AMOUNTS
        ]
        for delay in (arrow.noun.trigger, arrow.noun.hold):
            if not isinstance(delay, Delay):
                continue
            if isinstance(delay.amount, Name):
                owner = arrow.scope.owner("variable", delay.amount)
                if owner is not None:
                    self._awaited.add((owner, str(delay.amount)))
            if isinstance(delay.amount, int) and amounts:
                span = amounts[-1 if delay is arrow.noun.hold else 0]
                number = Number(span, delay.amount, span, arrow.element, called(arrow), is_delay=True)
                self.found.append(number)

    def shown(self, number: Number, text: str) -> str:
        """Return the expression around a number, with another text in its place."""
        start, end = number.shown
        whole = self.text[start : number.span.start] + text + self.text[number.span.end : end]
        return whole if len(whole) <= _LONGEST and "\n" not in whole and "`" not in whole else text

    def called(self, index: int) -> str:
        """Return the name of a number, or the expression around it."""
        number = self.found[index]
        return f"`{number.name or self.shown(number, self.text[slice(*number.span)])}`"


class _NumberReader:
    """Reads the numbers of one block."""

    def __init__(self, numbers: Numbers, place: PlacedBlock) -> None:
        self._to, self._place = numbers, place
        self._block = ScannedBlock(place.block.text)

    def _span(self, node: ast.AST) -> Span:
        return self._place.block.at(self._block.span(node))

    def read(self) -> None:
        start, end = self._place.block.span
        self._walk(self._block.tree, Span(start + 1, end - 1))

    def _walk(self, node: ast.AST, shown: Span) -> None:
        if isinstance(node, (ast.JoinedStr, ast.pattern)):
            return
        if isinstance(node, (ast.keyword, ast.Compare, ast.Call, ast.Assign, ast.AugAssign)):
            shown = self._span(node)
        if isinstance(node, ast.Compare) and len(node.ops) <= 2:
            self._compare(node)
        value = number_of(node)
        if value is not None:
            self._number(node, value, shown)
            return
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id in self._place.visible:
            key = self._place.visible[node.id], node.id
            self._to._reads[key].append(self._span(node))
        for child in _children(node):
            self._walk(child, shown)

    def _number(self, node: ast.AST, value: float, shown: Span) -> None:
        place, span, name = self._place, self._span(node), ""
        body = self._block.tree.body
        is_whole = len(body) == 1 and isinstance(body[0], ast.Expr) and body[0].value is node
        if place.purpose == "initialiser" and is_whole:
            name = place.element.path[-1]
            if place.element.kind == "variable":
                self._to._variables[span] = place.scope, name
        is_delay = place.purpose == "delay" and is_whole
        self._to.found.append(Number(span, value, shown, place.element, name, is_delay))

    def _compare(self, node: ast.Compare) -> None:
        sides = [node.left, *node.comparators]
        for left, operator, right in zip(sides, node.ops, sides[1:], strict=False):
            index = len(self._to.comparisons)
            found = WrittenComparison(self._span(left), self._span(right), type(operator))
            self._to.comparisons.append(found)
            for side, towards in ((left, -1), (right, 1)):
                for sign, term in _terms(side, towards):
                    if not isinstance(term, ast.Name):
                        self._to._links[self._span(term)].append(Term(index, sign))
                    elif term.id in self._place.visible:
                        self._to._links[self._place.visible[term.id], term.id].append(Term(index, sign))


def called(arrow: Arrow) -> str:
    """Return the name of a transition, or its source and destination."""
    return str(arrow.noun.name or f"{arrow.noun.source_text} -> {arrow.noun.destination}")


def number_of(node: ast.AST) -> float | None:
    """Return the value of a number as it is written, with its sign; None for anything else."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        value = number_of(node.operand)
        return None if value is None else -value
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        return node.value  # type: ignore[return-value]
    return None


def _children(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the parts of a node, without indices, exponents and numbers of digits."""
    if isinstance(node, ast.Subscript):
        yield node.value
    elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
        yield node.left
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "round":
        yield from node.args[:1]
    else:
        yield from ast.iter_child_nodes(node)


def _terms(node: ast.expr, sign: int) -> Iterator[tuple[int, ast.expr]]:
    """Yield the numbers and names of a sum, each with its sign."""
    if number_of(node) is not None or isinstance(node, ast.Name):
        yield sign, node
    elif isinstance(node, ast.BinOp) and isinstance(node.op, (ast.Add, ast.Sub)):
        yield from _terms(node.left, sign)
        yield from _terms(node.right, sign if isinstance(node.op, ast.Add) else -sign)
