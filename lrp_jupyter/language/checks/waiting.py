"""540 to 543: blocks that wait, and so hold up the whole program: endless loops, sleeping, typing.

Paper: §5.1 (a block runs within one tick).
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

from lrp_jupyter.language.checks.report import Reporter
from lrp_jupyter.language.checks.scanned import ScannedBlock, scanned
from lrp_jupyter.language.program import Span
from lrp_jupyter.language.resolution import Resolution

_MESSAGES = {
    "LRP540": (
        "This loop has no way out, so its block never returns and holds up the whole program. "
        "Remove the loop, because `running` is repeated at every tick, or add a `break`."
    ),
    "LRP541": (
        "Nothing in this loop changes its condition, because sensors are read only once per tick, so it "
        "never ends. Use a state with a transition that tests the condition."
    ),
    "LRP542": (
        "This holds up the whole program: until it returns, nothing else runs and no edit is applied. "
        "Use a state with `ontime` instead."
    ),
    "LRP543": (
        "`input` waits until someone types, and holds up the whole program. Declare a variable, and set its "
        "value while the program runs."
    ),
}
_PURE = frozenset({"abs", "bool", "degrees", "float", "int", "len", "max", "min", "round", "sum"})
"""Functions whose values depend on their arguments alone."""
_SIGNS = ("while", "sleep", "input")
_BINDING = ast.Import | ast.ImportFrom | ast.ExceptHandler | ast.Match
"""Statements that assign names which are not nodes."""
_FUNCTIONS = ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda


class _Wait(NamedTuple):
    """A place where a block waits; `name` is the outside name on which that depends, or empty."""

    code: str
    span: Span
    name: str = ""


def check_waiting(report: Reporter, names: Resolution) -> None:
    """Report the blocks of a program that wait."""
    for place in names.all_blocks:
        for code, span, name in _waits(place.block.text):
            is_unknown = code == "LRP542" and name and name not in report.names  # which is reported as such
            if name not in place.visible and not is_unknown:  # a variable of the program may have any value
                report.add(code, place.block.at(span), _MESSAGES[code])


@lru_cache(maxsize=20_000)
def _waits(text: str) -> tuple[_Wait, ...]:
    block = scanned(text, _SIGNS)
    return () if block is None else tuple(_Waits(block).found())


class _Waits:
    """The places where a block waits, found by what is imported and called in it."""

    def __init__(self, block: ScannedBlock) -> None:
        self._block = block
        calls = [node for node in block.nodes if isinstance(node, ast.Call)]
        self._called = {call.func.id for call in calls if isinstance(call.func, ast.Name)}

    def found(self) -> Iterator[_Wait]:
        """Yield the places where the block waits, in what runs when the block runs."""
        body = reversed(self._block.tree.body)
        nodes: list[tuple[ast.AST, bool]] = [(statement, False) for statement in body]
        while nodes:
            node, caught = nodes.pop()
            if isinstance(node, _FUNCTIONS) and getattr(node, "name", "") not in self._called:
                continue  # it may run on a thread of its own
            if isinstance(node, ast.While):
                yield from self._loop(node, caught)
            elif isinstance(node, ast.Call):
                yield from self._call(node)
            caught = caught or (isinstance(node, ast.Try) and bool(node.handlers))
            nodes += [(child, caught) for child in reversed(list(ast.iter_child_nodes(node)))]

    def _loop(self, loop: ast.While, caught: bool) -> Iterator[_Wait]:
        if caught or _has_way_out(loop):
            return
        if isinstance(loop.test, ast.Constant):
            code = "LRP540" if loop.test.value else ""
        else:
            code = "LRP541" if self._never_changes(loop) else ""
        if code:
            yield _Wait(code, self._block.span(loop, loop.test))

    def _never_changes(self, loop: ast.While) -> bool:
        """Return whether the condition of a loop has the same value each time, for certain."""
        read: set[str] = set()
        for node in ast.walk(loop.test):
            if isinstance(node, ast.Call):
                if not (isinstance(node.func, ast.Name) and node.func.id in _PURE):
                    return False
            elif isinstance(node, ast.Name):
                read.add(node.id)
            elif isinstance(node, ast.NamedExpr | ast.Await | ast.Yield | ast.YieldFrom | ast.GeneratorExp):
                return False
        read -= _PURE
        body = [node for statement in loop.body for node in ast.walk(statement)]
        calls = [node for node in body if isinstance(node, ast.Call)]
        if read == {"robot"}:
            return not any(isinstance(node, ast.Name) and node.id == "robot" for node in _stored(body))
        if calls or any(isinstance(node, _BINDING) for node in body):
            return False
        stored = _stored(body)  # an item may be changed by another name of its list
        return not any(not isinstance(node, ast.Name) or node.id in read for node in stored)

    def _call(self, call: ast.Call) -> Iterator[_Wait]:
        whole, outside = self._block.whole(call.func)
        if whole == "time.sleep":
            yield _Wait("LRP542", self._block.span(call.func), outside)
        elif whole == "input" and outside not in self._block.stored:
            yield _Wait("LRP543", self._block.span(call.func), outside)


def _has_way_out(loop: ast.While) -> bool:
    """Return whether a loop may be left by `break`, `return`, an exception or another task."""
    nodes: list[tuple[ast.AST, bool]] = [(statement, False) for statement in loop.body]
    while nodes:
        node, inner = nodes.pop()
        if isinstance(node, ast.Return | ast.Raise | ast.Assert | ast.Await | ast.Yield | ast.YieldFrom):
            return True
        if isinstance(node, ast.Break) and not inner:
            return True
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in _ENDING:
            return True
        if isinstance(node, _FUNCTIONS | ast.ClassDef):
            continue
        if isinstance(node, ast.While | ast.For | ast.AsyncFor):
            nodes += [(child, True) for child in node.body]
            nodes += [(child, inner) for child in node.orelse]
        else:
            nodes += [(child, inner) for child in ast.iter_child_nodes(node)]
    return False


_ENDING = frozenset({"exit", "quit", "next"})
"""Functions that end a loop by an exception."""


def _stored(nodes: list[ast.AST]) -> list[ast.expr]:
    """Return the names, attributes and items that are assigned or deleted."""
    kinds = ast.Name | ast.Attribute | ast.Subscript
    return [node for node in nodes if isinstance(node, kinds) and not isinstance(node.ctx, ast.Load)]
