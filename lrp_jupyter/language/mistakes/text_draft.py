"""A wrong text as nested forms: what a rule sees of it, and what a rule proposes."""

from __future__ import annotations

import ast
import builtins
import re
from collections.abc import Iterator, Sequence
from functools import cached_property
from keyword import kwlist
from typing import NamedTuple, cast

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.blocks.block import facts_of, read
from lrp_jupyter.language.blocks.builtin_names import PROVIDED, TIMES
from lrp_jupyter.language.python.block_suite import no_warnings
from lrp_jupyter.language.python.python_parser import parse_python
from lrp_jupyter.language.reading.forms import Mistake, shape_of
from lrp_jupyter.language.reading.tokens import HELD, KEYWORDS, LEGAL, NAMED, Token, keyword_of, tokenize
from lrp_jupyter.language.spellings import ARROWS, SIGN

_HYPHENED = re.compile(r"\(\s*event\s+(\w+(?:-\w+)+)")
_WORD = re.compile(r"[^\W\d]\w*")
_DEFINED = re.compile(rf"\(\s*(?:{'|'.join(sorted(NAMED))})\s+([^\s()\[\]]+)")
_WHOLE = re.compile(r"[\s()\[\]{}:;=#]|\Z")
"""What may stand after a name; another character is part of the word."""
_LONGEST = 6
"""Words of a name, and one more."""
_MOST_PHRASES = 20
_ARROW = re.compile(f"[{ARROWS}]+")
SIGNS = frozenset({"SIGN", "ASSIGN", "ARROW", "MINUS"})
_AS_IF = {"INVALID": "BLOCK", "UNCLOSED": "BLOCK", "UNOPENED": "BLOCK", "WORD": "NAME", "AMOUNT": "INTEGER"}
"""What a wrong part is, apart from what is wrong with it."""
_WRONG = frozenset({"COMMENT", "QUOTED", "STRAY", *_AS_IF})


class Piece(NamedTuple):
    """A part of a form: its type, and ``text[start:end]``.

    The type is that of a token or, where no form can have it, ``SIGN`` (a wrong arrow or assignment),
    ``WORD`` (a name that is none), ``AMOUNT`` (a number that is no delay) or ``INVALID`` (no Python).
    """

    kind: str
    start: int
    end: int


class DraftForm:
    """A form of a wrong text.

    `first` and `head` are the start and the end of its keyword as it is written. `around` is
    the keyword of the form around, and `row` the parts of that.
    """

    def __init__(self, keyword: str, start: int, head: int, around: str) -> None:
        self.keyword = keyword
        self.start = start
        self.first = head - len(keyword)
        self.head = self.end = head
        self.around = around
        self.items: list[Item] = []
        self.row: list[Item] = []

    @property
    def kind(self) -> str:
        """Its type in the form around it."""
        return f"{self.keyword.upper()}_FORM" if self.keyword in KEYWORDS else "FORM"

    @property
    def kinds(self) -> tuple[str, ...]:
        """The types of its parts."""
        return tuple([item.kind for item in self.items])

    def part(self, items: Sequence[Item], index: int) -> tuple[str, int]:
        """Return the type and the offset of a part if these are its parts; its end after the last."""
        return (items[index].kind, items[index].start) if index < len(items) else ("END", self.end)

    def replaced(self, first: int, last: int, *items: Item) -> list[Item]:
        """Return its parts with others instead of some."""
        return [*self.items[:first], *items, *self.items[last + 1 :]]

    def name(self) -> list[Piece]:
        """Return what is in the place of its keyword as a part."""
        return [Piece("NAME", self.first, self.head)] if self.keyword else []


Item = Piece | DraftForm


class Correction(NamedTuple):
    """What may be wrong with a form: an error, the edits that repair it, and the parts after them.

    `is_certain`: nothing else can be meant, so that the edits are offered as a fix.
    `hides`: the text after it is to be read again.
    `is_prefix`: the error is a word with which a keyword begins.
    `keyword`: that of the form, if it is another one.
    `alone`: it is wrong even if the form stays wrong before or at it.
    `doubt`: the message instead, if it turns out not to be certain.
    """

    code: str
    message: str
    start: int
    end: int
    edits: tuple[Edit, ...]
    items: Sequence[Item]
    is_certain: bool = True
    hides: bool = False
    is_prefix: bool = False
    keyword: str = ""
    alone: bool = False
    doubt: str = ""


Corrections = Iterator[Correction]


