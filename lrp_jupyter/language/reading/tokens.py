"""The tokens of a text: brackets of forms, names, signs, and blocks as one token each."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import lru_cache

from lrp_jupyter.language.python.scanner import block_end, brackets, line_end
from lrp_jupyter.language.triggers import FORMS

LEGAL: dict[str, frozenset[str]] = {
    "program": frozenset({"var", "machine", "event", "spawn", "onpause", "onresume", "onend"}),
    "machine": frozenset({"var", "event", "state", *FORMS}),
    "state": frozenset({"onentry", "running", "onexit", "machine"}),
    "onentry": frozenset({"spawn"}),
    "spawn": frozenset({"var"}),
    **dict.fromkeys(FORMS, frozenset({"effect"})),
}
"""The forms allowed directly in each form; a test keeps it equal to ``grammar.lark``."""

KEYWORDS = frozenset().union(*LEGAL.values())
HELD = frozenset({"on", "exit"})
"""The forms in which `for` is a keyword, after the trigger; anywhere else it is a name."""
NAMED = frozenset({"event", "machine", "state", "var"})
"""The forms that begin with the name that they define."""
ACTIONS = frozenset({"onentry", "running", "onexit", "effect", "onpause", "onresume", "onend"})

_SKIP = r"[\s\ufeff]*+(?:[;#][^\r\n]*+[\s\ufeff]*+)*+"
_MORE = r"[^\x00-\x2f\x3a-\x40\x5b-\x5e\x60\x7b-\x7f\s\ufeff]"
_NAME = (  # ASCII letters, digits and `_`, and all that is beyond ASCII; one set of characters is fast
    rf"[^\x00-\x40\x5b-\x5e\x60\x7b-\x7f\s\ufeff]{_MORE}*+"
)
_TOKEN = re.compile(
    rf"{_SKIP}(?:(?P<OPEN>\({_SKIP}(?P<KEYWORD>{_NAME})?+)|(?P<CLOSE>\))|(?P<FOR>for(?!{_MORE}))|(?P<NAME>{_NAME})"
    r"|(?P<BLOCK>\[[^\[\];'\"#]*+\])|(?P<OTHER>\[)|(?P<ARROW>->)|(?P<ASSIGN>:=)|(?P<INTEGER>[0-9][\w.]*+)"
    r"|(?P<STAR>\*)|(?P<DOT>\.(?![.]))|(?P<LBRACE>\{)|(?P<RBRACE>\})"
    r"|(?P<COMMENT>//[^\r\n]*|/\*(?:[\s\S]*?\*/|[^\r\n]*)|--+(?![>\w])[^\r\n]*)"
    r"|(?P<MINUS>-)|(?P<END>\Z)|(?P<QUOTED>\"[^\"\r\n]*\"|'[^'\r\n]*')|(?P<STRAY>[!$%&+?@\\^`|~]{2,}+|[\s\S]))"
)
FORM_LINE = re.compile(rf"[\r\n][ \t]*\((?={_SKIP}({'|'.join(sorted(KEYWORDS))})\b)")
_SPECIAL = frozenset({"OTHER", "STRAY", "FOR"})
_REMARK = re.compile(r"[;#][^\r\n]*")
_ARROW = re.compile(rf"{_SKIP}->")
_TRIGGERS = (("NAME",), ("BLOCK",), ("NAME", "DOT", "NAME"))
_HEADS = {"var": 3, "event": 2}  # number of tokens before the block; 1 in other forms
_BLOCKS = KEYWORDS - {"machine", "state", "spawn", "eps"}
_MANY = 100  # blocks without `]`: in a text with more, each of the others ends with its line
_FARTHEST = 100  # tokens back to the missing `[` of a block
_NEWLINE = re.compile(r"[\r\n]")
_TAIL = re.compile(r"\](?=[\s)]*+(?:[;#].*)?(?:[\r\n]|\Z)|[ \t]*+[\w*{][^\[\]\r\n]*->)")
_NEXT = re.compile(rf"\)[\s)]*+(?:;|\((?:{'|'.join(sorted(KEYWORDS))})\b)")
_AFTER_BLOCK = re.compile(r"\s*+[\[)]")


Token = tuple[str, int, int]
"""A token: its type and ``text[start:end]``.

