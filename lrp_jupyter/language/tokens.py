"""The tokens of a text: brackets of forms, names, signs, and blocks as one token each."""

from __future__ import annotations

import re
from typing import NamedTuple

from lrp_jupyter.language.scanner import block_end, brackets, line_end

__all__ = ["KEYWORDS", "LEGAL", "Token", "tokenize"]

LEGAL: dict[str, frozenset[str]] = {
    "program": frozenset({"var", "machine", "event", "spawn", "onpause", "onresume"}),
    "machine": frozenset({"var", "event", "state", "on", "ontime", "eps", "exit"}),
    "state": frozenset({"onentry", "running", "onexit", "machine"}),
    "onentry": frozenset({"spawn"}),
}
"""Which forms may stand directly in which; a test holds it equal to ``grammar.lark``."""

KEYWORDS = frozenset().union(*LEGAL.values())

_SKIP = r"[\s\ufeff]*+(?:[;#][^\r\n]*+[\s\ufeff]*+)*+"
_NAME = r"(?:[^\W\d]|[^\x00-\x7f\s\ufeff])(?:\w|[^\x00-\x7f\s\ufeff])*+"
_TOKEN = re.compile(
    rf"{_SKIP}(?:(?P<OPEN>\((?={_SKIP}({_NAME})?))|(?P<CLOSE>\))|(?P<NAME>{_NAME})|(?P<BLOCK>\[)|(?P<ARROW>->)"
    r"|(?P<ASSIGN>:=)|(?P<INTEGER>[0-9][\w.]*+)|(?P<STAR>\*)|(?P<LBRACE>\{)|(?P<RBRACE>\})|(?P<MINUS>-)"
    r"|(?P<END>\Z)|(?P<STRAY>[\s\S]))"
)
_FORM_LINE = re.compile(rf"[\r\n][ \t]*\((?={_SKIP}({'|'.join(sorted(KEYWORDS))})\b)")
_TAIL = re.compile(r"\](?=[\s)]*+(?:[;#].*)?(?:[\r\n]|\Z))")


class Token(NamedTuple):
    """One token: ``text[start:end]``.

    ``type`` is a terminal of ``grammar.lark`` or ``OPEN``, ``CLOSE``, ``STRAY``, ``UNCLOSED`` (a block whose
    ``]`` is missing; its end is a guess).
    """

    type: str
    start: int
    end: int


def tokenize(text: str) -> list[Token]:
    """Cut a text into tokens; white space and comments are left out."""
    tokens = []
    append = tokens.append
    match_at = _TOKEN.match
    position = 0
    while True:
        match = match_at(text, position)
        kind: str = match.lastgroup  # type: ignore[union-attr,assignment]
        start, position = match.span(kind)  # type: ignore[union-attr]
        if kind == "BLOCK":
            end = block_end(text, start)
            if end < 0:
                kind = "UNCLOSED"
                position = _guess_end(text, start)
            else:
                position = end + 1
        elif kind == "END":
            return tokens
        append(Token(kind, start, position))


def _guess_end(text: str, start: int) -> int:
    """Guess where a block without its ``]`` was meant to end, so that what follows is read as usual.

    That is before a ``)`` that closes nothing of its Python, in the line of a string or comment that
    has swallowed the bracket, or before the next line that looks like a form; whichever comes first.
    """
    form = _FORM_LINE.search(text, start)
    stop = form.start() if form else len(text)
    opened: list[str] = []
    for offset, char in brackets(text, start, stop):
        if char in '#"':
            tail = _TAIL.search(text, offset, line_end(text, offset))
            if tail:
                return tail.end()
        elif char in "([{":
            opened.append(char)
        elif char == ")" and len(opened) == 1:
            return offset
        elif opened[-1] + char in ("()", "[]", "{}"):
            opened.pop()
    return len(text[:stop].rstrip())
