"""Scanner for the ends of Python blocks inside a text that is not Python.

A block is Python between square brackets, and only its closing bracket marks its end, so strings,
f-strings and comments have to be distinguished from code. ``tokenize`` cannot do that: it rejects
incomplete programs, and before Python 3.12 it treats an f-string as one token. This scanner jumps from
one interesting character to the next and knows nothing else of Python. It reads f-strings by the
rules of PEP 701 on every Python.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

_BLOCK = re.compile(r"[\[\]#'\"]")
_QUOTE = re.compile(r"[#'\"]")
_CODE = re.compile(r"[\[\](){}#'\"]")
_FIELD = re.compile(r"[\[\](){}:#'\"]")
_NEWLINE = re.compile(r"[\r\n]")
LINE_END = re.compile(r"\r\n|\r|\n")
_PLAIN = {
    "'": re.compile(r"[^\\'\r\n]*+(?:\\(?:\r\n|[\s\S])[^\\'\r\n]*+)*+"),
    '"': re.compile(r'[^\\"\r\n]*+(?:\\(?:\r\n|[\s\S])[^\\"\r\n]*+)*+'),
    "'''": re.compile(r"(?:[^\\']++|\\[\s\S]|'(?!''))*+"),
    '"""': re.compile(r'(?:[^\\"]++|\\[\s\S]|"(?!""))*+'),
}
_PREFIXES = frozenset(["r", "u", "b", "br", "rb", "f", "fr", "rf", "t", "tr", "rt"])
_DEEPEST = 100  # f-strings inside f-strings; Python itself stops at 150


def line_end(text: str, start: int) -> int:
    """Return the offset of the next line end, or the length of the text."""
    match = _NEWLINE.search(text, start)
    return match.start() if match else len(text)


def block_end(text: str, start: int) -> int:
    """Return the offset of the ``]`` that closes the ``[`` at an offset; -1 if there is none.

    Only square brackets are counted, so an unclosed ``(`` inside a block does not hide its end.
    A string that is not closed ends with its line.
    """
    depth = 0
    position = start
    while match := _BLOCK.search(text, position):
        position = match.end()
        char = match[0]
        if char == "[":
            depth += 1
        elif char == "]":
            depth -= 1
            if not depth:
                return match.start()
        elif char == "#":
            position = line_end(text, position)
        else:
            position, _ = string_end(text, match.start(), start)
    return -1


def brackets(text: str, start: int, stop: int | None = None) -> Iterator[tuple[int, str]]:
    """Yield every bracket of code, and ``#`` and ``"`` where a comment or an unclosed string begins."""
    position = start
    stop = len(text) if stop is None else stop
    while match := _CODE.search(text, position, stop):
        position = match.end()
        char = match[0]
        if char == "#":
            yield match.start(), char
            position = line_end(text, position)
        elif char in "'\"":
            position, closed = string_end(text, match.start(), start)
            if not closed:
                yield match.start(), '"'
        else:
            yield match.start(), char


def strings(text: str) -> list[tuple[int, int]]:
    """Return the ranges of the strings of code, quotes included."""
    found = []
    position = 0
    while match := _QUOTE.search(text, position):
        position = match.end()
        if match[0] == "#":
            position = line_end(text, position)
        else:
            position, _ = string_end(text, match.start(), 0)
            found.append((match.start(), position))
    return found


def logical_lines(text: str) -> list[int]:
    """Return the offsets of the lines after the first on which a statement begins.

    Lines inside brackets and strings, continued by a backslash, blank or only a comment are left out.
    """
    inside: list[tuple[int, int]] = []  # brackets and strings
    comment_ends = set()
    depth = opened = position = 0
    while match := _CODE.search(text, position):
        position = match.end()
        char = match[0]
        if char == "#":
            position = line_end(text, position)
            comment_ends.add(position)
        elif char in "'\"":
            position, _ = string_end(text, match.start(), 0)
            inside.append((match.start(), position))
        elif char in "([{":
            opened = opened if depth else match.start()
            depth += 1
        elif depth:
            depth -= 1
            if not depth:
                inside.append((opened, position))
    if depth:
        inside.append((opened, len(text)))
    inside.sort(reverse=True)
    starts = []
    for match in _STATEMENT_LINE.finditer(text):
        newline = match.start()
        while inside and inside[-1][1] <= newline:
            inside.pop()
        continued = text[newline - 1 : newline] == "\\" and newline not in comment_ends
        if not continued and not (inside and inside[-1][0] < newline):
            starts.append(match.end() - len(match[1]))
    return starts


_STATEMENT_LINE = re.compile(r"(?:\r\n|\r|\n)([ \t\f]*+)(?=[^\s#])")


