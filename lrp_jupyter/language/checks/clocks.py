"""536: clocks of the computer, which run on in a pause and do not follow virtual time."""

from __future__ import annotations

import ast
from functools import lru_cache
from typing import NamedTuple

from lrp_jupyter.language.checks.report import Reporter
from lrp_jupyter.language.checks.scanned import scanned
from lrp_jupyter.language.program import Span
from lrp_jupyter.language.resolution import Resolution

_INSTEAD = "Write `elapsed`, the seconds since the state was entered, or `dt`, those since the last tick."
_NAMES = ("time", "monotonic", "perf_counter", "process_time", "now", "today", "utcnow")
_CLOCKS = {
    *(f"time.{name}{unit}" for name in _NAMES[:4] for unit in ("", "_ns")),
    *(f"{whole}.{name}" for name in _NAMES[4:] for whole in ("datetime", "datetime.datetime")),
}


class _Use(NamedTuple):
    """A use of a clock; `root` is the name outside the block on which it depends, or empty."""

    written: str
    span: Span
    root: str


def check_clocks(report: Reporter, names: Resolution) -> None:
    """Report the clocks of the computer that blocks read."""
    for place in names.all_blocks:
        for written, span, root in _uses(place.block.text):
            if not root or (root in report.names and root not in place.visible):  # else it is unknown
                what = "is a clock of the computer: it runs on in a pause, and does not follow virtual time"
                report.add("LRP536", place.block.at(span), f"`{written}` {what}. {_INSTEAD}")


def unimported(text: str, start: int) -> str:
    """Return what to write instead of importing the module at an offset of a block; empty if it is needed."""
    use = next((use for use in _uses(text) if use.span.start == start), None)
    what = "is not imported, and a clock of the computer would not follow virtual time"
    return f"`{use.root}` {what}. {_INSTEAD}" if use else ""


@lru_cache(maxsize=20_000)
def _uses(text: str) -> tuple[_Use, ...]:
    block = scanned(text, _NAMES)
    if block is None:
        return ()
    nodes = [node for node in block.nodes if isinstance(node, ast.Name | ast.Attribute)]
    whole = [(node, *block.whole(node)) for node in nodes if isinstance(node.ctx, ast.Load)]
    return tuple(
        _Use(ast.unparse(node), block.span(node), root) for node, name, root in whole if name in _CLOCKS
    )
