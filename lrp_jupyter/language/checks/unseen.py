"""531: calls that look up names as texts, and so see no variable of the program.

Variables are those of a function around the block: Python knows them where the block itself writes them.
"""

from __future__ import annotations

import ast
from functools import lru_cache
from itertools import chain

from lrp_jupyter.language.blocks import read
from lrp_jupyter.language.checks.report import Reporter
from lrp_jupyter.language.names import Offsets
from lrp_jupyter.language.program import Span
from lrp_jupyter.language.resolution import Resolution

_ARGUMENTS = {"eval": 1, "exec": 1, "globals": 0, "locals": 0, "vars": 0, "dir": 0}
"""The functions, each with the number of arguments with which it looks into the block itself."""


def check_unseen(report: Reporter, names: Resolution) -> None:
    """Report the calls that see no variable of the program, where there are some."""
    for place in chain.from_iterable(names.blocks.values()):
        for name, span in _looks(place.block.text):
            if place.visible and name not in place.visible:
                remedy = "Write the name itself in the block"
                if name in ("eval", "exec"):
                    remedy += ', or give the names to it, as in `eval(text, {"x": x})`'
                message = f"`{name}` does not see the variables of the program. {remedy}."
                start = place.block.span.start + 1
                report.add("LRP531", Span(start + span.start, start + span.end), message)


@lru_cache(maxsize=20_000)
def _looks(text: str) -> tuple[tuple[str, Span], ...]:
    if not any(f"{name}(" in text for name in _ARGUMENTS):
        return ()
    try:
        tree, suite, source, _ = read(text)
    except SyntaxError:  # only in a program built by hand; the parser rejects such a block
        return ()
    offsets, nodes = Offsets(source), list(ast.walk(tree))
    stored = {n.id for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    found = []
    for call in nodes:
        if not (isinstance(call, ast.Call) and isinstance(name := call.func, ast.Name)):
            continue
        if name.id not in stored and _ARGUMENTS.get(name.id) == len(call.args) and not call.keywords:
            span = Span(offsets.start_of(name) + suite.shift, offsets.end_of(name) + suite.shift)
            found.append((name.id, span))
    return tuple(found)