class TextDraft:
    """A wrong text; `missing` is the number of `)` that it lacks."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = tokenize(text)
        kinds = [token[0] for token in self.tokens]
        self.missing = kinds.count("OPEN") - kinds.count("CLOSE")
        self.names: set[str] = set()
        self.defined: dict[str, set[str]] = {keyword: set() for keyword in NAMED}
        for index, (kind, start, end) in enumerate(self.tokens):
            if kind == "NAME":
                self.names.add(text[start:end])
                if index and self.tokens[index - 1][0] == "OPEN" and _WHOLE.match(text, end):
                    keyword = keyword_of(text, self.tokens[index - 1]).lower()
                    self.defined.get(keyword, set()).add(text[start:end])
        self.hyphened = {word.replace("-", "_") for word in _HYPHENED.findall(text)}
        self.quotes = 0
        """Blocks so far in which a quote is missing."""

    @cached_property
    def phrases(self) -> dict[tuple[str, ...], list[Edit]]:
        """The names of several words of states and machines that contain forms.

        With the edits that join them everywhere: some places can be read as two names.
        """
        found: dict[tuple[str, ...], list[Edit]] = {}
        kinds = [token[0] for token in self.tokens]
        for at, token in enumerate(self.tokens):
            if token[0] == "OPEN" and keyword_of(self.text, token) in ("state", "machine"):
                end = next((end for end in range(at + 1, len(kinds)) if kinds[end] != "NAME"), at)
                if 2 < end - at < _LONGEST and kinds[end] == "OPEN" and len(found) < _MOST_PHRASES:
                    found[tuple(map(self.word, self.tokens[at + 1 : end]))] = []
        lengths = set(map(len, found))
        for at in range(len(self.tokens) if found else 0):
            for length in lengths:
                piece = self.tokens[at : at + length]
                words = tuple(map(self.word, piece))
                if words in found and {token[0] for token in piece} == {"NAME"}:
                    found[words].append(Edit(piece[0][1], piece[-1][2], "_".join(words)))
        return found

    @property
    def events(self) -> set[str]:
        """The names of the events."""
        return self.defined["event"]

    @property
    def states(self) -> set[str]:
        """The names of the states."""
        return self.defined["state"]

    @cached_property
    def definitions(self) -> set[str]:
        """What forms define, as it is written, valid or not."""
        return set(_DEFINED.findall(self.text))

    @cached_property
    def members(self) -> dict[str, set[str]]:
        """The names that the machines define, by the names of these."""
        found: dict[str, set[str]] = {}
        around = [""]  # the names of machines, and nothing for other forms
        for token, after in zip(self.tokens, [*self.tokens[1:], ("", 0, 0)], strict=True):
            if token[0] == "OPEN":
                keyword, name = keyword_of(self.text, token), self.word(after)
                if keyword in NAMED:
                    found.setdefault(around[-1], set()).add(name)
                around.append(name if keyword == "machine" else "")
            elif token[0] == "CLOSE" and len(around) > 1:
                around.pop()
        return found

    def word(self, item: Item | Token) -> str:
        """Return the text of a part."""
        start, end = (item.start, item.end) if isinstance(item, DraftForm) else item[1:]
        return self.text[start:end]

    def known(self, except_from: int = -1) -> set[str]:
        """Return the names that are used anywhere in the text but in one block, and Python's own."""
        words = {
            word
            for token in self.tokens
            if token[0] == "BLOCK" and token[1] != except_from
            for word in _WORD.findall(self.word(token))
        }
        return words | self.names | set(kwlist) | set(dir(builtins)) | PROVIDED

    def makes_sense(self, python: str) -> bool:
        """Return whether Python reads only what there is, and of an event only its value."""
        if not is_python(python):
            return False
        tree, _, _, uses = read(python)
        block = uses.scope
        reads = {use.name for use in uses.found if use.owner is block and use.name not in block.bound}
        kinds = ast.Call | ast.Attribute | ast.Subscript
        parts = [node for node in ast.walk(tree) if isinstance(node, kinds)]
        wholes = [node.func if isinstance(node, ast.Call) else node.value for node in parts]
        divided = {whole.id for whole in wholes if isinstance(whole, ast.Name)}
        return reads <= self.values and not divided & self.events

    @cached_property
    def values(self) -> set[str]:
        """The names that Python may read: what is defined or already read, and Python's own."""
        blocks = [self.word(token) for token in self.tokens if token[0] == "BLOCK"]
        words = {word for block in blocks for word in _WORD.findall(block)}
        defined = self.defined["var"] | self.events | self.defined["machine"]
        return words | defined | PROVIDED | TIMES | set(dir(builtins))

    def spaced(self, offset: int) -> bool:
        """Return whether what ends at an offset is followed by white space or a closing bracket."""
        return not self.text[offset : offset + 1].strip() or self.text[offset] in ")]}"

    def read(self) -> DraftForm:
        """Return the whole text as a form."""
        forms = [DraftForm("program", 0, 0, "")]
        for token in self.tokens:
            form = forms[-1]
            kind, start, end = token
            if kind == "OPEN":
                forms.append(DraftForm(keyword_of(self.text, token), start, end, form.keyword))
                form.items.append(forms[-1])
            elif kind == "CLOSE" and len(forms) > 1:
                forms.pop().end = end
            else:
                if kind == "DOT" and (form.keyword not in HELD or form.kinds != ("NAME",)):
                    token = ("STRAY", start, end)
                form.items += self._parts(token, form.items)
        while forms:
            form = forms.pop()
            form.end = max([form.end, *[item.end for item in form.items[-1:]]])
        return form

    def _parts(self, token: Token, before: list[Item]) -> list[Item]:
        """Return the parts that a token is or, if it continues a sign before it, change that."""
        (kind, start, end), text = token, self.text
        word = text[start:end]
        strange = kind == "NAME" and not word.isascii()
        arrow = _ARROW.search(word) if strange else None
        if arrow:
            first, last = start + arrow.start(), start + arrow.end()
            ends = ((start, first, "NAME"), (first, last, "SIGN"), (last, end, "NAME"))
            return [Piece(each, one, other) for one, other, each in ends if one < other]
        if kind in ("ARROW", "ASSIGN", "MINUS", "STRAY") and SIGN.fullmatch(word):
            sign = before[-1] if before else None
            apart = "" if [item.kind for item in before[-2:]] == ["STAR", "MINUS"] else " "
            joins = sign and not (word == "-" and text[sign.end - 1] in "=:")  # `:= -1`
            if sign and joins and sign.kind in SIGNS and text[sign.end : start] in ("", apart):
                before[-1] = Piece("SIGN", sign.start, end)
                return []
            return [Piece("SIGN" if kind == "STRAY" else kind, start, end)]
        if kind == "INTEGER" and not (word.isascii() and word.isdecimal()):
            kind = "AMOUNT"
        elif strange and not word.isidentifier():
            kind = "WORD"
        elif kind == "BLOCK" and not facts_of(word[1:-1]).valid:
            kind = "INVALID"
        return [Piece(kind, start, end)]