def string_end(text: str, quote_at: int, floor: int) -> tuple[int, bool]:
    """Return the end of the string whose quote is at an offset, or of its line, and whether it is closed.

    `floor`: offset before which no prefix is looked for.
    """
    end = _string_end(text, quote_at, floor, 0)
    if end >= 0:
        return end, True
    if text.startswith(text[quote_at] * 3, quote_at):
        return len(text), False
    if "f" not in _prefix(text, quote_at, floor):
        return _PLAIN[text[quote_at]].match(text, quote_at + 1).end(), False  # type: ignore[union-attr]
    return line_end(text, quote_at), False


def _prefix(text: str, quote_at: int, floor: int) -> str:
    """Return the letters before a quote, if they are a prefix: of ``if"x"`` none."""
    start = quote_at
    while start > floor and quote_at - start < 3 and (text[start - 1].isalnum() or text[start - 1] == "_"):
        start -= 1
    letters = text[start:quote_at].lower().replace("t", "f")
    return letters if letters in _PREFIXES else ""


def fields(text: str, start: int, stop: int) -> list[tuple[int, int]]:
    """Return the expressions in the f-strings of a range, with what follows up to their format or ``}``.

    Those in formats are included; not those of f-strings inside an expression.
    """
    found: list[tuple[int, int]] = []
    position = start
    while match := _QUOTE.search(text, position, stop):
        position = match.end()
        if match[0] == "#":
            position = line_end(text, position)
        else:
            position = max(_string_end(text, match.start(), start, 0, found), position)
    return found


_Found = list[tuple[int, int]] | None


def _string_end(text: str, quote_at: int, floor: int, depth: int, found: _Found = None) -> int:
    quotes = text[quote_at]
    if text.startswith(quotes * 3, quote_at):
        quotes *= 3
    prefix = _prefix(text, quote_at, floor)
    position = quote_at + len(quotes)
    if "f" in prefix:
        return _formatted_end(text, position, quotes, "r" in prefix, depth, found)
    end = _PLAIN[quotes].match(text, position).end()  # type: ignore[union-attr]
    return end + len(quotes) if text.startswith(quotes, end) else -1


def _formatted_end(text: str, position: int, quotes: str, raw: bool, depth: int, found: _Found) -> int:
    """Return the offset after an f-string whose text begins at `position`; -1 if it is not closed."""
    if depth > _DEEPEST:
        return -1
    literal = _LITERAL[quotes, raw]
    while True:
        position = literal.match(text, position).end()  # type: ignore[union-attr]
        if text.startswith(quotes, position):
            return position + len(quotes)
        if not text.startswith("{", position):
            return -1  # the end of the line, or of the text
        position = _field_end(text, position + 1, quotes, depth, found)
        if position < 0:
            return -1


def _field_end(text: str, position: int, quotes: str, depth: int, found: _Found) -> int:
    """Return the offset after the ``}`` of a replacement field whose expression begins at `position`."""
    floor = position
    level = 0
    while match := _FIELD.search(text, position):
        position = match.end()
        char = match[0]
        if char in "'\"":
            position = _string_end(text, match.start(), floor, depth + 1)
            if position < 0:
                return -1
        elif char == "#":
            position = line_end(text, position)
        elif char in "([{":
            level += 1
        elif level and char != ":":
            level -= 1
        elif char in "}:" and not level:
            if found is not None:
                found.append((floor, match.start()))
            return position if char == "}" else _format_end(text, position, quotes, depth, found)
    return -1


def _format_end(text: str, position: int, quotes: str, depth: int, found: _Found) -> int:
    """Return the offset after the ``}`` of a field whose format begins at `position`."""
    if depth > _DEEPEST:
        return -1
    plain = _FORMAT[quotes]
    while True:
        position = plain.match(text, position).end()  # type: ignore[union-attr]
        if text.startswith("}", position):
            return position + 1
        if not text.startswith("{", position):
            return -1
        position = _field_end(text, position + 1, quotes, depth + 1, found)
        if position < 0:
            return -1


def _literal(quotes: str, raw: bool) -> re.Pattern[str]:
    r"""Match the text of an f-string up to a field, its closing quotes, or its broken end.

    A backslash does not escape a brace; ``\N{…}`` is a name, not a field.
    """
    quote = quotes[0]
    multiline = len(quotes) == 3
    parts = [
        rf"[^\\{{}}{quote}]++" if multiline else rf"[^\\{{}}{quote}\r\n]++",
        r"\{\{",
        r"\}",
        r"\\(?:\r\n|[^{}])",
        r"\\(?=[{}])",
    ]
    if not raw:
        parts.insert(0, r"\\N\{[^{}'\"\r\n]*\}")
    if multiline:
        parts.append(rf"{quote}(?!{quote}{quote})")
    return re.compile(f"(?:{'|'.join(parts)})*+")


_LITERAL = {(quotes, raw): _literal(quotes, raw) for quotes in _PLAIN for raw in (False, True)}
_FORMAT = {
    quotes: re.compile(
        rf"(?:[^{{}}{quotes[0]}]|{quotes[0]}(?!{quotes[0] * 2}))*+"
        if len(quotes) == 3
        else rf"[^{{}}{quotes}\r\n]*+"
    )
    for quotes in _PLAIN
}
