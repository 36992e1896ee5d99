"""Slips in the Python of a block: what is wrong, and the change after which Python accepts it.

Python names the place where it gave up and often nothing else. So this module tries what people usually
mean: each rule proposes changes at a place that looks like its kind of slip (a sign of another language, a
missing bracket, a misspelt keyword), and the first change after which Python accepts the block is reported as
the mistake, with the change as its fix. One slip is one fault, whatever follows from it. Where nothing helps,
the error of Python is reported in other words.
"""

# ruff: noqa: RUF001  (signs that look like others are what this is about)

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterator
from difflib import SequenceMatcher
from functools import lru_cache
from itertools import pairwise
from keyword import iskeyword, kwlist
from typing import NamedTuple

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.program import line_starts
from lrp_jupyter.language.scanner import string_end
from lrp_jupyter.language.source import Diagnosis
from lrp_jupyter.language.suites import parse_block
from lrp_jupyter.language.wordings import in_words

__all__ = ["brief", "explain", "fault_of"]


LONGEST = 6_000
"""Characters of a block in which remedies are searched for."""
_ATTEMPTS = 250_000
"""Characters parsed at most in search of the remedies of one block."""
_MOST = 8
"""Slips reported at most in one block."""


def explain(text: str, line: int = 1, column: int = 0, is_condition: bool = False) -> tuple[Diagnosis, ...]:
    """Return the errors of a block that is not valid Python, in the order in which Python meets them.

    Parameters
    ----------
    text : str
    line, column : int
        Where the text begins in the program: its line, from 1, and its column, from 0.
    is_condition : bool
        Whether the block's value is tested, so that `=` is probably meant as `==`.
    """
    if len(text) > LONGEST:
        return brief(text, line)
    faults: list[Diagnosis] = []
    origins = list(range(len(text) + 1))  # of each character of the present text, its offset in the block's
    left = _ATTEMPTS
    while len(faults) < _MOST:
        error = _error(text)
        if error is None:
            break
        place = _offset(text, error.lineno, error.offset)
        best: _Guess | None = None
        guess: _Guess | None = None  # Python would accept it, but something else may be meant
        if "too " in error.msg:  # deeply nested: nothing is misspelt
            left = 0
        code = _Code(text, place, error.msg, column, is_condition)
        for candidate in _candidates(code):
            left -= len(text)
            if left < 0:
                break
            follower = _error(_applied(text, candidate.edits))
            if follower is None and candidate.is_certain:
                best = candidate
                break
            if follower is None:
                guess = guess or candidate
            elif best is None and _is_progress(text, candidate, place, follower):
                best = candidate
        best = best or guess
        if best is None:
            fault = _known_pattern(code) or fault_of(error, text, line)
            faults.append(fault._replace(start=origins[fault.start], end=origins[fault.end]))
            break
        edits = [Edit(origins[start], origins[end], new) for start, end, new in best.edits if best.is_certain]
        faults.append(
            Diagnosis(origins[best.start], origins[best.end], best.code, best.message, tuple(edits))
        )
        for start, end, new in sorted(best.edits, reverse=True):
            text = text[:start] + new + text[end:]
            origins[start:end] = [origins[start]] * len(new)
        column = 0 if column and origins[0] else column
    return tuple(faults)


def brief(text: str, line: int = 1) -> tuple[Diagnosis, ...]:
    """Return the first error of a block in words, without a search for its remedy."""
    error = _error(text)
    return () if error is None else (fault_of(error, text, line),)


def fault_of(error: SyntaxError, text: str, line: int = 1) -> Diagnosis:
    """Return an error of Python in other words; the text begins in the given line of the program."""
    start = _offset(text, error.lineno, error.offset)
    end = max(_offset(text, error.end_lineno, error.end_offset), min(start + 1, len(text)))
    match = _WORD.match(text, start)
    return Diagnosis(start, end, "LRP501", in_words(error.msg, match[0] if match else "", line))


_WORD = re.compile(r"\w{1,40}|[^\s\w`]")


@lru_cache(maxsize=512)
def _error(text: str) -> SyntaxError | None:
    try:
        parse_block(text)
    except SyntaxError as error:
        return error.with_traceback(None)
    return None


def _offset(text: str, line: int | None, column: int | None) -> int:
    starts = line_starts(text)
    return min(starts[min(line or 1, len(starts)) - 1] + (column or 1) - 1, len(text))


def _applied(text: str, edits: tuple[Edit, ...]) -> str:
    for start, end, new in sorted(edits, reverse=True):
        text = text[:start] + new + text[end:]
    return text


def _is_progress(text: str, candidate: _Guess, place: int, follower: SyntaxError) -> bool:
    """Return whether Python now gives up in a later line, so that this was one slip of several."""
    later = _offset(_applied(text, candidate.edits), follower.lineno, follower.offset)
    first = min(edit.start for edit in candidate.edits)
    grown = sum(len(new) - (end - start) for start, end, new in candidate.edits)
    if later - max(grown, 0) <= place:
        return False
    return candidate.code in _CERTAIN or "\n" in text[max(place, first) : later - grown]


_CERTAIN = frozenset({"LRP510", "LRP511"})
"""What is wrong wherever it stands, even if more is wrong in its line."""


def _known_pattern(code: _Code) -> Diagnosis | None:
    """Return what is wrong with a line that no single change can mend, if it looks like something known."""
    start = code.starts[code.at]
    end = code.starts[code.at + 1] if code.at + 1 < len(code.starts) else len(code.text)
    for pattern, code_of, message in _PATTERNS:
        if match := pattern.search(code.text, start, end):
            return Diagnosis(match.start(), match.end(), code_of, message)
    return None


_RANGE = "Python counts with `range`. Write `for i in range(3):`."
_PATTERNS = [
    (re.compile(pattern), number, message)
    for pattern, number, message in (
        (r"\bfor\s*\(", "LRP510", _RANGE),
        (r"\bfor\s+\w+\s*=", "LRP510", _RANGE),
        (r"\d\s*\.\.+\s*\d", "LRP510", _RANGE),
        (r"\b(?:repeat|loop)\b", "LRP511", _RANGE),
        (r"\bis\s+(?:less|greater|equal|bigger|smaller|not equal)\b|\bequals?\b", "LRP511",
         "Python compares with signs. Write `<`, `>` or `==`."),
        (r"\b(?:and|or)\s*[<>=!]", "LRP517",
         "`and` and `or` join whole comparisons. Write the name again before the sign."),
        (r"\)\s*\{|\belse\s*\{|\}\s*else\b", "LRP510",
         "Python has no braces around statements. Write `:`, and the rest in new lines, further right."),
    )
]  # fmt: skip


# The text as the rules see it


class _Token(NamedTuple):
    kind: str
    text: str
    start: int
    end: int
    line: int
    depth: int


