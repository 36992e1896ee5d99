"""The forms of a program's text with their brackets: where a new form goes, and how one is removed.

Edits made here change nothing else: comments, line ends and the layout of other forms stay, and a new form
is indented like the forms around it.
"""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Sequence
from functools import cached_property
from itertools import takewhile

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.blocks.block_margins import STEP, reindented
from lrp_jupyter.language.blocks.names_in_blocks import normal
from lrp_jupyter.language.python.scanner import LINE_END, strings
from lrp_jupyter.language.reading.tokens import ACTIONS, LEGAL, NAMED, Token, keyword_of, tokenize
from lrp_jupyter.language.triggers import FORMS

_ORDER = (
    *("var", "event", "onentry", "running", "onexit", "onpause", "onresume", "onend"),
    *("state", "machine", "spawn"),
)
_RANKS = {keyword: rank for rank, keyword in enumerate(_ORDER)} | dict.fromkeys(
    (*FORMS, "effect"), len(_ORDER)
)
"""The order of the forms in a form: a new one goes after the last one like it, or of a lower rank."""
_APART = frozenset({"machine", "spawn", "onpause"})  # at the top level: a blank line after another kind
_BLANKS = re.compile(r"[ \t]*")
_COMMENT = re.compile(r"[ \t]*[;#][^\r\n]*")


class WrittenForm:
    """A form as it is written: ``text[start:end]``; `head` is the end of its keyword and name.

    Its contents are read when they are needed, because an edit needs little of a long program.
    """

    def __init__(self, text: str, tokens: Sequence[Token], end: int | None = None) -> None:
        self._text, self._tokens = text, tokens
        kind, self.start, self.head = tokens[0]
        self.keyword = keyword_of(text, tokens[0]) if kind == "OPEN" else "program"
        self.end = tokens[-1][2] if end is None else end
        self.name: tuple[int, int] | None = None  # where it is, in a form that defines one
        if self.keyword in NAMED and tokens[1][0] == "NAME":
            self.name = tokens[1][1:]
            self.head = self.name[1]

    @cached_property
    def items(self) -> list[Token | WrittenForm]:
        """The tokens and forms in it."""
        found: list[Token | WrittenForm] = []
        begun = depth = 0
        inside = self._tokens[1 : len(self._tokens) - (self._tokens[0][0] == "OPEN")]
        for index, token in enumerate(inside):
            kind = token[0]
            if kind == "OPEN":
                begun = begun if depth else index
                depth += 1
            elif kind == "CLOSE":
                depth -= 1
                if not depth:
                    found.append(WrittenForm(self._text, inside[begun : index + 1]))
            elif not depth:
                found.append(token)
        return found

    @cached_property
    def forms(self) -> list[WrittenForm]:
        """The forms directly in it."""
        return [item for item in self.items if isinstance(item, WrittenForm)]

    @property
    def is_closed(self) -> bool:
        """Whether its closing bracket is there."""
        return self._tokens[-1][0] == "CLOSE" and self._tokens[-1][1] < self.end

    def around(self, offset: int) -> list[WrittenForm]:
        """Return itself and the forms in it that an offset is in, outer before inner."""
        found = [self]
        while inner := [form for form in found[-1].forms if form.has_inside(offset)]:
            found.append(inner[-1])
        return found

    def has_inside(self, offset: int) -> bool:
        """Return whether an offset is between its brackets."""
        return self.start < offset < self.end + (not self.is_closed)

    @property
    def types(self) -> tuple[str, ...]:
        """The types of its parts for the grammar, the keyword first."""
        kinds = (f"{i.keyword.upper()}_FORM" if isinstance(i, WrittenForm) else i[0] for i in self.items)
        return (self.keyword.upper(), *kinds)

    def span(self, index: int) -> tuple[int, int]:
        """Return the range of a part, counted as in `types`."""
        item = self.items[index - 1]
        return (item.start, item.end) if isinstance(item, WrittenForm) else (item[1], item[2])


