"""Parser: from text to program, with every error of the text at its own location.

The text is split into tokens, brackets are matched, and then every form is parsed by itself, innermost
first. A wrong form is reported and left out; the forms around it are parsed as if it were right.

Paper: §3.1, §3.2.
"""

from __future__ import annotations

import unicodedata
from bisect import bisect_right
from collections.abc import Iterable, Sequence
from itertools import groupby
from keyword import iskeyword

from lrp_jupyter.arguments import check_type
from lrp_jupyter.errors import MOST_FINDINGS, Edit, LRPSyntaxError, listed
from lrp_jupyter.language.blocks.block import facts_of, faults_of
from lrp_jupyter.language.mistakes import correct
from lrp_jupyter.language.mistakes.unclosed import unclosed
from lrp_jupyter.language.mistakes.wrong_brackets import is_form
from lrp_jupyter.language.program import Block, Finding, Machine, Name, Program, Span, Variable, line_starts
from lrp_jupyter.language.python.scanner import block_end
from lrp_jupyter.language.reading import elements_of_forms as nodes
from lrp_jupyter.language.reading.forms import USAGE, Mistake, Shape, article, expected_text, shape_of, short
from lrp_jupyter.language.reading.matching import Matching, match
from lrp_jupyter.language.reading.misplaced_forms import Members, Stray, members, relocated
from lrp_jupyter.language.reading.tokens import KEYWORDS, LEGAL, Token, keyword_of, tokenize
from lrp_jupyter.language.source import Diagnosis
from lrp_jupyter.language.spellings import closest
from lrp_jupyter.language.triggers import FORMS, Epsilon

MOST_PYTHON = 250_000
"""Characters of all blocks of a text: to compile so many takes seconds, and ten times as many a minute."""


def parse(text: str, filename: str = "<lrp>") -> Program:
    """Return the program that a text describes.

    Parameters
    ----------
    text : str
    filename : str
        Shown in tracebacks.

    Raises
    ------
    LRPSyntaxError
        The text is not a valid program; its ``findings`` are all the errors, in order of location.

    Examples
    --------
    >>> program = parse("(machine m (state a) (state b) (ontime 300 a -> b)) (spawn m a)")
    >>> [str(state.name) for state in program.machines[0].states]
    ['a', 'b']
    """
    check_type("text", text, str, "the text of a program")
    program, findings = scan(text, filename)
    if program is None:
        raise LRPSyntaxError(findings)
    return program


def scan(text: str, filename: str = "<lrp>") -> tuple[Program | None, tuple[Finding, ...]]:
    """Return a program, or None and all errors in order of location; never raise."""
    reader = _Reader(text, filename)
    program = reader.read()
    if not reader.findings:
        return program, ()
    found = reader.findings
    if len(found) <= _MANY and not all(map(_is_inside, found)):
        found = _corrected(text, found)
    place = Program(text=text).place
    found = sorted(set(found))
    first = [
        Finding(each.code, "error", each.message, *place(each.start), *place(each.end), each.fix, each.prefix)
        for each in found[:MOST_FINDINGS]
    ]
    return None, listed(first, len(found))


def sketch(text: str, filename: str = "<lrp>") -> Program:
    """Return as much of a program as a text has, for views of a text that is being written; never raise.

    Forms with errors are left out, and blocks that are not Python are empty.
    """
    return _Reader(text, filename, True).read() or Program(text=text, filename=filename)


def _is_inside(error: Diagnosis) -> bool:
    """Return whether an error hides nothing from the parser; a string that is not closed does."""
    return error.code.startswith(("LRP109", "LRP110", "LRP111", "LRP112", "LRP5")) and error.code != "LRP514"


_MANY = 100  # a text with more errors is something else than a program with mistakes
_ROUNDS = 5  # what one round corrects may have hidden something else


def _corrected(text: str, found: list[Diagnosis], rounds: int = _ROUNDS) -> list[Diagnosis]:
    """Return the errors of a text: those that can be corrected, and what is left of the others."""
    corrected = correct(text) if found and rounds else None
    if corrected is None:
        return found
    reader = _Reader(corrected.text, "")
    reader.read()
    rounds = rounds - 1 if corrected.text != text else 0
    left = [corrected.moved(each) for each in _corrected(corrected.text, reader.findings, rounds)]
    done = corrected.found
    return done + [
        each for each in left if not any(each.start < one.end and one.start < each.end for one in done)
    ]