def first_wrong(keyword: str, items: Sequence[Item], ignored: set[Item]) -> int | None:
    """Return the index of the first part that a form cannot have, apart from forms in the wrong form."""
    types = (keyword.upper(), *[item.kind for item in items])
    if keyword in KEYWORDS and not isinstance(shape_of(types), Mistake):
        return None
    legal = LEGAL.get(keyword, frozenset())
    kept = [
        index
        for index, item in enumerate(items)
        if item not in ignored
        and not (isinstance(item, DraftForm) and item.keyword in KEYWORDS and item.keyword not in legal)
    ]
    if keyword not in KEYWORDS and keyword != "program":
        return next((index for index in kept if items[index].kind in _WRONG), None)
    shape = shape_of((types[0], *[items[index].kind for index in kept]))
    return (*kept, len(items))[shape.position - 1] if isinstance(shape, Mistake) else None


def given_up(item: Item) -> Item | None:
    """Return what a part is if nothing can be done about what is wrong with it; None if it is nothing."""
    kind = _AS_IF.get(item.kind)
    return item._replace(kind=kind) if kind and isinstance(item, Piece) else None


def as_if(items: Sequence[Item]) -> tuple[str, ...]:
    """Return the types of parts, apart from what is wrong with them."""
    return tuple([_AS_IF.get(item.kind, item.kind) for item in items])


def is_complete(keyword: str, kinds: Sequence[str]) -> bool:
    """Return whether a form is right that has these parts."""
    return keyword in KEYWORDS and not isinstance(shape_of((keyword.upper(), *kinds)), Mistake)


def expression(text: str) -> ast.expr | None:
    """Return the tree of an expression; None for anything else."""
    try:
        with no_warnings():
            return cast(ast.expr, parse_python(text.strip(), mode="eval").body)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None


def is_python(text: str) -> bool:
    """Return whether a text is Python that does something."""
    facts = facts_of(text)
    return facts.valid and not facts.empty
