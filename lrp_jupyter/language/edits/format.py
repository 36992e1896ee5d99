"""The formatter: a program's text in the layout of the bundled programs. Only white space changes.

Every form of the top level and of a machine begins a line, as does every form of a state that does not fit in
one; what is inside a form is indented by two columns. Comments, blank lines and line ends stay, as does a
closing bracket on a separate line, below the beginning of its form.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.blocks.block_margins import STEP, aligned
from lrp_jupyter.language.parser import parse
from lrp_jupyter.language.python.scanner import LINE_END
from lrp_jupyter.language.reading.tokens import keyword_of, tokenize

_WIDTH = 90
_WHITE = re.compile(r"[\s\ufeff]*")  # as in `tokens`: a text may begin with a byte order mark
_GLUED = frozenset({("STAR", "MINUS"), ("MINUS", "LBRACE"), ("NAME", "DOT"), ("DOT", "NAME")})


def formatted(text: str) -> str:
    r"""Return the text of a program in the layout of the bundled programs.

    Its meaning, comments and line ends stay; only white space changes. Formatting it again changes nothing.

    Raises LRPSyntaxError: the text is not a program.

    >>> print(formatted("(machine m (state a(onentry [n=1])) ; so\n(ontime 300 a->a))(spawn m a)"))
    (machine m
      (state a (onentry [n=1])) ; so
      (ontime 300 a -> a))
    (spawn m a)
    <BLANKLINE>
    """
    parse(text)
    return _Layout(text).text()


def formatting(text: str) -> tuple[Edit, ...]:
    """Return the edits that :func:`formatted` makes, each of white space only; raise as it does."""
    after = formatted(text)
    edits = []
    old = new = 0
    while old < len(text) or new < len(after):
        end, new_end = _skip(text, old), _skip(after, new)
        if text[old:end] != after[new:new_end]:
            edits.append(Edit(old, end, after[new:new_end]))
        old, new = end + 1, new_end + 1
    return tuple(edits)


def _skip(text: str, offset: int) -> int:
    return _WHITE.match(text, offset).end()  # type: ignore[union-attr]


class _OpenForm(NamedTuple):
    """A form being written: its column, and whether each form in it begins a line."""

    column: int
    broken: bool


class _Layout:
    """Writes the tokens of a program, and the comments between them."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.tokens = tokenize(source)
        ends = LINE_END.search(source)
        self.newline = ends[0] if ends else "\n"
        self.lines: list[str] = []
        self.line = ""  # the last one, as written so far
        self.forms = [_OpenForm(-STEP, True)]

    def text(self) -> str:
        """Return the text in its new layout."""
        for index, (kind, _, _) in enumerate(self.tokens):
            form = self.forms.pop() if kind == "CLOSE" else self.forms[-1]
            self._gap(index, form)
            if kind == "OPEN":
                self.forms.append(_OpenForm(len(self.line), self._is_broken(index)))
            *above, last = LINE_END.split(self.line + self._word(index))
            self.lines += [line + self.newline for line in above]
            self.line = last
        self._gap(len(self.tokens), self.forms[-1])
        return "".join([*self.lines, self.line and self.line + self.newline])

    def _is_broken(self, index: int) -> bool:
        """Return whether each form inside a form begins a line: in a machine, and in a large state."""
        keyword = keyword_of(self.source, self.tokens[index])
        return keyword == "machine" or (keyword == "state" and not self._fits(index))

    def _fits(self, index: int) -> bool:
        """Return whether a state stays on one line: it is on one, it is short, and it has no machine."""
        width, depth, end = len(self.line), 0, index
        for token in self.tokens[index:]:
            depth += (token[0] == "OPEN") - (token[0] == "CLOSE")
            width += len(self._space(end)) * (end > index) + len(self._word(end))
            if keyword_of(self.source, token) == "machine" or width > _WIDTH:
                return False
            if not depth:
                break
            end += 1
        return not LINE_END.search(self.source, self.tokens[index][1], self.tokens[end][2])

    # -- white space and comments ------------------------------------------------------------------------

    def _gap(self, index: int, form: _OpenForm) -> None:
        """Write what precedes a token in a form: comments and white space."""
        kind = self.tokens[index][0] if index < len(self.tokens) else "END"
        beside, *lines = LINE_END.split(self._before(index))
        if not index:
            beside, lines = "", [beside, *lines]
        if kind != "END":
            del lines[-1:]  # the indentation of the token
        begins = kind == "OPEN" and form.broken
        if kind in ("OPEN", "BLOCK", "CLOSE"):
            begins = begins or "\n" in self._before(index) or "\r" in self._before(index)
        if beside.strip():
            self.line += (beside[: -len(beside.lstrip())] or " ") + beside.strip()
            begins = True
        is_blank = False
        for line in map(str.strip, lines):
            if line:
                self._begin(form.column + STEP, is_blank and form.broken)
                self.line += line
                begins = True
            is_blank = not line
        if kind == "END":
            return
        if kind == "CLOSE":
            is_blank = False
        if begins:
            self._begin(form.column + STEP * (kind != "CLOSE"), is_blank and form.broken)
        else:
            self.line += self._space(index)

    def _begin(self, column: int, below_a_blank: bool) -> None:
        """Begin a line."""
        if self.line or self.lines:
            self.lines.append(self.line + self.newline * (1 + below_a_blank))
        self.line = " " * column

    def _before(self, index: int) -> str:
        start = self.tokens[index - 1][2] if index else 0
        return self.source[start : self.tokens[index][1] if index < len(self.tokens) else len(self.source)]

    def _space(self, index: int) -> str:
        """Return the space before a token in its line."""
        before, kind = self.tokens[index - 1][0] if index else "", self.tokens[index][0]
        if not before or kind in ("CLOSE", "RBRACE") or before == "LBRACE" or (before, kind) in _GLUED:
            return ""
        if (before, kind) == ("STAR", "ARROW"):  # the paper writes `*->`
            return " " if self._before(index) else ""
        return " "

    # -- tokens ------------------------------------------------------------------------------------------

    def _word(self, index: int) -> str:
        """Return a token as it is written at this place."""
        kind, start, end = self.tokens[index]
        word = self.source[start:end]
        if kind == "BLOCK":
            return self._block(word[1:-1])
        if kind == "OPEN" and not set(";#") & set(word):  # else there is a comment before the keyword
            return f"({word[1:].strip()}"
        return word

    def _block(self, text: str) -> str:
        base = len(self.line) - len(self.line.lstrip())
        inside = aligned(text, len(self.line) + 1, base)
        ends = list(LINE_END.finditer(text))
        if ends and inside != text and not text[ends[-1].end() :].strip():
            inside += self.newline + " " * base  # the closing bracket stays on a separate line
        return f"[{inside}]"