_TOKEN = re.compile(
    r"(?P<line>\r\n|\r|\n)|(?P<blank>[ \t\f]+|\\(?:\r\n|\r|\n)|\#[^\r\n]*+)"
    r"|(?P<string>(?:[rbuftRBUFT]{1,2})?['\"])"
    r"|(?P<number>(?:\d\w*\.?|\.\d)\w*(?:(?<=\d[eE])[+-]\d+)?)|(?P<name>[^\W\d]\w*)"
    r"|(?P<sign>===|!==|\.\.\.|\*\*=|//=|>>=|<<=|&&|\|\||\+\+|--|=>|=<|<>|=!(?!=)|:=|=:|->|::|==|!="
    r"|<=|>=|<<|>>|\*\*|//|[-+*/%@&|^]=|[-+*/%@&|^~<>=!:;,.()\[\]{}\\])"
    r"|(?P<other>[\s\S])"
)
_OPENING = {"(": ")", "[": "]", "{": "}"}
_CLOSING = {closing: opening for opening, closing in _OPENING.items()}
_VALUES = frozenset({"True", "False", "None"})
_HEADERS = frozenset(
    {
        "if",
        "elif",
        "else",
        "while",
        "for",
        "def",
        "class",
        "try",
        "except",
        "finally",
        "with",
        "match",
        "case",
    }
)
_BARE = frozenset({"else", "try", "finally"})
"""Headers with nothing between the keyword and its colon."""
_SIMPLE = frozenset(
    {"return", "pass", "break", "continue", "raise", "del", "import", "from", "global", "assert"}
)


class _Code:
    """A block's text with its tokens, and the place where Python gives up."""

    def __init__(self, text: str, place: int, problem: str, column: int, is_condition: bool) -> None:
        self.text = text
        self.place = place
        self.problem = problem
        self.column = column
        self.is_condition = is_condition
        self.starts = line_starts(text)
        self.tokens = list(_tokens(text))
        self.at = sum(start <= place for start in self.starts) - 1
        """The line of the place, from 0."""

    def lines(self) -> Iterator[list[int]]:
        """Yield the tokens of each line that has some, as indices."""
        found: list[int] = []
        for index, token in enumerate(self.tokens):
            if found and self.tokens[found[-1]].line != token.line:
                yield found
                found = []
            found.append(index)
        if found:
            yield found

    def is_near(self, token: _Token) -> bool:
        """Return whether a token is in the line in which Python gives up, or the one before."""
        return self.at - 1 <= token.line <= self.at

    def near(self) -> Iterator[int]:
        """Yield the tokens near the place, those of its own line first."""
        here = [index for index, token in enumerate(self.tokens) if token.line == self.at]
        yield from here
        before = max((token.line for token in self.tokens if token.line < self.at), default=-1)
        yield from (index for index, token in enumerate(self.tokens) if token.line == before)

    def get(self, index: int) -> _Token:
        """Return a token; one that is empty before the first and after the last."""
        return self.tokens[index] if 0 <= index < len(self.tokens) else _NOTHING

    def begins(self, index: int) -> bool:
        """Return whether a statement may begin with a token."""
        before = self.get(index - 1)
        if before is _NOTHING or (before.line != self.tokens[index].line and not self.tokens[index].depth):
            return True
        return before.text in (";", "{", "}") or (before.text == ":" and not before.depth)

    def ends(self, index: int) -> bool:
        """Return whether a statement may end before a token."""
        token = self.get(index)
        return token is _NOTHING or token.line != self.get(index - 1).line or token.text in (";", "}")

    def statement_end(self, index: int) -> int:
        """Return the index after the statement that contains a token, within its line."""
        end = index + 1
        while not self.ends(end):
            end += 1
        return end

    def chain_end(self, index: int) -> int:
        """Return the index after the operand that begins at a token: ``robot.light[0].data(1)``."""
        while self.get(index).text in ("-", "+", "not", "!"):
            index += 1
        end = index
        if self.get(end).text in _OPENING:
            end = self.partner(end)
        end += 1
        while True:
            after = self.get(end)
            if after.text == "." and self.get(end + 1).kind == "name":
                end += 2
            elif after.text in ("(", "[") and after.start == self.get(end - 1).end:
                end = self.partner(end) + 1
            else:
                return min(end, len(self.tokens))

    def partner(self, index: int) -> int:
        """Return the index of the bracket that closes one, or the last of its line."""
        depth = 0
        line = self.tokens[index].line
        for end in range(index, len(self.tokens)):
            text = self.tokens[end].text
            depth += (text in _OPENING) - (text in _CLOSING)
            if not depth or self.get(end + 1).line != line:
                return end
        return len(self.tokens) - 1

    def around(self, index: int) -> str:
        """Return the innermost bracket that is open at a token."""
        depth = 0
        for token in reversed(self.tokens[:index]):
            depth += (token.text in _CLOSING) - (token.text in _OPENING)
            if depth < 0:
                return token.text
        return ""

    def is_gap(self, index: int) -> bool:
        """Return whether a token and the next one cannot be neighbours: two values, one after the other."""
        left, right = self.get(index), self.get(index + 1)
        if left.line != right.line or _NOTHING in (left, right) or not _is_value_end(left):
            return False
        return _is_value_start(right) and not (left.kind == right.kind == "string")

    def piece(self, start: int, end: int) -> str:
        """Return some of the text for a message."""
        text = " ".join(self.text[start:end].split()).replace("`", "'")
        return text if len(text) <= 30 else f"{text[:29]}…"


_NOTHING = _Token("end", "", -1, -1, -1, 0)


def _tokens(text: str) -> Iterator[_Token]:
    position = line = depth = 0
    begins = True
    while match := _TOKEN.match(text, position):
        kind: str = match.lastgroup  # type: ignore[assignment]
        start, position = match.span()
        if kind == "line":
            line, begins = line + 1, True
            continue
        if kind == "blank":
            line += kind == "blank" and match[0][:1] == "\\"
            continue
        if kind == "string":
            position, closed = string_end(text, position - 1, 0)
            kind = "string" if closed else "open"
        word = text[start:position]
        if kind == "name" and not word.isidentifier():  # `y²`: some characters of words are not of names
            good = next(size for size in range(len(word), -1, -1) if word[:size].isidentifier() or not size)
            kind, position = ("name", start + good) if good else ("other", start + 1)
            word = text[start:position]
        if begins and word in _HEADERS | _SIMPLE and word not in ("if", "else", "for"):
            depth = 0  # an unclosed bracket does not reach across statements
        begins = False
        if word in _CLOSING:
            depth = max(depth - 1, 0)
        yield _Token(kind, word, start, position, line, depth)
        if word in _OPENING:
            depth += 1
        line += sum(1 for _ in _LINE_END.finditer(word)) if kind in ("string", "open") else 0


