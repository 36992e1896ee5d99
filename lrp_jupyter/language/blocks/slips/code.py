"""A block that is not valid Python as the rules see it, and what a rule proposes."""

from __future__ import annotations

import re
from collections.abc import Iterator
from keyword import iskeyword
from typing import NamedTuple

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.program import line_starts
from lrp_jupyter.language.python.scanner import LINE_END, string_end


class PythonToken(NamedTuple):
    """A token of the text; `line` is from 0, `depth` the number of brackets that are open before it."""

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
OPENING = {"(": ")", "[": "]", "{": "}"}
CLOSING = {closing: opening for opening, closing in OPENING.items()}
VALUES = frozenset({"True", "False", "None"})
HEADERS = frozenset({
    "if", "elif", "else", "while", "for", "def", "class", "try", "except", "finally", "with", "match", "case",
})  # fmt: skip
BARE = frozenset({"else", "try", "finally"})
"""Headers with nothing between the keyword and its colon."""
SIMPLE = frozenset(
    {"return", "pass", "break", "continue", "raise", "del", "import", "from", "global", "assert"}
)


class WrongBlock:
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

    def is_near(self, token: PythonToken) -> bool:
        """Return whether a token is in the line in which Python gives up, or the one before."""
        return self.at - 1 <= token.line <= self.at

    def near(self) -> Iterator[int]:
        """Yield the tokens near the place, those of its own line first."""
        here = [index for index, token in enumerate(self.tokens) if token.line == self.at]
        yield from here
        before = max((token.line for token in self.tokens if token.line < self.at), default=-1)
        yield from (index for index, token in enumerate(self.tokens) if token.line == before)

    def get(self, index: int) -> PythonToken:
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
        if self.get(end).text in OPENING:
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

    def partner(self, index: int, across_lines: bool = False) -> int:
        """Return the index of the bracket that closes one, or the last of its line."""
        depth, last = 0, -1
        line = self.tokens[index].line
        for end in range(index, len(self.tokens)):
            text = self.tokens[end].text
            depth += (text in OPENING) - (text in CLOSING)
            if last < 0 and self.get(end + 1).line != line:
                last = end
            if not depth or (last >= 0 and not across_lines):
                return end
        return last

    def around(self, index: int) -> str:
        """Return the innermost bracket that is open at a token."""
        depth = 0
        for token in reversed(self.tokens[:index]):
            depth += (token.text in CLOSING) - (token.text in OPENING)
            if depth < 0:
                return token.text
        return ""

    def is_gap(self, index: int) -> bool:
        """Return whether a token and the next one cannot be neighbours: two values, one after the other."""
        left, right = self.get(index), self.get(index + 1)
        if left.line != right.line or _NOTHING in (left, right) or not is_value_end(left):
            return False
        return _is_value_start(right) and not (left.kind == right.kind == "string")

    def piece(self, start: int, end: int) -> str:
        """Return some of the text for a message."""
        text = " ".join(self.text[start:end].split()).replace("`", "'")
        return text if len(text) <= 30 else f"{text[:29]}…"


_NOTHING = PythonToken("end", "", -1, -1, -1, 0)


def _tokens(text: str) -> Iterator[PythonToken]:
    position = line = depth = 0
    begins = True
    while match := _TOKEN.match(text, position):
        kind: str = match.lastgroup  # type: ignore[assignment]
        start, position = match.span()
        if kind == "line":
            line, begins = line + 1, True
            continue
        if kind == "blank":
            line += match[0][:1] == "\\"
            continue
        if kind == "string":
            position, closed = string_end(text, position - 1, 0)
            kind = "string" if closed else "open"
        word = text[start:position]
        if kind == "name" and not word.isidentifier():  # `y²`: some characters of words are not of names
            good = next(size for size in range(len(word), -1, -1) if word[:size].isidentifier() or not size)
            kind, position = ("name", start + good) if good else ("other", start + 1)
            word = text[start:position]
        if begins and word in HEADERS | SIMPLE and word not in ("if", "else", "for"):
            depth = 0  # an unclosed bracket does not reach across statements
        begins = False
        if word in CLOSING:
            depth = max(depth - 1, 0)
        yield PythonToken(kind, word, start, position, line, depth)
        if word in OPENING:
            depth += 1
        line += sum(1 for _ in LINE_END.finditer(word)) if kind in ("string", "open") else 0


def is_value_end(token: PythonToken) -> bool:
    """Return whether a value may end with a token."""
    if token.kind == "name":
        return not iskeyword(token.text) or token.text in VALUES
    return token.kind in ("number", "string", "open") or token.text in CLOSING


def _is_value_start(token: PythonToken) -> bool:
    if token.kind == "name":
        return not iskeyword(token.text) or token.text in VALUES or token.text in ("lambda", *SIMPLE)
    return token.kind in ("number", "string", "open")


class Guess(NamedTuple):
    """What may be wrong, and the edits that would repair it.

    `is_certain`: nothing else can be meant. `is_form`: it is a form of the program, whatever is meant by it.
    """

    code: str
    message: str
    start: int
    end: int
    edits: tuple[Edit, ...]
    is_certain: bool = True
    is_form: bool = False


Guesses = Iterator[Guess]


def change(token: PythonToken, text: str, number: str, message: str) -> Guess:
    """Return the guess that another text was meant instead of a token."""
    return Guess(number, message, token.start, token.end, (Edit(token.start, token.end, text),))
