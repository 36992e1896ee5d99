"""Blocks: Python between square brackets, from text to a function bound to the program's variables.

A block is any Python, in any layout: it may begin in the middle of a line and go on in others. It is never
dedented as text, which would change its strings. Instead its lines are kept as they are, something is put
before the first one (an indentation, and a header above it if the others are indented too) that makes the whole
a suite of Python, and afterwards the positions in the tree are moved to where the code really stands, so that
a traceback shows the line and the column of the program's text.

To reach the program's variables the block becomes the inner one of two functions. The outer one, never called,
has the variables for its parameters; so the compiler makes them free variables of the inner one, and
:func:`bind` gives it one cell for each. That is as fast as local variables, and nothing is written
into any namespace. Paper: §5.2, where classes are generated instead.
"""

from __future__ import annotations

import ast
import re
import warnings
from functools import lru_cache
from typing import NamedTuple

from lrp_jupyter.language.scanner import block_end, logical_lines

__all__ = ["BlockFacts", "block_end", "facts_of", "parse_block"]

_BLANK = re.compile(r"[ \t\f]*+")


class _Layout(NamedTuple):
    """A block's text made a suite: what stands above and before it, and what its first line lost."""

    header: str
    indent: str
    skipped: int

    def source(self, text: str) -> str:
        return f"{self.header}{self.indent}{text[self.skipped :]}\n"


def parse_block(text: str) -> ast.Module:
    """Parse what stands between the brackets of a block.

    Any layout of the same code gives the same ``ast.dump``. Positions are those of the made-up source, not of
    the text.

    Raises
    ------
    SyntaxError
        With ``lineno``, ``offset``, ``end_lineno`` and ``end_offset`` in `text`, in characters, all from 1.
    """
    return _parse(text)[0]


def _layouts(text: str) -> list[_Layout]:
    skipped = _BLANK.match(text).end()  # type: ignore[union-attr]
    margins = {_BLANK.match(text, start)[0] for start in logical_lines(text)}  # type: ignore[index]
    if text[skipped : skipped + 1] in ("", "\n", "\r", "#"):  # no code in the first line
        margin = min(margins, key=len, default="")
        return [_Layout("if 1:\n" if margin else "", "", 0)]
    layouts = [_Layout("", "", skipped)]
    if margins:
        margin = min(margins, key=len)
        layouts.insert(0, _Layout("if 1:\n" if margin else "", margin, skipped))
    return layouts


def _parse(text: str) -> tuple[ast.Module, _Layout]:
    worst: tuple[tuple[int, int], SyntaxError] | None = None
    for layout in _layouts(text):
        try:
            tree = _python(layout.source(text))
        except SyntaxError as error:
            found = _in_text(error, text, layout)
            place = (found.lineno or 0, found.offset or 0)
            if worst is None or place > worst[0]:
                worst = place, found
            continue
        if layout.header:
            tree.body = tree.body[0].body if tree.body else []  # type: ignore[attr-defined]
        return tree, layout
    assert worst is not None
    raise worst[1] from None


def _python(source: str) -> ast.Module:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SyntaxWarning)
        warnings.simplefilter("ignore", DeprecationWarning)
        try:
            return ast.parse(source)
        except (RecursionError, MemoryError):
            raise SyntaxError("too deeply nested", ("", 1, 1, "", 1, 1)) from None
        except ValueError as error:  # a null character, or half a surrogate pair
            raise SyntaxError(str(error), ("", 1, 1, "", 1, 1)) from None


def _in_text(error: SyntaxError, text: str, layout: _Layout) -> SyntaxError:
    """Move the place of an error from the made-up source to the text."""
    above = layout.header.count("\n")
    shift = layout.skipped - len(layout.indent)

    def move(line: int | None, column: int | None) -> tuple[int, int]:
        line = (line or 1) - above
        column = column or 1
        return max(line, 1), max(column + shift if line <= 1 else column, 1)

    line, column = move(error.lineno, error.offset)
    end_line, end_column = move(error.end_lineno or error.lineno, error.end_offset or error.offset)
    return SyntaxError(error.msg, (error.filename, line, column, error.text, end_line, end_column))


class Fault(NamedTuple):
    """An error of a block: a sentence, and the range of the block's text where it is."""

    message: str
    start: int
    end: int


class Declared(NamedTuple):
    """A name in a `global` statement, and where it stands in the block's text."""

    name: str
    start: int
    end: int


class BlockFacts(NamedTuple):
    """What the parser wants to know of a block, found from its text alone."""

    empty: bool
    fault: Fault | None
    globals: tuple[Declared, ...]


@lru_cache(maxsize=20_000)
def facts_of(text: str) -> BlockFacts:
    """Judge a block by its text: whether it is empty, or no Python."""
    try:
        tree = parse_block(text)
    except SyntaxError as error:
        return BlockFacts(False, _fault(text, error), ())
    return BlockFacts(not tree.body, None, ())


_QUOTED = re.compile(r"'([^']*)'")


def _fault(text: str, error: SyntaxError) -> Fault:
    from lrp_jupyter.language.program import line_starts

    starts = line_starts(text)

    def offset(line: int, column: int) -> int:
        return min(starts[min(line, len(starts)) - 1] + column - 1, len(text))

    start = offset(error.lineno or 1, error.offset or 1)
    end = max(offset(error.end_lineno or 1, error.end_offset or 1), start)
    message = _QUOTED.sub(r"`\1`", error.msg)
    return Fault(f"Python cannot read this block: {message}.", start, end)
