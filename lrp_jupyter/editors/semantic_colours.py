"""The colours of words by what they mean: of the language, and of Python in its blocks."""

from __future__ import annotations

import keyword
import re
from bisect import bisect_left
from collections.abc import Iterator
from typing import NamedTuple

from lrp_jupyter.editors.program_text import ProgramText
from lrp_jupyter.language.blocks.builtin_names import PROVIDED, TIMES
from lrp_jupyter.language.python.scanner import LINE_END, strings

KINDS = (
    *("keyword", "comment", "string", "number", "operator"),
    *("class", "enumMember", "event", "variable", "function", "property", "method"),
)
MODIFIERS = ("declaration", "defaultLibrary")
_OF_ELEMENTS = {
    "machine": "class",
    "state": "enumMember",
    "event": "event",
    "variable": "variable",
    "transition": "function",
}
_OF_TOKENS = {
    "INTEGER": "number",
    "ARROW": "operator",
    "ASSIGN": "operator",
    "STAR": "operator",
    "FOR": "keyword",
    "KEYWORD": "keyword",
    "COMMENT": "comment",
}
_PYTHON = re.compile(
    r"(?P<comment>#[^\r\n]*)|(?P<number>\b\d[\w.]*)|(?P<word>[^\W\d]\w*(?:\.[^\W\d]\w*)*)", re.UNICODE
)


class ColouredWord(NamedTuple):
    """A word ``text[start:end]``, its kind, and its modifiers."""

    start: int
    end: int
    kind: str
    modifiers: tuple[str, ...] = ()


def words(text: ProgramText) -> list[ColouredWord]:
    """Return the words of a text that have a colour, in order; none is in another one."""
    named = sorted(_named(text))
    found = [*named, *(part for word in _written(text) for part in _around(word, named))]
    return [part for word in sorted(found) for part in _lines(text.text, word)]


def _around(word: ColouredWord, named: list[ColouredWord]) -> Iterator[ColouredWord]:
    """Yield the parts of a word around the names in it: a string may contain the name of a state."""
    at = word.start
    for name in named[bisect_left(named, word.start, key=lambda each: each.start) :]:
        if name.start >= word.end:
            break
        yield word._replace(start=at, end=name.start)
        at = name.end
    yield word._replace(start=at)


def encoded(text: ProgramText) -> list[int]:
    """Return the words as the protocol has them: each by its distance from the one before."""
    data: list[int] = []
    line = column = 0
    for start, end, kind, modifiers in words(text):
        place = text.at.position(start)
        length = text.at.position(end).character - place.character
        mask = sum(1 << MODIFIERS.index(each) for each in modifiers)
        column = column if place.line == line else 0
        data += [place.line - line, place.character - column, length, KINDS.index(kind), mask]
        line, column = place.line, place.character
    return data


def _named(text: ProgramText) -> Iterator[ColouredWord]:
    """Yield the names of elements, where they are defined and where they are used."""
    seen = set()
    for symbol in text.symbols[0]:
        kind = _OF_ELEMENTS[symbol.element.kind]
        yield ColouredWord(*symbol.definition, kind, ("declaration",))
        seen.add(symbol.definition)
    for symbol in text.symbols[0]:
        for span in symbol.references:
            if span not in seen:
                seen.add(span)
                yield ColouredWord(*span, _OF_ELEMENTS[symbol.element.kind])


def _written(text: ProgramText) -> Iterator[ColouredWord]:
    """Yield keywords, signs, comments, and the Python of blocks: everything in a text but names."""
    for kind, start, end in text.parts:
        if kind in _OF_TOKENS:
            yield ColouredWord(start, end, _OF_TOKENS[kind])
        elif kind in ("BLOCK", "UNCLOSED", "UNOPENED"):
            yield from _in_block(text.text, start, end)


def _in_block(text: str, start: int, end: int) -> Iterator[ColouredWord]:
    code = text[start:end]
    found = strings(code)
    for first, last in found:
        yield ColouredWord(start + first, start + last, "string")
    at = 0
    for first, last in [*found, (len(code), len(code))]:
        for word in _PYTHON.finditer(code, at, first):
            yield from _python(word, start)
        at = last


def _python(word: re.Match[str], shift: int) -> Iterator[ColouredWord]:
    start, end = word.start() + shift, word.end() + shift
    if word.lastgroup != "word":
        yield ColouredWord(start, end, str(word.lastgroup))
        return
    first, *rest = word[0].split(".")
    if keyword.iskeyword(first):
        yield ColouredWord(start, end, "keyword")
    elif first in PROVIDED | TIMES:
        yield ColouredWord(start, start + len(first), "variable", ("defaultLibrary",))
        if rest:
            called = word.string[word.end() : word.end() + 1] == "("
            yield ColouredWord(start + len(first) + 1, end, "method" if called else "property")


def _lines(text: str, word: ColouredWord) -> Iterator[ColouredWord]:
    """Yield the parts of a word in each of its lines: the protocol has none of several."""
    at = word.start
    for found in [*LINE_END.finditer(text, word.start, word.end), None]:
        end = word.end if found is None else found.start()
        if at < end:
            yield word._replace(start=at, end=end)
        at = end if found is None else found.end()
