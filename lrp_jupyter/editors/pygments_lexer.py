"""The colours of a program for Pygments, and so for nbconvert, Sphinx, rich and the terminal.

The tokens are those of the parser, so that a text is coloured as it is read.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from pygments.lexer import Lexer
from pygments.lexers.python import PythonLexer
from pygments.token import Comment, Keyword, Name, Number, Operator, Punctuation, Whitespace, _TokenType

from lrp_jupyter.language.reading.tokens import KEYWORDS, NAMED, keyword_of, tokenize

_MAGIC = re.compile(r"%%lrp\b[^\r\n]*")
_GAP = re.compile(r"(?P<comment>[;#][^\r\n]*)|[^;#]+")
_DEFINED = {
    "machine": Name.Namespace,
    "state": Name.Class,
    "event": Name.Function,
    "var": Name.Variable,
}
_TYPES = {
    "CLOSE": Punctuation,
    "LBRACE": Punctuation,
    "RBRACE": Punctuation,
    "DOT": Operator,
    "ARROW": Operator,
    "ASSIGN": Operator,
    "STAR": Operator,
    "MINUS": Operator,
    "INTEGER": Number.Integer,
    "FOR": Keyword,
    "COMMENT": Comment.Single,
}

_Coloured = Iterator[tuple[int, _TokenType, str]]


class LRPLexer(Lexer):
    """Programs in LRP, with the Python of their blocks; also a notebook's cell that begins with ``%%lrp``."""

    name = "LRP"
    aliases = ("lrp",)
    filenames = ("*.lrp",)
    mimetypes = ("text/x-lrp",)

    def get_tokens_unprocessed(self, text: str) -> _Coloured:
        """Yield the offset, type and text of each token."""
        magic = _MAGIC.match(text)
        begin = 0
        if magic is not None:
            begin = magic.end()
            yield 0, Comment.Preproc, magic[0]
        program = text[begin:]
        end, before = 0, ""
        for kind, start, stop in tokenize(program):
            yield from _gap(program, begin, end, start)
            word = keyword_of(program, (kind, start, stop)) if kind == "OPEN" else ""
            for offset, type_, part in _coloured(program, kind, start, stop, word, before):
                yield begin + offset, type_, part
            end, before = stop, word
        yield from _gap(program, begin, end, len(program))


def _gap(program: str, begin: int, start: int, stop: int) -> _Coloured:
    """Yield what stands between two tokens: comments and white space."""
    for match in _GAP.finditer(program, start, stop):
        yield begin + match.start(), Comment.Single if match["comment"] else Whitespace, match[0]


def _coloured(program: str, kind: str, start: int, stop: int, word: str, before: str) -> _Coloured:
    """Yield a token in its parts; `before`: the keyword of the form that begins directly before it."""
    text = program[start:stop]
    if kind == "OPEN":
        yield start, Punctuation, "("
        rest = stop - len(word) if word else stop
        yield from _gap(program, 0, start + 1, rest)
        if word:
            yield rest, Keyword if word in KEYWORDS else Name, word
    elif kind in ("BLOCK", "UNCLOSED", "UNOPENED"):
        first, last = text.startswith("["), kind != "UNCLOSED" and len(text) > 1
        if first:
            yield start, Punctuation, "["
        inside = text[first : len(text) - last]
        for offset, type_, part in PythonLexer().get_tokens_unprocessed(inside):
            yield start + first + offset, type_, part
        if last:
            yield stop - 1, Punctuation, "]"
    elif kind == "NAME":
        yield start, _DEFINED[before] if before in NAMED else Name, text
    else:
        yield start, _TYPES.get(kind, Punctuation), text