class _Form:
    """A form being parsed; its first token is the keyword, and a nested form is one token."""

    __slots__ = ("declared", "empty", "keyword", "parts", "tokens", "types")

    def __init__(self, keyword: str, token: Token) -> None:
        self.keyword = keyword
        self.types = [keyword.upper()]
        self.parts: list[nodes.Part] = [None]
        self.tokens = [token]
        self.empty = False  # whether it has an empty block
        self.declared: list[tuple[str, Span]] = []  # names that blocks inside declare `global`

    def add(self, kind: str, part: nodes.Part, token: Token) -> None:
        self.types.append(kind)
        self.parts.append(part)
        self.tokens.append(token)


class _Reader:
    """Parses one text; findings are kept as offsets and located only at the end.

    `sketching`: whether a form is kept without the words in it that do not belong there.
    """

    def __init__(self, text: str, filename: str, sketching: bool = False) -> None:
        self.text = text
        self.filename = filename
        self.sketching = sketching
        self.starts = line_starts(text)
        self.python = 0  # characters of the blocks so far
        self.line = 1  # of the last block parsed …
        self.content = self.before = 0  # … its offset, and the bytes before that in its line
        self.invalid = 0  # blocks so far that are not Python
        self.findings: list[Diagnosis] = []
        self.strays: list[Stray] = []  # forms in the wrong form
        self.machines: list[Members] = []

    def read(self) -> Program | None:
        """Return the program, or at least what is found of it; `findings` are the errors."""
        tokens = tokenize(self.text)
        matching = match(self.text, self.starts, tokens)
        self.findings += matching.findings
        return None if matching.too_deep else self._build(tokens, matching)

    def report(self, start: int, end: int, code: str, message: str, *edits: Edit) -> None:
        """Register an error at a range of the text, with the edits that certainly repair it."""
        self.findings.append(Diagnosis(start, end, code, message, edits))

    def _build(self, tokens: Sequence[Token], matching: Matching) -> Program:
        _, extra, lost, closing, _ = matching
        text = self.text
        form = _Form("program", ("", 0, 0))
        forms: list[_Form] = []
        for index, token in enumerate(tokens):
            kind, start, end = token
            if closing and index in closing:
                for _ in range(closing[index]):
                    form = self._finish(form, forms, tokens[index - 1][2])
            if kind == "OPEN" or (lost and index in lost):
                forms.append(form)
                form = _Form(keyword_of(text, token), token)
                continue
            if kind == "CLOSE":
                if index not in extra:
                    form = self._finish(form, forms, end)
                continue
            word = text[start:end]
            part: nodes.Part = None
            if kind == "NAME":
                part = Name(word if word.isascii() else self._name(word, start, end), Span(start, end))
            elif kind == "BLOCK":
                part = self._block(word, start, end, form)
            elif kind == "INTEGER":
                part = self._integer(word, start, end, form)
            elif kind in _BROKEN:
                self._broken(kind, word, start, end, form)
                if kind in _MEANINGLESS:
                    continue
                kind, part = "BLOCK", Block("", Span(start, end)) if self.sketching else None
            form.add(kind, part, token)
        for _ in range(closing.get(len(tokens), 0)):
            form = self._finish(form, forms, tokens[-1][2])
        self._shape(form, len(text))
        for stray in self.strays[:_MANY]:
            edits = relocated(stray, self.machines, text)
            if edits:
                self.findings[stray.finding] = self.findings[stray.finding]._replace(edits=edits)
        program = nodes.program(form.types, form.parts, text, self.filename)
        self._declared(form, program.variables)
        return program

    def _broken(self, kind: str, word: str, start: int, end: int, form: _Form) -> None:
        if kind == "UNCLOSED":
            doubled = word.startswith("[[") and facts_of(word[2:-1]).valid
            if word.endswith("]") and not doubled and not facts_of(word[1:]).valid:
                # a quote or a `]` inside is missing
                faults = faults_of(word[1:-1], is_condition=form.keyword in _TESTED)
                if len(faults) == 1 and {edit.text for edit in faults[0].edits} & {"]", "'", '"'}:
                    self.findings.append(faults[0].shifted(start + 1))
                    return
            closes = block_end(f"{word}]", 0) == len(word)  # else a string or comment would hide it
            place = unclosed(self.text, start, end if closes else start)
            self.report(*place, *([Edit(end, end, "]")] if closes else []))
        elif kind == "UNOPENED":
            message = "A `[` is missing here, before the Python that ends with `]`. Insert it."
            self.report(start, start + 1, "LRP103", message, Edit(start, start, "["))
        else:
            what = f"`{short(word)}` is not part of the language"
            if word == "]":
                what = "Unmatched `]`: there is no open block here"
            last = self.findings[-1] if self.findings else None
            if last and last.code == "LRP104" and last.end == start and word != "]":
                start = self.findings.pop().start  # one error for all of a row
                what = f"`{short(self.text[start : min(end, start + 40)])}` is not part of the language"
            self.report(start, end, "LRP104", f"{what}. Remove it.", Edit(start, end, ""))

    def _integer(self, word: str, start: int, end: int, form: _Form) -> int:
        if word.isascii() and word.isdecimal() and len(word) < 16:
            return int(word)
        if form.keyword != "ontime" and form.types[-1] != "FOR":
            return 0  # no number belongs there: that is the error
        remedy = f"Write digits only, or a block: `[{word}]`."
        self.report(start, end, "LRP108", f"`{word}` is not a whole number of milliseconds. {remedy}")
        return 0

    def _name(self, word: str, start: int, end: int) -> str:
        if not word.isidentifier():
            self.report(start, end, "LRP110", f"`{word}` is not a valid name. Use letters, digits and `_`.")
        return unicodedata.normalize("NFKC", word)  # as Python does

    def _block(self, word: str, start: int, end: int, form: _Form) -> Block:
        starts = self.starts
        line = self.line
        while line < len(starts) and starts[line] <= start:
            line += 1
        self.line = line
        content = start + 1
        line_start = starts[line - 1]
        if self.content < line_start:
            self.content, self.before = line_start, 0
        self.before += len(self.text[self.content : content].encode("utf-8", "replace"))
        self.content = content
        block = Block(word[1:-1], Span(start, end), line, content - line_start + 1, self.before)
        before, self.python = self.python, self.python + end - start
        if self.python > MOST_PYTHON:
            if before <= MOST_PYTHON:
                message = (
                    f"The blocks up to here have more than {MOST_PYTHON:,} characters. Move functions and "
                    "tables into a module, and import it."
                )
                self.report(start, start + 1, "LRP501", message)
            return block
        empty, valid, declared = facts_of(block.text)
        if empty:
            form.empty = True
        if not valid and is_form(block.text, form.keyword):
            self.report(start, end, "LRP104", "A form is written in round brackets.")
        elif not valid:
            self.invalid += 1
            is_brief = self.invalid > _EXPLAINED
            if self.sketching:
                return Block("", block.span)
            for fault in faults_of(block.text, line, block.column - 1, form.keyword in _TESTED, is_brief):
                self.findings.append(fault.shifted(content))
        for name, first, last in declared:
            form.declared.append((name, Span(content + first, content + last)))
        return block

    def _finish(self, form: _Form, forms: list[_Form], end: int) -> _Form:
        """Close a form, append its value to the enclosing form, and return that form."""
        outer = forms.pop()
        keyword = form.keyword
        if keyword in KEYWORDS:
            shape = self._shape(form, end)
            part = None
            start = form.tokens[0][1]
            if not isinstance(shape, Mistake):
                part = nodes.node(keyword, form.types, form.parts, shape, Span(start, end))
                if form.empty or form.declared or keyword in _VALIDATED:
                    self._validate(form, shape, part)
            if keyword == "machine":
                self.machines.append(members(form.parts, Span(start, end)))
            kind = _FORM_TYPES[keyword]
            if part is not None or not self.sketching:
                outer.add(kind, part, (kind, start, end))
        else:
            self._unknown(form, outer.keyword)
        if form.declared:
            outer.declared += form.declared
        return outer

    def _validate(self, form: _Form, shape: Shape | None, part: nodes.Node) -> None:
        """Report errors that the grammar does not exclude."""
        keyword = form.keyword
        if keyword == "var" and isinstance(part, Variable):
            if iskeyword(part.name) or part.name == "__debug__":
                message = f"`{part.name}` is a keyword of Python. Give the variable another name."
                self.report(*form.tokens[1][1:], "LRP110", message)
        elif shape is not None and shape.source == "every" and keyword == Epsilon.keyword:
            message = (
                "An `eps` from `*` would leave every other state before it acts. "
                "Name its sources, as in `(eps {a b} -> c)`."
            )
            self.report(*form.tokens[form.types.index("STAR")][1:], "LRP112", message)
        if form.empty and keyword in _FILLED:
            _, start, end = form.tokens[form.types.index("BLOCK")]
            self.report(start, end, "LRP109", f"This block is empty. Write {_FILLED[keyword]} into it.")
        if form.declared and isinstance(part, Machine):
            self._declared(form, part.variables)

    def _declared(self, form: _Form, variables: Sequence[Variable | None]) -> None:
        """Report the blocks that declare one of these variables `global`."""
        names = {variable.name for variable in variables if variable}
        for name, span in form.declared:
            if name in names:
                what = "a variable of the program, not a global of Python"
                message = f"`{name}` is {what}. Remove this `global`."
                self.report(*span, "LRP501", message)

    # Mistakes

    def _unknown(self, form: _Form, around: str) -> None:
        legal = sorted(LEGAL.get(around, KEYWORDS))
        _, start, end = form.tokens[0]
        if not form.keyword:
            message = f"This `(` has no keyword. Write {_either(legal)} after it."
            self.report(start, start + 1, "LRP106", message)
            return
        close = closest(form.keyword, legal, 0.6) or closest(form.keyword, KEYWORDS, 0.6)
        hint = f"Did you mean `{close}`?" if close else f"Write {_either(legal)}."
        self.report(end - len(form.keyword), end, "LRP106", f"`{form.keyword}` is not a keyword. {hint}")

    def _shape(self, form: _Form, end: int) -> Shape | Mistake | None:
        """Return the shape of a form, after reporting what violates the grammar."""
        shape = shape_of(tuple(form.types))
        if isinstance(shape, Mistake):
            before = len(form.types)
            self._drop_misplaced(form, end)
            shape = shape_of(tuple(form.types))
            emptied = len(form.types) == 1 < before  # what it lacks was perhaps in the wrong form
            if isinstance(shape, Mistake) and not emptied:
                self._mistaken(form, shape, end)
            if self.sketching:
                kept = [at for at, kind in enumerate(form.types) if at < 2 or kind.endswith(_LASTING)]
                form.types, form.parts = [form.types[at] for at in kept], [form.parts[at] for at in kept]
                form.tokens = [form.tokens[at] for at in kept]
                shape = shape_of(tuple(form.types))
        return shape

    def _drop_misplaced(self, form: _Form, end: int) -> None:
        """Report and drop what is not allowed in a form at all, so that the rest can be checked."""
        legal = LEGAL.get(form.keyword, frozenset())
        kept = []
        rows = list(zip(form.types, form.parts, form.tokens, strict=True))
        for index, row in enumerate(rows):
            keyword = row[0].removesuffix("_FORM").lower()
            if keyword in legal or not row[0].endswith("_FORM"):
                kept.append(row)
            elif form.keyword not in ("running", "onexit") or rows[index - 1][0] != row[0]:
                self._misplaced(keyword, form, index, end)
        if form.keyword == "program":
            for is_form, run in groupby(kept[1:], key=lambda row: row[0].endswith("_FORM")):
                if not is_form:
                    tokens = [token for _, _, token in run]
                    message = "This is outside every form. Put it into a form, or after `;` as a comment."
                    self.report(tokens[0][1], tokens[-1][2], "LRP105", message)
            kept[1:] = [row for row in kept[1:] if row[0].endswith("_FORM")]
        form.types, form.parts, form.tokens = (list(column) for column in zip(*kept, strict=True))

    def _misplaced(self, keyword: str, form: _Form, index: int, end: int) -> None:
        around = form.keyword
        homes = [home for home, legal in LEGAL.items() if keyword in legal]
        start = self.text.index(keyword, form.tokens[index][1])
        places = ["at the end of a transition"] if homes == [*FORMS] else [*map(_where, homes)]
        message = f"`{keyword}` is not allowed {_where(around)}. Put it {_one_of(places)}."
        is_right = form.parts[index] is not None  # else it may be meant for another form
        edits = self._relocated(keyword, form, index, end) if is_right and len(self.findings) <= _MANY else ()
        self.strays.append(Stray(len(self.findings), form.parts[index], *form.tokens[index][1:]))
        self.report(start, start + len(keyword), "LRP107", message, *edits)

    def _relocated(self, keyword: str, form: _Form, index: int, end: int) -> tuple[Edit, ...]:
        """Return the edits that put a form where it certainly belongs, or none."""
        _, start, stop = form.tokens[index]
        text = self.text[start:stop]
        around = form.keyword
        if keyword == "spawn" and around == "state":
            return Edit(start, start, "(onentry "), Edit(stop, stop, ")")
        if keyword == "spawn" and around in ("running", "onexit") and "BLOCK" not in form.types:
            head = form.tokens[0]
            is_first = around == "running" and index == 1
            return (Edit(head[2] - len(around), head[2], "onentry"),) if is_first else ()
        gone = Edit(len(self.text[:start].rstrip()), stop, "")
        if around == "state" and keyword in LEGAL["machine"]:
            if keyword in ("var", "event"):
                opening = form.tokens[0][1]
                return Edit(opening, opening, f"{text} "), gone
            return gone, Edit(end, end, f" {text}")
        if keyword == "spawn" and around == "machine":
            return gone, Edit(end, end, f"\n{text}")
        home = {"program": "MACHINE_FORM", "machine": "STATE_FORM"}.get(around)
        inner = {"program": LEGAL["machine"], "machine": LEGAL["state"]}.get(around, frozenset())
        last = next((at for at in range(index - 1, 0, -1) if form.types[at] == home), None)
        if last is None or keyword not in inner or (around == "program" and form.types.count(str(home)) > 1):
            return ()
        close = form.tokens[last][2] - 1
        return Edit(close, close, f" {text}"), gone

    def _mistaken(self, form: _Form, mistake: Mistake, end: int) -> None:
        index, expected = mistake
        what = expected_text(form.keyword, tuple(form.types[:index]), expected)
        usage = f"Write `{USAGE[form.keyword]}`."
        if index == len(form.types):
            message = f"`{form.keyword}` lacks {what} here. {usage}"
            self.report(end - 1, end, "LRP108", message)
            return
        _, start, stop = form.tokens[index]
        _, first, last = form.tokens[index - 1]
        if index and bisect_right(self.starts, last) < bisect_right(self.starts, start):
            message = f"`{form.keyword}` lacks {what} after this. {usage}"
            self.report(first, last, "LRP108", message)
            return
        found = short(self.text[start : min(stop, start + 40)])
        message = f"Expected {what} instead of `{found}`. {usage}"
        if form.keyword in _TESTED and form.types[index - 1 : index + 1] == ["BLOCK", "BLOCK"]:
            message = f"`{form.keyword}` has one condition. Join the two with `and` or `or`."
        elif what == "its name":
            message = f"Expected the name of this `{form.keyword}` instead of `{found}`. {usage}"
        self.report(start, stop, "LRP108", message)


_EXPLAINED = 20
"""Blocks of a text for which the remedies of their errors are searched."""
_TESTED = frozenset({"event", "on", "exit"})
"""The forms whose block is a condition."""
_LASTING = ("_FORM", "BLOCK")
"""What stays in a form that is being written, besides its name."""
_MEANINGLESS = frozenset({"COMMENT", "QUOTED", "STRAY"})
_BROKEN = _MEANINGLESS | {"UNCLOSED", "UNOPENED"}
_FORM_TYPES = {keyword: f"{keyword.upper()}_FORM" for keyword in KEYWORDS}
_VALIDATED = frozenset({"var", Epsilon.keyword})
_FILLED = {
    "var": "the variable's value",
    "event": "the event's condition",
    **{keyword: form.block for keyword, form in FORMS.items() if form.block},
}
"""What the block of a form must contain: the value of an empty block would be `None`."""


def _where(keyword: str) -> str:
    return "at the top level" if keyword == "program" else f"in {article(keyword)} `{keyword}`"


def _either(words: Iterable[str]) -> str:
    return _one_of([f"`{word}`" for word in words])


def _one_of(words: Sequence[str]) -> str:
    return f"{', '.join(words[:-1])} or {words[-1]}" if words[1:] else words[0]
