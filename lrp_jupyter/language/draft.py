"""A wrong text while it is read for correction: its tokens, the open forms, and what was found so far."""

from __future__ import annotations

import builtins
import re
from bisect import bisect_left
from collections.abc import Sequence
from keyword import kwlist
from typing import NamedTuple

from lrp_jupyter.errors import Edit
from lrp_jupyter.language.blocks import facts_of
from lrp_jupyter.language.provided import PROVIDED
from lrp_jupyter.language.source import Diagnosis
from lrp_jupyter.language.tokens import Token, keyword_of, tokenize

LONGEST = 40
"""Number of parts that are looked at: more than any form has that can be corrected."""


_HYPHENED = re.compile(r"\(\s*event\s+(\w+(?:-\w+)+)")
_WORD = re.compile(r"[^\W\d]\w*")


class Piece(NamedTuple):
    """A part of a form: its type, ``text[start:end]``, and the keyword of a nested form."""

    kind: str
    start: int
    end: int
    keyword: str = ""


class OpenForm:
    """A form being read."""

    __slots__ = ("commas", "items", "keyword", "start")

    def __init__(self, keyword: str, start: int) -> None:
        self.keyword = keyword
        self.start = start
        self.items: list[Piece] = []
        self.commas: list[Edit] = []

    @property
    def types(self) -> tuple[str, ...]:
        """The types of its first parts: more than any form that can be corrected has."""
        return tuple([item.kind for item in self.items[:LONGEST]])


class TextDraft:
    """A wrong text; `edits` correct it, `found` are the errors."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = tokenize(text)
        self.starts = [token[1] for token in self.tokens]
        kinds = [token[0] for token in self.tokens]
        self.missing = kinds.count("OPEN") - kinds.count("CLOSE")  # number of `)`
        self.names: dict[str, int] = {}
        self.events: set[str] = set()
        self.machines: set[str] = set()
        self.states: set[str] = set()
        self.variables: set[str] = set()
        defined = {"event": self.events, "machine": self.machines, "state": self.states}
        defined["var"] = self.variables
        for index, (kind, start, end) in enumerate(self.tokens):
            if kind == "NAME":
                name = text[start:end]
                self.names[name] = self.names.get(name, 0) + 1
                if index and self.tokens[index - 1][0] == "OPEN":
                    keyword = keyword_of(text, self.tokens[index - 1]).lower()
                    if keyword in defined:
                        defined[keyword].add(name)
        self.hyphened = {word.replace("-", "_") for word in _HYPHENED.findall(text)}
        self.frames = [OpenForm("program", 0)]
        self.edits: list[Edit] = []
        self.found: list[Diagnosis] = []
        self.misspelt: set[str] = set()
        self.quotes = 0  # blocks so far in which a quote is missing

    def _add(self, start: int, end: int, code: str, message: str, *edits: Edit, certain: bool = True) -> None:
        """Register an error and the edits that correct it; they are its fix if they are certain."""
        self.found.append(Diagnosis(start, end, code, message, edits if certain else ()))
        self.edits += edits

    def _after(self, offset: int) -> int:
        """Return the index of the first token from an offset on."""
        return bisect_left(self.starts, offset)

    def _word(self, token: Token | Piece) -> str:
        return self.text[token[1] : token[2]]

    def _kind(self, index: int) -> str:
        return self.tokens[index][0] if index < len(self.tokens) else ""

    def _rest(self, index: int) -> Sequence[Token]:
        """Return the tokens of the form up to its `)` or the next form."""
        rest = []
        for token in self.tokens[index : index + 12]:
            if token[0] in ("OPEN", "CLOSE"):
                break
            rest.append(token)
        return rest

    def _known(self, except_from: int = -1) -> set[str]:
        """Return the names that are used anywhere in the text but in one block, and Python's own."""
        words = {
            word
            for token in self.tokens
            if token[0] == "BLOCK" and token[1] != except_from
            for word in _WORD.findall(self._word(token))
        }
        return words | set(self.names) | set(kwlist) | set(dir(builtins)) | PROVIDED


def is_python(text: str) -> bool:
    """Return whether a text is Python that does something."""
    facts = facts_of(text)
    return facts.valid and not facts.empty
