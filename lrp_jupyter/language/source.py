"""Pieces of a program's text with their positions: spans, names and blocks of Python."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

from lrp_jupyter.errors import Edit, Fix
from lrp_jupyter.language.python.block_suite import parse_block


class Span(NamedTuple):
    """A range of characters of the text: ``text[start:end]``."""

    start: int
    end: int


NOWHERE = Span(0, 0)


class Diagnosis(NamedTuple):
    """An error of a text, with offsets instead of lines, and the edits that certainly repair it."""

    start: int
    end: int
    code: str
    message: str
    edits: tuple[Edit, ...] = ()
    prefix: bool = False

    def shifted(self, offset: int) -> Diagnosis:
        """Return the diagnosis for a longer text, in which its own text begins at an offset."""
        edits = tuple([Edit(start + offset, end + offset, text) for start, end, text in self.edits])
        return self._replace(start=self.start + offset, end=self.end + offset, edits=edits)

    @property
    def fix(self) -> Fix | None:
        """The fix with its title, or None."""
        return Fix(_title(self.edits), self.edits) if self.edits else None


def _title(edits: tuple[Edit, ...]) -> str:
    """Return the title of edits, in the imperative."""
    if len(edits) == 2 and any(edit.start == edit.end for edit in edits) and not all(e.text for e in edits):
        return "Move it"
    new = " … ".join(dict.fromkeys(filter(None, (" ".join(edit.text.split()) for edit in edits))))
    if not new:
        return "Change the spaces" if any(edit.text for edit in edits) else "Remove it"
    verb = "Change to" if any(edit.start < edit.end for edit in edits) else "Insert"
    return f"{verb} `{new if len(new) <= 60 else new[:59] + '…'}`"


class Name(str):
    """A string with its position in the program's text."""

    __slots__ = ("span",)
    span: Span

    def __new__(cls, text: str, span: Span = NOWHERE) -> Name:
        """Return a name with its span."""
        self = super().__new__(cls, text)
        self.span = span
        return self

    def __getnewargs__(self) -> tuple[str, Span]:  # type: ignore[override]
        return str(self), self.span


@lru_cache(maxsize=20_000)
def _meaning(text: str) -> str:
    try:
        return ast.dump(parse_block(text))
    except SyntaxError:  # only in a program built by hand; the parser rejects such a block
        return text


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Python between square brackets.

    `text`: the text between the brackets, unchanged.
    `span`: both brackets included.
    `line`, `column`: position of the first character after the opening bracket, from 1; columns in
        characters.
    `before`: bytes (UTF-8) before that character in its line, because Python counts columns in bytes.
    """

    text: str
    span: Span = NOWHERE
    line: int = 1
    column: int = 1
    before: int = 0

    def at(self, span: Span) -> Span:
        """Return where a range of the block's text is in the program's."""
        start = self.span.start + 1
        return Span(start + span.start, start + span.end)

    @property
    def meaning(self) -> str:
        """The block's syntax tree as text: equal for blocks that differ in layout only."""
        return _meaning(self.text)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Block):
            return NotImplemented
        return self.text == other.text or self.meaning == other.meaning

    def __hash__(self) -> int:
        return hash(self.meaning)
