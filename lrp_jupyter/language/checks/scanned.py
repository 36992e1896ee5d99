"""The nodes of a block's tree, for checks that look through all of them."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable
from typing import NamedTuple

from lrp_jupyter.language.blocks import read
from lrp_jupyter.language.names import Offsets
from lrp_jupyter.language.program import Span


class ScannedBlock(NamedTuple):
    """All nodes of a block.

    `span_of`: returns where a node is, in the text of the block.
    `stored`: the names that the block itself assigns.
    """

    nodes: list[ast.AST]
    span_of: Callable[[ast.expr | ast.alias], Span]
    stored: frozenset[str]


def scanned(text: str, signs: Iterable[str]) -> ScannedBlock | None:
    """Return the nodes of a block; None if its text has none of the given signs."""
    if not any(sign in text for sign in signs):
        return None
    try:
        tree, suite, source, _ = read(text)
    except SyntaxError:  # only in a program built by hand; the parser rejects such a block
        return None
    offsets, nodes = Offsets(source), list(ast.walk(tree))

    def span_of(node: ast.expr | ast.alias) -> Span:
        return Span(offsets.start_of(node) + suite.shift, offsets.end_of(node) + suite.shift)

    stored = {n.id for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    return ScannedBlock(nodes, span_of, frozenset(stored))
