"""531: calls that look up names given as texts, and therefore see no variable of the program.

Variables belong to a function around the block, so Python finds them only where the block itself names them.
"""

from __future__ import annotations

import ast
from functools import lru_cache

from lrp_jupyter.language.checks.report import Reporter
from lrp_jupyter.language.checks.scanned import scanned
from lrp_jupyter.language.program import Span
from lrp_jupyter.language.resolution import Resolution

_ARGUMENTS = {"eval": 1, "exec": 1, "globals": 0, "locals": 0, "vars": 0, "dir": 0}
"""The functions, each with the number of arguments with which it looks into the block itself."""


def check_unseen(report: Reporter, names: Resolution) -> None:
    """Report the calls that see no variable of the program, where there are some."""
    for place in names.all_blocks:
        for name, span in _looks(place.block.text):
            if place.visible and name not in place.visible:
                remedy = "Write the name itself in the block"
                if name in ("eval", "exec"):
                    remedy += ', or give the names to it, as in `eval(text, {"x": x})`'
                message = f"`{name}` does not see the variables of the program. {remedy}."
                report.add("LRP531", place.block.at(span), message)


@lru_cache(maxsize=20_000)
def _looks(text: str) -> tuple[tuple[str, Span], ...]:
    block = scanned(text, (f"{name}(" for name in _ARGUMENTS))
    if block is None:
        return ()
    found = []
    for call in block.nodes:
        if not (isinstance(call, ast.Call) and isinstance(name := call.func, ast.Name)):
            continue
        if name.id not in block.stored and _ARGUMENTS.get(name.id) == len(call.args) and not call.keywords:
            found.append((name.id, block.span(name)))
    return tuple(found)