The type is a terminal of ``grammar.lark``, ``OPEN`` (a ``(`` with its keyword), ``CLOSE``,
``STRAY``, ``UNCLOSED`` or ``UNOPENED``: a block whose ``]`` or ``[`` is missing; its end or start is a guess.
"""


@lru_cache(maxsize=4)
def tokenize(text: str) -> Sequence[Token]:
    """Return the tokens of a text, without white space and comments; the last ones are kept."""
    tokens: list[Token] = []
    append = tokens.append
    end = unclosed = 0
    while True:
        for match in _TOKEN.finditer(text, end):
            kind: str = match.lastgroup  # type: ignore[assignment]
            if kind in _SPECIAL:
                break
            append((kind, *match.span(kind)))
        else:
            while tokens and tokens[-1][0] == "END":
                del tokens[-1]
            return tokens
        start, end = match.span(kind)
        if kind == "FOR":
            kind = "FOR" if _follows_trigger(text, tokens) and not _ARROW.match(text, end) else "NAME"
        elif kind == "STRAY":
            first = _guess_start(text, tokens, start) if text[start] == "]" else None
            if first is not None:
                kind, start = "UNOPENED", tokens[first][1]
                del tokens[first:]
        else:
            kind, end = "BLOCK", block_end(text, start) + 1 if unclosed < _MANY else 0
            if not end or _goes_on(text, start, end):
                kind, end = "UNCLOSED", _guess_end(text, start) if unclosed < _MANY else line_end(text, start)
                unclosed += 1
        append((kind, start, end))


def _goes_on(text: str, start: int, end: int) -> bool:
    """Return whether a block continues past the end of its form, to a `]` of another block or a comment."""
    if not _NEXT.search(text, start, end):
        return False
    opened = 0
    for offset, char in brackets(text, start, end):
        opened += (char in "([{") - (char in ")]}")
        if char == ")" and opened < 1 and _NEXT.match(text, offset):
            return True
    return False


def _follows_trigger(text: str, tokens: Sequence[Token]) -> bool:
    """Return whether what follows the tokens stands after an event or condition, where `for` is a keyword."""
    for kinds in _TRIGGERS:
        before = tokens[-len(kinds) - 1 :]
        if before and before[0][0] == "OPEN" and tuple(token[0] for token in before[1:]) == kinds:
            return keyword_of(text, before[0]) in HELD
    return False


def keyword_of(text: str, token: Token) -> str:
    """Return the keyword after the ``(`` of a token; empty if there is none."""
    if text[token[1]] != "(":  # a form whose `(` is missing
        return text[token[1] : token[2]]
    word = text[token[1] + 1 : token[2]]
    if word in KEYWORDS:
        return word
    match = _TOKEN.match(text, token[1])
    return (match and match["KEYWORD"]) or ""


def coloured_parts(text: str, tokens: Sequence[Token]) -> Iterator[Token]:
    """Yield the tokens of a text as they are coloured, some of them empty, with the comments between them.

    Instead of an ``OPEN`` there is its ``KEYWORD``, or the ``NAME`` that stands there.
    """
    before = 0
    for token in [*tokens, ("END", len(text), len(text))]:
        kind, start, end = token
        if kind == "OPEN":
            word = keyword_of(text, token)
            kind, start = "KEYWORD" if word in KEYWORDS else "NAME", end - len(word)
        for found in _REMARK.finditer(text, before, start):
            yield "COMMENT", *found.span()
        yield kind, start, end
        before = end


def _guess_start(text: str, tokens: list[Token], end: int) -> int | None:
    """Return the token that probably begins a block whose ``[`` is missing, or None."""
    closed = 0
    line = max(text.rfind("\n", 0, end), text.rfind("\r", 0, end))
    for index in range(len(tokens) - 1, max(-1, len(tokens) - _FARTHEST), -1):
        token = tokens[index]
        if token[2] <= line:
            break
        if token[0] == "CLOSE":
            closed += 1
        elif token[0] == "OPEN" and closed:
            closed -= 1
        elif token[0] == "OPEN":
            keyword = keyword_of(text, token)
            first = index + _HEADS.get(keyword, 1)
            if keyword not in _BLOCKS or first >= len(tokens):
                return None
            return None if any(_is_no_python(text, token) for token in tokens[first:]) else first
    return None


def _is_no_python(text: str, token: Token) -> bool:
    """Return whether a token cannot be in Python that lacks its `[`; a block directly after a name can."""
    return token[0] == "ARROW" or (token[0] == "BLOCK" and text[token[1] - 1].isspace())


def _guess_end(text: str, start: int) -> int:
    """Return the probable end of a block without its ``]``, so that the rest is parsed as usual.

    That is before a ``)`` that closes nothing of its Python, in the line of a string or comment that
    has swallowed the bracket, after a ``]`` that another block or a ``)`` follows, or before the next line
    that looks like a form; whichever comes first.
    """
    form = FORM_LINE.search(text, start)
    stop = form.start() if form else len(text)
    opened: list[str] = []
    places: list[int] = []
    for offset, char in brackets(text, start, stop):
        if char in '#"':
            tail = _TAIL.search(text, offset, line_end(text, offset))
            if tail:
                return tail.end()
        elif char in "([{":
            opened.append(char)
            places.append(offset)
        elif char == ")" and len(opened) == 1:
            return offset
        else:
            ends = char == "]" and len(opened) > 1 and _AFTER_BLOCK.match(text, offset + 1)
            if ends and _NEWLINE.search(text, places[-1], offset):
                return offset + 1  # the block ends here, and the `]` is missing in an earlier line
            if opened[-2:] == ["(", "["] and char == ")":
                opened.pop()  # the `]` is missing here
                places.pop()
            if opened[-1] + char in ("()", "[]", "{}"):
                opened.pop()
                places.pop()
            if not opened:
                return offset + 1
    return start + len(text[start:stop].rstrip())
