"""A block's tree, with the places of its nodes in the text of the block, and what it imports and calls."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from functools import cached_property

from lrp_jupyter.language.blocks.block import read
from lrp_jupyter.language.blocks.names_in_blocks import Offsets
from lrp_jupyter.language.program import Span


class ScannedBlock(Offsets):
    """The tree of a block and its names; `shift` leads from an offset in `source` to one in its text."""

    def __init__(self, text: str) -> None:
        self.tree, suite, source, self.names = read(text)
        super().__init__(source)
        self.shift = suite.shift

    @cached_property
    def nodes(self) -> list[ast.AST]:
        """All nodes of the tree."""
        return list(ast.walk(self.tree))

    @cached_property
    def stored(self) -> frozenset[str]:
        """The names that the block itself assigns."""
        names = [node for node in self.nodes if isinstance(node, ast.Name)]
        return frozenset(name.id for name in names if isinstance(name.ctx, ast.Store))

    @cached_property
    def imported(self) -> dict[str, str]:
        """The names that it imports, each with what it stands for: ``{"sleep": "time.sleep"}``."""
        found = {}
        for node in self.nodes:
            if isinstance(node, ast.Import | ast.ImportFrom):
                for alias in node.names:
                    found[alias.asname or alias.name] = whole_name(node, alias)
        return found

    def whole(self, node: ast.expr) -> tuple[str, str]:
        """Return the whole name of a name or attribute, and the outside name on which it depends."""
        name = ast.unparse(node) if isinstance(node, ast.Name | ast.Attribute) else ""
        root, dot, rest = name.partition(".")
        return self.imported.get(root, root) + dot + rest, "" if root in self.imported else root

    def span(self, first: ast.AST, last: ast.AST | None = None) -> Span:
        """Return the range of a node, or from one node to the end of another."""
        return Span(self.start_of(first) + self.shift, self.end_of(last or first) + self.shift)

    def between(self, first: ast.expr, sign: str, second: ast.expr) -> Span | None:
        """Return the range of an operator between two expressions."""
        start = self.source.find(sign, self.end_of(first), self.start_of(second)) + self.shift
        return Span(start, start + len(sign)) if start >= self.shift else None


def whole_name(node: ast.Import | ast.ImportFrom, alias: ast.alias) -> str:
    """Return the name of what is imported, with that of its module."""
    return f"{node.module}.{alias.name}" if isinstance(node, ast.ImportFrom) else alias.name


def scanned(text: str, signs: Iterable[str] = ("",)) -> ScannedBlock | None:
    """Return the tree of a block; None if its text has none of the given signs."""
    if not any(sign in text for sign in signs):
        return None
    try:
        return ScannedBlock(text)
    except SyntaxError:  # only in a program built by hand; the parser rejects such a block
        return None
