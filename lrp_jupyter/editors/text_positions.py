"""Positions of the Language Server Protocol: lines from 0, columns in UTF-16 or other code units.

A line ends with LF, CRLF or CR only, as in the language itself.
"""

from __future__ import annotations

from bisect import bisect_right

from lsprotocol.types import Position, Range, TextEdit

from lrp_jupyter.errors import Edit, Finding
from lrp_jupyter.language.program import line_starts

_SIZES = {"utf-8": 1, "utf-16": 2, "utf-32": 4}


class TextPositions:
    """The positions of one text, in the code units that the client counts."""

    def __init__(self, text: str, encoding: str = "utf-16") -> None:
        self.text = text
        self._size = _SIZES[encoding]
        self._codec = encoding if encoding == "utf-8" else f"{encoding}-le"
        self._starts = line_starts(text)
        self._is_plain = text.isascii()

    def offset(self, position: Position) -> int:
        """Return the character offset of a position; what lies outside the text becomes its nearest end."""
        if position.line >= len(self._starts):
            return len(self.text)
        start = self._starts[position.line]
        line = self._line(position.line)
        if self._is_plain:
            return start + min(position.character, len(line))
        left = position.character
        for index, char in enumerate(line):
            if left <= 0:
                return start + index
            left -= self._units(char)
        return start + len(line)

    def position(self, offset: int) -> Position:
        """Return the position of a character offset."""
        line = bisect_right(self._starts, offset) - 1
        return Position(line, self._units(self.text[self._starts[line] : offset]))

    def range(self, start: int, end: int) -> Range:
        """Return the range of ``text[start:end]``."""
        return Range(self.position(start), self.position(end))

    def range_of_finding(self, finding: Finding) -> Range:
        """Return the range of a finding, whose lines and columns are counted from 1, in characters."""
        first, last = (finding.line, finding.column), (finding.end_line, finding.end_column)
        start, end = (self._starts[line - 1] + column - 1 for line, column in (first, last))
        return self.range(start, end)

    def span(self, found: Range) -> tuple[int, int]:
        """Return the characters of a range."""
        return self.offset(found.start), self.offset(found.end)

    def edit(self, edit: Edit) -> TextEdit:
        """Return an edit as the client applies it."""
        return TextEdit(self.range(edit.start, edit.end), edit.text)

    def line_end(self, offset: int) -> Position:
        """Return the end of the line of an offset."""
        line = bisect_right(self._starts, offset) - 1
        return self.position(self._starts[line] + len(self._line(line)))

    def _line(self, line: int) -> str:
        ends = self._starts[line + 1] if line + 1 < len(self._starts) else len(self.text)
        return self.text[self._starts[line] : ends].rstrip("\r\n")

    def _units(self, text: str) -> int:
        return len(text) if self._is_plain else len(text.encode(self._codec, "surrogatepass")) // self._size