_LINE_END = re.compile(r"\r\n|\r|\n")


def _is_value_end(token: _Token) -> bool:
    if token.kind == "name":
        return not iskeyword(token.text) or token.text in _VALUES
    return token.kind in ("number", "string", "open") or token.text in _CLOSING


def _is_value_start(token: _Token) -> bool:
    if token.kind == "name":
        return not iskeyword(token.text) or token.text in _VALUES or token.text in ("lambda", *_SIMPLE)
    return token.kind in ("number", "string", "open")


# The rules, in the order in which they are tried


class _Guess(NamedTuple):
    """What may be wrong, and the edits that would repair it; `is_certain`: nothing else can be meant."""

    code: str
    message: str
    start: int
    end: int
    edits: tuple[Edit, ...]
    is_certain: bool = True


_Candidates = Iterator[_Guess]


def _candidates(code: _Code) -> _Candidates:
    for rule in _RULES:
        yield from rule(code)


def _change(token: _Token, text: str, number: str, message: str) -> _Guess:
    return _Guess(number, message, token.start, token.end, (Edit(token.start, token.end, text),))


def _worded(text: str, start: int, end: int, word: str) -> Edit:
    """Return the edit that writes a word instead of a sign, with blanks around it."""
    before = "" if text[start - 1 : start].isspace() or start == 0 else " "
    return Edit(start, end, f"{before}{word}" + ("" if text[end : end + 1].isspace() else " "))


def _signs(code: _Code) -> _Candidates:
    """Signs of other languages; all of one kind are one slip."""
    found: dict[str, list[int]] = {}
    for index, token in enumerate(code.tokens):
        if token.kind == "sign" and token.text in _MEANT:
            found.setdefault(token.text, []).append(index)
    for sign, indices in found.items():
        for meant in _MEANT[sign]:
            edits = []
            for index in indices:
                start, end = code.tokens[index].start, code.tokens[index].end
                if meant.isalpha():
                    edits.append(_worded(code.text, start, end, meant))
                elif meant == ".":
                    edits.append(Edit(code.tokens[index - 1].end if index else start, end, meant))
                else:
                    edits.append(Edit(start, end, meant))
            first = code.tokens[indices[0]]
            message = f"Python has no `{sign}`. Write `{meant.strip()}`."
            yield _Guess("LRP510", message, first.start, first.end, tuple(edits))
    yield from _negations(code)
    yield from _increments(code)
    yield from _assignments(code)
    for first, second in pairwise(code.tokens):
        if (
            second.text == "="
            and first.text in "=!<>+-*/"
            and first.end < second.start
            and first.kind == "sign"
        ):
            sign = f"{first.text}="
            message = f"`{code.text[first.start : second.end]}` is two signs. Write `{sign}`."
            yield _Guess("LRP510", message, first.start, second.end, (Edit(first.start, second.end, sign),))


_MEANT: dict[str, tuple[str, ...]] = {
    "&&": ("and",),
    "||": ("or",),
    "===": ("==",),
    "!==": ("!=",),
    "=>": (">=", ":"),
    "=<": ("<=",),
    "<>": ("!=",),
    "=:": ("=",),
    "::": (".", ":"),
    "->": (".", "="),
}


def _negations(code: _Code) -> _Candidates:
    signs = [index for index, token in enumerate(code.tokens) if token.text in ("!", "=!")]
    if not signs:
        return
    first = code.tokens[signs[0]]
    for index in signs:
        token, after = code.tokens[index], code.get(index + 1)
        if token.text == "=!" and (after.kind in ("number", "string") or not code.begins(index - 1)):
            yield _change(token, "!=", "LRP510", "Python has no `=!`. Write `!=`.")
    for wrapped in (False, True):
        edits = []
        for index in signs:
            token = code.tokens[index]
            word = "= not" if token.text == "=!" else "(not" if wrapped else "not"
            edits.append(_worded(code.text, token.start, token.end, word))
            if edits[-1].text.startswith(" (") or code.get(index - 1).text in _OPENING:
                edits[-1] = edits[-1]._replace(text=edits[-1].text.lstrip())
            if code.get(index + 1).start > token.end and edits[-1].text.endswith(" "):
                edits[-1] = edits[-1]._replace(text=edits[-1].text.rstrip())
            if wrapped and token.text == "!":
                end = code.tokens[code.chain_end(index + 1) - 1].end
                edits.append(Edit(end, end, ")"))
        yield _Guess(
            "LRP510", f"Python has no `{first.text}`. Write `not`.", first.start, first.end, tuple(edits)
        )
    for index in signs:
        yield _change(
            code.tokens[index], "!=", "LRP510", f"Python has no `{code.tokens[index].text}`. Write `!=`."
        )


def _increments(code: _Code) -> _Candidates:
    for index, token in enumerate(code.tokens):
        if token.text not in ("++", "--"):
            continue
        added = f" {token.text[0]}= 1"
        message = f"Python has no `{token.text}`. Write `{added.strip()}`."
        if code.ends(index + 1):
            edit = Edit(code.get(index - 1).end if index else token.start, token.end, added)
            yield _Guess("LRP510", message, token.start, token.end, (edit,))
        elif code.begins(index):
            end = code.tokens[code.chain_end(index + 1) - 1].end
            edits = (Edit(token.start, code.tokens[index + 1].start, ""), Edit(end, end, added))
            yield _Guess("LRP510", message, token.start, token.end, edits)


def _assignments(code: _Code) -> _Candidates:
    signs = [index for index, token in enumerate(code.tokens) if token.text == ":="]
    plain = [
        index
        for index in signs
        if any(
            code.begins(start) and code.chain_end(start) == index for start in range(max(index - 9, 0), index)
        )
    ]
    message = "`:=` belongs outside of blocks. In Python, `=` assigns: write `=`."
    if plain and not code.is_condition:
        first = code.tokens[plain[0]]
        edits = tuple(Edit(code.tokens[index].start, code.tokens[index].end, "=") for index in plain)
        yield _Guess("LRP510", message, first.start, first.end, edits)
    for index in signs:
        if code.is_condition:
            yield _change(code.tokens[index], "==", "LRP516", "`:=` assigns. Write `==` to compare.")
        yield _change(code.tokens[index], "=", "LRP510", message)
        yield _change(code.tokens[index], "==", "LRP516", "`:=` assigns. Write `==` to compare.")


