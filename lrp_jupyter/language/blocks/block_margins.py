"""Margins: changes of the white space before lines that keep strings and the meaning of a block."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable

from lrp_jupyter.language.python.block_suite import parse_suite
from lrp_jupyter.language.python.scanner import logical_lines, strings
from lrp_jupyter.language.source import Block

STEP = 2
"""The columns by which what is inside a form is indented further than the form."""

_BODY = 4  # Python that is indented further than its first line
_MARGIN = re.compile(r"[ \t\f]*+")
_LINE = re.compile(r"(\r\n|\r|\n)([ \t]*+)(?=\S)")


def aligned(text: str, column: int, base: int) -> str:
    """Return the text of a block without white space around it, its lines below its first statement.

    Its first statement stands in `column`, from 0, after the bracket, or on a separate line, :data:`STEP`
    further than `base`, where the line of the bracket begins. A text whose meaning would change is unchanged.
    """
    better = text.strip(" \t").rstrip()
    lines = [_MARGIN.match(text, start)[0] for start in logical_lines(text)]  # type: ignore[index]
    if lines:
        smallest = len(min(lines, key=len))
        below = better[:1] in ("\r", "\n")
        try:
            level = not smallest or below or better[:1] == "#" or bool(parse_suite(text)[1].indent)
        except SyntaxError:
            return text
        target = base + STEP if below else column if level else column + _BODY
        better = _moved(better, target - smallest)
    return better if Block(better) == Block(text) else text


def _moved(text: str, by: int) -> str:
    return reindented(text, strings(text), lambda margin: margin + " " * by if by >= 0 else margin[-by:])


def reindented(text: str, inside: Iterable[tuple[int, int]], margin: Callable[[str], str]) -> str:
    """Return a text with the margins of its lines changed, except the first and those `inside` a string."""
    spans = list(inside)

    def line(match: re.Match[str]) -> str:
        at = match.start()
        return match[0] if any(start < at < end for start, end in spans) else match[1] + margin(match[2])

    return _LINE.sub(line, text)
