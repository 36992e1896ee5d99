"""A block's text as a Python suite: parsed in any layout, with positions that can be mapped back."""

from __future__ import annotations

import ast
import re
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import NamedTuple

from lrp_jupyter.language.python.python_parser import parse_python
from lrp_jupyter.language.python.scanner import LINE_END, logical_lines

DEEPEST = 100
"""Maximum depth of a block's syntax tree."""

_BLANK = re.compile(r"[ \t\f]*+")
_TOO_DEEP = ("too deeply nested", ("", 1, 1, "", 1, 1))
_LINE = re.compile(r"\bline (\d+)")
_UNHEARD = re.compile(r"[\0\ud800-\udfff]")


class Suite(NamedTuple):
    """How a block's text becomes a suite: the lines above, the indentation, the characters skipped."""

    header: str
    indent: str
    skipped: int

    @property
    def shift(self) -> int:
        """The difference of an offset in the block's text and the same one in the source."""
        return self.skipped - len(self.indent) - len(self.header)

    def source(self, text: str) -> str:
        """Return the source of the suite."""
        return f"{self.header}{self.indent}{text[self.skipped :]}\n"


def parse_block(text: str) -> ast.Module:
    """Parse the text of a block: any layout of the same code has the same ``ast.dump``.

    Positions refer to the generated source; those of a SyntaxError to `text`, in characters, from 1.
    """
    return parse_suite(text)[0]


def _suites(text: str) -> list[Suite]:
    skipped = _BLANK.match(text).end()  # type: ignore[union-attr]
    margins = {_BLANK.match(text, start)[0] for start in logical_lines(text)}  # type: ignore[index]
    margin = min(margins, key=len, default="")
    if text[skipped : skipped + 1] in ("", "\n", "\r", "#"):  # no code in the first line
        indent, skipped = "", 0
    else:
        indent = margin
    suites = [Suite("", "", skipped)]
    if margin:
        suites.insert(0, Suite("if 1:\n", indent, skipped))
    return suites


def _body(tree: ast.Module) -> list[ast.stmt]:
    """Return the statements of a suite below its header, or raise if some are outside."""
    header, *rest = tree.body
    assert isinstance(header, ast.If)
    outside = rest + header.orelse
    if outside:
        place = (outside[0].lineno, outside[0].col_offset + 1)
        raise IndentationError(
            "unindent does not match any outer indentation level", ("", *place, "", *place)
        )
    return header.body


def parse_suite(text: str) -> tuple[ast.Module, Suite]:
    """Return the syntax tree of a block's text, and how the text was turned into a suite."""
    match = _UNHEARD.search(text)
    if match:
        lines = LINE_END.split(text[: match.start()])
        line, column = len(lines), len(lines[-1]) + 1
        raise SyntaxError("invalid character", ("", line, column, "", line, column + 1))
    worst: tuple[tuple[int, int], SyntaxError] | None = None
    for suite in _suites(text):
        try:
            tree = _python(suite.source(text))
            if suite.header:
                tree.body = _body(tree)
        except SyntaxError as error:
            found = _in_text(error, text, suite)
            place = (found.lineno or 0, found.offset or 0)
            if worst is None or place > worst[0]:
                worst = place, found
            continue
        return tree, suite
    assert worst is not None
    raise worst[1] from None


@contextmanager
def no_warnings() -> Iterator[None]:
    """Suppress Python's warnings about a user's code; the checks report what matters."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def _python(source: str) -> ast.Module:
    with no_warnings():
        try:
            tree: ast.Module = parse_python(source)
        except (RecursionError, MemoryError):
            raise SyntaxError(*_TOO_DEEP) from None
    if len(source) > DEEPEST and _is_too_deep(tree):
        raise SyntaxError(*_TOO_DEEP)
    return tree


def _is_too_deep(tree: ast.Module) -> bool:
    """Return whether walking the tree recursively could exhaust Python's stack."""
    level: list[ast.AST] = [tree]
    for _ in range(DEEPEST):
        level = children(level)
    return bool(level)


def children(nodes: Iterable[ast.AST]) -> list[ast.AST]:
    """Return the direct children of nodes, several times as fast as :func:`ast.iter_child_nodes`."""
    found = []
    for node in nodes:
        if not node._fields:
            continue  # one object, such as `Load`, for all trees: IPython's tracebacks note a parent in it
        for value in node.__dict__.values():
            if value.__class__ is list:
                found += [item for item in value if isinstance(item, ast.AST)]
            elif isinstance(value, ast.AST):
                found.append(value)
    return found


def _in_text(error: SyntaxError, text: str, suite: Suite) -> SyntaxError:
    """Return an error of the generated source with its position in the text."""
    above = suite.header.count("\n")
    shift = suite.skipped - len(suite.indent)

    def move(line: int | None, column: int | None) -> tuple[int, int]:
        line = (line or 1) - above
        column = column or 1
        return max(line, 1), max(column + shift if line <= 1 else column, 1)

    line, column = move(error.lineno, error.offset)
    end_line, end_column = move(error.end_lineno or error.lineno, error.end_offset or error.offset)
    message = _LINE.sub(lambda number: f"line {max(int(number[1]) - above, 1)}", error.msg)
    return SyntaxError(message, (error.filename, line, column, error.text, end_line, end_column))