def _characters(code: _Code) -> _Candidates:
    """Characters that Python does not know: typographic quotes, mathematical signs, invisible ones."""
    strange = [token for token in code.tokens if token.kind == "other"]
    for chosen in ([token for token in strange if _ascii(token.text) in ("'", '"')], strange):
        known = [token for token in chosen if _ascii(token.text) is not None]
        if known:
            edits = [_written(code.text, token, _ascii(token.text) or "") for token in known]
            first, meant = known[0], _ascii(known[0].text) or ""
            remedy = f"Write `{meant}`" if meant.strip() else "Write a blank" if meant else "Remove it"
            shown = f"`{first.text}`" if first.text.isprintable() else "this invisible character"
            message = f"Python does not know {shown}. {remedy}."
            yield _Guess("LRP510", message, first.start, first.end, tuple(edits))
    for token in strange[:3]:
        shown = f"`{token.text}`" if token.text.isprintable() else "this invisible character"
        message = f"Python does not know {shown}. Remove it."
        yield _change(token, "", "LRP510", message)


_SIGNS = {
    **dict.fromkeys("“”„‟«»″", '"'),
    **dict.fromkeys("‘’‚‛´′`", "'"),
    **dict.fromkeys("−–—‐‑", "-"),
    **dict.fromkeys("×·⋅∙", "*"),
    **dict.fromkeys("\u200b\u200c\u200d\u2060\ufeff\u00ad\u200e\u200f", ""),
    "≤": "<=", "⩽": "<=", "≥": ">=", "⩾": ">=", "≠": "!=", "≡": "==", "÷": "/", "∕": "/",
    "²": "**2", "³": "**3",
    "∧": "and", "∨": "or", "¬": "not", "←": "=", "≔": "=", "…": "...", "→": ".",
}  # fmt: skip


def _written(text: str, token: _Token, meant: str) -> Edit:
    if meant.isalpha():
        return _worded(text, token.start, token.end, meant)
    return Edit(token.start, token.end, meant)


def _ascii(character: str) -> str | None:
    meant = _SIGNS.get(character)
    if meant is None:
        plain = unicodedata.normalize("NFKC", character)
        meant = plain if plain.isascii() and plain != character and plain.isprintable() else None
    return meant


def _comments(code: _Code) -> _Candidates:
    """Comments as the text outside of blocks, or another language, writes them."""
    for index in code.near():
        token, after = code.tokens[index], code.get(index + 1)
        if token.text in (";", "//", "--") and after.line == token.line and after.text not in (";", "}"):
            message = f"In a block, `{token.text}` does not begin a comment. Write `#`."
            yield _change(token, "#", "LRP510", message)
        elif token.text == "/" and after.text.startswith("*") and after.start == token.end:
            end = code.text.find("*/", after.end)
            edits = [Edit(token.start, after.end, "#")]
            if end >= 0:
                edits.append(Edit(end, end + 2, ""))
            yield _Guess("LRP510", "Python has no `/*`. Write `#`.", token.start, after.end, tuple(edits))


def _numbers(code: _Code) -> _Candidates:
    for index in code.near():
        token = code.tokens[index]
        if token.kind != "number":
            continue
        comma, after = code.get(index + 1), code.get(index + 2)
        if comma.text == "," and after.kind == "number" and token.end == comma.start == after.start - 1:
            edit = Edit(comma.start, comma.end, ".")
            message = f"A decimal number has a point. Write `{token.text}.{after.text}`."
            yield _Guess("LRP510", message, token.start, after.end, (edit,))
        if re.fullmatch(r"0+[1-9]\d*", token.text):
            plain = token.text.lstrip("0")
            message = f"A number does not begin with 0. Write `{plain}`."
            yield _change(token, plain, "LRP501", message)
        if match := re.fullmatch(r"(\d+(?:\.\d*)?)(ms|s|m|cm|mm|rad|deg|hz|Hz|px)", token.text):
            message = f"Python knows no units. Write the number alone: `{match[1]}`."
            yield _change(token, match[1], "LRP510", message)
        elif match := re.fullmatch(r"(\d+)([A-Za-z_]\w*)", token.text):
            message = (
                f"`{token.text}` is neither a number nor a name. Write `{match[1]} * {match[2]}` to multiply."
            )
            yield _change(token, f"{match[1]} * {match[2]}", "LRP501", message)


def _strings(code: _Code) -> _Candidates:
    """Strings without their first or second quote, or with one inside."""
    for index, token in enumerate(code.tokens):
        after = code.get(index + 1)
        if token.kind == "string" and after.kind == "name" and after.start == token.end:
            last = next((each for each in code.tokens[index:] if each.kind == "open"), None)
            other = '"' if token.text[0] == "'" else "'"
            if last and last.line == token.line and last.text[0] == token.text[0] != other:
                whole = code.text[token.start + 1 : last.start]
                if other not in whole:
                    message = (
                        f"The `{token.text[0]}` inside ends this string. Write it with `{other}` around it."
                    )
                    pair = (
                        Edit(token.start, token.start + 1, other),
                        Edit(last.start, last.start + 1, other),
                    )
                    yield _Guess("LRP514", message, token.start, last.start + 1, pair)
    for index, token in enumerate(code.tokens):
        start = index - 1
        if token.kind not in ("string", "open") or code.get(start).kind != "name":
            continue
        if code.get(start).end == token.start:  # a name does not touch the quote after it
            while code.get(start - 1).kind == "name" and code.get(start - 1).line == token.line:
                start -= 1
            word, quote = code.tokens[start], token.text.lstrip("rbuftRBUFT")[:1]
            message = f"This string has no quote at its beginning. Write `{quote}` before `{word.text}`."
            edit = Edit(word.start, word.start, quote)
            yield _Guess("LRP514", message, word.start, token.start + 1, (edit,))
    for token in code.tokens:
        if token.kind != "open":
            continue
        quote = token.text.lstrip("rbuftRBUFT")[:1]
        if token.text.lstrip("rbuftRBUFT")[:3] == quote * 3:
            message = f"This string is not closed. Write `{quote * 3}` at its end."
            end = len(code.text.rstrip())
            yield _Guess("LRP514", message, token.start, token.start + 3, (Edit(end, end, quote * 3),))
            continue
        content = token.text[1:]
        bare = content.rstrip(" \t)]}:,;")
        if bare[-1:] in ("'", '"') and bare[-1:] != quote:  # closed by the other kind of quote
            end = token.start + 1 + len(bare)
            message = f"A string ends with the quote that it begins with. Write `{quote}` here."
            yield _Guess("LRP514", message, token.start, end, (Edit(end - 1, end, quote),))
        ends = [token.start + 1 + match.start() for match in re.finditer(r"\)(?=\s*;)", content)]
        ends += [token.start + 1 + size for size in range(len(bare), len(content) + 1)]
        is_certain = "," not in bare
        for end in ends:
            shown = code.piece(token.start + 1, end)
            message = f"This string is not closed. Write `{quote}` after `{shown}`."
            yield _Guess("LRP514", message, token.start, end, (Edit(end, end, quote),), is_certain)


