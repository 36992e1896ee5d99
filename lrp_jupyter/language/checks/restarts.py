"""544: counters that a `running` sets back at every tick."""

from __future__ import annotations

import ast
from functools import lru_cache

from lrp_jupyter.language.checks.report import Reporter
from lrp_jupyter.language.checks.scanned import scanned
from lrp_jupyter.language.checks.uses import number_of
from lrp_jupyter.language.program import Span
from lrp_jupyter.language.resolution import Resolution


def check_restarts(report: Reporter, names: Resolution) -> None:
    """Report what counts from the same number at every tick."""
    for place in names.all_blocks:
        if place.element.kind == "running":
            for name, text, span in _restarted(place.block.text):
                message = f"`{name}` starts again from {text} at every tick, because `running` is repeated."
                remedy = "Move this line into `onentry`."
                if name not in place.visible:
                    remedy = f"Declare `(var {name} := [{text}])`, and remove this line."
                report.add("LRP544", place.block.at(span), f"{message} {remedy}")


@lru_cache(maxsize=20_000)
def _restarted(text: str) -> tuple[tuple[str, str, Span], ...]:
    """Return the names that a block sets to a number and then counts on, with that number and its place."""
    block = scanned(text, ("+=", "-=", "+ ", "- "))
    first: dict[str, tuple[str, Span]] = {}
    found = []
    for statement in block.tree.body if block is not None else ():
        target = statement.targets[0] if isinstance(statement, ast.Assign) else None
        if isinstance(statement, ast.AugAssign):
            target = statement.target
        if block is None or not isinstance(target, ast.Name):
            continue
        name = target.id
        if isinstance(statement, ast.Assign) and number_of(statement.value) is not None:
            first[name] = ast.unparse(statement.value), block.span(statement)
        elif name in first and _counts(statement, name):
            found.append((name, *first.pop(name)))
    return tuple(found)


def _counts(statement: ast.stmt, name: str) -> bool:
    """Return whether a statement adds a number to a name."""
    if isinstance(statement, ast.AugAssign):
        return number_of(statement.value) is not None
    value = statement.value if isinstance(statement, ast.Assign) else None
    if not isinstance(value, ast.BinOp) or not isinstance(value.op, ast.Add | ast.Sub):
        return False
    return isinstance(value.left, ast.Name) and value.left.id == name and number_of(value.right) is not None
