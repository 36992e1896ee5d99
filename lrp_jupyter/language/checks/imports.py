"""The imports of a block, and the full names of what it calls."""

from __future__ import annotations

import ast
from collections.abc import Iterable


def imported(nodes: Iterable[ast.AST]) -> dict[str, str]:
    """Return the names that are imported, each with what it stands for: ``{"sleep": "time.sleep"}``."""
    found = {}
    for node in nodes:
        if isinstance(node, ast.Import | ast.ImportFrom):
            for alias in node.names:
                found[alias.asname or alias.name] = whole_name(node, alias)
    return found


def whole_name(node: ast.Import | ast.ImportFrom, alias: ast.alias) -> str:
    """Return the name of what is imported, with that of its module."""
    return f"{node.module}.{alias.name}" if isinstance(node, ast.ImportFrom) else alias.name


def called(call: ast.Call, known: dict[str, str]) -> tuple[str, str]:
    """Return the whole name of what is called, and the name outside the block on which that depends."""
    name = ast.unparse(call.func) if isinstance(call.func, ast.Name | ast.Attribute) else ""
    root, dot, rest = name.partition(".")
    return known.get(root, root) + dot + rest, "" if root in known else root