def _brackets(code: _Code) -> _Candidates:
    """Brackets that are missing or superfluous."""
    opened: list[int] = []
    unmatched: list[int] = []
    pairs: list[tuple[int, int]] = []
    for index, token in enumerate(code.tokens):
        if token.kind != "sign":
            continue
        if token.text in _OPENING:
            opened.append(index)
        elif token.text in _CLOSING:
            if opened and code.tokens[opened[-1]].text == _CLOSING[token.text]:
                pairs.append((opened.pop(), index))
            else:
                unmatched.append(index)
    for index in unmatched:
        yield from _unmatched(code, index, opened)
    for index in reversed(opened):
        yield from _unclosed(code, index)


def _unmatched(code: _Code, index: int, opened: list[int]) -> _Candidates:
    token = code.tokens[index]
    around = next((each for each in reversed(opened) if each < index), None)
    if around is not None:
        meant = _OPENING[code.tokens[around].text]
        message = f"`{token.text}` does not close `{code.tokens[around].text}`. Write `{meant}`."
        yield from _unclosed(code, around, index)
        yield _change(token, meant, "LRP513", message)
    opening = _CLOSING[token.text]
    for gap in range(index - 2, -1, -1):
        left, right = code.get(gap), code.get(gap + 1)
        if left.line != token.line or left.text in (";", ":"):
            break
        if (code.is_gap(gap) and left.kind == "name") or (
            left.kind == "name" and right.kind in ("string", "number")
        ):
            message = f"A `(` is missing after `{left.text}`. Insert it."
            yield _Guess("LRP513", message, left.start, right.end, (Edit(left.end, right.start, opening),))
    before = code.get(index - 1)
    if before.kind == "name" and code.get(index - 2).text == "." and not iskeyword(before.text):
        message = f"A `{opening}` is missing after `{before.text}`. Insert it."
        yield _Guess("LRP513", message, before.start, token.end, (Edit(token.start, token.start, opening),))
    message = f"Unmatched `{token.text}`: no `{opening}` is open here. Remove it."
    yield _change(token, "", "LRP513", message)


_MEASURES = frozenset({"abs", "len", "min", "max", "round", "int", "float", "sum", "sqrt", "hypot"})
_COMPARISONS = frozenset({"<", ">", "<=", ">=", "==", "!=", "and", "or", "if", "else"})


def _unclosed(code: _Code, index: int, stop: int | None = None) -> _Candidates:
    """Close a bracket: in its line, then at the ends of later lines."""
    token = code.tokens[index]
    closing = _OPENING[token.text]
    inside = [each for each in range(index, len(code.tokens)) if code.tokens[each].line == token.line]
    ends = [inside[-1]]
    is_call = code.get(index - 1).text in _MEASURES
    depth = 0
    for each in inside[1:]:
        text = code.tokens[each].text
        depth += (text in _OPENING) - (text in _CLOSING)
        if is_call and not depth and text in _COMPARISONS:
            ends.insert(0, each - 1)
            break
    if stop is not None:
        ends = [stop - 1]
    last = code.tokens[ends[-1]]
    if last.text in (":", ";", ",") and stop is None:
        ends.insert(-1, ends[-1] - 1)
        while code.tokens[ends[-2]].text in (":", ";", ","):
            ends[-2] -= 1
    if stop is None:
        for each in inside[1:-1]:
            if code.tokens[each].text in (":", ";") and code.tokens[each - 1].text not in (":", ";"):
                ends.insert(0 if code.tokens[each].text == ":" else len(ends), each - 1)
        ends += reversed(inside[:-1])
        later = [line[-1] for line in code.lines() if code.tokens[line[0]].line > token.line]
        ends += later[:6]
    for each in dict.fromkeys(ends):
        end = code.tokens[each].end
        if each == index and token.text != "(":
            continue
        shown = code.piece(code.tokens[max(each - 2, index)].start if each > index else token.start, end)
        message = f"This `{token.text}` is not closed. Write `{closing}` after `{shown}`."
        yield _Guess("LRP513", message, token.start, token.end, (Edit(end, end, closing),))


def _keywords(code: _Code) -> _Candidates:
    """Keywords that are misspelt, or those of other languages."""
    for index in code.near():
        token, after = code.tokens[index], code.get(index + 1)
        if token.kind != "name":
            continue
        word = token.text
        if word in ("then", "do") and (not code.begins(index) or code.get(index - 1).text == ":"):
            before = code.get(index - 1)
            if ":" in (after.text, before.text):
                message = f"Python has no `{word}`. Remove it."
                yield _Guess("LRP511", message, token.start, token.end, (Edit(before.end, token.end, ""),))
            else:
                message = f"Python has no `{word}`. Write `:`."
                yield _Guess("LRP511", message, token.start, token.end, (Edit(before.end, token.end, ":"),))
        if word == "else" and after.text == "if" and after.line == token.line:
            edit = Edit(token.start, after.end, "elif")
            yield _Guess("LRP511", "Python writes `else if` in one word. Write `elif`.", *edit[:2], (edit,))
        if word in _DECLARING and after.kind == "name" and code.begins(index):
            message = f"Python has no `{word}`. Write the assignment without it."
            edits = [Edit(token.start, after.start, "")]
            if code.get(index + 2).text == ":=":
                edits.append(Edit(code.get(index + 2).start, code.get(index + 2).end, "="))
            yield _Guess("LRP511", message, token.start, token.end, tuple(edits))
        if word in _ENDING and code.begins(index) and code.ends(index + 1):
            message = f"Python has no `{word}`; the lines further right belong together. Remove it."
            yield _change(token, "", "LRP511", message)
        for meant in _meant(word):
            if meant == word.lower():
                message = f"Python writes `{meant}` in small letters. Write `{meant}`."
            elif word.lower() in _SYNONYMS:
                message = f"Python has no `{word}`. Write `{meant}`."
            else:
                message = f"`{word}` is not a keyword of Python. Did you mean `{meant}`?"
            yield _change(token, meant, "LRP511", message)
        for keyword in ("return", "not", "if", "while", "elif", "import"):
            rest = word.removeprefix(keyword)
            if rest != word and rest and not iskeyword(word):
                message = f"A blank is missing. Write `{keyword} {rest}`."
                yield _change(token, f"{keyword} {rest}", "LRP511", message)


_DECLARING = frozenset({
    "var", "let", "const", "int", "float", "double", "bool", "boolean", "string", "auto", "my", "dim",
    "local", "set", "call", "new",
})  # fmt: skip
_ENDING = frozenset({"end", "endif", "endwhile", "endfor", "fi", "done", "od", "begin"})
_SYNONYMS = {
    "function": "def", "func": "def", "fun": "def", "proc": "def", "sub": "def", "elseif": "elif",
    "elsif": "elif", "elsef": "elif", "foreach": "for", "unless": "if not", "until": "while not",
    "catch": "except", "throw": "raise", "switch": "match", "otherwise": "else", "when": "if", "mod": "%",
    "div": "//", "xor": "!=", "equals": "==", "eq": "==", "of": "in",
}  # fmt: skip


