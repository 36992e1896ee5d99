"""Variables whose value is written in the program, and what its blocks set."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

from lrp_jupyter.language.checks.scanned import scanned
from lrp_jupyter.language.program import Block, Span
from lrp_jupyter.language.resolution import Resolution, Scope


class WrittenValue(NamedTuple):
    """A literal that is the value of a block, and its place there."""

    block: Block
    value: object
    span: Span

    @property
    def number(self) -> float | None:
        """The value, if that is a number."""
        return self.value if type(self.value) in (int, float) else None  # type: ignore[return-value]


class Constants:
    """The variables of a program that have a literal as their value at first."""

    def __init__(self, names: Resolution) -> None:
        self._changed: set[tuple[Scope, str]] = set()
        self._replaced: set[tuple[Scope, str]] = set()
        for place in names.all_blocks:
            for name, is_replaced in changes(place.block.text):
                if name in place.visible:
                    self._changed.add((place.visible[name], name))
                    if is_replaced:
                        self._replaced.add((place.visible[name], name))
        self._written: dict[tuple[Scope, str], list[WrittenValue]] = {}
        self._first: dict[tuple[Scope, str], WrittenValue] = {}
        for scope in names.scopes:
            for name, variable in scope.variables.items():
                if written := written_in(variable.initial):
                    self._first[scope, name] = written
                    self._written[scope, name] = [written]
        for spawning in names.spawns:
            for setting in spawning.noun.settings if spawning.machine else ():
                assert spawning.machine is not None
                key = spawning.machine, str(setting.name)
                self._changed.add(key)
                if written := written_in(setting.initial):
                    self._written.setdefault(key, []).append(written)

    def number(self, scope: Scope | None, name: str) -> WrittenValue | None:
        """Return what a variable of a scope always is, if that is a number."""
        if scope is None or (scope, name) in self._changed:
            return None
        written = self._first.get((scope, name))
        return written if written is not None and written.number is not None else None

    def begun(self) -> Iterator[tuple[Scope, str, WrittenValue]]:
        """Yield all literals with which variables begin."""
        for (scope, name), several in self._written.items():
            yield from ((scope, name, written) for written in several)

    def is_replaced(self, scope: Scope, name: str) -> bool:
        """Return whether a block sets a variable to something that does not depend on its old value."""
        return (scope, name) in self._replaced


def written_in(block: Block) -> WrittenValue | None:
    """Return the literal that a block is, if it is one."""
    value, span = _literal(block.text)
    return None if span is None else WrittenValue(block, value, span)


@lru_cache(maxsize=20_000)
def _literal(text: str) -> tuple[object, Span | None]:
    """Return the value of a block that is a literal, and its place."""
    block = scanned(text)
    if block is None or len(block.tree.body) != 1 or not isinstance(block.tree.body[0], ast.Expr):
        return None, None
    node = block.tree.body[0].value
    try:
        return ast.literal_eval(node), block.span(node)
    except (ValueError, TypeError, MemoryError, RecursionError):
        return None, None


@lru_cache(maxsize=20_000)
def changes(text: str) -> frozenset[tuple[str, bool]]:
    """Return the names that a block sets, each with whether it does so without their old value."""
    block = scanned(text, ("=", "for", "import", "as", "def", "class", "del"))
    if block is None:
        return frozenset()
    written = Counter(use.name for use in block.names.found if use.writes)
    again: Counter[str] = Counter()
    for node in block.nodes:
        target: ast.expr | None = node.target if isinstance(node, ast.AugAssign) else None
        if isinstance(node, ast.Assign) and len(node.targets) == 1:
            target = node.targets[0]
        if isinstance(target, ast.Name) and (isinstance(node, ast.AugAssign) or _reads(node, target.id)):
            again[target.id] += 1
    return frozenset((name, count > again[name]) for name, count in written.items())


def _reads(node: ast.AST, name: str) -> bool:
    inner = ast.walk(node.value) if isinstance(node, ast.Assign) else ()
    return any(isinstance(each, ast.Name) and each.id == name for each in inner)
