"""Places and names as a page writes them (see `protocol`): lines and columns from 1, paths as texts."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable
from functools import lru_cache

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.blocks.names_in_blocks import as_path
from lrp_jupyter.language.program import Path, line_starts, path_text
from lrp_jupyter.widgets.wire.protocol import TextEdit, TextRange


@lru_cache(maxsize=2)  # many ranges of one text are converted in a row
def _line_starts(text: str) -> list[int]:
    return line_starts(text)


def edits_view(text: str, edits: Iterable[Edit]) -> list[TextEdit]:
    """Return edits of a text as the page applies them."""
    return [{"range": range_of(text, *span), "text": new} for *span, new in edits]


def range_of(text: str, start: int, end: int) -> TextRange:
    """Convert the characters ``text[start:end]`` to lines and columns."""
    starts = _line_starts(text)
    line, end_line = bisect_right(starts, start), bisect_right(starts, end)
    return {
        "line": line,
        "column": start - starts[line - 1] + 1,
        "end_line": end_line,
        "end_column": end - starts[end_line - 1] + 1,
    }


def offset_of(text: str, line: int, column: int) -> int:
    """Convert a line and a column to a character offset, clamped to the end of the text."""
    starts = _line_starts(text)
    if line > len(starts):
        return len(text)
    return min(starts[line - 1] + column - 1, len(text))


def id_of(kind: str, path: Path) -> str:
    """Return an element's path as the page writes it: a transition's last name comes after a colon."""
    return f"{path_text(path[:-1])}:{path[-1]}" if kind == "transition" else path_text(path)


def path_of(kind: str, text: str) -> Path:
    """Return an element's path from the form in which the page writes it."""
    machine, colon, label = text.partition(":")
    if kind == "transition" and colon:
        return (*machine.split("/"), label)
    return as_path(text) if text else ()