@lru_cache(maxsize=1024)
def _meant(word: str) -> tuple[str, ...]:
    """Return the keywords that a word may be meant for, the most similar first."""
    if iskeyword(word):
        return ()
    small = word.lower()
    if small in _SYNONYMS:
        return (_SYNONYMS[small],)
    if iskeyword(small):
        return (small,)
    found = []
    for keyword in kwlist:
        if keyword in _VALUES or abs(len(keyword) - len(small)) > 2:
            continue
        if len(keyword) == 2:
            is_similar = sorted(small) == sorted(keyword) or (len(small) == 3 and set(small) == set(keyword))
        else:
            is_similar = sorted(small) == sorted(keyword) or (
                SequenceMatcher(None, small, keyword).ratio() >= (0.7 if len(keyword) > 3 else 0.79)
            )
        if is_similar:
            found.append((-SequenceMatcher(None, small, keyword).ratio(), keyword))
    return tuple(keyword for _, keyword in sorted(found)[:3])


def _calls_in_brackets(code: _Code) -> _Candidates:
    """Change the brackets of a call into parentheses."""
    for index in code.near():
        token, before = code.tokens[index], code.get(index - 1)
        if token.text in ("[", "{") and before.kind == "name" and before.end == token.start:
            last = code.partner(index)
            if any(each.text == "=" for each in code.tokens[index:last]):
                message = f"A call has parentheses. Write `(` instead of `{token.text}`."
                end = code.tokens[last]
                edits = (Edit(token.start, token.end, "("), Edit(end.start, end.end, ")"))
                yield _Guess("LRP513", message, token.start, token.end, edits)


def _conditions(code: _Code) -> _Candidates:
    """Conditions that are written like a statement: `if x > 1:`."""
    if not code.is_condition or not code.tokens:
        return
    first, second, last = code.tokens[0], code.get(1), code.tokens[-1]
    edits = []
    if first.text.lower() in ("if", "when", "while", "until") and second.start >= 0:
        edits.append(Edit(first.start, second.start, ""))
    if last.text in (":", "then"):
        edits.append(Edit(code.get(len(code.tokens) - 2).end, last.end, ""))
    if edits:
        word = first if edits[0].start == first.start else last
        message = f"A condition is written without `{word.text}`. Remove it."
        yield _Guess("LRP511", message, word.start, word.end, tuple(edits))


def _forms(code: _Code) -> _Candidates:
    """Forms of the program inside a block."""
    for index in code.near():
        token, word = code.tokens[index], code.get(index + 1)
        if token.text == "(" and word.text in _FORMS and code.get(index + 2).kind == "name":
            end = code.tokens[code.partner(index)].end
            message = (
                f"`({word.text} …)` is a form of the program, not Python. Put it after the `]` of this block."
            )
            yield _Guess("LRP510", message, token.start, word.end, (Edit(token.start, end, "pass"),), False)


_FORMS = frozenset(
    {"var", "event", "machine", "state", "spawn", "on", "ontime", "eps", "onentry", "running", "onexit"}
)


def _braces(code: _Code) -> _Candidates:
    """Braces around statements."""
    edits: list[Edit] = []
    first: _Token | None = None
    depth = 0
    for index, token in enumerate(code.tokens):
        before, after = code.get(index - 1), code.get(index + 1)
        if token.text == "{" and (before.text in (")", *_BARE) or _is_value_end(before)):
            depth += 1
            first = first or token
            edits.append(Edit(before.end, token.end, ":"))
        elif (
            token.text == "}"
            and depth
            and (code.begins(index) or code.ends(index + 1) or code.begins(index - 1))
        ):
            depth -= 1
            end = after.start if after.line == token.line else token.end
            start = token.start
            if before.line == token.line:
                start = before.end if after.line != token.line else start
            edits.append(Edit(start, end, ""))
        elif token.text == "}" and depth:
            depth -= 1
            edits.append(Edit(token.start, token.end, ""))
    if first is not None:
        message = "Python has no braces around statements. Write `:` instead of `{`, and remove the `}`."
        yield _Guess("LRP510", message, first.start, first.end, tuple(edits))


def _colons(code: _Code) -> _Candidates:
    """Headers without their colon, and colons that do not belong."""
    for line in code.lines():
        head, last = code.tokens[line[0]], code.tokens[line[-1]]
        if not code.is_near(head) or head.kind != "name":
            continue
        if head.text not in _HEADERS:
            if last.text == ":":
                message = "Only a header such as `if …:` ends with `:`. Remove it."
                yield _Guess("LRP512", message, last.start, last.end, (Edit(last.start, last.end, ""),))
            continue
        message = f"This `{head.text}` needs a `:`. Write it after `{{}}`."
        if head.text == "def" and last.kind == "name" and len(line) == 2:
            edits = (Edit(last.end, last.end, "():"),)
            yield _Guess(
                "LRP512", f"This `def` needs `():`. Write it after `{last.text}`.", *head[2:4], edits
            )
        if head.text == "def" and len(line) > 2 and code.get(line[2]).text == ":":
            name = code.get(line[1])
            message = f"A function needs parentheses. Write `{name.text}()`."
            yield _Guess("LRP513", message, name.start, name.end, (Edit(name.end, name.end, "()"),))
        ends = [line[0]] if head.text in _BARE else []
        for index in line[1:-1]:
            after = code.tokens[index + 1]
            is_start = after.kind == "name" and (after.text in _SIMPLE or not iskeyword(after.text))
            if _is_value_end(code.tokens[index]) and is_start:
                ends.append(index)
        if last.text in (";", ",", ".", "=", "->", "=>", "{"):
            index = line[-1] - 1
            shown = code.piece(head.start, code.tokens[index].end)
            fault = f"`{last.text}` does not end a header. Write `:`."
            yield _Guess("LRP512", fault, last.start, last.end, (Edit(last.start, last.end, ":"),))
        ends.insert(0 if head.text not in _BARE else 1, line[-1])
        colons = [index for index in line if code.tokens[index].text == ":" and not code.tokens[index].depth]
        for index in dict.fromkeys(ends):
            if colons and index < colons[-1]:
                continue
            end = code.tokens[index].end
            shown = code.piece(head.start, end)
            yield _Guess("LRP512", message.format(shown), head.start, end, (Edit(end, end, ":"),))
        for index in line[1:]:
            token = code.tokens[index]
            if token.text in (";", ",") and not (token.depth or colons):
                fault = f"`{token.text}` does not end a header. Write `:`."
                yield _Guess("LRP512", fault, token.start, token.end, (Edit(token.start, token.end, ":"),))