class Sheet:
    """The text of a valid program, as nested forms in `root`; `line_end`: the first line end of the text.

    `tokens`: of a text that is not valid, with brackets that match.
    """

    def __init__(self, text: str, tokens: Sequence[Token] | None = None) -> None:
        self.text = text
        self._tokens = tokenize(text) if tokens is None else tokens
        self.root = WrittenForm(text, [("PROGRAM", 0, 0), *self._tokens], end=len(text))
        found = LINE_END.search(text)
        self.line_end = found[0] if found else "\n"

    def at(self, start: int) -> WrittenForm:
        """Return the form that begins at a place."""
        return self._nesting(start)[-1]

    def _nesting(self, start: int) -> list[WrittenForm]:
        """Return the form that begins at a place, after all forms that it is in, the top level first."""
        forms = [self.root]
        while forms[-1].start != start or len(forms) == 1:
            inner = forms[-1].forms
            forms.append(inner[bisect_right(inner, start, key=lambda form: form.start) - 1])
        return forms

    def name(self, span: tuple[int, int]) -> str:
        """Return the name in a range, as the parser reads it."""
        return normal(self.text[slice(*span)])

    # -- new forms -----------------------------------------------------------------------------------

    def added(self, parent: WrittenForm, *forms: str) -> Edit:
        """Return the edit that adds forms of one kind, or of increasing rank, to a form."""
        if parent is self.root:
            return self._at_top(forms)
        end, gap = self.place(parent, _keyword(forms[0]))
        return Edit(end, end, "".join(gap + form for form in forms))

    def place(self, parent: WrittenForm, keyword: str) -> tuple[int, str]:
        """Return where a new form goes in another one, and the white space to write before it."""
        before = self._predecessor(parent, keyword)
        first = next(iter(parent.forms), None)
        sample = before or first
        if not self._begins_line((sample or parent).start):
            return (before.end if before else parent.head), " "
        indent = self.indent(sample.start) if sample else self.indent(parent.start) + " " * STEP
        return self._after_comment(before.end if before else parent.head), self.line_end + indent

    def appended(self, form: WrittenForm, item: str) -> Edit:
        """Return the edit that adds an item after the last one of a form."""
        start, end = form.span(len(form.items))
        gap = self.line_end + self.indent(start) if self._begins_line(start) else " "
        end = self._after_comment(end) if gap != " " else end
        return Edit(end, end, gap + item)

    def spawned_by(self, state: WrittenForm, spawn: str) -> Edit:
        """Return the edit that adds a spawn to what a state does on entry."""
        entries = [form for form in state.forms if form.keyword == "onentry"]
        return self.appended(entries[-1], spawn) if entries else self.added(state, f"(onentry {spawn})")

    def _predecessor(self, parent: WrittenForm, keyword: str) -> WrittenForm | None:
        rank = _RANKS[keyword]
        alike = [form for form in parent.forms if _RANKS[form.keyword] == rank]
        lower = [form for form in parent.forms if _RANKS[form.keyword] < rank]
        return next(iter(reversed(alike or lower)), None)

    def _at_top(self, forms: tuple[str, ...]) -> Edit:
        keyword, one = _keyword(forms[0]), self.line_end
        before = self._predecessor(self.root, keyword)
        whole = (one * 2).join(forms)
        if before is not None:
            end = self._after_comment(before.end)
            apart = keyword == "machine" or (keyword in _APART and before.keyword != keyword)
            gap = one * (2 if apart else 1)
        elif self.root.forms:
            first = self.root.forms[0]
            return Edit(first.start, first.start, whole + one * (1 if keyword == first.keyword else 2))
        else:
            end = len(self.text.rstrip())
            gap = one * 2 if end else ""
        return Edit(end, end, gap + whole + ("" if self.text[end:] else one))

    def _after_comment(self, end: int) -> int:
        """Return the end of the comment that follows on the same line, with nothing between; else `end`."""
        found = _COMMENT.match(self.text, end)
        return found.end() if found else end

    def _begins_line(self, start: int) -> bool:
        line = self._line_start(start)
        return not self.text[line:start].strip(" \t\ufeff")

    def _line_start(self, offset: int) -> int:
        return max(self.text.rfind("\n", 0, offset), self.text.rfind("\r", 0, offset)) + 1

    def indent(self, offset: int) -> str:
        """Return the white space at the beginning of a line."""
        return _BLANKS.match(self.text, self._line_start(offset))[0]  # type: ignore[index]

    # -- removed forms -------------------------------------------------------------------------------

    def removed(self, forms: Iterable[WrittenForm]) -> list[Edit]:
        """Return the edits that remove forms, and forms that lose all their items. Comments stay."""
        gone = set(forms)
        for form in list(gone):
            around = self._nesting(form.start)[-2]
            if around.keyword in ACTIONS and gone.issuperset(set(around.items)):
                gone.add(around)
        runs: list[list[int]] = []
        for form in sorted(gone, key=lambda form: form.start):
            if runs and form.end <= runs[-1][1]:
                continue  # inside one that is removed
            if runs and not self.text[runs[-1][1] : form.start].strip():
                runs[-1][1] = form.end
            else:
                runs.append([form.start, form.end])
        return [self._cut(start, end) for start, end in runs]

    def _cut(self, start: int, end: int) -> Edit:
        """Return the edit that removes ``text[start:end]`` with the white space that belongs to it."""
        text, line = self.text, self._line_start(start)
        left = start - len(list(takewhile(" \t".__contains__, reversed(text[line:start]))))
        right = _BLANKS.match(text, end).end()  # type: ignore[union-attr]
        if left > line:
            return Edit(left, end, "")
        line_end = LINE_END.match(text, right)
        if line_end or right == len(text):
            return Edit(left, line_end.end() if line_end else right, "")
        if text[right] != ")":
            return Edit(start, right, "")
        index = bisect_left(self._tokens, start, key=lambda token: token[1])
        before = self._tokens[index - 1][2] if index else 0
        if text[before:left].strip():  # a comment: the bracket must not be on its line
            return Edit(start, right, "")
        return Edit(before, right, "")

    # -- moved forms ---------------------------------------------------------------------------------

    def shifted(self, form: WrittenForm, indent: str) -> str:
        """Return the text of a form indented for another line, the lines of strings unchanged."""
        text, old = self.text[form.start : form.end], self.indent(form.start)
        inside = (
            (start + 1 + begin, start + 1 + end)
            for kind, start, stop in tokenize(text)
            if kind == "BLOCK"
            for begin, end in strings(text[start + 1 : stop - 1])
        )
        return reindented(text, inside, lambda margin: indent + margin.removeprefix(old))


def _keyword(form: str) -> str:
    return keyword_of(form, tokenize(form)[0])


assert frozenset().union(*LEGAL.values()) <= _RANKS.keys()
