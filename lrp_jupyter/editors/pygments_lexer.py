"""The colours of a program for Pygments, and so for nbconvert, Sphinx, rich and the terminal.

The tokens are those of the parser, so that a text is coloured as it is read.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from pygments.lexer import Lexer
from pygments.lexers.python import PythonLexer
from pygments.token import Comment, Keyword, Name, Number, Operator, Punctuation, Whitespace, _TokenType

from lrp_jupyter.language.reading.tokens import coloured_parts, tokenize

_MAGIC = re.compile(r"%%lrp\b[^\r\n]*")
_GAP = re.compile(r"\(|[^(]+")
_DEFINED = {
    "machine": Name.Namespace,
    "state": Name.Class,
    "event": Name.Function,
    "var": Name.Variable,
}
_TYPES = {
    "DOT": Operator,
    "ARROW": Operator,
    "ASSIGN": Operator,
    "STAR": Operator,
    "MINUS": Operator,
    "INTEGER": Number.Integer,
    "FOR": Keyword,
    "KEYWORD": Keyword,
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
        end, before = 0, ""  # `before`: the keyword of a form, until something follows
        for kind, start, stop in coloured_parts(program, tokenize(program)):
            for gap in _GAP.finditer(program, end, start):
                yield begin + gap.start(), Punctuation if gap[0] == "(" else Whitespace, gap[0]
            for offset, type_, part in _coloured(program[start:stop], kind, before):
                yield begin + start + offset, type_, part
            end = stop
            if kind != "COMMENT":
                before = program[start:stop] if kind == "KEYWORD" else ""


def _coloured(text: str, kind: str, before: str) -> _Coloured:
    """Yield a token in its parts; `before`: the keyword of the form that begins directly before it."""
    if kind in ("BLOCK", "UNCLOSED", "UNOPENED"):
        first, last = text.startswith("["), kind != "UNCLOSED" and len(text) > 1
        if first:
            yield 0, Punctuation, "["
        inside = text[first : len(text) - last]
        for offset, type_, part in PythonLexer().get_tokens_unprocessed(inside):
            yield first + offset, type_, part
        if last:
            yield len(text) - 1, Punctuation, "]"
    elif text:
        other = _DEFINED.get(before, Name) if kind == "NAME" else Punctuation
        yield 0, _TYPES.get(kind, other), text