def _equals(code: _Code) -> _Candidates:
    """Compare instead of assigning, and give an argument its value with `=`."""
    signs = [token for token in code.tokens if token.text == "=" and not token.depth]
    if code.is_condition and len(signs) > 1:
        edits = tuple(Edit(token.start, token.end, "==") for token in signs)
        yield _Guess("LRP516", "`=` assigns. Write `==` to compare.", signs[0].start, signs[0].end, edits)
    for index in code.near():
        token = code.tokens[index]
        if token.text == "," and not token.depth and code.get(index + 2).text == "=":
            message = f"A comma does not separate statements. Write `;` before `{code.get(index + 1).text}`."
            yield _change(token, ";", "LRP516", message)
        elif token.text == ";" and code.around(index) == "(":
            yield _change(token, ",", "LRP516", "Arguments are separated by commas. Write `,`.")
    for index in code.near():
        token = code.tokens[index]
        if token.text == "=":
            if code.around(index) == "{":
                yield _change(token, ":", "LRP516", "In `{ }`, a value comes after `:`. Write `:`.")
            before = [each.text for each in code.tokens[:index] if each.line == token.line]
            compares = not {"if", "elif", "while", "assert", "return", "not"}.isdisjoint(before)
            if compares or code.is_condition:
                yield _change(token, "==", "LRP516", "`=` assigns. Write `==` to compare.")
            elif "==" in code.problem or "assign" in code.problem:
                message = "Only a name can be assigned. Write one before the `=`, or `==` to compare."
                yield _change(token, "==", "LRP516", message)._replace(is_certain=False)
        elif token.text == ":" and code.around(index) == "(" and code.get(index - 1).kind == "name":
            name = code.tokens[index - 1].text
            message = f"An argument has its value after `=`. Write `{name}=`."
            after = code.get(index + 1)
            yield _Guess("LRP516", message, token.start, token.end, (Edit(token.start, after.start, "="),))


def _negated(code: _Code) -> _Candidates:
    """`not` in the wrong place."""
    for index in code.near():
        token, before, after = code.tokens[index], code.get(index - 1), code.get(index + 1)
        if token.text != "not":
            continue
        if before.text == "is" and after.text in _OPPOSITE:
            message = f"`is not` comes before a value. Write `{_OPPOSITE[after.text]}`."
            yield _Guess("LRP517", message, before.start, after.end,
                             (Edit(before.start, after.end, _OPPOSITE[after.text]),))  # fmt: skip
        if after.text in _OPPOSITE:
            meant = _OPPOSITE[after.text]
            message = f"`not` does not negate the sign after it. Write `{meant}`."
            yield _Guess("LRP517", message, token.start, after.end, (Edit(token.start, after.end, meant),))
        if _is_value_end(before):
            yield _change(token, "and not", "LRP517", "Something is missing before `not`. Write `and not`.")
            yield _change(token, "!=", "LRP517", "`not` does not compare. Write `!=`.")
        end = code.get(code.chain_end(index + 1) - 1).end
        shown = code.piece(token.start, end)
        edits = (Edit(token.start, token.start, "("), Edit(end, end, ")"))
        yield _Guess("LRP517", f"This `not` needs parentheses. Write `({shown})`.", token.start, end, edits)
    for index in code.near():
        token, after = code.tokens[index], code.get(index + 1)
        if token.text == "is" and after.text in _OPPOSITE:
            message = f"`is` and `{after.text}` do not go together. Write `{after.text}`."
            yield _Guess("LRP517", message, token.start, after.end, (Edit(token.start, after.start, ""),))


_OPPOSITE = {"==": "!=", "=": "!=", "!=": "==", "<": ">=", ">": "<=", "<=": ">", ">=": "<"}


def _conditionals(code: _Code) -> _Candidates:
    """Conditional expressions of other languages: ``test ? one : other``."""
    for index in code.near():
        token = code.tokens[index]
        if token.text != "?":
            continue
        colon = next(
            (each for each in range(index, code.statement_end(index)) if code.get(each).text == ":"), None
        )
        start = index
        while not code.begins(start) and code.get(start - 1).text not in ("=", "return", "(", ",", "[", "+="):
            start -= 1
        if colon is None or start == index:
            continue
        end = code.statement_end(colon)
        while end > colon + 1 and code.get(end - 1).text in (")", "]") and code.around(end - 1) == "":
            end -= 1
        first, middle, last = (
            code.text[code.tokens[one].start : code.tokens[other - 1].end]
            for one, other in ((start, index), (index + 1, colon), (colon + 1, end))
            if other > one
        )
        meant = f"{middle} if {first} else {last}"
        edit = Edit(code.tokens[start].start, code.tokens[end - 1].end, meant)
        shown = " ".join(meant.replace("`", "'").split())
        yield _Guess("LRP510", f"Python has no `?`. Write `{shown}`.", token.start, token.end, (edit,))


def _unfinished(code: _Code) -> _Candidates:
    """Operators with nothing after them."""
    for index in code.near():
        token = code.tokens[index]
        is_last = code.ends(index + 1) or code.get(index + 1).text in _CLOSERS
        if is_last and token.text in _OPERATORS:
            message = f"Something is missing after `{token.text}`. Complete it, or remove the `{token.text}`."
            edit = Edit(code.get(index - 1).end if index else token.start, token.end, "")
            yield _Guess("LRP501", message, token.start, token.end, (edit,), False)


_CLOSERS = frozenset({")", "]", "}", ":", ","})
_OPERATORS = frozenset({
    "+", "-", "*", "/", "%", "**", "//", "<", ">", "<=", ">=", "==", "!=", "=", "+=", "-=", "*=", "/=",
    "and", "or", "not", "in", "is", ",", ".", "&", "|",
})  # fmt: skip


def _gaps(code: _Code) -> _Candidates:
    """Two values without a sign between them: calls without parentheses, missing commas and points."""
    for index in code.near():
        if not code.is_gap(index):
            continue
        left, right = code.tokens[index], code.tokens[index + 1]
        between = Edit(left.end, right.start, "")
        if right.depth:
            message = f"A comma is missing between `{_short(left)}` and `{_short(right)}`. Insert it."
            yield _Guess("LRP517", message, left.start, right.end, (Edit(left.end, left.end, ","),))
        calls = list(_calls(code, index))
        is_member = left.kind == right.kind == "name" and _root(code, index) == "robot"
        if left.text != "robot" and (right.kind != "name" or code.get(index + 2).text == "="):
            yield from calls
        if is_member:
            message = f"A `.` is missing between `{left.text}` and `{right.text}`. Write it without blanks."
            yield _Guess("LRP517", message, left.start, right.end, (between._replace(text="."),))
        yield from calls
        before = [each.text for each in code.tokens[:index] if each.line == left.line]
        if right.kind == "name" and (left.text == ")" or "=" in before):
            message = f"Two statements are in one line. Write `;` before `{_short(right)}`, or a new line."
            yield _Guess("LRP517", message, left.start, right.end, (Edit(left.end, left.end, ";"),))
    for index in code.near():
        if code.is_gap(index):
            left, right = code.tokens[index], code.tokens[index + 1]
            if left.kind == "name" and right.kind == "name" and not iskeyword(right.text):
                glued = f"{left.text}_{right.text}"
                pair = f"`{left.text}` and `{right.text}`"
                message = f"A name has no blanks. Write `{glued}`, or a sign between {pair}."
                edit = Edit(left.start, right.end, glued)
                yield _Guess("LRP517", message, left.start, right.end, (edit,), False)


def _calls(code: _Code, index: int) -> _Candidates:
    """Yield the call of what ends at a token, with the rest of the statement as its arguments."""
    left, right = code.tokens[index], code.tokens[index + 1]
    start = index
    while code.get(start - 1).text == "." and code.get(start - 2).kind == "name":
        start -= 2
    stop = code.statement_end(index)
    if not code.begins(start):
        if left.text not in _FUNCTIONS:
            return
        stop = next((each for each in range(index, stop) if code.tokens[each].text in _AFTER), stop)
    if left.kind == "name":
        end = code.tokens[stop - 1].end
        call = code.piece(code.tokens[start].start, left.end) + "(" + code.piece(right.start, end) + ")"
        edits = (Edit(left.end, right.start, "("), Edit(end, end, ")"))
        is_certain = left.text in _FUNCTIONS or start < index or not _is_word(right)
        message = f"A call needs parentheses. Write `{call}`."
        yield _Guess("LRP517", message, left.start, end, edits, is_certain)


_FUNCTIONS = frozenset(
    {"print", "range", "abs", "len", "min", "max", "round", "int", "float", "str", "bool", "sum"}
)
_AFTER = frozenset({":", ";", "and", "or", "if", "else", "<", ">", "<=", ">=", "==", "!="})


def _is_word(token: _Token) -> bool:
    return token.kind == "name"


def _short(token: _Token) -> str:
    return " ".join(token.text.replace("`", "'").split())[:20]


def _root(code: _Code, index: int) -> str:
    while code.get(index - 1).text == ".":
        index -= 2
    return code.get(index).text


def _indentation(code: _Code) -> _Candidates:
    """Lines that begin in the wrong column; of several remedies, the smallest move."""
    lines = [(code.tokens[line[0]], code.tokens[line[-1]]) for line in code.lines()]
    margins: list[tuple[int, str, _Token, _Token]] = []  # line, white space before it, first and last token
    for head, last in lines:
        start = code.starts[min(head.line, len(code.starts) - 1)]
        white = code.text[start : head.start]
        if head.line == 0:
            white = " " * code.column
        margins.append((start, white, head, last))
    tabs = [row for row in margins if "\t" in row[1] and row[2].line]
    if tabs and ("tab" in code.problem or "indent" in code.problem):
        yield from _tabs(code, tabs)
    here = [head.text for head, _ in lines if head.line == code.at]
    if "indent" not in code.problem and not _PARTNERS.intersection(here):
        return
    around = [row for row in range(len(margins)) if abs(margins[row][2].line - code.at) <= 6]
    first = next((row for row in around if margins[row][2].line >= code.at), len(margins) - 1)
    widths = {len(white) for _, white, head, _ in margins if head.line or code.column}
    moves: list[tuple[tuple[int, int, int], _Guess]] = []
    for row in around:
        start, white, head, _ = margins[row]
        if head.line == 0:
            continue
        wanted = set(widths)
        if row:
            outer = len(margins[row - 1][1])
            if margins[row - 1][3].text == ":":
                wanted |= {outer + 2, outer + 4}
            following = [len(each[1]) for each in margins[row + 1 : row + 2]]
            if margins[row - 1][3].text == ":" and following and following[0] > outer:
                wanted = {following[0]}
        for width in wanted - {len(white)}:
            edit = Edit(start, start + len(white), " " * width)
            if row and margins[row - 1][3].text == ":" and width > len(white):
                keyword = margins[row - 1][2].text
                message = f"This line belongs to the `{keyword}` above. Start it further right."
            elif width < len(white):
                message = f"This line begins too far right. Start it {len(white) - width} to the left."
            else:
                message = f"This line begins too far left. Start it {width - len(white)} further right."
            rank = (abs(row - first), abs(width - len(white)), -width)
            place = (head.start, head.end)
            moves.append((rank, _Guess("LRP515", message, *place, (edit,))))
    ranks = [rank[:2] for rank, _ in moves]
    for rank, fault in sorted(moves, key=lambda move: move[0]):
        if ranks.count(rank[:2]) > 1:  # as far from one line above as from another
            message = "This line begins between two others. Start it below the line to which it belongs."
            fault = fault._replace(message=message, is_certain=False)
        yield fault


_PARTNERS = frozenset({"else", "elif", "except", "finally"})


def _tabs(code: _Code, tabs: list[tuple[int, str, _Token, _Token]]) -> _Candidates:
    message = "Tabs and blanks are mixed in front of this line. Use blanks only."
    for size in (8, 4, 2):
        edits = tuple(Edit(start, start + len(white), white.expandtabs(size)) for start, white, _, _ in tabs)
        head = tabs[0][2]
        yield _Guess("LRP515", message, head.start, head.end, edits)


def _strays(code: _Code) -> _Candidates:
    """Signs and words that should not be there."""
    for index in code.near():
        token = code.tokens[index]
        before = code.get(index - 1)
        if token.kind == "name" and token.text == before.text:
            edit = Edit(before.end, token.end, "")
            yield _Guess(
                "LRP501", f"`{token.text}` is written twice. Remove one.", token.start, token.end, (edit,)
            )
        elif token.kind == "sign" and token.text == before.text and token.text not in _OPENING:
            yield _change(token, "", "LRP501", f"`{token.text}` is written twice. Remove one.")
    for index in code.near():
        token = code.tokens[index]
        if token.kind == "sign" and token.text in (".", ",", ":", ";", "\\"):
            yield _change(token, "", "LRP501", f"There is a `{token.text}` too many. Remove it.")


_RULES: tuple[Callable[[_Code], _Candidates], ...] = (
    _conditions,
    _forms,
    _signs,
    _characters,
    _strings,
    _numbers,
    _calls_in_brackets,
    _braces,
    _brackets,
    _keywords,
    _negated,
    _colons,
    _equals,
    _comments,
    _conditionals,
    _unfinished,
    _gaps,
    _indentation,
    _strays,
)
